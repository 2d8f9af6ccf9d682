// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/simulated_laps.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/config/derived.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/drawn.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kRunOut = 0.3;  // after the last gate [s]

bool is_faced(const world::WorldGate& gate, const Eigen::Vector3d& p_EB, double yaw) {
  constexpr double kNear = 0.5, kFar = 4.0, kAskew = 25.0 * kDegree;
  const Eigen::Vector3d p_GB = rotation_z(-gate.yaw_EG) * (p_EB - gate.p_EG);
  return p_GB.x() < -kNear && p_GB.x() > -kFar && std::abs(p_GB.y()) < 1.0 &&
         std::abs(wrap_angle(yaw - gate.yaw_EG)) < kAskew;
}

}  // namespace

simulated_race::RaceConfig race_on(const std::string& track, int laps,
                                   simulated_race::Vision vision, std::uint64_t seed,
                                   bool exact_map, const std::vector<std::string>& configs,
                                   const std::vector<std::string>& settings) {
  const config::Config config = config::load_config(config::config_files(configs), settings);
  const config::TrackFile file = config::read_track(config::find_track(track), config.gate);
  simulated_race::RaceConfig race;
  race.vision = vision, race.timeout = config.sim.timeout, race.pilot = config.pilot;
  race.pilot.track = file.track;
  if (laps > 0) race.pilot.track.laps = laps;
  world::SimConfig nominal = config::simulator_config(config, file);
  nominal.cache_dir = std::filesystem::temp_directory_path() / "gatefly-cache";
  world::Randomize sigma = config::randomized(file.randomize, config.randomize, "[randomize]");
  if (exact_map) sigma.gate_position = sigma.gate_heading = sigma.gate_height = 0.0;
  race.sim = sim::drawn(nominal, sigma, seed);
  return race;
}

SimulatedLaps simulated_laps(const std::string& track, int laps, std::uint64_t seed) {
  // The drag filter is studied on laps that it flew itself.
  const simulated_race::RaceConfig race =
      race_on(track, laps, simulated_race::Vision::kIdeal, seed, false, {}, {"filter.model=drag"});
  SimulatedLaps flown;
  flown.accel_bias = race.sim.sensors.accel_bias + race.sim.sensors.flight_bias;
  double done = 1e9;
  const auto result = simulated_race::fly(race, [&](const flight_log::Tick& tick) {
    const double t = 1e-9 * static_cast<double>(tick.sensors.time.count());
    LapMoment m{.imu = tick.sensors.imu,
                .t = t,
                .dt = flown.moments.empty() ? 0.0 : t - flown.moments.back().t,
                .p_EB = tick.truth.p_EB,
                .v_E = tick.truth.v_E,
                .attitude = tick.truth.attitude};
    m.rests = std::holds_alternative<OnGround>(tick.pilot.phase());
    for (const world::WorldGate& gate : race.sim.world.gates)
      m.faces_gate = m.faces_gate || (!m.rests && is_faced(gate, m.p_EB, m.attitude.yaw));
    flown.moments.push_back(m);
    if (tick.pilot.finished()) done = std::min(done, t);
    return t < done + kRunOut;
  });
  flown.finished = result.gates_passed == result.gates_total;
  return flown;
}

}  // namespace gatefly::experiments
