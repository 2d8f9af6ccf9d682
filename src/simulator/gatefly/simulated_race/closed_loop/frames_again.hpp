// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "gatefly/world/sim_config.hpp"

namespace gatefly::simulated_race {

/// Renders the pictures of a flight again, without its pilot: body and camera obey the rotor speeds
/// that were recorded. Whatever the pilot is by now, the pictures are those of the flight.
class FramesAgain {
 public:
  /// Commanded rotor speeds of a tick, which the body obeys from there on [rad/s].
  using Motors = std::function<std::array<double, 4>(std::size_t tick)>;

  /// @param config  drawn for the flight's seed.
  /// @param while_baking  called some twenty times a second; may throw to stop; may be empty.
  FramesAgain(const world::SimConfig& config, Motors motors,
              const std::function<void()>& while_baking = {});
  ~FramesAgain();
  FramesAgain(const FramesAgain&) = delete;
  FramesAgain& operator=(const FramesAgain&) = delete;

  /// The ticks flown so far.
  [[nodiscard]] std::size_t ticks() const;
  /// Flies up to and with a tick; it must not have been flown yet.
  /// @return the bytes of the picture that arrives in it, until the next call; empty when none does.
  [[nodiscard]] std::span<const std::uint8_t> picture_of(std::size_t tick);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gatefly::simulated_race
