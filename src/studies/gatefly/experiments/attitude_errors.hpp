// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {

/// Squared errors [rad²] and what was claimed.
struct AttitudeErrors {
  static constexpr double kWithin95 = 2.4477;  ///< Bound of two errors, in σ.

  double square = 0.0, claimed = 0.0, most = 0.0;
  int n = 0, within = 0;

  void add(double error, double sigma) {
    square += error * error, claimed += sigma * sigma, most = std::max(most, std::abs(error)), ++n;
    within += std::abs(error) < kWithin95 * sigma;
  }
  [[nodiscard]] double rms_deg() const { return std::sqrt(square / n) / kDegree; }
  [[nodiscard]] double claimed_deg() const { return std::sqrt(2.0 * claimed / n) / kDegree; }
};

/// Roll and pitch beside the reference; a constant difference (pad, bias, mounting) is told apart.
struct AttitudeDifferences {
  std::vector<Eigen::Vector2d> all;

  void add(const Attitude& a, const Attitude& reference) {
    all.emplace_back(a.roll - reference.roll, a.pitch - reference.pitch);
  }
  [[nodiscard]] Eigen::Vector2d offset() const {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const auto& d : all) sum += d;
    return sum / static_cast<double>(all.size());
  }
  [[nodiscard]] double rms_deg() const {
    double sum = 0.0;
    for (const auto& d : all) sum += (d - offset()).squaredNorm();
    return std::sqrt(0.5 * sum / static_cast<double>(all.size())) / kDegree;
  }
};

/// Both errors [deg] over time, ours and Mahony's.
struct AttitudeTrace {
  static constexpr double kShown = 0.1;  ///< Between two points [s].

  explicit AttitudeTrace(std::string title, std::string y = "inclination error [°]")
      : plot{.title = std::move(title),
             .x_label = "time [s]",
             .y_label = std::move(y),
             .series = {{.name = "Mahony, Kp 0.5", .color = drawing::kLight.gate_solid},
                        {.name = "ours, as flown"}},
             .y_from_0 = false} {}

  void add(double t, double ours, double mahony) {
    if (t < next) return;
    next = t + kShown;
    plot.series[0].points.emplace_back(t, mahony / kDegree),
        plot.series[1].points.emplace_back(t, ours / kDegree);
  }

  drawing::Plot plot;
  double next = -1.0;
};

}  // namespace gatefly::experiments
