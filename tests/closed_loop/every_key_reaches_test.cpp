// SPDX-License-Identifier: Apache-2.0
// Every key of [randomize] and [faults] reaches the sensors that its name says, and no others.
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/config/faults.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/simulated_race/closed_loop/sensor_suite.hpp"
#include "gatefly/simulated_race/closed_loop/simulators.hpp"

#include "support/race_setup.hpp"

namespace gatefly::simulated_race {
namespace {

using nlohmann::json;

/// Channels that a reader of the sensors alone can tell apart.
enum Channel {
  kStamps,    ///< Times of the ticks.
  kAccel,     ///< Ticks' samples.
  kGyro,      ///<
  kSonar,     ///<
  kBaro,      ///<
  kArrivals,  ///< In which ticks pictures arrive.
  kSeen,      ///< Ideal vision's detections, by the time of exposure.
  kPictures,  ///< Pixels, at two moments.
  kChannels
};
constexpr std::array<const char*, kChannels> kNames{
    "stamps", "accelerometer", "gyro", "sonar", "baro", "arrivals", "ideal vision", "pictures"};

/// Sensor data as bytes: a map by time, so that common parts can be compared.
using Record = std::map<double, std::string>;
using Records = std::array<Record, kChannels>;

void put(Record& record, double t, const void* data, std::size_t size) {
  record[t].append(static_cast<const char*>(data), size);
}
void put(Record& record, double t, const Eigen::Vector3d& v) {
  put(record, t, v.data(), 3 * sizeof(double));
}

constexpr double kDuration = 2.0, kFlash1 = 1.2, kFlash2 = 1.9;  // [s]

/// The same rotor speeds whatever happens: up, then about level, turning a little.
std::array<double, 4> motors_at(double t) {
  if (t < 0.3) return {300, 300, 300, 300};
  if (t < 1.0) return {860, 860, 855, 855};
  return {775, 772, 776, 773};
}

/// Two pictures as they are rendered from where the drone is.
void take_pictures(const world::SimConfig& config, const std::vector<sim::BodyPose>& poses,
                   Record& record) {
  sim::CameraRenderer renderer{config.world, config.camera,    config.light,
                               config.seed,  config.cache_dir, config.bake_threads};
  std::vector<std::uint8_t> bytes;
  std::uint32_t frame = 0;
  for (const double t : {kFlash1, kFlash2}) {
    renderer.meter_anew();
    renderer.render(++frame, t, poses, bytes);
    put(record, t, bytes.data(), bytes.size());
  }
}

Records flown(const world::SimConfig& config) {
  Records records;
  IdealSimulator simulator{config, {}};
  SensorSuite suite{config};
  Stopwatch watch{"camera"};
  const int steps = physics_steps(config.sensors.imu_hz);
  std::vector<sim::BodyPose> poses;
  for (std::int64_t tick = 0; simulator.body.time() < kDuration; ++tick) {
    const double dt = suite.next_interval(), now = simulator.body.time();
    for (int i = 0; i < steps; ++i) {
      simulator.body.step(motors_at(now), dt / steps);
      suite.remember(simulator.body.state(), simulator.body.time());
      const sim::BodyState& state = simulator.body.state();
      poses.push_back({simulator.body.time(), state.p_EB, state.q_EB});
    }
    const Sensors sensors = suite.read(tick, dt, simulator, watch);
    const auto count = static_cast<double>(tick);
    const auto stamp = sensors.time.count();
    put(records[kStamps], count, &stamp, sizeof stamp);
    put(records[kAccel], count, sensors.imu.accel_B);
    put(records[kGyro], count, sensors.imu.gyro_B);
    if (sensors.sonar) put(records[kSonar], count, &*sensors.sonar, sizeof(double));
    if (sensors.baro) put(records[kBaro], count, &*sensors.baro, sizeof(double));
    if (!sensors.seen) continue;
    put(records[kArrivals], count, "picture", 7);
    Record& seen = records[kSeen];
    seen[suite.camera().start()];
    for (const GateDetection& gate : sensors.seen->gates)
      put(seen, suite.camera().start(), gate.corners_px.data(), sizeof gate.corners_px);
  }
  take_pictures(config, poses, records[kPictures]);
  return records;
}

/// Ideal vision is asked about the exposures of both; else what came in one only counts, too.
bool differ(const Record& a, const Record& b, bool common_only) {
  for (const auto& [t, bytes] : a) {
    const auto other = b.find(t);
    if (other == b.end() ? !common_only : other->second != bytes) return true;
  }
  return !common_only && a.size() != b.size();
}

std::set<std::string> changed(const Records& a, const Records& b) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < kChannels; ++i)
    if (differ(a[i], b[i], i == kSeen)) names.insert(kNames[i]);
  return names;
}

/// Effect of a key, by name.
struct Effect {
  json value;
  std::vector<Channel> must;      ///< These show it ...
  std::vector<Channel> may = {};  ///< ... these may, all others must not.
  json with = json::object();     ///< Other keys of the section, set before and after.
  std::uint64_t seed = 1003;      ///< One that shows it.
  bool polynomial = false;        ///< Through a polynomial lens, not the Bebop's.
};

