// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/drawn.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::sim {
namespace {

using Numbers = std::map<std::string, double>;

void put(Numbers& numbers, const std::string& name, std::span<const double> values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    numbers[values.size() == 1 ? name : name + "." + std::to_string(i)] = values[i];
}
void put(Numbers& numbers, const std::string& name, double value) { numbers[name] = value; }
template <int N>
void put(Numbers& numbers, const std::string& name, const Eigen::Vector<double, N>& v) {
  put(numbers, name, std::span{v.data(), static_cast<std::size_t>(N)});
}

/// Angle about the grey axis, and what a turn of the hue leaves alone: grey and saturation.
void put_color(Numbers& numbers, const std::string& name, const Eigen::Vector3d& rgb) {
  const double x = (2 * rgb.x() - rgb.y() - rgb.z()) / std::sqrt(6.0),
               y = (rgb.y() - rgb.z()) / std::sqrt(2.0);
  put(numbers, name + ".hue", std::atan2(y, x));
  put(numbers, name + ".grey", rgb.mean());
  put(numbers, name + ".saturation", std::hypot(x, y));
}

/// Every number of a configuration by name. The bindings stop compiling when a member is added:
/// then a draw may change it, and this list has to know.
Numbers numbers_of(const world::SimConfig& config) {
  Numbers n;
  const auto& [world, vehicle, sensors, autopilot, camera, light, ideal_vision, start, wind, faults,
               seed, cache_dir, bake_threads] = config;
  put(n, "seed", static_cast<double>(seed));
  put(n, "bake_threads", bake_threads);
  put(n, "ideal_vision.outliers", ideal_vision.outliers);
  {
    const auto& [takes, hz, delay, delay_jitter, smoothing_hz, gain, angle_gain, most_angle,
                 rc_rate, super_rate, rc_expo, throttle_mid, throttle_expo] = autopilot;
    put(n, "set_points",
        std::array{static_cast<double>(takes), hz, delay, delay_jitter, smoothing_hz, gain,
                   angle_gain, most_angle});
    put(n, "rc_rate", rc_rate), put(n, "super_rate", super_rate), put(n, "rc_expo", rc_expo);
    put(n, "throttle", std::array{double(throttle_mid), double(throttle_expo)});
  }
  {
    const auto& [look, room_size, room_center, gates, false_gates, paint, obstacles, decoys,
                 people] = world;
    put(n, "paint", std::array{paint.width, paint.blue, paint.wear});
    put(n, "false_gates", static_cast<double>(false_gates.size()));
    put(n, "room_size", room_size);
    put(n, "room_center", room_center);
    put(n, "decoys", static_cast<double>(decoys.size()));
    put(n, "people", static_cast<double>(people.size()));
    for (std::size_t i = 0; i < gates.size(); ++i) {
      const auto& [p_EG, yaw_EG, side, bar, color, sought, missing, hidden_beyond, depth] =
          gates[i];
      const std::string name = "gate" + std::to_string(i);
      put(n, name + ".p_EG", p_EG);
      put(n, name + ".yaw_EG", yaw_EG);
      put(n, name + ".side", side);
      put(n, name + ".bar", bar);
      put(n, name + ".depth", depth);
      put_color(n, name, color);
      put(n, name + ".there", std::array{sought ? 1.0 : 0.0, missing ? 1.0 : 0.0, hidden_beyond});
    }
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      const auto& [center, size, heading, bottom, top, pole] = obstacles[i];
      const std::string name = "obstacle" + std::to_string(i);
      put(n, name + ".center", center);
      put(n, name + ".size", size);
      put(n, name, std::array{heading, bottom, top, pole ? 1.0 : 0.0});
    }
  }
  {
    const auto& [mass, inertia, size, arm_x, arm_y, propeller_radius, thrust_coefficient,
                 torque_coefficient, rotor_time_constant, min_speed, max_speed, rotor_drag,
                 body_drag, air_moment, sag, sag_time, battery] = vehicle;
    put(n, "mass", mass);
    put(n, "inertia", inertia);
    put(n, "size", size);
    put(n, "arms", std::array{arm_x, arm_y, propeller_radius});
    put(n, "thrust_coefficient", thrust_coefficient);
    put(n, "torque_coefficient", torque_coefficient);
    put(n, "rotors", std::array{rotor_time_constant, min_speed, max_speed});
    put(n, "rotor_drag", rotor_drag);
    put(n, "body_drag", body_drag);
    put(n, "air_moment", air_moment);
    put(n, "sag", sag);
    put(n, "sag_time", sag_time);
    const auto& [capacity, full, empty, resistance, hover_power, electronics] = battery;
    put(n, "battery", std::array{capacity, full, empty, resistance, hover_power, electronics});
  }
  {
    const auto& [accel_bias, flight_bias, gyro_bias, gyro_drift, accel_scale, gyro_scale,
                 accel_noise, accel_vibration, gyro_noise, gyro_vibration, gyro_rumble, imbalance,
                 accel_warming, gyro_warming, warming_time, noise_scale, imu_hz, sonar_hz, baro_hz,
                 imu_jitter, autopilot_imu_hz, autopilot_gyro_cutoff, autopilot_accel_cutoff,
                 autopilot_imu_jitter, sonar_noise, sonar_max, sonar_loss, sonar_double, baro_noise,
                 baro_drift, baro_airspeed, camera_hz, camera_latency, latency_jitter, frame_loss] =
        sensors;
    put(n, "accel_bias", accel_bias);
    put(n, "flight_bias", flight_bias);
    put(n, "gyro_bias", gyro_bias);
    put(n, "gyro_drift", gyro_drift);
    put(n, "accel_scale", accel_scale);
    put(n, "gyro_scale", gyro_scale);
    put(n, "accel_noise", accel_noise);
    put(n, "accel_vibration", accel_vibration);
    put(n, "gyro_noise", gyro_noise);
    put(n, "gyro_vibration", gyro_vibration);
    put(n, "gyro_rumble", gyro_rumble);
    put(n, "noise_scale", noise_scale);
    put(n, "rates", std::array{imu_hz, sonar_hz, baro_hz});
    put(n, "imu_jitter", imu_jitter);
    put(n, "autopilot",
        std::array{autopilot_imu_hz, autopilot_gyro_cutoff, autopilot_accel_cutoff,
                   autopilot_imu_jitter});
    put(n, "sonar", std::array{sonar_noise, sonar_max});
    put(n, "baro", std::array{baro_noise, baro_drift, baro_airspeed});
    put(n, "imbalance", imbalance);
    put(n, "accel_warming", accel_warming);
    put(n, "gyro_warming", gyro_warming);
    put(n, "warming_time", warming_time);
    put(n, "sonar_loss", sonar_loss);
    put(n, "sonar_double", sonar_double);
    put(n, "camera_hz", camera_hz);
    put(n, "camera_latency", camera_latency);
    put(n, "latency_jitter", latency_jitter);
    put(n, "frame_loss", frame_loss);
  }
  {
    const auto& [lens, p_BC, tilt_down, stored_width, stored_height, stored_rotation, jpeg_quality,
                 exposure, readout, fast, imaging] = camera;
    const auto& [focal_px, center_px, k] = std::get<DhaneFisheye>(lens.model);
    put(n, "focal_px", focal_px);
    put(n, "center_px", center_px);
    put(n, "lens_k", k);
    put(n, "p_BC", p_BC);
    put(n, "tilt_down", tilt_down);
    put(n, "stored",
        std::array{double(stored_width), double(stored_height), double(stored_rotation),
                   double(jpeg_quality)});
    put(n, "shutter", std::array{exposure, readout});
    put(n, "fast", double(fast));
    put(n, "imaging.saturation", imaging.saturation);
    put(n, "imaging",
        std::array{imaging.footprint_px, imaging.red_shift_px, double(imaging.chroma_smoothing)});
  }
  {
    const auto& [group_gain, group_color, exposure_target, white_balance, noise_scale, out, blur,
                 surfaces] = light;
    for (const auto& color : group_color) put(n, "group_color", color);
    put(n, "appearance", std::array{blur, double(surfaces)});
    put(n, "light.out", out);
    put(n, "group_gain", group_gain);
    put(n, "exposure_target", exposure_target);
    put(n, "white_balance", white_balance);
    put(n, "picture_noise_scale", noise_scale);
  }
  put(n, "start.position", start.position);
  put(n, "start.heading", start.heading);
  put(n, "wind.mean", wind.mean);
  put(n, "wind.gust", wind.gust);
  put(n, "wind.shape", std::array{wind.gust_length, wind.gust_vertical});
  put(n, "wind.jet", std::array{wind.jet.speed, wind.jet.width});
  put(n, "wind.shear", wind.shear.rate);
  put(n, "wind.wash", wind.wash);
  return n;
}

