// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/pilot.hpp"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "support/allocation_counter.hpp"
#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/generators.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector3d;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

PilotConfig config() {
  PilotConfig c;
  c.track.gates = {{{4, 0, -1.5}, 0.0}, {{2, 4, -1.5}, kPi}};
  c.track.laps = 2;
  c.camera = bebop_rig();
  return c;
}

Sensors sensed_at(int tick, const Imu& imu) {
  Sensors s;
  s.time = std::chrono::nanoseconds{static_cast<long long>(tick) * 1'953'125};  // 512 Hz
  s.imu = imu;
  s.imu.gyro_B.x() += tick % 2 * 1e-12;  // no IMU says the same twice while rotors turn
  return s;
}

Imu still() { return {Vector3d::Zero(), {0, 0, -9.81}}; }

bool motors_off(const Command& c) {
  for (const double w : c.motors)
    if (w != 0.0) return false;
  return true;
}

bool is_finite(const Command& c) {
  for (const double w : c.motors)
    if (!std::isfinite(w)) return false;
  return std::isfinite(c.attitude.roll) && std::isfinite(c.attitude.pitch) &&
         std::isfinite(c.attitude.yaw) && std::isfinite(c.attitude.thrust);
}

bool is_finite(const Estimate& e) {
  return e.p_EB.allFinite() && e.v_E.allFinite() && e.covariance_GB.allFinite() &&
         e.accel_bias.allFinite() && std::isfinite(e.attitude.yaw);
}

template <class P>
bool in(const Pilot& pilot) {
  return std::holds_alternative<P>(pilot.phase());
}

// Runs a pilot until it has taken off; the next tick to use.
int take_off(Pilot& pilot) {
  for (int tick = 1; tick < 4000; ++tick) {
    (void)pilot.step(sensed_at(tick, still()));
    if (in<TakeOff>(pilot)) return tick + 1;
  }
  ADD_FAILURE() << "never took off";
  return 4000;
}

// A climb as sensors see it, 0.8 m/s up to 1.5 m, level.
int climb(Pilot& pilot, int tick) {
  for (int i = 0; i < 1024; ++i, ++tick) {
    Sensors s = sensed_at(tick, still());
    const double height = std::min(1.5, 0.8 * i / 512.0);
    if (i % 26 == 0) s.sonar = height;
    if (i % 10 == 0) s.baro = height;
    (void)pilot.step(s);
  }
  return tick;
}

// As README shows it: a default configuration lacks the course alone, and says so.
TEST(Pilot, FliesOnADefaultConfigurationOnceItHasACourse) {
  PilotConfig config;
  try {
    const Pilot pilot{config};
    FAIL() << "without gates";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "the track has no gates: PilotConfig::track.gates is empty");
  }
  config.camera = {AnyCamera{DhaneFisheye{}}, camera_mount(0.35), {0.10, 0.0, 0.0}};
  config.track.gates = {{.p_EG = {4.0, 0.0, -1.5}}, {.p_EG = {4.0, 4.0, -1.5}, .yaw_EG = 3.14}};
  Pilot pilot{config};
  Sensors sensors = sensed_at(0, {.gyro_B = {0, 0, 0}, .accel_B = {0, 0, -9.81}});
  const std::vector<std::uint8_t> bytes(std::size_t{2} * 160 * 315, 128);
  sensors.image = Image{bytes.data(), PixelFormat::kUyvy, 160, 315, /*stored_rotation_deg=*/90};
  EXPECT_EQ(pilot.step(sensors).motors[0], 0.0);  // it rests first
}

TEST(Pilot, KeepsItsMotorsOffOnTheGroundAndTakesOffAfterItsRest) {
  Pilot pilot{config()};
  const int rest = PhaseParams{}.rest_samples;
  for (int tick = 1; tick < rest; ++tick) {
    EXPECT_TRUE(motors_off(pilot.step(sensed_at(tick, still())))) << tick;
    EXPECT_TRUE(in<OnGround>(pilot)) << tick;
  }
  Command c;
  for (int tick = rest; tick < rest + 10; ++tick) c = pilot.step(sensed_at(tick, still()));
  EXPECT_TRUE(in<TakeOff>(pilot));
  EXPECT_FALSE(motors_off(c));
}

