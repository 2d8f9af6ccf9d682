// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "gatefly/flight_log/recording.hpp"
#include "gatefly/tasks/recorded_flight.hpp"

namespace gatefly::simulated_race {

/// The pictures of a flight that did not keep them, rendered from what lies in its folder: track,
/// configuration, seed, and the rotor speeds of its log.
///
/// The flight's own configuration counts, not the user's: another pilot looks at the same pictures.
/// Asked in order; one before the last one is rendered from the start again.
/// @param flight  must live as long.
/// @param while_baking  called some twenty times a second; may throw to stop; may be empty.
/// @throws std::runtime_error one line: the folder does not say enough.
[[nodiscard]] flight_log::PictureSource rendered_again(const tasks::RecordedFlight& flight,
                                                       const std::function<void()>& while_baking);

}  // namespace gatefly::simulated_race
