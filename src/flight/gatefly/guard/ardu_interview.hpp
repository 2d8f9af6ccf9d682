// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/guard/autopilot_facts.hpp"

namespace gatefly::guard {

/// Parameters of ArduCopter that decide what a set point of ours does.
enum class ArduParameter : std::uint8_t {
  kGuidedOptions,
  kGuidedTimeout,
  kHoverThrust,
  kThrustExpo,
  kSpinMin,
  kSpinMax,
  kAngleBoost,
};
inline constexpr std::array<std::string_view, 7> kArduParameters{
    "GUID_OPTIONS", "GUID_TIMEOUT", "MOT_THST_HOVER", "MOT_THST_EXPO",
    "MOT_SPIN_MIN", "MOT_SPIN_MAX", "ATC_ANGLE_BOOST"};

using ArduFacts = AutopilotFacts<ArduParameter, kArduParameters.size()>;

/// Reasons why this program must not fly it.
enum class ArduComplaint : std::uint8_t {
  kNotArduPilot,
  kNoMulticopter,
  kNoVersion,
  kNoParameters,
  kThrustIsClimbRate,
  kTimeout,
  kNoHover,
  kNoGyro,
  kNoAccelerometer,
  kArmed,
};
using ArduComplaints = FixedList<ArduComplaint, 10>;

/// In the order in which they are to be seen to; none: everything is known that has to be.
[[nodiscard]] ArduComplaints complaints_about(const ArduFacts& facts);

/// For the line that a user reads.
[[nodiscard]] std::string_view text_of(ArduComplaint complaint);

}  // namespace gatefly::guard
