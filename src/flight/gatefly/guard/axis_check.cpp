// SPDX-License-Identifier: Apache-2.0
#include "gatefly/guard/axis_check.hpp"

#include <cmath>

#include <Eigen/LU>

#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly::guard {
namespace {

constexpr double kWindow = 0.25;  ///< [s]
/// A turn of 90° in a second is four windows of 0.4 rad: 0.6 rad². About each axis at least a third of it.
constexpr double kEnough = 0.2;               ///< [rad²]
constexpr double kLeast = 0.8, kMost = 1.25;  ///< Limits of a correct scale.
constexpr double kSilence = 0.01;             ///< Share of the expected signal that counts as none.

}  // namespace

std::string_view text_of(AxisVerdict verdict) {
  switch (verdict) {
    case AxisVerdict::kNotTurned:
      return "not turned far enough";
    case AxisVerdict::kAgrees:
      return "agrees with the attitude";
    case AxisVerdict::kOpposite:
      return "has the other sign than the attitude";
    case AxisVerdict::kWrongScale:
      return "has another scale than the attitude";
    case AxisVerdict::kOtherAxis:
      return "shows what another axis does";
    case AxisVerdict::kDead:
      return "shows nothing";
  }
  return "";
}

void AxisCheck::take(const Eigen::Vector3d& gyro_B, const Attitude& attitude, double dt) {
  const Eigen::Matrix3d R_EB = rotation_EB(attitude).matrix;
  if (!gyro_B.allFinite() || !R_EB.allFinite() || !(dt >= 0.0)) return;
  if (!began_) {
    began_ = R_EB;
    return;
  }
  turned_ += gyro_B * dt;
  lasted_ += dt;
  if (lasted_ < kWindow) return;
  const Eigen::Vector3d by_attitude = turn_of(began_->transpose() * R_EB);
  gyro_attitude_ += turned_ * by_attitude.transpose();
  attitude_attitude_ += by_attitude * by_attitude.transpose();
  turned_.setZero();
  began_ = R_EB;
  lasted_ = 0.0;
}

std::optional<double> AxisCheck::scale(int axis) const {
  if (attitude_attitude_(axis, axis) < kEnough) return std::nullopt;
  return gyro_attitude_(axis, axis) / attitude_attitude_(axis, axis);
}

AxisVerdict AxisCheck::verdict(int axis) const {
  const auto along = scale(axis);
  if (!along) return AxisVerdict::kNotTurned;
  double most_other = 0.0;
  for (int other = 0; other < 3; ++other) {
    if (other == axis || attitude_attitude_(other, other) < kEnough) continue;
    const double slope = gyro_attitude_(axis, other) / attitude_attitude_(other, other);
    most_other = std::max(most_other, std::abs(slope));
  }
  if (most_other > 0.5 && most_other > 2.0 * std::abs(*along)) return AxisVerdict::kOtherAxis;
  if (std::abs(*along) < kSilence) return AxisVerdict::kDead;
  if (*along < 0.0) return AxisVerdict::kOpposite;
  return *along < kLeast || *along > kMost ? AxisVerdict::kWrongScale : AxisVerdict::kAgrees;
}

bool AxisCheck::all_agree() const {
  for (int axis = 0; axis < 3; ++axis)
    if (verdict(axis) != AxisVerdict::kAgrees) return false;
  return true;
}

}  // namespace gatefly::guard