TEST(Pilot, StaysOnTheGroundWhileItIsCarriedAboutOrDeaf) {
  Pilot carried{config()}, deaf{config()};
  Rng rng{2};
  for (int tick = 1; tick < 5000; ++tick) {
    EXPECT_TRUE(motors_off(carried.step(
        sensed_at(tick, {Vector3d{1.0, -0.8, 0.5}, Vector3d{0, 0, -9.81} + any_vector3(rng, 3)}))));
    EXPECT_TRUE(motors_off(
        deaf.step(sensed_at(tick, {Vector3d::Constant(kNan), Vector3d::Constant(kNan)}))));
  }
  EXPECT_TRUE(in<OnGround>(carried));
  EXPECT_TRUE(in<OnGround>(deaf));
}

TEST(Pilot, StandsAtTheStartOfTheMap) {
  PilotConfig c = config();
  c.track.start = {0.2, -0.3};
  c.track.start_heading = 0.1;
  Pilot pilot{c};
  for (int tick = 1; tick < 700; ++tick) (void)pilot.step(sensed_at(tick, still()));
  const Estimate e = pilot.estimate();
  EXPECT_NEAR(e.p_EB.x(), 0.2, 1e-9);
  EXPECT_NEAR(e.p_EB.y(), -0.3, 1e-9);
  EXPECT_NEAR(e.p_EB.z(), 0.0, 1e-9);
  EXPECT_NEAR(e.attitude.yaw, 0.1, 1e-9);
}

TEST(Pilot, FliesForwardOnceItHasClimbed) {
  Pilot pilot{config()};
  int tick = climb(pilot, take_off(pilot));
  EXPECT_TRUE(in<Straight>(pilot) || in<Turn>(pilot)) << name_of(pilot.phase());
  EXPECT_NEAR(-pilot.estimate().p_EB.z(), 1.5, 0.15);
  EXPECT_LT(pilot.step(sensed_at(tick, still())).attitude.pitch, -0.02) << "nose down: go";
}

TEST(Pilot, GivesUpWhenItDoesNotClimb) {
  Pilot pilot{config()};
  int tick = take_off(pilot);
  for (int i = 0; i < 8 * 512; ++i, ++tick) {
    Sensors s = sensed_at(tick, still());
    if (i % 26 == 0) s.sonar = 0.03;
    if (i % 10 == 0) s.baro = 0.0;
    (void)pilot.step(s);
  }
  EXPECT_TRUE(pilot.landed()) << name_of(pilot.phase());
  EXPECT_EQ(pilot.abort_reason(), AbortReason::kNoClimb);
}

// By way of an autopilot, which levels itself.
TEST(Pilot, ASilentImuLeadsToALandingWithAReason) {
  PilotConfig by_autopilot = config();
  by_autopilot.output = Output::kRatesThrust;
  Pilot pilot{by_autopilot};
  int tick = climb(pilot, take_off(pilot));
  const Imu silent{Vector3d::Constant(kNan), Vector3d::Constant(kNan)};
  for (int i = 0; i < 51; ++i) (void)pilot.step(sensed_at(tick++, silent));
  EXPECT_FALSE(in<Land>(pilot)) << "0.1 s may pass";
  for (int i = 0; i < 77; ++i) {
    const Command c = pilot.step(sensed_at(tick++, silent));
    EXPECT_TRUE(is_finite(c));
  }
  EXPECT_TRUE(in<Land>(pilot)) << name_of(pilot.phase());
  EXPECT_EQ(pilot.abort_reason(), AbortReason::kSensorsLost);
  for (int i = 0; i < 15 * 512; ++i) (void)pilot.step(sensed_at(tick++, silent));
  EXPECT_TRUE(pilot.landed());
  EXPECT_TRUE(motors_off(pilot.step(sensed_at(tick, silent))));
}

