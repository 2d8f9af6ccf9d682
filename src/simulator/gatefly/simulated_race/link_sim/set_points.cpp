// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/set_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly::link_sim {
namespace {

// Gains of a small drone that is well tuned. Ours: TS-002 names none.
constexpr double kTurn = 8.0, kToPosition = 1.5, kToVelocity = 3.0;  ///< [1/s]
constexpr double kMostRate = 6.0, kMostSpeed = 5.0,
                 kMostAcceleration = 6.0;  ///< [rad/s, m/s, m/s²]

constexpr std::uint8_t kNoThrust = 64, kNoAttitude = 128;
constexpr int kNoYaw = 1024, kNoYawRate = 2048, kBodyNed = 8;

double number(float value) { return std::isfinite(value) ? double(value) : 0.0; }

Eigen::Vector3d cut(const Eigen::Vector3d& vector, double most) {
  const double norm = vector.norm();
  return norm > most ? Eigen::Vector3d{most / norm * vector} : vector;
}

/// Those of three numbers whose bits, from `first` on, are not to be ignored; the others 0.
Eigen::Vector3d kept(int mask, int first, float x, float y, float z) {
  const auto one = [&](int i, float value) {
    return (mask & (first << i)) != 0 ? 0.0 : number(value);
  };
  return {one(0, x), one(1, y), one(2, z)};
}

Eigen::Vector3d rates_to(const Eigen::Matrix3d& R_EB, const Eigen::Matrix3d& wanted) {
  return cut(kTurn * turn_of(R_EB.transpose() * wanted), kMostRate);
}

}  // namespace

RatesAndThrust wanted_of(const mavlink::SetAttitudeTarget& target, const Known& is) {
  RatesAndThrust wanted;
  wanted.rates_B = kept(target.type_mask, 1, target.body_roll_rate, target.body_pitch_rate,
                        target.body_yaw_rate);
  const std::array<double, 4> q{number(target.q[0]), number(target.q[1]), number(target.q[2]),
                                number(target.q[3])};
  const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  if ((target.type_mask & kNoAttitude) == 0 && norm > 0.5)
    wanted.rates_B += rates_to(
        rotation_EB(is.attitude).matrix,
        rotation_EB(Quaternion{q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm}).matrix);
  wanted.rates_B = cut(wanted.rates_B, kMostRate);
  wanted.thrust =
      (target.type_mask & kNoThrust) != 0 ? is.hover : std::clamp(number(target.thrust), 0.0, 1.0);
  return wanted;
}

RatesAndThrust wanted_of(const mavlink::SetPositionTargetLocalNed& target, const Known& is) {
  const int mask = target.type_mask;
  const double heading = is.attitude.yaw;
  // Axes of what is not a position: the earth's, or those of the heading.
  Eigen::Matrix3d R_EA = Eigen::Matrix3d::Identity();
  if (target.coordinate_frame == kBodyNed)
    R_EA = rotation_EB(gatefly::Attitude{0, 0, heading}).matrix;
  Eigen::Vector3d to_position = Eigen::Vector3d::Zero();
  const std::array<float, 3> place{target.x, target.y, target.z};
  for (int i = 0; i < 3; ++i)
    if ((mask & (1 << i)) == 0)
      to_position[i] =
          kToPosition * (number(place[static_cast<std::size_t>(i)]) - is.place.p_EB[i]);
  const Eigen::Vector3d v_E =
      cut(R_EA * kept(mask, 8, target.vx, target.vy, target.vz) + to_position, kMostSpeed);
  const Eigen::Vector3d off_A = R_EA.transpose() * (v_E - is.place.v_E);
  Eigen::Vector3d a_A = kept(mask, 64, target.afx, target.afy, target.afz);
  // Along an axis without position and velocity only the acceleration counts.
  for (int i = 0; i < 3; ++i)
    if ((mask & (8 << i)) == 0 || (mask & 7) != 7) a_A[i] += kToVelocity * off_A[i];
  Eigen::Vector3d a_E = R_EA * a_A;
  a_E = cut(a_E, kMostAcceleration);

  const Eigen::Vector3d thrust_E = a_E - Eigen::Vector3d{0, 0, kGravity};
  const double yaw = (mask & kNoYaw) != 0 ? heading : number(target.yaw);
  // Down of the body is against the thrust; its front as near to the heading as that allows.
  const Eigen::Vector3d down = -thrust_E.normalized();
  const Eigen::Vector3d right =
      down.cross(Eigen::Vector3d{std::cos(yaw), std::sin(yaw), 0}).normalized();
  Eigen::Matrix3d R_EB_wanted;
  R_EB_wanted.col(0) = right.cross(down);
  R_EB_wanted.col(1) = right;
  R_EB_wanted.col(2) = down;
  const Eigen::Matrix3d R_EB = rotation_EB(is.attitude).matrix;
  RatesAndThrust wanted;
  wanted.rates_B = rates_to(R_EB, R_EB_wanted);
  if ((mask & kNoYawRate) == 0) wanted.rates_B.z() += number(target.yaw_rate);
  wanted.thrust = std::clamp(is.hover * thrust_E.dot(-R_EB.col(2)) / kGravity, 0.0, 1.0);
  return wanted;
}

}  // namespace gatefly::link_sim
