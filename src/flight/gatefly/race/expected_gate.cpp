// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/expected_gate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly {
namespace {

constexpr double kNearest = 0.4;  // before the lens [m]
// Sine of the angle between the gate's plane and the way to it: the narrowest frame the search knows
// is .36 as wide as high.
constexpr double kNarrowest = 0.3;
// So much of a side may be beyond the border: corners are found where their sides would cross. [ours: of
// 166 pictures of a race, none was found with more]
constexpr double kBeyond = 0.25;
// Room around the expected place beside its sigmas: the gate's own fit, and an attitude a frame old.
// [ours: 17 px of 315 at most, where the gate was 80 px wide; 10 where it was 45]
constexpr double kOfSide = 0.25, kOfDistance = 0.06;
constexpr double kSigmas = 3.0;

}  // namespace

double place_sigma(const eskf::ErrorStateFilter& filter) {
  return std::max({filter.sigma(eskf::kP), filter.sigma(eskf::kP + 1), filter.sigma(eskf::kP + 2)});
}

std::optional<ExpectedGate> expected_gate(const eskf::ErrorStateFilter& filter, int slot,
                                          double ago, const PictureClock& picture) {
  const eskf::Nominal& x = filter.now();
  const eskf::GateBelief& gate = x.gates[static_cast<std::size_t>(slot)];
  const eskf::GateShape& shape = filter.landmarks().shape(slot);
  const Eigen::Matrix3d R_EB = x.R_EB * rotation_of(-ago * x.rate_B);
  const Eigen::Vector3d p_EB = x.p_EB - ago * x.v_E, way_E = gate.p_EG - p_EB;
  const double distance = way_E.norm(),
               across = (rotation_z(-gate.yaw_EG) * way_E).x() / std::max(1e-9, distance);
  if (std::abs(across) < kNarrowest) return std::nullopt;
  const Eigen::Matrix3d R_EG = rotation_z(gate.yaw_EG + (across < 0.0 ? kPi : 0.0));
  const auto corners = gate_corners_G(shape.side - shape.bar);
  ExpectedGate expected;
  expected.facing = std::abs(across);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d p_B = R_EB.transpose() * (way_E + R_EG * corners[i]);
    const Eigen::Vector3d p_C = x.R_BC.transpose() * (p_B - picture.camera.p_BC);
    const auto px = p_C.z() > kNearest ? picture.camera.lens.project(p_C) : std::nullopt;
    if (!px) return std::nullopt;
    expected.bars_px[i] = *px;
  }
  Eigen::Array2d least = expected.bars_px[0], most = least;
  for (const Eigen::Vector2d& p : expected.bars_px)
    least = least.min(p.array()), most = most.max(p.array());
  const Eigen::Array2d end = picture.size_px.array() - 1.0;
  if ((most < 0.0).any() || (least > end).any()) return std::nullopt;

  const Quad& q = expected.bars_px;
  const Eigen::Vector2d down = 0.5 * (q[3] - q[0] + q[2] - q[1]),
                        right = 0.5 * (q[1] - q[0] + q[2] - q[3]);
  const double upright = expected.side_px = down.norm();
  const double turned = std::max(
      {filter.sigma(eskf::kTheta), filter.sigma(eskf::kTheta + 1), filter.sigma(eskf::kTheta + 2)});
  const double place = place_sigma(filter), aside = distance * turned,
               sigma = std::sqrt(place * place + aside * aside),
               px_per_m = upright / (shape.side - shape.bar);
  const double beyond = kBeyond * upright + sigma * px_per_m;
  expected.shows_whole = (least > -beyond).all() && (most < end + beyond).all();
  const double margin = kOfSide * upright + (kOfDistance * distance + kSigmas * sigma) * px_per_m;
  // Its shape may differ by so much because of the lens and the fit; more where the place is uncertain.
  constexpr double kWidthPart = 1.4, kRollOff = 8.0 * kDegree;
  constexpr double kLeastPart = 0.8, kMostPart = 1.25, kNearestPart = 0.3;
  const double off = kSigmas * place / distance, width = right.norm() / std::max(1e-9, upright),
               roll = gatefly::atan2(-down.x(), down.y());
  expected.window = {.left = least.x() - margin,
                     .top = least.y() - margin,
                     .right = most.x() + margin,
                     .bottom = most.y() + margin,
                     .least_side = kLeastPart * upright / (1.0 + off),
                     .most_side = kMostPart * upright / std::max(kNearestPart, 1.0 - off),
                     .least_width = width / kWidthPart - off,
                     .most_width = width * kWidthPart + off,
                     .least_roll = roll - kRollOff,
                     .most_roll = roll + kRollOff,
                     .for_one = true};
  return expected;
}

}  // namespace gatefly
