// SPDX-License-Identifier: Apache-2.0
#include "gatefly/world/randomize.hpp"

#include <stdexcept>

#include "gatefly/geometry/math.hpp"

namespace gatefly::world {

Randomize randomize_level(const std::string& level) {
  if (level == "none") return {};
  Randomize race;
  race.gate_position = 0.10, race.gate_heading = 3 * kDegree, race.gate_height = 0.05;
  race.start_position = 0.10, race.start_heading = 3 * kDegree;
  race.camera_focal = 0.01, race.camera_center_px = 2.0, race.camera_k = race.camera_k1 = 0.02,
  race.camera_tilt = 1 * kDegree;
  race.camera_latency = 0.010;
  race.gate_side = 0.01;
  race.drag = 0.08, race.mass = 0.03, race.thrust = 0.03, race.sag = 0.05;
  race.accel_bias = 0.25, race.gyro_bias = 0.2 * kDegree, race.scale = 0.01,
  race.flight_bias = 0.05;
  race.light = 0.40, race.exposure = 0.30, race.hue = 6 * kDegree, race.white_balance = 0.08,
  race.saturation = 0.20;
  race.frame_loss = 0.02, race.latency_jitter = 0.010;
  race.imbalance = 0.3, race.accel_warming = 0.05, race.gyro_warming = 0.05 * kDegree;
  race.sonar_loss = 0.03, race.sonar_double = 0.002;
  race.decoys = 2, race.people = 2;
  if (level == "race") return race;
  if (level != "hard")
    throw std::invalid_argument("level = \"" + level + "\", must be none, race or hard");
  Randomize hard;
  hard.gate_position = 0.30, hard.gate_heading = 10 * kDegree, hard.gate_height = 0.15;
  hard.start_position = 0.20, hard.start_heading = 6 * kDegree;
  hard.camera_focal = 0.02, hard.camera_center_px = 4.0, hard.camera_k = hard.camera_k1 = 0.04,
  hard.camera_tilt = 2 * kDegree;
  hard.camera_latency = 0.025;
  hard.gate_side = 0.02;
  hard.drag = 0.15, hard.mass = 0.06, hard.thrust = 0.06, hard.sag = 0.15;
  hard.accel_bias = 0.5, hard.gyro_bias = 0.5 * kDegree, hard.scale = 0.02, hard.flight_bias = 0.10;
  hard.noise_scale = 2.0;
  hard.light = 0.70, hard.exposure = 0.50, hard.hue = 12 * kDegree, hard.white_balance = 0.15,
  hard.saturation = 0.35;
  hard.frame_loss = 0.10, hard.latency_jitter = 0.030;
  hard.wind = 0.5, hard.gust = 1.0;
  hard.jet = 0.5, hard.shear = 0.1, hard.wash = 1.0;
  hard.imbalance = 0.6, hard.accel_warming = 0.15, hard.gyro_warming = 0.15 * kDegree;
  hard.sonar_loss = 0.15, hard.sonar_double = 0.01;
  hard.decoys = 6, hard.people = 6;
  return hard;
}

}  // namespace gatefly::world
