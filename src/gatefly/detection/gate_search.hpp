// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/detection/careful_search.hpp"
#include "gatefly/detection/snake_search.hpp"

namespace gatefly {

/// Finds gates: in microseconds where they stand out, else by looking everywhere.
class GateSearch {
 public:
  explicit GateSearch(const GateSearchParams& params = {}) : params_{params}, snakes_{params}, careful_{params} {}

  /// Distinct gates, best first; those that stand out, if there are any. Allocates nothing.
  [[nodiscard]] GateDetections detect(const Image& image, const ColorModel& color);

  /// All distinct gates, best first, by the careful search. Allocates nothing.
  [[nodiscard]] GateDetections detect_all(const Image& image, const ColorModel& color) { return careful_.detect(image, color); }

 private:
  GateSearchParams params_;
  SnakeSearch snakes_;
  CarefulSearch careful_;
};

}  // namespace gatefly