/// A world with two gates and an obstacle, and no number at a value that a draw would leave alone.
world::SimConfig nominal_config() {
  world::SimConfig config;
  config.world.gates = {{.p_EG = {2.0, 1.0, -1.5}, .yaw_EG = 0.6, .color = {0.6, 0.4, 0.3}},
                        {.p_EG = {-3.0, 2.0, -1.8}, .yaw_EG = -2.0, .color = {0.3, 0.4, 0.6}}};
  config.world.obstacles = {{{1.0, -3.0}, {1.5, 0.6}, 0.5, 0.0, 1.9, false}};
  config.start = {{0.5, -0.5}, 0.3};
  config.wind = {.mean = {0.2, -0.1}, .gust = 0.3};
  config.vehicle.sag = 0.04;
  config.sensors.flight_bias = {0.01, 0.02, 0.03};
  config.sensors.gyro_drift = {0.001, 0.002, 0.003};
  config.sensors.noise_scale = 1.5;
  config.sensors.latency_jitter = 0.002;
  config.sensors.frame_loss = 0.01;
  config.light.group_gain = {0.9, 1.1, 0.8};
  config.light.exposure_target = 1.2;
  config.light.white_balance = {1.05, 0.95, 0.9};
  config.light.noise_scale = 1.5;
  config.sensors.accel_warming = {0.02, 0.01, 0.03};
  config.sensors.gyro_warming = {0.001, 0.003, 0.002};
  config.sensors.sonar_loss = 0.01, config.sensors.sonar_double = 0.002;
  return config;
}