TEST(Pilot, AStuckImuIsALostOneAndWithoutOneNothingLevels) {
  Pilot pilot{config()};
  int tick = climb(pilot, take_off(pilot));
  const Imu stuck{{0.1, -0.2, 0.3}, {0.5, -0.5, -9.7}};
  const auto step = [&] {
    Sensors s = sensed_at(tick++, {});
    s.imu = stuck;
    return pilot.step(s);
  };
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(motors_off(step())) << "samples may be alike: " << i;
  for (int i = 0; i < 3; ++i) (void)step();
  EXPECT_EQ(pilot.abort_reason(), AbortReason::kSensorsLost);
  EXPECT_TRUE(motors_off(step()));
  EXPECT_GE(pilot.health().imu_stuck, 1u);
  EXPECT_EQ(pilot.health().imu_not_finite, 0u);
  EXPECT_TRUE(is_finite(pilot.estimate()));
}

TEST(Pilot, OnTheGroundACoarseImuMayStandStill) {
  Pilot pilot{config()};
  for (int tick = 1; tick < PhaseParams{}.rest_samples; ++tick) {
    Sensors s = sensed_at(tick, {});
    s.imu = still();
    (void)pilot.step(s);
  }
  EXPECT_TRUE(in<OnGround>(pilot));
  EXPECT_EQ(pilot.health().imu_stuck, 0u);
}

TEST(Pilot, ACameraThatSendsNothingAnyMoreLeadsDown) {
  Pilot pilot{config()};
  int tick = climb(pilot, take_off(pilot));
  const auto fly = [&](double seconds, int pictures_every) {
    for (int i = 0; i < seconds * 512; ++i) {
      Sensors s = sensed_at(tick++, still());
      if (pictures_every > 0 && i % pictures_every == 0) s.seen.emplace();
      (void)pilot.step(s);
    }
  };
  fly(3.0, 34);
  EXPECT_EQ(pilot.abort_reason(), AbortReason::kNone) << "pictures without a gate are pictures";
  fly(1.1, 0);
  EXPECT_EQ(pilot.abort_reason(), AbortReason::kNone) << "a second may be lost";
  fly(0.3, 0);
  EXPECT_EQ(pilot.abort_reason(), AbortReason::kNoPictures);
  EXPECT_TRUE(in<Land>(pilot)) << name_of(pilot.phase());
}

TEST(Pilot, RareOrNoPicturesFromTheStartAreNoDeadCamera) {
  for (const int every : {0, 450}) {  // none, 1.1 a second
    Pilot pilot{config()};
    int tick = climb(pilot, take_off(pilot));
    for (int i = 0; i < 6 * 512; ++i) {
      Sensors s = sensed_at(tick++, still());
      if (every > 0 && i % every == 0 && i / every != 4) s.seen.emplace();
      (void)pilot.step(s);
      ASSERT_NE(pilot.abort_reason(), AbortReason::kNoPictures) << every << " " << i;
    }
  }
}

TEST(Pilot, TheSamePictureAgainIsNotLookedAt) {
  PilotConfig c = config();
  c.track.gates[0].p_EG = {3.5, 0, -1.5};
  Pilot pilot{c};
  int tick = climb(pilot, take_off(pilot));
  View view;
  view.p_GB = pilot.estimate().p_EB - c.track.gates[0].p_EG;
  Canvas canvas{316, 160};
  canvas.draw_gate(view, c.camera);
  const auto bytes = canvas.uyvy();
  for (int i = 0; i < 3; ++i) {
    Sensors s = sensed_at(tick++, still());
    s.image = Image{bytes.data(), PixelFormat::kUyvy, 316, 160};
    (void)pilot.step(s);
    EXPECT_EQ(pilot.sighting().seen, i == 0) << i;
  }
  EXPECT_EQ(pilot.health().pictures_repeated, 2u);
}

TEST(Pilot, AClockThatJumpsMovesNothing) {
  for (const double jump : {0.1, -0.1, 10.0, -10.0}) {
    Pilot jumped{config()}, straight{config()};
    int tick = climb(jumped, take_off(jumped));
    (void)climb(straight, take_off(straight));
    for (int i = 0; i < 256; ++i, ++tick) {
      Sensors s = sensed_at(tick, still());
      (void)straight.step(s);
      s.time += std::chrono::nanoseconds{std::llround(1e9 * jump)};
      (void)jumped.step(s);
    }
    EXPECT_EQ(jumped.health().clock_jumps, 1u) << jump;
    EXPECT_LT((jumped.estimate().p_EB - straight.estimate().p_EB).norm(), 1e-4) << jump;
  }
}

