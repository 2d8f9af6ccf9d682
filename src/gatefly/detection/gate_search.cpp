// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/gate_search.hpp"

namespace gatefly {

GateDetections GateSearch::detect(const Image& image, const ColorModel& color) {
  const GateDetections quick = snakes_.detect(image, color);
  const bool sure = !quick.empty() && quick[0].fitness >= confidence_of(params_.sure_score);
  return sure ? quick : careful_.detect(image, color);
}

}  // namespace gatefly
