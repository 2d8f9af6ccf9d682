// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/frames_again.hpp"

#include <utility>

#include "gatefly/simulated_race/closed_loop/sensor_suite.hpp"
#include "gatefly/simulated_race/closed_loop/simulators.hpp"
#include "gatefly/simulated_race/closed_loop/stopwatch.hpp"

namespace gatefly::simulated_race {

struct FramesAgain::Impl {
  Impl(const world::SimConfig& config, Motors m, const std::function<void()>& while_baking)
      : motors{std::move(m)},
        simulator{config, while_baking},
        suite{config},
        steps{physics_steps(config.sensors.imu_hz)} {}

  /// As FlightIn::step, less pilot, referee and books.
  bool step() {
    const std::array<double, 4> command = tick == 0 ? std::array<double, 4>{} : motors(tick - 1);
    const double dt = suite.next_interval();
    for (int i = 0; i < steps; ++i) {
      simulator.body.step(command, dt / steps);
      suite.remember(simulator.body.state(), simulator.body.time());
    }
    return suite.read(static_cast<std::int64_t>(tick++), dt, simulator, watch).image.has_value();
  }

  Motors motors;
  RenderedSimulator simulator;
  SensorSuite suite;
  Stopwatch watch{"camera"};
  int steps;
  std::size_t tick = 0;
};

FramesAgain::FramesAgain(const world::SimConfig& config, Motors motors,
                         const std::function<void()>& while_baking)
    : impl_{std::make_unique<Impl>(config, std::move(motors), while_baking)} {}
FramesAgain::~FramesAgain() = default;

std::size_t FramesAgain::ticks() const { return impl_->tick; }

std::span<const std::uint8_t> FramesAgain::picture_of(std::size_t tick) {
  bool arrived = false;
  while (impl_->tick <= tick) arrived = impl_->step();
  return arrived ? impl_->simulator.picture() : std::span<const std::uint8_t>{};
}

}  // namespace gatefly::simulated_race
