// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/race/lookout.hpp"

#include "looks.hpp"

namespace gatefly::measuring {

/// What a pilot would have of one picture.
struct Answer {
  std::vector<GateDetection> gates;  ///< Whole ones, outer corners.
  std::optional<LowerCorners> lower;
  std::optional<GateBars> bars;
  std::optional<GateDetection> cut;  ///< A gate that the border cuts.
};

/// A detector used as the pilot uses it: ours looks everywhere when the gate that is flown to does
/// not stand out; the paper's, as it flew, tries the last picture's gate again.
class Eye {
 public:
  Eye(Detector detector, const LookoutParams& params);

  /// @param target  the gate that is flown to, where it is whole in the picture.
  [[nodiscard]] Answer look(const Image& image, const std::optional<Quad>& target);
  /// The next picture does not follow the last.
  void forget() { previous_.reset(); }

 private:
  [[nodiscard]] std::vector<GateDetection> whole(const Image& image, LookFor::Gates wanted);

  LookoutParams params_;
  GateDetector detector_;
  bool is_paper_;
  std::optional<Quad> previous_;
};

/// Shares this much of both areas with the gate: it is that gate. [the paper's rule]
inline constexpr double kSame = 0.7;

}  // namespace gatefly::measuring