/// How a size of `Randomize` and a random number z, or the size alone, change a number.
enum class Change {
  kAdds,         ///< nominal + size z
  kScales,       ///< nominal (1 + size z)
  kReplaces,     ///< size z
  kAddsItself,   ///< nominal + size
  kScalesItself  ///< nominal size
};

/// Effect of one member of `Randomize`.
struct Draw {
  const char* name;
  double world::Randomize::*member;
  double size;  ///< To try: small enough that no limit but 2.5 standard deviations is met.
  Change change;
  /// Each list shares one random number; the numbers of different lists are independent.
  std::vector<std::vector<std::string>> numbers;
};

/// docs/simulation.md, "What a seed changes". All but `decoys`.
const std::vector<Draw>& draws() {
  using enum Change;
  static const std::vector<Draw> list{
      {"gate_position",
       &world::Randomize::gate_position,
       0.1,
       kAdds,
       {{"gate0.p_EG.0"}, {"gate0.p_EG.1"}, {"gate1.p_EG.0"}, {"gate1.p_EG.1"}}},
      {"gate_heading",
       &world::Randomize::gate_heading,
       0.05,
       kAdds,
       {{"gate0.yaw_EG"}, {"gate1.yaw_EG"}}},
      {"gate_height",
       &world::Randomize::gate_height,
       0.05,
       kAdds,
       {{"gate0.p_EG.2"}, {"gate1.p_EG.2"}}},
      {"gate_side", &world::Randomize::gate_side, 0.01, kScales, {{"gate0.side"}, {"gate1.side"}}},
      {"start_position",
       &world::Randomize::start_position,
       0.1,
       kAdds,
       {{"start.position.0"}, {"start.position.1"}}},
      {"start_heading", &world::Randomize::start_heading, 0.05, kAdds, {{"start.heading"}}},
      {"camera_focal",
       &world::Randomize::camera_focal,
       0.01,
       kScales,
       {{"focal_px.0", "focal_px.1"}}},
      {"camera_center_px",
       &world::Randomize::camera_center_px,
       2.0,
       kAdds,
       {{"center_px.0"}, {"center_px.1"}}},
      {"camera_k", &world::Randomize::camera_k, 0.02, kAdds, {{"lens_k"}}},
      {"camera_k1", &world::Randomize::camera_k1, 0.02, kScales, {}},  // no polynomial lens here
      {"camera_tilt", &world::Randomize::camera_tilt, 0.02, kAdds, {{"tilt_down"}}},
      {"camera_latency", &world::Randomize::camera_latency, 0.01, kAdds, {{"camera_latency"}}},
      {"drag",
       &world::Randomize::drag,
       0.08,
       kScales,
       {{"rotor_drag.0", "rotor_drag.1", "rotor_drag.2"}, {"body_drag"}}},
      {"mass",
       &world::Randomize::mass,
       0.03,
       kScales,
       {{"mass", "inertia.0", "inertia.1", "inertia.2"}}},
      {"thrust", &world::Randomize::thrust, 0.03, kScales, {{"thrust_coefficient"}}},
      {"sag", &world::Randomize::sag, 0.05, kAddsItself, {{"sag"}}},
      {"accel_bias",
       &world::Randomize::accel_bias,
       0.25,
       kReplaces,
       {{"accel_bias.0"}, {"accel_bias.1"}, {"accel_bias.2"}}},
      {"gyro_bias",
       &world::Randomize::gyro_bias,
       0.003,
       kAdds,
       {{"gyro_drift.0"}, {"gyro_drift.1"}, {"gyro_drift.2"}}},
      {"scale",
       &world::Randomize::scale,
       0.01,
       kAdds,
       {{"accel_scale.0"},
        {"accel_scale.1"},
        {"accel_scale.2"},
        {"gyro_scale.0"},
        {"gyro_scale.1"},
        {"gyro_scale.2"}}},
      {"flight_bias",
       &world::Randomize::flight_bias,
       0.05,
       kAdds,
       {{"flight_bias.0"}, {"flight_bias.1"}, {"flight_bias.2"}}},
      {"noise_scale",
       &world::Randomize::noise_scale,
       2.0,
       kScalesItself,
       {{"noise_scale", "picture_noise_scale"}}},
      {"light",
       &world::Randomize::light,
       0.3,
       kScales,
       {{"group_gain.0"}, {"group_gain.1"}, {"group_gain.2"}}},
      {"exposure", &world::Randomize::exposure, 0.25, kScales, {{"exposure_target"}}},
      {"hue", &world::Randomize::hue, 0.1, kAdds, {{"gate0.hue", "gate1.hue"}}},
      {"white_balance",
       &world::Randomize::white_balance,
       0.08,
       kScales,
       {{"white_balance.0"}, {"white_balance.1"}, {"white_balance.2"}}},
      {"saturation", &world::Randomize::saturation, 0.2, kScales, {{"imaging.saturation"}}},
      {"frame_loss", &world::Randomize::frame_loss, 0.02, kAddsItself, {{"frame_loss"}}},
      {"latency_jitter",
       &world::Randomize::latency_jitter,
       0.01,
       kAddsItself,
       {{"latency_jitter"}}},
      {"wind", &world::Randomize::wind, 0.5, kAdds, {{"wind.mean.0"}, {"wind.mean.1"}}},
      {"gust", &world::Randomize::gust, 1.0, kAddsItself, {{"wind.gust"}}},
      {"jet", &world::Randomize::jet, 0.3, kAddsItself, {{"wind.jet.0"}}},
      {"shear", &world::Randomize::shear, 0.1, kAddsItself, {{"wind.shear"}}},
      {"wash", &world::Randomize::wash, 0.5, kAddsItself, {{"wind.wash"}}},
      {"imbalance",
       &world::Randomize::imbalance,
       0.3,
       kScales,
       {{"imbalance.0"}, {"imbalance.1"}, {"imbalance.2"}, {"imbalance.3"}}},
      {"accel_warming",
       &world::Randomize::accel_warming,
       0.05,
       kAdds,
       {{"accel_warming.0"}, {"accel_warming.1"}, {"accel_warming.2"}}},
      {"gyro_warming",
       &world::Randomize::gyro_warming,
       0.01,
       kAdds,
       {{"gyro_warming.0"}, {"gyro_warming.1"}, {"gyro_warming.2"}}},
      {"sonar_loss", &world::Randomize::sonar_loss, 0.05, kAddsItself, {{"sonar_loss"}}},
      {"sonar_double", &world::Randomize::sonar_double, 0.01, kAddsItself, {{"sonar_double"}}}};
  return list;
}

