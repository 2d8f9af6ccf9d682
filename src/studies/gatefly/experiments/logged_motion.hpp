// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/geometry/attitude.hpp"

namespace gatefly::experiments {

/// Motion capture's positions and somebody's attitudes, between their samples. Before the first and
/// after the last: those.
class LoggedMotion {
 public:
  LoggedMotion() = default;
  /// With the attitudes of the log's own AHRS.
  explicit LoggedMotion(const flight_log::FlightFolder& flight);

  /// Attitudes in the order of their times [s].
  void clear_attitudes() { attitudes_.clear(); }
  void add_attitude(double t, const Attitude& attitude);

  /// Earth frame [m].
  [[nodiscard]] Eigen::Vector3d position(double t) const { return between(positions_, t); }
  [[nodiscard]] Attitude attitude(double t) const;

 private:
  struct Point {
    double t;
    Eigen::Vector3d value;
  };
  static Eigen::Vector3d between(const std::vector<Point>& points, double t);
  std::vector<Point> positions_, attitudes_;
};

}  // namespace gatefly::experiments
