// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"

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

/// An ArduCopter's answers about itself; one that did not come is absent.
struct ArduFacts {
  std::optional<mavlink::Heartbeat> heartbeat;
  std::optional<mavlink::AutopilotVersion> version;
  std::optional<mavlink::SysStatus> sensors;
  std::array<std::optional<float>, kArduParameters.size()> parameters;

  [[nodiscard]] std::optional<float> parameter(ArduParameter which) const {
    return parameters[static_cast<std::size_t>(which)];
  }
  [[nodiscard]] bool armed() const;
};

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