world::Randomize alone(const Draw& draw) {
  world::Randomize sigma;
  sigma.*draw.member = draw.size;
  return sigma;
}

world::Randomize all_draws() {
  world::Randomize sigma;
  for (const Draw& draw : draws()) sigma.*draw.member = draw.size;
  return sigma;
}

Numbers drawn_numbers(const world::Randomize& sigma, std::uint64_t seed) {
  world::SimConfig nominal = nominal_config();
  nominal.seed = seed;
  return numbers_of(drawn(nominal, sigma, seed));
}

/// The random number that made `real` of `nominal`, or how far the size alone is off what it says.
double standardised(const Draw& draw, double nominal, double real) {
  switch (draw.change) {
    case Change::kAdds:
      return (real - nominal) / draw.size;
    case Change::kScales:
      return (real / nominal - 1.0) / draw.size;
    case Change::kReplaces:
      return real / draw.size;
    case Change::kAddsItself:
      return real - (nominal + draw.size);
    case Change::kScalesItself:
      return real - nominal * draw.size;
  }
  return 1e9;
}

bool is_random(const Draw& draw) {
  return draw.change != Change::kAddsItself && draw.change != Change::kScalesItself;
}

TEST(Randomize, EveryMemberHasARowInTheTableAbove) {
  world::Randomize sigma;
  // A member more and this does not compile: give it a row.
  auto& [m0, m1, m2, m3, m4, m5, m6, m7, m8, m9, m10, m11, m12, m13, m14, m15, m16, m17, m18, m19,
         m20, m21, m22, m23, m24, m25, m26, m27, m28, m29, m30, m31, m32, m33, m34, m35, m36, m37,
         decoys, people] = sigma;
  const std::set<double*> members{&m0,  &m1,  &m2,  &m3,  &m4,  &m5,  &m6,  &m7,  &m8,  &m9,
                                  &m10, &m11, &m12, &m13, &m14, &m15, &m16, &m17, &m18, &m19,
                                  &m20, &m21, &m22, &m23, &m24, &m25, &m26, &m27, &m28, &m29,
                                  &m30, &m31, &m32, &m33, &m34, &m35, &m36, &m37};
  // These have tests of their own below.
  static_assert(std::is_same_v<decltype(decoys), int>);
  static_assert(std::is_same_v<decltype(people), int>);
  std::set<double*> rows;
  for (const Draw& draw : draws()) rows.insert(&(sigma.*draw.member));
  EXPECT_EQ(rows, members);
  EXPECT_EQ(draws().size(), members.size());
}

