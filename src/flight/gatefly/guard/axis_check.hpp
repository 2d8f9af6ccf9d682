// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::guard {

/// Verdict on an axis of a gyro, beside the attitude of the same controller.
enum class AxisVerdict : std::uint8_t {
  kNotTurned,  ///< Too little to tell.
  kAgrees,
  kOpposite,    ///< The other sign.
  kWrongScale,  ///< Degrees for radians, counts for degrees, another range.
  kOtherAxis,   ///< It shows what another axis does.
  kDead,        ///< It shows nothing.
};
[[nodiscard]] std::string_view text_of(AxisVerdict verdict);

/// Whether gyro and attitude tell of the same turns: signs, axes and scale, found while a drone is turned by hand.
///
/// Ours: over windows of a quarter of a second the gyro's rates, added up, beside the attitude's turn; for each axis the slope of one over the other. Attitudes in whole degrees, as MSP's yaw, are fine enough for it.
class AxisCheck {
 public:
  /// A sample of both, `dt` [s] after the one before, which the gyro's rate is taken to have lasted.
  void take(const Eigen::Vector3d& gyro_B, const Attitude& attitude, double dt);

  /// The verdict on axis 0 … 2: front, right, down.
  [[nodiscard]] AxisVerdict verdict(int axis) const;
  /// How much the gyro shows of a turn about its axis; 1 is right. nullopt while too little was turned.
  [[nodiscard]] std::optional<double> scale(int axis) const;
  [[nodiscard]] bool all_agree() const;

 private:
  Eigen::Vector3d turned_ = Eigen::Vector3d::Zero();  ///< By the gyro, in this window [rad].
  std::optional<Eigen::Matrix3d> began_;              ///< Attitude at the window's beginning.
  double lasted_ = 0.0;
  /// Sums over windows of gyro · attitudeᵀ and attitude · attitudeᵀ [rad²].
  Eigen::Matrix3d gyro_attitude_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d attitude_attitude_ = Eigen::Matrix3d::Zero();
};

}  // namespace gatefly::guard
