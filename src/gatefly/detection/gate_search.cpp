// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/gate_search.hpp"

#include <algorithm>

namespace gatefly {

// Of gates that are all beyond doubt, scores that differ by a picture's noise must not say which
// one is answered.
GateDetections GateSearch::in_order(GateDetections gates, const Image& image) const {
  const Eigen::Vector2d middle{0.5 * (image.width() - 1), 0.5 * (image.height() - 1)};
  const auto off = [&](const GateDetection& gate) {
    return (center(gate.corners_px) - middle).squaredNorm();
  };
  insertion_sort(gates, [&](const GateDetection& a, const GateDetection& b) {
    if (is_sure(a) && is_sure(b)) return off(a) < off(b);
    return a.fitness > b.fitness;
  });
  return gates;
}

GateDetections GateSearch::detect(const Image& image, const ColorModel& color) {
  const GateDetections quick = snakes_.detect(image, color);
  return in_order(!quick.empty() && is_sure(quick[0]) ? quick : careful_.detect(image, color),
                  image);
}

GateDetections GateSearch::detect_best(const Image& image, const ColorModel& color) {
  const GateDetections quick = snakes_.detect(image, color);
  if (quick.empty() || !is_sure(quick[0])) return in_order(careful_.detect(image, color), image);
  if (!snakes_.shows_bars_beside(quick)) return in_order(quick, image);
  // What stood out stays, unless the careful search is surer of something in its place.
  GateDetections all = careful_.detect(image, color);
  for (const GateDetection& gate : quick) {
    if (!is_sure(gate)) continue;
    const auto same = std::find_if(all.begin(), all.end(), [&](const auto& other) {
      return same_place(other.corners_px, gate.corners_px);
    });
    if (same == all.end())
      (void)all.push_back(gate);
    else if (gate.fitness > same->fitness)
      *same = gate;
  }
  return in_order(all, image);
}

}  // namespace gatefly