TEST(Randomize, EachSizeAloneChangesItsNumbersAndNoOthers) {
  for (const Draw& draw : draws()) {
    SCOPED_TRACE(draw.name);
    std::set<std::string> expected;
    for (const auto& list : draw.numbers) expected.insert(list.begin(), list.end());
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Numbers nominal = drawn_numbers({}, seed), real = drawn_numbers(alone(draw), seed);
      ASSERT_EQ(nominal.size(), real.size());
      std::set<std::string> changed;
      for (const auto& [name, value] : nominal)
        // A turned colour comes back with other last bits.
        if (std::abs(real.at(name) - value) > 1e-12 * std::abs(value)) changed.insert(name);
      EXPECT_EQ(changed, expected) << "seed " << seed;
    }
  }
}

TEST(Randomize, EachSizeDrawsTheSameNumbersWhateverElseIsDrawn) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Numbers together = drawn_numbers(all_draws(), seed);
    for (const Draw& draw : draws()) {
      const Numbers real = drawn_numbers(alone(draw), seed);
      for (const auto& list : draw.numbers)
        for (const auto& name : list)
          EXPECT_EQ(real.at(name), together.at(name)) << name << " seed " << seed;
    }
  }
}

TEST(Randomize, LevelNoneChangesNothing) {
  world::SimConfig nominal = nominal_config();
  nominal.world.gates[0].color = {1.0, 0.0, 0.0};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    nominal.seed = seed;
    const Numbers real = numbers_of(drawn(nominal, world::randomize_level("none"), seed));
    for (const auto& [name, value] : numbers_of(nominal)) EXPECT_EQ(real.at(name), value) << name;
  }
}

TEST(Randomize, TheSeedIsKeptForTheRace) { EXPECT_EQ(drawn({}, {}, 77).seed, 77u); }

TEST(Randomize, AnUnknownLevelIsRefused) {
  EXPECT_THROW((void)world::randomize_level("easy"), std::invalid_argument);
}

// Mean 0 and the spread of a normal number cut at 2.5, which is 0.9546; four standard errors.
// 43 independent numbers make 903 pairs: 4.5 standard errors for their correlations.
TEST(Randomize, DrawsAreNormalCutAtTwoAndAHalfSigmaAndIndependent) {
  constexpr int kSeeds = 2000;
  constexpr double kSpread = 0.9546;
  std::vector<std::vector<double>> z;
  std::vector<std::string> names;
  for (const Draw& draw : draws())
    if (is_random(draw))
      for (const auto& list : draw.numbers) names.push_back(list.front());
  z.resize(names.size());
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Numbers nominal = drawn_numbers({}, seed), real = drawn_numbers(all_draws(), seed);
    std::size_t k = 0;
    for (const Draw& draw : draws()) {
      for (const auto& list : draw.numbers) {
        const auto of = [&](const std::string& name) {
          return standardised(draw, nominal.at(name), real.at(name));
        };
        for (const auto& name : list)  // one random number for all of them; none for the exact ones
          ASSERT_NEAR(of(name), is_random(draw) ? of(list.front()) : 0.0, 1e-9) << name;
        if (is_random(draw)) z[k++].push_back(of(list.front()));
      }
    }
  }
  for (std::size_t k = 0; k < z.size(); ++k) {
    double sum = 0.0, sum2 = 0.0, most = 0.0;
    for (const double x : z[k]) sum += x, sum2 += x * x, most = std::max(most, std::abs(x));
    EXPECT_LE(most, 2.5 + 1e-9) << names[k];
    EXPECT_GT(most, 2.3) << names[k];
    EXPECT_NEAR(sum / kSeeds, 0.0, 4 * kSpread / std::sqrt(kSeeds)) << names[k];
    // The fourth moment of the cut normal is 2.22: the variance's own error is that of 1.39 / n.
    EXPECT_NEAR(sum2 / kSeeds, kSpread * kSpread, 4 * std::sqrt(1.39 / kSeeds)) << names[k];
    for (std::size_t other = 0; other < k; ++other) {
      double both = 0.0;
      for (std::size_t i = 0; i < z[k].size(); ++i) both += z[k][i] * z[other][i];
      EXPECT_NEAR(both / (kSpread * kSpread * kSeeds), 0.0, 4.5 / std::sqrt(kSeeds))
          << names[k] << " and " << names[other];
    }
  }
}

TEST(Randomize, OneGateMoreLeavesThoseBeforeItWhereTheyAre) {
  const world::SimConfig two = nominal_config();
  world::SimConfig three = two;
  three.world.gates.push_back({.p_EG = {0.0, 5.0, -1.5}});
  const Numbers with_two = numbers_of(drawn(two, all_draws(), 9)),
                with_three = numbers_of(drawn(three, all_draws(), 9));
  for (const auto& [name, value] : with_two) EXPECT_EQ(with_three.at(name), value) << name;
}

