// SPDX-License-Identifier: Apache-2.0
// soak [HOURS] [TRACK] [SEED] [LEVEL]: one flight round and round without an end, ideal vision, the battery always
// full. Says once an hour what must stay as it was: memory, errors, stamps, counters. Exit 0: flown to its end.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

#include "gatefly/sensing/sensor_health.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"

#include "support/allocation_counter.hpp"
#include "support/race_setup.hpp"

namespace {

using namespace gatefly;

long resident_kb() {
  std::ifstream status{"/proc/self/statm"};
  long all = 0, resident = 0;
  status >> all >> resident;
  return 4 * resident;
}

struct Hour {
  double square = 0.0, worst = 0.0;
  long ticks = 0;
};

}  // namespace

int main(int argc, char** argv) try {
  const int hours = argc > 1 ? std::atoi(argv[1]) : 24;
  if (hours < 1) throw std::invalid_argument("HOURS must be a whole number of at least 1");
  const std::string track = argc > 2 ? argv[2] : "oval", level = argc > 4 ? argv[4] : "none";
  const std::uint64_t seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1001;
  gatefly::simulated_race::RaceConfig race = test::race_on(track, seed, 1'000'000, {}, level);
  race.vision = gatefly::simulated_race::Vision::kIdeal;
  race.allocations = [] { return static_cast<std::uint64_t>(test::allocations); };
  race.timeout = 3600.0 * hours + 60.0;
  race.sim.vehicle.sag = 0.0;
  race.sim.vehicle.battery.capacity = 1e12;
  std::printf("hour  gates passed  rms [m]  worst [m]  memory [kB]  refused samples\n");
  Hour hour;
  int hours_flown = 0;
  gatefly::simulated_race::Flight flight{race};
  while (hours_flown < hours && flight.step()) {
    const gatefly::flight_log::Tick tick = flight.tick();
    const double t = 1e-9 * static_cast<double>(tick.sensors.time.count());
    const Estimate estimate = tick.pilot.estimate();
    const Eigen::Vector3d error = estimate.p_EB - tick.truth.p_EB;
    hour.square += error.squaredNorm(), hour.worst = std::max(hour.worst, error.norm()),
                                        ++hour.ticks;
    if (t < 3600.0 * (hours_flown + 1)) continue;
    ++hours_flown;
    std::uint64_t refused = 0;
    for (const SensorCount& each : kSensorCounts) refused += tick.pilot.health().*each.count;
    std::printf("%4d  %12d  %7.3f  %9.3f  %11ld  %15lu\n", hours_flown, estimate.gates_passed,
                std::sqrt(hour.square / static_cast<double>(hour.ticks)), hour.worst, resident_kb(),
                static_cast<unsigned long>(refused));
    std::fflush(stdout);
    hour = {};
  }
  const gatefly::simulated_race::RaceResult result = flight.result();
  std::printf("allocations in the pilot's steps: %lu\n",
              static_cast<unsigned long>(result.step_allocations));
  if (hours_flown >= hours) return 0;
  std::printf("over after %d hours and %d gates: %s %s\n", hours_flown, result.gates_passed,
              result.stop_reason.c_str(), result.crash_object.c_str());
  return 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "soak: %s\n", error.what());
  return 2;
}