// Any garbage a broken sensor could send, in any order, for ten seconds; seeds 1..10.
Sensors garbage(int tick, Rng& rng, const Image& noise) {
  const auto wild = [&](double usual) {
    switch (rng.uniform_index(40)) {
      case 0:
        return kNan;
      case 1:
        return std::numeric_limits<double>::infinity();
      case 2:
        return rng.uniform(-1, 1) * 1e300;
      case 3:
        return rng.uniform(-1, 1) * 1e6;
      case 4:
        return 0.0;
      default:
        return rng.uniform(-usual, usual);
    }
  };
  Sensors s = sensed_at(tick, {});
  s.imu.gyro_B = {wild(10), wild(10), wild(10)};
  s.imu.accel_B = {wild(30), wild(30), wild(30) - 9.81};
  if (rng.uniform_index(20) == 0) s.sonar = wild(5);
  if (rng.uniform_index(10) == 0) s.baro = wild(10);
  if (rng.uniform_index(100) == 0) s.image = rng.uniform_index(2) ? noise : Image{};
  if (rng.uniform_index(50) == 0) s.time -= std::chrono::milliseconds{rng.uniform_index(2000)};
  return s;
}

TEST(Pilot, GarbageLeavesEverythingFinite) {
  Rng paint{1};
  Canvas canvas{316, 160};
  canvas.add_noise(paint, 60, 40);
  const auto bytes = canvas.uyvy();
  const Image noise{bytes.data(), PixelFormat::kUyvy, 316, 160};
  const VehicleParams vehicle;
  for_all(10, [&](Rng& rng) {
    Pilot pilot{config()};
    int tick = take_off(pilot);
    for (int i = 0; i < 10 * 512; ++i) {
      const Command c = pilot.step(garbage(tick++, rng, noise));
      ASSERT_TRUE(is_finite(c)) << "tick " << i << " phase " << name_of(pilot.phase());
      ASSERT_TRUE(is_finite(pilot.estimate()))
          << "tick " << i << " phase " << name_of(pilot.phase());
      for (const double w : c.motors) ASSERT_LE(w, vehicle.max_speed + 1e-6);
    }
  });
}

TEST(Pilot, NoisySensorsOnAFlightKeepItFinite) {
  for_all(10, [&](Rng& rng) {
    Pilot pilot{config()};
    int tick = climb(pilot, take_off(pilot));
    for (int i = 0; i < 10 * 512; ++i) {
      Sensors s =
          sensed_at(tick++, {any_vector3(rng, 1.0), Vector3d{0, 0, -9.81} + any_vector3(rng, 4.0)});
      if (i % 26 == 0) s.sonar = rng.uniform(0, 3);
      if (i % 10 == 0) s.baro = 1.5 + rng.uniform(-1, 1);
      ASSERT_TRUE(is_finite(pilot.step(s)));
      ASSERT_TRUE(is_finite(pilot.estimate()));
    }
  });
}

TEST(Pilot, SameInputsGiveTheSameOutputs) {
  Canvas canvas{316, 160};
  canvas.draw_gate({{-3.5, 0, 0}, {0, 0, 0}}, bebop_rig());
  const auto bytes = canvas.uyvy();
  const Image image{bytes.data(), PixelFormat::kUyvy, 316, 160};
  Pilot a{config()}, b{config()};
  Rng rng{4};
  for (int tick = 1; tick < 4000; ++tick) {
    Sensors s = sensed_at(
        tick, tick < 900 ? still()
                         : Imu{any_vector3(rng, 0.3), Vector3d{0, 0, -9.9} + any_vector3(rng, 1)});
    if (tick % 26 == 0) s.sonar = tick < 900 ? 0.05 : 1.3;
    if (tick % 34 == 0) s.image = image;
    const Command x = a.step(s), y = b.step(s);
    ASSERT_EQ(x.motors, y.motors) << tick;
    ASSERT_EQ(x.attitude.roll, y.attitude.roll) << tick;
    ASSERT_EQ(a.estimate().p_EB, b.estimate().p_EB) << tick;
  }
}