TEST(Randomize, AGateThatStandsOnTheFloorDoesNotSinkIntoIt) {
  world::SimConfig nominal;
  nominal.world.gates = {{.p_EG = {0, 0, -1.35}, .side = 2.7}, {.p_EG = {5, 0, -1.5}}};
  world::Randomize sizes;
  sizes.gate_height = 0.05, sizes.gate_side = 0.01;
  int lower = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto gates = drawn(nominal, sizes, seed).world.gates;
    EXPECT_LE(gates[0].p_EG.z() + 0.5 * gates[0].side, 1e-12);
    lower += gates[1].p_EG.z() > -1.5;
  }
  EXPECT_GT(lower, 10) << "others go up and down";
}

TEST(Randomize, LightStaysAboveATenthAndExposureAboveThreeTenths) {
  world::Randomize wild;
  wild.light = wild.exposure = 1.0;
  double darkest = 1.0, shortest = 1.0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const world::LightConditions light = drawn({}, wild, seed).light;
    darkest = std::min(darkest, *std::ranges::min_element(light.group_gain));
    shortest = std::min(shortest, light.exposure_target);
  }
  EXPECT_EQ(darkest, 0.1);
  EXPECT_EQ(shortest, 0.3);
}

TEST(Randomize, LatencyIsNeverNegative) {
  world::Randomize wild;
  wild.camera_latency = 0.1;
  double least = 1.0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed)
    least = std::min(least, drawn({}, wild, seed).sensors.camera_latency);
  EXPECT_EQ(least, 0.0);
}

/// Distance on the floor from the straight way through a gate: 5 m before it to 3 m behind.
double to_lane(const world::WorldGate& gate, const Eigen::Vector2d& p) {
  const Eigen::Vector2d along = rotation_z(gate.yaw_EG).col(0).head<2>();
  const Eigen::Vector2d from_gate = p - gate.p_EG.head<2>();
  return (from_gate - std::clamp(from_gate.dot(along), -5.0, 3.0) * along).norm();
}

TEST(Decoys, StandAtTheWallsOffTheLanesInTheColourOfTheGates) {
  world::SimConfig nominal = nominal_config();
  nominal.world.room_center = {1.0, -2.0};
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    world::Randomize sigma = all_draws();
    sigma.decoys = 4;
    const world::World real = drawn(nominal, sigma, seed).world;
    EXPECT_EQ(real.decoys.size(), 4u) << "seed " << seed;
    for (const world::Decoy& decoy : real.decoys) {
      const Eigen::Vector2d from_wall =
          0.5 * real.room_size.head<2>() - (decoy.shape.center - real.room_center).cwiseAbs();
      EXPECT_NEAR(from_wall.minCoeff(), 0.25, 1e-9);
      for (const world::WorldGate& gate : real.gates)
        EXPECT_GT(to_lane(gate, decoy.shape.center), 1.19);  // of points 0.25 m apart on it
      EXPECT_EQ(decoy.color, real.gates[0].color);
      EXPECT_EQ(decoy.shape.bottom, 0.0);
      EXPECT_GE(decoy.shape.top, 0.5);
      EXPECT_LE(decoy.shape.top, 1.8);
    }
  }
}

TEST(Decoys, MoreOfThemLeaveTheFirstOnesAndAllElseAsTheyWere) {
  world::Randomize few = all_draws(), many = all_draws();
  few.decoys = 2, many.decoys = 6;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Numbers one = drawn_numbers(few, seed);
    Numbers two = drawn_numbers(many, seed);
    EXPECT_EQ(one.at("decoys"), 2);
    EXPECT_EQ(two.at("decoys"), 6);
    two.at("decoys") = 2;
    for (const auto& [name, value] : one) EXPECT_EQ(two.at(name), value) << name;
    const auto first = drawn(nominal_config(), few, seed).world.decoys,
               more = drawn(nominal_config(), many, seed).world.decoys;
    for (std::size_t i = 0; i < first.size(); ++i)
      EXPECT_EQ(first[i].shape.center, more[i].shape.center);
  }
}

/// How far a point of the floor is from an obstacle's footprint; a pole's is its square.
double to_obstacle(const world::WorldBox& box, const Eigen::Vector2d& p) {
  const Eigen::Vector3d away{p.x() - box.center.x(), p.y() - box.center.y(), 0.0};
  const Eigen::Vector2d own = (rotation_z(-box.heading) * away).head<2>();
  return (own.cwiseAbs() - 0.5 * box.size).cwiseMax(0.0).norm();
}

