// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/experiments/blind_arc.hpp"

namespace gatefly::experiments {

/// Arcs from one source, as they are drawn and counted.
struct ArcSource {
  std::string name;  ///< "" as a picture's caption: not in its legend.
  drawing::Color color;
  std::vector<BlindArc> arcs;
  std::optional<Spread2> told;  ///< Only this is known of somebody else's arcs.

  /// Spread of the displacements.
  [[nodiscard]] Spread2 displacement() const;
};

/// End points seen from the entry, with an ellipse of one σ for each source; the paths above each
/// other; and one small picture for each arc of `each`. x is up, the inside of the turn is right.
[[nodiscard]] drawing::Canvas picture_of(const std::vector<ArcSource>& sources,
                                         const ArcSource& each, const PlannedArc& planned);

}  // namespace gatefly::experiments
