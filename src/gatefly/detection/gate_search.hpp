// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/detection/search/careful_search.hpp"
#include "gatefly/detection/search/snake_search.hpp"

namespace gatefly {

/// Finds gates: in microseconds where they stand out, else by looking everywhere.
class GateSearch {
 public:
  explicit GateSearch(const GateSearchParams& params = {})
      : params_{params}, snakes_{params}, careful_{params} {}

  /// Distinct gates; those that stand out, if there are any. Best first, of several beyond doubt
  /// the one nearest to the middle of the picture. Allocates nothing.
  [[nodiscard]] GateDetections detect(const Image& image, const ColorModel& color);

  /// The same for who knows nothing about the picture and wants one answer: that of the whole
  /// picture, too, where a strong bar beside the gates found may be another gate's. A pilot knows
  /// which gate it is after.
  [[nodiscard]] GateDetections detect_best(const Image& image, const ColorModel& color);

  /// All distinct gates, best first, by the careful search. Allocates nothing.
  [[nodiscard]] GateDetections detect_all(const Image& image, const ColorModel& color) {
    return in_order(careful_.detect(image, color), image);
  }

 private:
  [[nodiscard]] bool is_sure(const GateDetection& gate) const {
    return gate.fitness >= confidence_of(params_.sure_score);
  }
  [[nodiscard]] GateDetections in_order(GateDetections gates, const Image& image) const;

  GateSearchParams params_;
  SnakeSearch snakes_;
  CarefulSearch careful_;
};

}  // namespace gatefly