TEST(People, WalkAlongTheWallsOffTheLanesAndRoundNoObstacle) {
  world::SimConfig nominal = nominal_config();
  nominal.world.room_size = {16.0, 18.0, 3.2};
  nominal.world.room_center = {1.0, -2.0};
  nominal.world.obstacles = {{{1.0, 6.2}, {0.6, 0.6}, 0.4, 0.0, 1.5, false}};
  world::Randomize sigma = all_draws();
  sigma.people = 4;
  int warm = 0, people = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const world::World real = drawn(nominal, sigma, seed).world;
    EXPECT_EQ(real.people.size(), 4u) << "seed " << seed;
    for (const world::Person& person : real.people) {
      const double length = (person.to - person.from).norm();
      EXPECT_GE(length, 2.0 - 1e-9);
      EXPECT_GE(person.speed, 0.3);
      EXPECT_LE(person.speed, 1.2);
      for (double s = 0.0; s <= 1.0; s += 0.01) {
        const Eigen::Vector2d p = person.from + s * (person.to - person.from);
        const Eigen::Vector2d from_wall =
            0.5 * real.room_size.head<2>() - (p - real.room_center).cwiseAbs();
        EXPECT_NEAR(from_wall.minCoeff(), 0.7, 1e-9);
        EXPECT_GE(to_obstacle(real.obstacles[0], p), 0.3);
        for (const world::WorldGate& gate : real.gates) EXPECT_GT(to_lane(gate, p), 1.17);
      }
      ++people, warm += person.shirt.x() > 0.3 && person.shirt.y() < 0.26 ? 1 : 0;
    }
  }
  EXPECT_GT(warm, people / 12) << "some wear what looks like a gate";
  EXPECT_LT(warm, people / 3);
}

TEST(People, MoreOfThemLeaveTheFirstOnesAndAllElseAsTheyWere) {
  world::Randomize few = all_draws(), many = all_draws();
  few.people = 1, many.people = 3;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const world::SimConfig one = drawn(nominal_config(), few, seed),
                           two = drawn(nominal_config(), many, seed);
    ASSERT_EQ(one.world.people.size(), 1u);
    EXPECT_EQ(one.world.people[0].from, two.world.people[0].from);
    EXPECT_EQ(one.world.people[0].shirt, two.world.people[0].shirt);
    Numbers other = numbers_of(two);
    other.at("people") = 1;
    for (const auto& [name, value] : numbers_of(one)) EXPECT_EQ(other.at(name), value) << name;
  }
}

TEST(Decoys, ARoomWithoutSpaceForThemGetsFewer) {
  world::SimConfig config = nominal_config();
  config.world.room_size = {2.0, 2.0, 3.0};
  config.world.gates = {{.p_EG = {0, 0, -1.5}}};
  world::Randomize sigma;
  sigma.decoys = 3;
  EXPECT_TRUE(drawn(config, sigma, 1).world.decoys.empty());
}

/// On which side of a jet's axis, seen along it: right is positive.
double side_of(const world::Jet& jet, const Eigen::Vector2d& p) {
  return (rotation_z(-jet.heading).topLeftCorner<2, 2>() * (p - jet.through)).y();
}

TEST(Draughts, AJetCrossesALegWhoseEndsLieOnEitherSide) {
  world::SimConfig nominal = nominal_config();
  nominal.world.gates.push_back({.p_EG = {4.0, -5.0, -1.5}});
  world::Randomize sigma = all_draws();
  sigma.jet = 0.3;
  std::set<std::size_t> legs;
  int from_left = 0;
  constexpr int kSeeds = 200;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const world::SimConfig real = drawn(nominal, sigma, seed);
    const world::Jet& jet = real.wind.jet;
    const Eigen::Vector2d blows = rotation_z(jet.heading).col(0).head<2>();
    bool crossed = false;
    for (std::size_t i = 0; i + 1 < real.world.gates.size(); ++i) {
      const Eigen::Vector2d from = real.world.gates[i].p_EG.head<2>(),
                            way = real.world.gates[i + 1].p_EG.head<2>() - from;
      const double part = (jet.through - from).dot(way) / way.squaredNorm();
      if ((from + part * way - jet.through).norm() > 1e-9) continue;
      crossed = true, legs.insert(i);
      EXPECT_LT(side_of(jet, from) * side_of(jet, from + way), 0.0) << "seed " << seed;
      EXPECT_NEAR(part, 0.5, 0.25);
      EXPECT_LE(std::abs(blows.dot(way.normalized())), 0.5 + 1e-9) << "30 degrees aslant at most";
      from_left += way.x() * blows.y() - way.y() * blows.x() > 0.0 ? 1 : 0;
    }
    EXPECT_TRUE(crossed) << "seed " << seed;
  }
  EXPECT_EQ(legs.size(), 2u);
  EXPECT_NEAR(from_left, kSeeds / 2, 4 * std::sqrt(kSeeds / 4.0));
}

