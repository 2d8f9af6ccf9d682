// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/detection/paper/paper_detector.hpp"

namespace gatefly::test {

/// Settings of all detectors.
struct DetectorSettings {
  ColorModel model = ColorModel::described({1.0, 0.4, 0.0});
  GateDetectorParams search;
  std::optional<Quad> previous;
};

/// Runs every detector on a picture; "" when all answers are possible ones, else what is wrong with
/// which.
class AllDetectors {
 public:
  [[nodiscard]] std::string complaint(const Image& image, const DetectorSettings& settings) {
    using Gates = LookFor::Gates;
    using Part = LookFor::Part;
    for (const auto& [name, mode, look_for] :
         {Case{"fast", DetectorMode::kFast, {Gates::kAll}},
          Case{"careful", DetectorMode::kCareful, {Gates::kAll}},
          Case{"ours", DetectorMode::kOurs, {Gates::kStandingOut}},
          Case{"best", DetectorMode::kOurs, {Gates::kBest}},
          Case{"part", DetectorMode::kOurs, {Gates::kNone, Part::kToo}},
          Case{"paper", DetectorMode::kPaper, {Gates::kAll}},
          Case{"side bars", DetectorMode::kFlown, {Gates::kNone, Part::kToo}}}) {
      GateDetector detector{settings.search, mode};
      const auto what = wrong(detector.look(image, settings.model, look_for), image);
      if (!what.empty()) return std::string{name} + ": " + what;
    }
    Rng rng{1};
    if (const auto gate = detect_as_flown(image, {}, rng, settings.previous))
      if (const auto what = wrong(*gate, image); !what.empty()) return "flown: " + what;
    return "";
  }

 private:
  struct Case {
    const char* name;
    DetectorMode mode;
    LookFor look_for;
  };
  static bool is_part(double x) { return x >= 0.0 && x <= 1.0; }  // NaN is none

  /// A frame may reach over the border, by its own size at most.
  static bool is_near(const Eigen::Vector2d& p, const Image& image) {
    const double most = 2.0 * (image.width() + image.height()) + 100.0;
    return std::abs(p.x()) < most && std::abs(p.y()) < most;
  }
  static std::string wrong(const GateDetection& gate, const Image& image) {
    for (const auto& corner : gate.corners_px)
      if (!is_near(corner, image)) return "corner far outside";
    return is_part(gate.fitness) ? "" : "fitness";
  }
  static std::string wrong(const GatesInView& view, const Image& image) {
    for (const auto& gate : view.gates)
      if (auto what = wrong(gate, image); !what.empty()) return what;
    if (!view.part) return "";
    const GateBars& bars = view.part->bars;
    if (!is_near(bars.left_px, image) || !is_near(bars.right_px, image)) return "bars far outside";
    if (bars.left_px.x() > bars.right_px.x()) return "left bar is right";
    return wrong(view.part->gate, image);
  }
};

}  // namespace gatefly::test