TEST(Pilot, RepeatedAndOlderStampsLetNoTimePass) {
  Pilot pilot{config()};
  int tick = climb(pilot, take_off(pilot));
  (void)pilot.step(sensed_at(tick, still()));
  const Vector3d p = pilot.estimate().p_EB;
  const Imu moving{Vector3d{0.5, 0.5, 0.5}, {2, 2, -12}};
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(is_finite(pilot.step(sensed_at(tick - i % 3, moving))));
  EXPECT_EQ(pilot.estimate().p_EB, p);
  EXPECT_EQ(pilot.health().imu_stale, 50u);
  for (int i = 0; i < 200; ++i) EXPECT_TRUE(is_finite(pilot.step(sensed_at(tick - i % 3, moving))));
  EXPECT_EQ(pilot.abort_reason(), AbortReason::kSensorsLost) << "a clock that stands";
}

// A pilot that has climbed, turned for a moment, and got pictures of the gate 3.5 m ahead meanwhile.
Pilot after_a_turn(PilotConfig config, double late) {
  config.track.gates[0].p_EG = {3.5, 0, -1.5};
  Pilot pilot{config};
  int tick = climb(pilot, take_off(pilot));
  Canvas canvas{316, 160};
  canvas.draw_gate({{-3.5, 0, 0}, {0, 0, 0}}, config.camera);
  auto bytes = canvas.uyvy();
  for (int i = 0; i < 60; ++i, ++tick) {
    Sensors s = sensed_at(tick, {Vector3d{0.0, 0.0, 0.2}, Vector3d{0, 0, -9.81}});
    bytes[0] = static_cast<std::uint8_t>(i);  // no picture comes twice
    if (i % 15 == 14) s.image = Image{bytes.data(), PixelFormat::kUyvy, 316, 160};
    s.picture_late = late;
    (void)pilot.step(s);
  }
  return pilot;
}

// A picture that is late by its stamp is one of a camera that is so much slower, and no other.
TEST(Pilot, TakesALatePictureForAsOldAsItIs) {
  constexpr double kLate = 0.05, kUsual = 0.044;
  for (const FilterModel model : {FilterModel::kOurs, FilterModel::kDrag}) {
    PilotConfig usual = config(), slower = config();
    usual.filter_model = slower.filter_model = model;
    usual.camera_timing.latency = kUsual, slower.camera_timing.latency = kUsual + kLate;
    const Pilot late = after_a_turn(usual, kLate), slow = after_a_turn(slower, 0.0),
                unaware = after_a_turn(usual, 0.0);
    ASSERT_NE(late.sighting().source, Sighting::Source::kNone);
    EXPECT_EQ(late.estimate().p_EB, slow.estimate().p_EB);
    EXPECT_EQ(late.sighting().nis, slow.sighting().nis);
    EXPECT_NE(late.estimate().p_EB, unaware.estimate().p_EB);
  }
}

TEST(Pilot, APictureOlderThanItsMemoryCountsNeitherForNorAgainstIt) {
  PilotConfig remembers = config();
  remembers.filter_model = FilterModel::kOurs;
  const Pilot pilot = after_a_turn(remembers, remembers.filter_memory);
  EXPECT_EQ(pilot.sighting().source, Sighting::Source::kNone);
  EXPECT_FALSE(pilot.sighting().seen);
}

// Whatever gate of the map is seen tells the height: a drone that searches for the next one is not
// lost in it, as a guard above the pilot has to know.
TEST(Pilot, AGateThatIsNotFlownToTellsTheHeightToo) {
  PilotConfig c = config();
  c.filter_model = FilterModel::kOurs;
  c.track.gates = {{{4, 6, -1.5}, kPi / 2}, {{3.5, 0, -1.5}, 0.0}};
  Pilot pilot{c};
  int tick = climb(pilot, take_off(pilot));
  Canvas canvas{316, 160};
  canvas.draw_gate({{-3.5, 0, 0}, {0, 0, 0}}, c.camera);
  auto bytes = canvas.uyvy();
  bool told = false;
  for (int i = 0; i < 100; ++i, ++tick) {
    Sensors s = sensed_at(tick, still());
    bytes[0] = static_cast<std::uint8_t>(i);
    if (i % 33 == 32) s.image = Image{bytes.data(), PixelFormat::kUyvy, 316, 160};
    (void)pilot.step(s);
    told = told || pilot.sighting().tells_height;
    EXPECT_EQ(pilot.sighting().source, Sighting::Source::kNone);
  }
  EXPECT_TRUE(told);
}

