// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "gatefly/live/ardu_introduction.hpp"
#include "gatefly/live/bench.hpp"
#include "gatefly/live/controller_link.hpp"
#include "gatefly/live/px4_introduction.hpp"

// The checks of bench.hpp of an ArduCopter or a PX4, which send by themselves: the scale of its samples is not to be found but to be checked.

namespace gatefly::live {

/// Checks what the drone answers about itself: identity, parameters, flags.
[[nodiscard]] Findings of_introduction(const ArduIntroduction& said);
[[nodiscard]] Findings of_introduction(const Px4Introduction& said);

/// The IMU of a drone that lies level and still: that it lives, its scale, which way is up.
[[nodiscard]] Findings of_rest(LinkQueries& link, std::chrono::milliseconds lasts);

/// Its gyro beside its attitude, while somebody turns it about each axis, until all agree or `limit`.
[[nodiscard]] Findings of_turns(LinkQueries& link, std::chrono::milliseconds limit,
                                const std::function<void(const std::string&)>& say);

/// The link, with set points at rest at their rate.
[[nodiscard]] Findings of_link(LinkCommands& link, std::chrono::milliseconds lasts);

/// drone.toml of what was found.
[[nodiscard]] std::string drone_toml(const ArduDrone& drone, const Told& told);
[[nodiscard]] std::string drone_toml(const Px4Drone& drone, const Told& told);

}  // namespace gatefly::live
