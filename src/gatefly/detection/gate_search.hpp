// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/detection/careful_search.hpp"
#include "gatefly/detection/snake_search.hpp"

namespace gatefly {

/// Finds gates: in microseconds where they stand out, else by looking everywhere.
class GateSearch {
 public:
  explicit GateSearch(const GateSearchParams& params = {}) : params_{params}, snakes_{params}, careful_{params} {}

  /// Distinct gates, best first. Allocates nothing.
  [[nodiscard]] GateDetections detect(const Image& image, const ColorModel& color);

 private:
  GateSearchParams params_;
  SnakeSearch snakes_;
  CarefulSearch careful_;
};

}  // namespace gatefly