TEST(Pilot, ALatenessThatIsNoneCountsAsNone) {
  Canvas canvas{316, 160};
  canvas.draw_gate({{-3.5, 0, 0}, {0, 0, 0}}, bebop_rig());
  const auto bytes = canvas.uyvy();
  Vector3d without = Vector3d::Zero();
  for (const double late : {0.0, -0.05, 5.0, kNan}) {
    PilotConfig c = config();
    c.track.gates[0].p_EG = {3.5, 0, -1.5};
    Pilot pilot{c};
    Sensors s = sensed_at(climb(pilot, take_off(pilot)), still());
    s.image = Image{bytes.data(), PixelFormat::kUyvy, 316, 160};
    s.picture_late = late;
    (void)pilot.step(s);
    if (late == 0.0) without = pilot.estimate().p_EB;
    EXPECT_EQ(pilot.estimate().p_EB, without) << late;
  }
}

// The drone stands 3.5 m before the gate, where its map says: the picture confirms it and the fix
// is taken.
TEST(Pilot, TakesAFixFromAGateInView) {
  PilotConfig c = config();
  c.track.gates[0].p_EG = {3.5, 0, -1.5};
  Pilot pilot{c};
  int tick = climb(pilot, take_off(pilot));
  const Estimate before = pilot.estimate();
  View view;
  view.p_GB = before.p_EB - c.track.gates[0].p_EG;
  view.attitude_GB = before.attitude;
  Canvas canvas{316, 160};
  canvas.draw_gate(view, c.camera);
  const auto bytes = canvas.uyvy();
  Sensors s = sensed_at(tick, still());
  s.image = Image{bytes.data(), PixelFormat::kUyvy, 316, 160};
  (void)pilot.step(s);
  EXPECT_TRUE(pilot.sighting().seen);
  EXPECT_EQ(pilot.sighting().source, Sighting::Source::kCorners);
  EXPECT_LT(pilot.estimate().covariance_GB(1, 1), before.covariance_GB(1, 1));
  EXPECT_LT((pilot.estimate().p_EB - before.p_EB).norm(), 0.15);
}

// A frame of the bars of two gates says 1.5 m farther; the lower corners of the gate, whose top is
// cut off, say right here.
TEST(Pilot, APartThatIsExpectedCountsMoreThanAFrameFarOff) {
  PilotConfig c = config();
  c.track.gates[0].p_EG = {2.5, 0, -1.9};
  Pilot pilot{c};
  int tick = climb(pilot, take_off(pilot));
  const Estimate before = pilot.estimate();
  View view{.p_GB = before.p_EB - c.track.gates[0].p_EG, .attitude_GB = before.attitude};
  const Quad corners = *corners_of(1.0, view, c.camera);
  view.p_GB.x() -= 1.5;
  SeenGates seen;
  (void)seen.gates.push_back({*corners_of(1.0, view, c.camera), 1.0});
  seen.lower_corners = LowerCorners{corners[3], corners[2], 1.0};
  Sensors s = sensed_at(tick, still());
  s.seen = seen;
  (void)pilot.step(s);
  EXPECT_EQ(pilot.sighting().source, Sighting::Source::kCorners);
  EXPECT_EQ(pilot.sighting().used, -1);
  EXPECT_LT((pilot.estimate().p_EB - before.p_EB).norm(), 0.05);
}

// Sees a gate as if the drone were somewhere else; whether that corrected it.
class Watched {
 public:
  explicit Watched(const PilotConfig& c)
      : config{c}, pilot{c}, tick{climb(pilot, take_off(pilot))} {}

  bool see(const Vector3d& off) {
    const Estimate now = pilot.estimate();
    const View view{.p_GB = now.p_EB - config.track.gates[0].p_EG + off,
                    .attitude_GB = now.attitude};
    Sensors s = sensed_at(tick++, still());
    s.seen.emplace();
    (void)s.seen->gates.push_back({*corners_of(1.0, view, config.camera), 1.0});
    (void)pilot.step(s);
    return pilot.sighting().source != Sighting::Source::kNone;
  }
  void wait(int ticks) {
    for (int i = 0; i < ticks; ++i) (void)pilot.step(sensed_at(tick++, still()));
  }

