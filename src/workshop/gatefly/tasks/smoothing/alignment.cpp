// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/smoothing/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::smoothing {
namespace {

using Eigen::Vector3d;

Vector3d place_at(std::span<const Place> path, double time) {
  const auto after = std::lower_bound(path.begin(), path.end(), time,
                                      [](const Place& p, double t) { return p.time < t; });
  if (after == path.begin()) return path.front().p_EB;
  if (after == path.end()) return path.back().p_EB;
  const Place &a = *(after - 1), &b = *after;
  return a.p_EB + (time - a.time) / (b.time - a.time) * (b.p_EB - a.p_EB);
}

Alignment with_lag(std::span<const Place> path, std::span<const Place> truth, double lag) {
  const auto n = static_cast<Eigen::Index>(truth.size());
  Eigen::Matrix3Xd a(3, n), b(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Place& place = truth[static_cast<std::size_t>(i)];
    a.col(i) = place_at(path, place.time - lag), b.col(i) = place.p_EB;
  }
  a.colwise() -= a.rowwise().mean().eval();
  b.colwise() -= b.rowwise().mean().eval();
  const Eigen::Matrix3d C = a * b.transpose();
  Alignment found;
  found.lag = lag;
  found.turned = std::atan2(C(0, 1) - C(1, 0), C(0, 0) + C(1, 1));
  const Eigen::Matrix3Xd off = rotation_z(found.turned) * a - b;
  found.rms = (off.rowwise().squaredNorm() / static_cast<double>(n)).cwiseSqrt();
  return found;
}

}  // namespace

std::optional<Alignment> aligned(std::span<const Place> path, std::span<const Place> truth) {
  if (truth.size() < 10 || path.size() < 2) return std::nullopt;
  std::optional<Alignment> best;
  for (int step = -10; step <= 30; ++step) {
    const Alignment one = with_lag(path, truth, 0.005 * step);
    if (!best || one.rms.norm() < best->rms.norm()) best = one;
  }
  return best;
}

}  // namespace gatefly::smoothing