TEST(Draughts, OfOneGateTheJetCrossesTheWayThere) {
  world::SimConfig nominal = nominal_config();
  nominal.world.gates.resize(1);
  world::Randomize sigma;
  sigma.jet = 0.3;
  const world::SimConfig real = drawn(nominal, sigma, 5);
  EXPECT_LT(side_of(real.wind.jet, real.start.position) *
                side_of(real.wind.jet, real.world.gates[0].p_EG.head<2>()),
            0.0);
}

TEST(Draughts, AShearStandsStillInTheMiddleOfTheGatesAndBlowsAnyWay) {
  world::Randomize sigma;
  sigma.shear = 0.1;
  Eigen::Vector2d sum{0, 0};
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const world::Shear shear = drawn(nominal_config(), sigma, seed).wind.shear;
    EXPECT_LT((shear.middle - Eigen::Vector2d{-0.5, 1.5}).norm(), 1e-12);
    sum += rotation_z(shear.heading).col(0).head<2>();
  }
  EXPECT_LT(sum.norm(), 3 * std::sqrt(200.0));
}

TEST(Draughts, AtLevelRaceAndBelowThereAreNone) {
  for (const char* level : {"none", "race"}) {
    const world::Wind wind = drawn(nominal_config(), world::randomize_level(level), 3).wind;
    EXPECT_EQ(wind.jet.speed, 0.0);
    EXPECT_EQ(wind.shear.rate, 0.0);
    EXPECT_EQ(wind.wash, 0.0);
  }
}

world::SimConfig with(const AnyCamera& lens) {
  world::SimConfig config;
  config.camera.lens = lens;
  return config;
}

world::Randomize lens_only() {
  world::Randomize sigma;
  sigma.camera_focal = 0.01, sigma.camera_center_px = 2.0;
  sigma.camera_k = 0.02, sigma.camera_k1 = 0.02;
  return sigma;
}

TEST(Randomize, WithoutSizesLeavesEveryLensAlone) {
  const RadialPolynomial radial{{-0.3, 0.1, 0.02, 0}};
  for (const AnyCamera& lens :
       {AnyCamera{DhaneFisheye{}}, AnyCamera{Pinhole{}},
        AnyCamera{BrownConrady{{168, 168}, {157, 124}, {-0.3, 0.1, 0.001, 0.002, 0.02}}},
        AnyCamera{KannalaBrandt{.radial = radial}}})
    EXPECT_EQ(drawn(with(lens), {}, 7).camera.lens.project({0.3, 0.2, 1}),
              lens.project({0.3, 0.2, 1}));
}

TEST(Randomize, DrawsFocalLengthCentreAndFirstCoefficientOfPolynomialLenses) {
  const BrownConrady nominal{{168, 168}, {157, 124}, {-0.3, 0.1, 0.001, 0.002, 0.02}};
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto real =
        std::get<BrownConrady>(drawn(with({nominal}), lens_only(), seed).camera.lens.model);
    const auto k = real.distortion();
    EXPECT_NE(k[0], -0.3);
    EXPECT_NEAR(k[0], -0.3, 0.3 * 0.02 * 2.5) << "a part of itself, cut at 2.5 sigma";
    EXPECT_EQ(k, (BrownConrady::Coefficients{k[0], 0.1, 0.001, 0.002, 0.02}));
    EXPECT_NE(real.focal_px, nominal.focal_px);
    EXPECT_NEAR(real.focal_px.x(), 168, 168 * 0.025 + 1e-9);
    EXPECT_NE(real.center_px, nominal.center_px);
  }
}

TEST(Randomize, GivesEveryModelTheSameDrawButItsOwnDistortion) {
  const auto dhane =
      std::get<DhaneFisheye>(drawn(with({DhaneFisheye{}}), lens_only(), 3).camera.lens.model);
  const auto fisheye = std::get<KannalaBrandt>(
      drawn(with({KannalaBrandt{.radial = RadialPolynomial{{0.1, 0, 0, 0}}}}), lens_only(), 3)
          .camera.lens.model);
  EXPECT_EQ(dhane.focal_px, fisheye.focal_px);
  EXPECT_EQ(dhane.center_px, fisheye.center_px);
  EXPECT_NEAR(fisheye.radial.coefficients()[0], 0.1 * (1.0 + dhane.k - DhaneFisheye{}.k), 1e-15);
}

TEST(Randomize, WhatAPolynomialsCoefficientIsOffByLeavesAStraightLensAsItIs) {
  world::Randomize sigma;
  sigma.camera_k1 = 0.13;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    EXPECT_EQ(
        std::get<DhaneFisheye>(drawn(with({DhaneFisheye{.k = 1.0}}), sigma, seed).camera.lens.model)
            .k,
        1.0);
    EXPECT_NE(
        std::get<KannalaBrandt>(
            drawn(with({KannalaBrandt{.radial = RadialPolynomial{{0.1, 0, 0, 0}}}}), sigma, seed)
                .camera.lens.model)
            .radial.coefficients()[0],
        0.1);
  }
}

}  // namespace
}  // namespace gatefly::sim