  PilotConfig config;
  Pilot pilot;
  int tick;
};

// After a blind leg one gate aside is not believed; two that say the same are, two that do not are
// not.
TEST(Pilot, AfterABlindLegTwoSightingsHaveToAgree) {
  PilotConfig c = config();
  c.track.gates[0].p_EG = {3.5, 0, -1.5};
  for (const double second : {0.4, -0.4}) {
    Watched drone{c};
    EXPECT_TRUE(drone.see(Vector3d::Zero())) << "not blind yet";
    drone.wait(600);
    EXPECT_FALSE(drone.see({0, 0.4, 0}));
    drone.wait(34);
    EXPECT_EQ(drone.see({0, second, 0}), second == 0.4);
  }
}

// A fix far off, but inside the innovation gate, is used once a second sighting confirms it. How far
// that is depends on the covariance: steps of 2 cm find it.
TEST(Pilot, AnImprobableSightingNeedsConfirmation) {
  PilotConfig c = config();
  c.track.gates[0].p_EG = {3.5, 0, -1.5};
  int believed_at_once = 0, believed_then = 0, refused = 0;
  for (double off = 0.0; off < 1.2; off += 0.02) {
    Watched drone{c};
    ASSERT_TRUE(drone.see(Vector3d::Zero()));
    drone.wait(34);
    const bool first = drone.see({-off, 0, 0});
    drone.wait(34);
    const bool second = drone.see({-off, 0, 0});
    EXPECT_TRUE(second || !first);
    ++(first ? believed_at_once : second ? believed_then : refused);
    EXPECT_TRUE(!first || (believed_then == 0 && refused == 0))
        << "nearer ones are believed sooner";
    EXPECT_TRUE(!second || refused == 0 || first);
  }
  EXPECT_GT(believed_at_once, 2);
  EXPECT_GT(believed_then, 0);
  EXPECT_GT(refused, 10);
}

TEST(Pilot, AllocatesNothingOnceBuilt) {
  Canvas canvas{316, 160};
  Rng paint{1};
  canvas.add_noise(paint);
  canvas.draw_gate({{-3, 0.1, 0}, {0, 0, 0}}, bebop_rig());
  const auto bytes = canvas.uyvy();
  const Image image{bytes.data(), PixelFormat::kUyvy, 316, 160};
  Pilot pilot{config()};
  Rng rng{6};
  {
    const NothingAllocated guard;
    for (int tick = 1; tick < 6000; ++tick) {
      Sensors s = sensed_at(tick, tick < 900 ? still()
                                             : Imu{any_vector3(rng, 0.5),
                                                   Vector3d{0, 0, -9.81} + any_vector3(rng, 1)});
      if (tick % 26 == 0) s.sonar = tick < 900 ? 0.0 : 1.4;
      if (tick % 10 == 0) s.baro = tick < 900 ? 0.0 : 1.4;
      if (tick % 34 == 0) s.image = image;
      (void)pilot.step(s);
      (void)pilot.estimate();
    }
  }
  EXPECT_FALSE(in<OnGround>(pilot));
  test::expect_that_allocations_are_counted();
}

TEST(Pilot, RefusesPicturesThatComeLaterThanItsFilterRemembers) {
  PilotConfig c = config();
  c.camera_timing = {.latency = 0.245, .readout = 0.020};
  try {
    const Pilot pilot{c};
    ADD_FAILURE() << "should have refused";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string{error.what()}.find("camera.latency_ms"), std::string::npos);
    EXPECT_NE(std::string{error.what()}.find("filter.memory_ms"), std::string::npos);
  }
  c.filter_memory = 0.3;
  EXPECT_NO_THROW(Pilot{c});
}

TEST(Pilot, RefusesACourseThatCannotBeFlown) {
  PilotConfig c = config();
  c.track.gates.clear();
  EXPECT_THROW(Pilot{c}, std::invalid_argument);
}

}  // namespace
}  // namespace gatefly
