// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/link/betaflight_sitl.hpp"
#include "gatefly/sim/body.hpp"
#include "gatefly/sim/referee.hpp"
#include "gatefly/sim/sensors.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::link_sim {

/// A seed's drone among its gates: motors in, what a flight controller's sensors feel out, and a referee who watches.
class DroneInWorld {
 public:
  DroneInWorld(const world::SimConfig& config, int laps);

  /// Another `dt` [s] with motors 0 … 1 of their highest speed: front left, front right, rear right, rear left.
  void step(const std::array<double, 4>& motors, double dt);

  /// The state that a flight controller's simulator is told.
  [[nodiscard]] betaflight_sitl::State told() const;
  [[nodiscard]] const sim::BodyState& state() const { return body_.state(); }
  [[nodiscard]] double time() const { return body_.time(); }

  [[nodiscard]] bool airborne() const { return airborne_; }
  [[nodiscard]] bool rests() const;
  /// The first thing that was touched in the air, the floor aside; nullopt while nothing was.
  [[nodiscard]] const std::optional<std::string>& hit() const { return hit_; }
  [[nodiscard]] const std::vector<sim::GatePass>& passes() const { return passes_; }
  [[nodiscard]] int gates_total() const { return referee_.total(); }
  [[nodiscard]] bool finished() const { return referee_.finished(); }
  /// From the first gate's plane to the last one's [m/s]; 0 before the second.
  [[nodiscard]] double mean_speed() const;

 private:
  world::VehicleTruth vehicle_;
  sim::Body body_;
  sim::ImuModel imu_model_;
  sim::Referee referee_;
  Imu imu_;
  std::vector<sim::GatePass> passes_;
  std::optional<std::string> hit_;
  double way_ = 0.0, way_at_pass_ = 0.0;  ///< Since the first gate [m].
  bool airborne_ = false;
};

}  // namespace gatefly::link_sim
