// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/flight_log/recording.hpp"
#include "gatefly/live/controller_link.hpp"
#include "gatefly/live/flight_deck.hpp"
#include "gatefly/live/keeper.hpp"
#include "gatefly/live/wires.hpp"

// The loops of the link's thread. Each runs until it is told to stop or the link is cut.

namespace gatefly::live {

/// Listens to a controller; sends it nothing but questions.
void listen(LinkQueries& link, Wires& wires, const RunClock& clock);

/// Flies a drone: every period the deck decides, the keeper hears of it, the set point goes. Ends when the flight is over, not before:
/// whoever stops it in the air waits for the descent.
/// @param told_to_end  asked every period: whoever records may be held up by a disk, and must not be needed to end a flight.
void fly(LinkCommands& link, FlightDeck& deck, Keeper& keeper, Wires& wires, const RunClock& clock,
         const std::function<bool()>& told_to_end);

/// A recorded flight in the place of a drone.
/// @param pace  times its own; 0: as fast as it is flown.
void play(const std::vector<flight_log::RecordedTick>& ticks,
          const flight_log::FlightFolder& folder, double pace, Wires& wires, const RunClock& clock);

}  // namespace gatefly::live
