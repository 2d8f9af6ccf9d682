// SPDX-License-Identifier: Apache-2.0
// pilot_loop TRACK CONFIG...: the pilot in a loop of yours, with course, camera and vehicle from files. The sensors
// here are those of a drone that is held on the floor: the pilot starts, sees that it does not climb, and gives up.
#include <chrono>
#include <iostream>
#include <string_view>

#include <gatefly/config/pilot_files.hpp>
#include <gatefly/race/pilot.hpp>

// Yours: waits for the next IMU sample. A picture is given with the sample in whose time it arrives.
gatefly::Sensors read_sensors(int tick) {
  gatefly::Sensors sensors;
  sensors.time = std::chrono::nanoseconds{tick * 1'953'125LL};  // 512 Hz
  // A sensor that says the same again and again is taken for stuck.
  const double noise = tick % 2 == 0 ? 0.002 : -0.002;
  sensors.imu.accel_B = {0.0, 0.0, -9.81 + noise};  // x forward, y right, z down
  sensors.sonar = 0.05 + noise;
  return sensors;
}

// Yours: rad/s of left front, right front, right back, left back.
void set_motors(const std::array<double, 4>& /*speeds*/) {}

int main(int argc, char** argv) try {
  gatefly::Pilot pilot{gatefly::config::read_pilot_config(argc > 1 ? argv[1] : "showroom",
                                                          {argv + std::min(argc, 2), argv + argc})};
  std::string_view phase;
  for (int tick = 0; !pilot.landed(); ++tick) {
    const gatefly::Sensors sensors = read_sensors(tick);
    set_motors(pilot.step(sensors).motors);
    if (phase == name_of(pilot.phase())) continue;
    phase = name_of(pilot.phase());
    std::cout << 1e-9 * static_cast<double>(sensors.time.count()) << " s: " << phase << '\n';
  }
  std::cout << (pilot.finished() ? "finished" : text_of(pilot.abort_reason())) << '\n';
} catch (const std::exception& error) {
  return std::cerr << error.what() << '\n', 2;
}
