// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/scene_figure.hpp"

namespace gatefly::sim {

void add_figure(SceneBuilder& b, const FloorFrame& frame, const Figure& figure, double stride) {
  const double hip = 0.48 * figure.height, neck = 0.83 * figure.height;
  for (const double side : {-1.0, 1.0}) {
    const double foot = side * stride;
    b.block(frame.at(foot - 0.07, 0.10 * side - 0.07, 0.0),
            frame.at(0.14, 0, 0) - frame.at(0, 0, 0), frame.at(0, 0.14, 0) - frame.at(0, 0, 0),
            frame.at(0, 0, hip) - frame.at(foot, 0, 0), figure.trousers);
    const double arm = 0.19 * side;
    b.box(frame, {-0.05, arm - 0.04, hip - 0.02}, {0.05, arm + 0.04, neck - 0.03}, figure.shirt);
    b.box(frame, {-0.04, arm - 0.035, hip - 0.12}, {0.04, arm + 0.035, hip - 0.02}, figure.skin);
  }
  b.box(frame, {-0.12, -0.15, hip}, {0.12, 0.15, neck}, figure.shirt);
  b.box(frame, {-0.05, -0.05, neck}, {0.05, 0.05, neck + 0.05}, figure.skin);
  b.box(frame, {-0.09, -0.075, neck + 0.05}, {0.10, 0.075, figure.height - 0.05}, figure.skin);
  b.box(frame, {-0.11, -0.085, neck + 0.12}, {0.06, 0.085, figure.height}, figure.hair);
}

}  // namespace gatefly::sim
