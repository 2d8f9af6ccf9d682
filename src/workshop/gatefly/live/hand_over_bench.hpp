// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>

#include "gatefly/live/bench.hpp"
#include "gatefly/live/controller_link.hpp"
#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/hand_over_rig.hpp"

namespace gatefly::live {

/// Request to the person at the radio.
namespace at_radio {
inline constexpr std::string_view kArm = "throttle down, sticks centred, hands off them; arm",
                                  kOverrideOn = "switch the override on",
                                  kOverrideOnAgain = "switch the override on again",
                                  kOverrideOff = "switch the override off", kDisarm = "disarm",
                                  kBothOff = "switch the override off, then disarm";
}  // namespace at_radio

/// The hand-over test, propellers off: somebody arms and switches at the radio as asked, and what the channels do is compared with
/// what is sent, while the program has the drone, when it is taken back, and when camera, first process, and both are gone.
///
/// Three flights, each from disarmed to disarmed, by processes of their own (HandOverRig): we watch, and ask the controller only
/// when nobody else does. Whatever fails, nobody is left with a drone that obeys a program: it is waited for until the override is
/// off.
struct HandOverTest {
  HandOverRig::Plan plan;
  std::chrono::milliseconds step{60'000};  ///< So long somebody at the radio has for each.

  std::function<void(const std::string&)> say;  ///< Hears what is to be done at the radio.
  std::function<void(const Finding&)>
      found;  ///< Hears each finding; the first that is not well is the last but for advice.
  std::function<bool()> told_to_end;  ///< Asked in the process that flies, too.

  /// @return whether all was well.
  [[nodiscard]] bool run(Introduced met, const DroneFile& drone) const;
};

}  // namespace gatefly::live
