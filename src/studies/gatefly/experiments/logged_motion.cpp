// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/logged_motion.hpp"

#include <algorithm>
#include <iterator>

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/seconds.hpp"

namespace gatefly::experiments {

LoggedMotion::LoggedMotion(const flight_log::FlightFolder& flight) {
  for (const flight_log::FlightSample& sample : flight.samples) {
    const double t = seconds(sample.time);
    if (sample.ahrs) add_attitude(t, *sample.ahrs);
    // The log repeats a position until the next one has come.
    if (sample.true_p_EB && (positions_.empty() || positions_.back().value != *sample.true_p_EB))
      positions_.push_back({t, *sample.true_p_EB});
  }
}

void LoggedMotion::add_attitude(double t, const Attitude& attitude) {
  const double before = attitudes_.empty() ? attitude.yaw : attitudes_.back().value.z();
  attitudes_.push_back(
      {t, {attitude.roll, attitude.pitch, before + wrap_angle(attitude.yaw - before)}});
}

Attitude LoggedMotion::attitude(double t) const {
  const Eigen::Vector3d a = between(attitudes_, t);
  return {a.x(), a.y(), wrap_angle(a.z())};
}

Eigen::Vector3d LoggedMotion::between(const std::vector<Point>& points, double t) {
  if (points.empty()) return Eigen::Vector3d::Zero();
  const auto after = std::lower_bound(points.begin(), points.end(), t,
                                      [](const Point& p, double at) { return p.t < at; });
  if (after == points.begin()) return points.front().value;
  if (after == points.end()) return points.back().value;
  const Point &a = *std::prev(after), &b = *after;
  return a.value + (t - a.t) / (b.t - a.t) * (b.value - a.value);
}

}  // namespace gatefly::experiments
