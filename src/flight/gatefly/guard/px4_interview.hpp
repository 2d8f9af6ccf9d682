// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/guard/autopilot_facts.hpp"

namespace gatefly::guard {

/// Parameters of PX4 that decide what a set point of ours does, or one that does not come any more.
enum class Px4Parameter : std::uint8_t {
  kOffboardTimeout,
  kOffboardLoss,
  kHoverThrust,
  kModelFactor,
  kImuControl,
};
inline constexpr std::array<std::string_view, 5> kPx4Parameters{
    "COM_OF_LOSS_T", "COM_OBL_RC_ACT", "MPC_THR_HOVER", "THR_MDL_FAC", "EKF2_IMU_CTRL"};

using Px4Facts = AutopilotFacts<Px4Parameter, kPx4Parameters.size()>;

/// Reasons why this program must not fly it.
enum class Px4Complaint : std::uint8_t {
  kNotPx4,
  kNoMulticopter,
  kNoVersion,
  kNoParameters,
  kTimeout,
  kDoesNotLand,
  kNoHover,
  kBiasMoves,
  kNoGyro,
  kNoAccelerometer,
  kArmed,
};
using Px4Complaints = FixedList<Px4Complaint, 11>;

/// In the order in which they are to be seen to; none: everything is known that has to be.
[[nodiscard]] Px4Complaints complaints_about(const Px4Facts& facts);

/// For the line that a user reads.
[[nodiscard]] std::string_view text_of(Px4Complaint complaint);

}  // namespace gatefly::guard