// A body that moves otherwise may show it anywhere but in the clock and the camera's schedule.
const std::vector<Channel> kMotion{kAccel, kGyro, kSonar, kBaro, kSeen, kPictures};

const std::map<std::string, Effect>& effects() {
  static const std::map<std::string, Effect> table{
      // randomize: gates and what is around
      {"randomize.gate_position_m", {0.3, {kSeen, kPictures}}},
      {"randomize.gate_heading_deg", {10, {kSeen, kPictures}}},
      {"randomize.gate_height_m", {0.2, {kSeen, kPictures}}},
      {"randomize.gate_side_percent", {5, {kSeen, kPictures}}},
      {"randomize.decoys", {40, {kPictures}, {kSeen, kSonar}}},
      {"randomize.start_position_m", {0.2, {kSeen, kPictures}, kMotion}},
      {"randomize.start_heading_deg", {6, {kSeen, kPictures}, kMotion}},
      // camera
      {"randomize.camera_focal_percent", {2, {kSeen, kPictures}}},
      {"randomize.camera_center_px", {4, {kSeen, kPictures}}},
      {"randomize.camera_k", {0.05, {kSeen, kPictures}}},
      {"randomize.camera_k1_percent",
       {.value = 20, .must = {kSeen, kPictures}, .polynomial = true}},
      {"randomize.camera_tilt_deg", {2, {kSeen, kPictures}}},
      {"randomize.camera_latency_ms", {25, {kArrivals}}},
      {"randomize.latency_jitter_ms", {30, {kArrivals}}},
      {"randomize.frame_loss_percent", {30, {kArrivals}}},
      {"randomize.light_percent", {70, {kPictures}}},
      {"randomize.exposure_percent", {50, {kPictures}}},
      {"randomize.hue_deg", {12, {kPictures}}},
      {"randomize.white_balance_percent", {15, {kPictures}}},
      {"randomize.saturation_percent", {35, {kPictures}}},
      {"randomize.people", {12, {kPictures}}},
      // body and air
      {"randomize.drag_percent", {15, {kAccel}, kMotion}},
      {"randomize.mass_percent", {6, {kAccel}, kMotion}},
      {"randomize.thrust_percent", {6, {kAccel}, kMotion}},
      {"randomize.sag_percent", {15, {kAccel}, kMotion}},
      {"randomize.wind_mps", {0.5, {kAccel, kBaro}, kMotion}},
      {"randomize.gust_mps", {1.0, {kAccel, kBaro}, kMotion}},
      {"randomize.shear_per_s", {0.2, {kAccel, kBaro}, kMotion}},
      // Started in the jet, and beside a wall.
      {"randomize.jet_mps", {1.0, {kAccel, kBaro}, kMotion, {{"start_position_m", 2}}, 1001}},
      {"randomize.wash", {1.0, {kAccel}, kMotion, {{"start_position_m", 2}}, 1010}},
      // IMU, sonar
      {"randomize.accel_bias_mps2", {0.5, {kAccel}}},
      {"randomize.flight_bias_mps2", {0.5, {kAccel}}},
      {"randomize.accel_warming_mps2", {5, {kAccel}}},
      {"randomize.gyro_bias_degps", {5, {kGyro}}},
      {"randomize.gyro_warming_degps", {20, {kGyro}}},
      {"randomize.scale_percent", {5, {kAccel, kGyro}}},
      {"randomize.noise_scale", {3, {kAccel, kGyro, kPictures}}},
      {"randomize.imbalance_percent", {60, {kAccel, kGyro}}},
      {"randomize.sonar_loss_percent", {50, {kSonar}}},
      {"randomize.sonar_double_percent", {50, {kSonar}}},
      // faults: camera, light
      {"faults.camera_drop_percent", {50, {kArrivals}}},
      {"faults.camera_out_s", {{0.8, 0.5}, {kArrivals}}},
      {"faults.camera_stuck_s", {{0.8, 0.8}, {kSeen}}},
      {"faults.camera_delay_ms", {40, {kArrivals}}},
      {"faults.camera_tilt_deg", {5, {kSeen, kPictures}}},
      {"faults.focal_percent", {5, {kSeen, kPictures}}},
      {"faults.light_out_s", {{1.0, 9}, {kSeen, kPictures}}},
      {"faults.hue_deg", {120, {kPictures}}},
      // IMU
      {"faults.imu_stuck_s", {{0.8, 0.2}, {kAccel, kGyro}}},
      {"faults.imu_nan_s", {{0.8, 0.2}, {kAccel, kGyro}}},
      {"faults.accel_range_mps2", {9, {kAccel}}},
      {"faults.gyro_range_degps", {10, {kGyro}}},
      {"faults.bias_step_at_s",
       {1.0,
        {kAccel, kGyro},
        {},
        {{"accel_bias_step_mps2", {0, 0, 1}}, {"gyro_bias_step_degps", {0, 5, 0}}}}},
      {"faults.accel_bias_step_mps2", {{0.5, 0, 0}, {kAccel}}},
      {"faults.gyro_bias_step_degps", {{0, 5, 0}, {kGyro}}},
      {"faults.imu_tilt_deg", {{5, 0}, {kAccel, kGyro}}},
      {"faults.time_jump_s", {{1.0, 0.5}, {kStamps}}},
      // height
      {"faults.sonar_drop_percent", {50, {kSonar}}},
      {"faults.sonar_out_s", {{0.5, 1}, {kSonar}}},
      // gates
      {"faults.moved_gate", {1, {kSeen, kPictures}, {}, {{"gate_moved_m", {0.3, 0.3, 0}}}}},
      {"faults.gate_moved_m", {{0.3, 0.3, 0}, {kSeen, kPictures}, {}, {{"moved_gate", 1}}}},
      {"faults.gate_aside_m", {0.5, {kSeen, kPictures}, {}, {{"moved_gate", -1}}}},
      {"faults.gate_turned_deg", {20, {kSeen, kPictures}, {}, {{"moved_gate", 1}}}},
      {"faults.course_scale_percent", {-7, {kSeen, kPictures}}},
      {"faults.missing_gate", {1, {kSeen, kPictures}}},
      // Pictures show a gate that ideal vision hides.
      {"faults.hidden_gate", {1, {kSeen}, {kPictures}, {{"gate_hidden_m", 1.0}}}},
      {"faults.gate_hidden_m", {1.0, {kSeen}, {kPictures}, {{"hidden_gate", 1}}}},
      {"faults.false_gates", {8, {kPictures}, {kSeen, kSonar}}},
      // start, rotors, battery, air
      {"faults.start_heading_deg", {6, {kSeen, kPictures}, kMotion}},
      {"faults.hover_thrust_percent", {10, {kAccel}, kMotion}},
      {"faults.thrust_loss_percent", {10, {kAccel}, kMotion}},
      {"faults.weak_rotor", {2, {kAccel, kGyro}, kMotion, {{"thrust_loss_percent", 5}}}},
      {"faults.thrust_loss_s", {{1.0, 0.5}, {kAccel}, kMotion, {{"thrust_loss_percent", 10}}}},
      {"faults.battery_sag_percent", {30, {kAccel}, kMotion}},
      {"faults.wind_mps", {{1, 0}, {kAccel, kBaro}, kMotion}},
      {"faults.wind_s", {{1.0, 0.5}, {kAccel, kBaro}, kMotion, {{"wind_mps", {1, 0}}}}}};
  return table;
}

