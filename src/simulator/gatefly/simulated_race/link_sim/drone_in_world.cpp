// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/drone_in_world.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::link_sim {
namespace {

constexpr double kAirborne = 0.15;  ///< From here on a contact is a crash [m].
constexpr double kStill = 0.1;      ///< [m/s]

}  // namespace

DroneInWorld::DroneInWorld(const world::SimConfig& config, int laps)
    : vehicle_{config.vehicle},
      body_{config},
      imu_model_{config.sensors, config.seed},
      referee_{config.world, config.vehicle, laps} {
  passes_.reserve(static_cast<std::size_t>(referee_.total()));
}

void DroneInWorld::step(const std::array<double, 4>& motors, double dt) {
  std::array<double, 4> speeds{};
  for (std::size_t i = 0; i < speeds.size(); ++i)
    speeds[i] = vehicle_.max_speed * std::clamp(motors[i], 0.0, 1.0);
  body_.step(speeds, dt);
  imu_ = imu_model_.measure(body_.state(), dt);
  const sim::BodyState& state = body_.state();
  if (!passes_.empty() && !finished()) way_ += state.v_E.norm() * dt;
  if (const auto pass = referee_.update(state, body_.time())) {
    passes_.push_back(*pass);
    way_at_pass_ = way_;
  }
  airborne_ = airborne_ || -state.p_EB.z() > kAirborne;
  if (!airborne_ || hit_) return;
  const auto touched = body_.contact();
  if (touched && *touched != "floor") hit_ = touched;
}

betaflight_sitl::State DroneInWorld::told() const {
  const sim::BodyState& state = body_.state();
  return {.time = std::chrono::nanoseconds{std::llround(1e9 * body_.time())},
          .imu = imu_,
          .p_EB = state.p_EB,
          .v_E = state.v_E,
          .attitude = attitude_of({sim::R_EB_of(state.q_EB)})};
}

bool DroneInWorld::rests() const {
  return body_.contact() == "floor" && body_.state().v_E.norm() < kStill;
}

double DroneInWorld::mean_speed() const {
  if (passes_.size() < 2) return 0.0;
  return way_at_pass_ / (passes_.back().time - passes_.front().time);
}

}  // namespace gatefly::link_sim
