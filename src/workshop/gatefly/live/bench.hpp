// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "gatefly/link/msp_axes.hpp"
#include "gatefly/live/msp_introduction.hpp"

namespace gatefly::live {

/// One thing that was looked at, in a line.
struct Finding {
  bool well = false;
  std::string line;
};
using Findings = std::vector<Finding>;
[[nodiscard]] bool all_well(const Findings& findings);

/// Checks what the drone answers about itself: identity, settings, flags.
[[nodiscard]] Findings of_introduction(const Introduction& said);

/// The IMU of a drone that lies level and still: that it lives, its scale, which way is up.
/// @param scale  gets the size of the accelerometer's counts.
[[nodiscard]] Findings of_rest(Port& port, std::chrono::milliseconds lasts, msp::ImuScale& scale);

/// How a line begins that asks whoever is at the drone for something, and how one for a turn goes on.
inline constexpr std::string_view kBenchSays = "gatefly bench-drone: ",
                                  kTurnPrompt =
                                      "turn it by a quarter and back, in a second, about: ";

/// Its gyro beside its attitude, while somebody turns it about each axis, until all agree or `limit`.
/// @param say  hears which axes still have to be turned, once a second.
[[nodiscard]] Findings of_turns(Port& port, const msp::ImuScale& scale,
                                std::chrono::milliseconds limit,
                                const std::function<void(const std::string&)>& say);

/// The link, with neutral stick frames at their rate beside the questions.
[[nodiscard]] Findings of_link(Port& port, const msp::ChannelOrder& order,
                               std::chrono::milliseconds lasts);

/// The constants that no controller knows and the user states.
struct Told {
  std::string name;
  int hover_stick_us = 0;
  double exponent = 0.0, least_v = 0.0;
};
/// drone.toml of what was found.
[[nodiscard]] std::string drone_toml(const Introduction& said, const msp::ImuScale& scale,
                                     const Told& told);
/// How it begins.
inline constexpr const char* kDroneFileMark = "# Written by gatefly bench-drone";

}  // namespace gatefly::live
