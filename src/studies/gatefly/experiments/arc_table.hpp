// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "gatefly/experiments/blind_arc.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::experiments {

/// Quantity told of every arc and, as mean and standard deviation, of every source.
struct ArcQuantity {
  const char* name;  ///< In the table; "" is not.
  const char* key;   ///< In CSV and JSON.
  const char* paper;
  double (*of)(const BlindArc&);
};
[[nodiscard]] const std::array<ArcQuantity, 20>& arc_quantities();

[[nodiscard]] Spread1 spread_of(const std::vector<BlindArc>& arcs,
                                double (*value)(const BlindArc&));
/// Spread of the displacements.
[[nodiscard]] Spread2 ends_of(const std::vector<BlindArc>& arcs);

/// Means of the four parts of one axis: end, nose, speed, slip.
[[nodiscard]] std::string parts_text(const std::vector<BlindArc>& arcs, int axis);

/// "0.27 ± 0.38", "(0.27, 3.34)".
[[nodiscard]] std::string text_of(const Spread1& spread);
[[nodiscard]] std::string text_of(const Eigen::Vector2d& p);
[[nodiscard]] nlohmann::ordered_json json_of(const Spread1& spread);
[[nodiscard]] nlohmann::ordered_json json_of(const Eigen::Vector2d& p);

}  // namespace gatefly::experiments
