// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "gatefly/detection/gate_search.hpp"
#include "gatefly/detection/paper/paper_detector.hpp"
#include "gatefly/detection/search/careful_search.hpp"
#include "gatefly/detection/search/part_search.hpp"
#include "gatefly/detection/search/snake_search.hpp"

namespace gatefly::test {

/// What all detectors are told.
struct DetectorSettings {
  ColorModel model = ColorModel::described({1.0, 0.4, 0.0});
  GateSearchParams search;
  std::optional<Quad> previous;
};

/// Runs every detector on a picture; "" when all answers are possible ones, else what is wrong with
/// which.
class AllDetectors {
 public:
  [[nodiscard]] std::string complaint(const Image& image, const DetectorSettings& settings) {
    SnakeSearch snakes{settings.search};
    if (const auto what = wrong(snakes.detect(image, settings.model), image); !what.empty())
      return "snakes: " + what;
    CarefulSearch careful{settings.search};
    if (const auto what = wrong(careful.detect(image, settings.model), image); !what.empty())
      return "careful: " + what;
    GateSearch search{settings.search};
    if (const auto what = wrong(search.detect(image, settings.model), image); !what.empty())
      return "both: " + what;
    if (const auto what = wrong(search.detect_all(image, settings.model), image); !what.empty())
      return "all: " + what;
    PartSearch parts{settings.search};
    if (const auto part = parts.detect(image, settings.model)) {
      if (const auto what = wrong(part->gate, image); !what.empty()) return "part: " + what;
      if (!is_near(part->bars.left_px, image) || !is_near(part->bars.right_px, image))
        return "bars: far outside";
      if (part->bars.left_px.x() > part->bars.right_px.x()) return "bars: left is right";
    }
    Rng rng{1};
    if (const auto what = wrong(detect_as_paper(image, {}, rng), image); !what.empty())
      return "paper: " + what;
    if (const auto gate = detect_as_flown(image, {}, rng, settings.previous))
      if (const auto what = wrong(*gate, image); !what.empty()) return "flown: " + what;
    return "";
  }

 private:
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
  template <std::size_t N>
  static std::string wrong(const FixedList<GateDetection, N>& gates, const Image& image) {
    if (gates.size() > N) return "too many";
    for (const auto& gate : gates)
      if (auto what = wrong(gate, image); !what.empty()) return what;
    return "";
  }
};

}  // namespace gatefly::test
