// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/race/course.hpp"
#include "gatefly/race/lookout.hpp"
#include "gatefly/race/messages.hpp"

namespace gatefly {

/// The paper's eye: the best gate of a picture is the one that is flown to; rays meet where the drone
/// is.
///
/// Source: Li18 §3.2, Eq. (5)-(10), and the checks of its flight code: side bars before corners,
/// nothing from behind the gate or from before the leg. Differs: attitude with the right signs, all
/// four corners (docs/paper/deviations.md#eq-5). The filter is corrected with whatever comes: no
/// second sighting, no other gates of the map, no heading.
class PaperLookout {
 public:
  explicit PaperLookout(const LookoutParams& params);

  /// See Lookout::look.
  void look(const Sensors& sensors, bool looking, const Course& course, Navigator& navigator);

  /// Result of the last picture.
  [[nodiscard]] const Sighting& sighting() const { return sighting_; }

 private:
  void find_gates(const Sensors& sensors);
  [[nodiscard]] std::optional<Fix> fix_of(const Navigator::Past& then, const MapGate& gate,
                                          bool by_corners);

  LookoutParams params_;
  GateDetector detector_;
  Sighting sighting_;
  std::optional<Quad> previous_;  ///< The last picture's gate.
};

}  // namespace gatefly
