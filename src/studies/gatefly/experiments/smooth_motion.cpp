// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/smooth_motion.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <Eigen/Dense>

#include "gatefly/files/quantile.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

using Window = std::pair<std::size_t, std::size_t>;  // first, one after the last

/// Tukey's weight of a residual, given the median of all.
double weight_of(double residual, double median, double floor) {
  constexpr double kNormal = 1.4826, kTukey = 4.685;  // 95 % efficient where nothing is wrong
  const double u = residual / (kTukey * std::max(kNormal * median, floor));
  return u < 1.0 ? std::pow(1.0 - u * u, 2) : 0.0;
}

/// A polynomial of t through rows of values, outliers left out; row k of the answer is the k-th
/// derivative's part at t = 0, over k!.
template <int kOrder, int kColumns>
Eigen::Matrix<double, kOrder + 1, kColumns> robust_fit(
    std::span<const double> t, std::span<const Eigen::Matrix<double, kColumns, 1>> values,
    double floor) {
  constexpr int kRounds = 4;
  std::vector<double> weights(t.size(), 1.0), residuals(t.size());
  Eigen::Matrix<double, kOrder + 1, kColumns> fit;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix<double, kOrder + 1, kOrder + 1> normal;
    normal.setZero(), fit.setZero();
    for (std::size_t i = 0; i < t.size(); ++i) {
      Eigen::Matrix<double, kOrder + 1, 1> powers;
      powers[0] = 1.0;
      for (int k = 1; k <= kOrder; ++k) powers[k] = powers[k - 1] * t[i];
      normal += weights[i] * powers * powers.transpose();
      fit += weights[i] * powers * values[i].transpose();
    }
    fit = normal.ldlt().solve(fit).eval();
    for (std::size_t i = 0; i < t.size(); ++i) {
      Eigen::Matrix<double, kColumns, 1> at = Eigen::Matrix<double, kColumns, 1>::Zero();
      for (int k = kOrder; k >= 0; --k) at = at * t[i] + fit.row(k).transpose();
      residuals[i] = (values[i] - at).norm();
    }
    const double median = files::nearest_rank(residuals, 0.5);
    for (std::size_t i = 0; i < t.size(); ++i) weights[i] = weight_of(residuals[i], median, floor);
  }
  return fit;
}

/// Headings without jumps of whole turns.
std::vector<double> unwrapped(std::span<const MotionSample> samples) {
  std::vector<double> yaw;
  for (const MotionSample& s : samples)
    yaw.push_back(yaw.empty() ? s.attitude.yaw
                              : yaw.back() + wrap_angle(s.attitude.yaw - yaw.back()));
  return yaw;
}

bool is_surrounded(std::span<const MotionSample> samples, std::size_t i, const Window& window,
                   double max_gap) {
  constexpr std::size_t kEachSide = 3;  // a parabola has three numbers
  if (i < window.first + kEachSide || window.second < i + 1 + kEachSide) return false;
  for (std::size_t k = window.first + 1; k < window.second; ++k)
    if (samples[k].t - samples[k - 1].t > max_gap) return false;
  return true;
}

}  // namespace

std::vector<SmoothSample> smoothed(std::span<const MotionSample> samples,
                                   const SmoothingParams& params) {
  // Nothing nearer to the curve is an outlier: a turn's beginning bends the headings by 1.4° [m],
  // [rad].
  constexpr double kPositionNoise = 0.005, kYawNoise = 1.0 * kDegree;
  const std::vector<double> yaw = unwrapped(samples);
  std::vector<SmoothSample> smooth(samples.size());
  Window window{0, 0};
  std::vector<double> t;
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector2d> angles;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const MotionSample& here = samples[i];
    while (here.t - samples[window.first].t > params.half_window) ++window.first;
    while (window.second < samples.size() &&
           samples[window.second].t - here.t <= params.half_window)
      ++window.second;
    smooth[i].t = here.t;
    if (!is_surrounded(samples, i, window, params.max_gap)) continue;
    t.clear(), positions.clear(), angles.clear();
    for (std::size_t k = window.first; k < window.second; ++k)
      t.push_back(samples[k].t - here.t), positions.push_back(samples[k].p_E),
          angles.emplace_back(yaw[k], samples[k].attitude.pitch);
    const Eigen::Matrix3d place = robust_fit<2, 3>(t, positions, kPositionNoise);
    const Eigen::Matrix2d turn = robust_fit<1, 2>(t, angles, kYawNoise);
    smooth[i] = {.t = here.t,
                 .p_E = place.row(0),
                 .v_E = place.row(1),
                 .pitch = turn(0, 1),
                 .yaw = turn(0, 0),
                 .yaw_rate = turn(1, 0),
                 .tracked = true};
  }
  return smooth;
}

SmoothSample at(std::span<const SmoothSample> motion, double t) {
  const auto after =
      std::lower_bound(motion.begin(), motion.end(), t,
                       [](const SmoothSample& s, double time) { return s.t < time; });
  if (after == motion.begin()) return motion.front();
  if (after == motion.end()) return motion.back();
  const SmoothSample &a = *std::prev(after), &b = *after;
  const double part = (t - a.t) / (b.t - a.t);
  const auto between = [&](const auto& from, const auto& to) {
    return (from + part * (to - from)).eval();
  };
  return {.t = t,
          .p_E = between(a.p_E, b.p_E),
          .v_E = between(a.v_E, b.v_E),
          .pitch = a.pitch + part * (b.pitch - a.pitch),
          .yaw = a.yaw + part * (b.yaw - a.yaw),
          .yaw_rate = a.yaw_rate + part * (b.yaw_rate - a.yaw_rate),
          .tracked = a.tracked && b.tracked};
}

}  // namespace gatefly::experiments