/// A seed's truth in which nothing is varied but what is said.
world::SimConfig drawn_with(const json& randomize, const json& faults, const Effect& effect) {
  world::SimConfig nominal = test::race_on("oval", effect.seed, 1, {}, "none").sim;
  if (effect.polynomial)
    nominal.camera.lens = {KannalaBrandt{{168, 168}, {157, 124}, RadialPolynomial{{0.1, 0, 0, 0}}}};
  // Something to lose and to jitter, so that each key alone shows.
  nominal.faults = config::with_faults({}, faults, "here");
  return sim::drawn(nominal, config::randomized({}, randomize, "here"), effect.seed);
}

world::SimConfig drawn_with(const std::string& name, const Effect& effect, bool set) {
  const auto dot = name.find('.');
  json table = effect.with;
  if (set) table[name.substr(dot + 1)] = effect.value;
  const bool is_fault = name.starts_with("faults.");
  return drawn_with(is_fault ? json::object() : table, is_fault ? table : json::object(), effect);
}

TEST(EveryKey, HasAnEffectNamedHere) {
  std::set<std::string> keys, named;
  for (const auto& key : config::randomize_keys()) keys.insert(key.rule.name);
  for (const auto& key : config::fault_keys()) keys.insert(key.rule.name);
  for (const auto& [name, effect] : effects()) named.insert(name);
  EXPECT_EQ(named, keys);
}

TEST(EveryKey, ReachesTheSensorsOfItsNameAndNoOthers) {
  std::map<std::string, Records> befores;  // most keys have the same
  for (const auto& [name, effect] : effects()) {
    SCOPED_TRACE(name);
    const std::string section = effect.with.empty() && !effect.polynomial ? "" : name;
    if (!befores.contains(section)) befores[section] = flown(drawn_with(name, effect, false));
    const auto shown = changed(befores.at(section), flown(drawn_with(name, effect, true)));
    std::set<std::string> allowed;
    for (const Channel channel : effect.must) {
      EXPECT_TRUE(shown.contains(kNames[channel])) << kNames[channel] << " does not show it";
      allowed.insert(kNames[channel]);
    }
    for (const Channel channel : effect.may) allowed.insert(kNames[channel]);
    for (const std::string& channel : shown)
      EXPECT_TRUE(allowed.contains(channel)) << channel << " shows it";
  }
}

}  // namespace
}  // namespace gatefly::simulated_race
