// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/blind_arc.hpp"

#include <cmath>
#include <limits>
#include <map>

#include <Eigen/Dense>

#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double angle_of(const Eigen::Vector2d& v) { return std::atan2(v.y(), v.x()); }

}  // namespace

Eigen::Vector2d BlindArc::in_entry_frame(const Eigen::Vector2d& of_E) const {
  const Eigen::Vector2d ahead{std::cos(heading), std::sin(heading)};
  const Eigen::Vector2d inside = (right ? 1.0 : -1.0) * Eigen::Vector2d{-ahead.y(), ahead.x()};
  return {ahead.dot(of_E), inside.dot(of_E)};
}

double BlindArc::entry_slip() const { return angle_of(in_entry_frame(v_entry)); }

double BlindArc::exit_slip() const { return angle_of(-in_entry_frame(v_exit)); }

Spread1 spread_of(std::span<const double> values) {
  Spread1 spread{.count = values.size(), .mean = kNan, .deviation = kNan};
  if (values.empty()) return spread;
  double sum = 0.0, squares = 0.0;
  for (const double v : values) sum += v;
  const auto n = static_cast<double>(values.size());
  spread.mean = sum / n;
  for (const double v : values) squares += std::pow(v - spread.mean, 2);
  if (values.size() > 1) spread.deviation = std::sqrt(squares / (n - 1.0));
  return spread;
}

Spread2 spread_of(std::span<const Eigen::Vector2d> points) {
  Spread2 spread{.count = points.size(),
                 .mean = Eigen::Vector2d::Constant(kNan),
                 .covariance = Eigen::Matrix2d::Constant(kNan)};
  if (points.empty()) return spread;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) sum += p;
  spread.mean = sum / static_cast<double>(points.size());
  if (points.size() < 2) return spread;
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& p : points)
    squares += (p - spread.mean) * (p - spread.mean).transpose();
  spread.covariance = squares / static_cast<double>(points.size() - 1);
  return spread;
}

FlightSpread flight_spread(std::span<const FlightPoint> points) {
  std::map<std::string, std::vector<Eigen::Vector2d>> flights;
  for (const FlightPoint& p : points) flights[p.flight].push_back(p.point);
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  double freedom = 0.0;
  std::vector<Eigen::Vector2d> means;
  for (const auto& [name, own] : flights) {
    const Spread2 spread = spread_of(own);
    means.push_back(spread.mean);
    if (own.size() < 2) continue;
    const auto n = static_cast<double>(own.size() - 1);
    squares += n * spread.covariance.diagonal(), freedom += n;
  }
  const Eigen::Vector2d none = Eigen::Vector2d::Constant(kNan);
  return {.within = freedom > 0.0 ? (squares / freedom).cwiseSqrt().eval() : none,
          .between = spread_of(means).deviation()};
}

double variance_with_zero_row(std::size_t count, double mean, double variance) {
  // Sums of squares add up, and so does what the two means differ by: n / (n + 1) mean².
  const auto n = static_cast<double>(count);
  return ((n - 1.0) * variance + n / (n + 1.0) * mean * mean) / n;
}

double fitted_radius(std::span<const Eigen::Vector2d> points) {
  if (points.size() < 3) return kNan;
  // |p|² = 2 c·p + (r² - |c|²) is linear in c and the bracket. About the first point, for the
  // digits.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d p = point - points.front();
    const Eigen::Vector3d row{2.0 * p.x(), 2.0 * p.y(), 1.0};
    normal += row * row.transpose();
    right += p.squaredNorm() * row;
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> solver{normal};
  if (!solver.isInvertible()) return kNan;
  const Eigen::Vector3d fit = solver.solve(right);
  return std::sqrt(fit.z() + fit.head<2>().squaredNorm());
}

}  // namespace gatefly::experiments
