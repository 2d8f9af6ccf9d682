// SPDX-License-Identifier: Apache-2.0
// Faults of the camera and of the world, as they reach the pilot's sensors in a flight.
#include "gatefly/world/faults.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/simulated_race/closed_loop/race.hpp"

#include "support/race_setup.hpp"

namespace gatefly::simulated_race {
namespace {

using test::race_on;

/// Data that arrived at the pilot until `until` [s].
struct Arrived {
  std::vector<double> pictures;          ///< When [s].
  std::vector<std::size_t> whole_gates;  ///< In each of them, where they were drawn, not rendered.
  std::vector<std::vector<std::uint8_t>> bytes;
  std::vector<double> stamps;  ///< Times of every tick [s].
  int sonar = 0, not_numbers = 0;
};

Arrived flown_until(const RaceConfig& race, double until) {
  Arrived arrived;
  (void)fly(race, [&](const flight_log::Tick& tick) {
    const Sensors& sensors = tick.sensors;
    const double t = 1e-9 * static_cast<double>(sensors.time.count());
    arrived.stamps.push_back(t);
    arrived.sonar += sensors.sonar.has_value();
    arrived.not_numbers += !sensors.imu.accel_B.allFinite();
    if (sensors.image || sensors.seen) arrived.pictures.push_back(t);
    if (sensors.seen) arrived.whole_gates.push_back(sensors.seen->gates.size());
    if (sensors.image) arrived.bytes.emplace_back(tick.frame.begin(), tick.frame.end());
    return static_cast<double>(arrived.stamps.size()) < until * 512;
  });
  return arrived;
}

RaceConfig ideal(const world::Faults& faults) {
  RaceConfig race = race_on("oval", 1003, 1, {}, "", faults);
  race.vision = Vision::kIdeal;
  return race;
}

/// How many pictures arrived between two times [s].
std::ptrdiff_t pictures(const Arrived& arrived, double from, double to) {
  return std::count_if(arrived.pictures.begin(), arrived.pictures.end(),
                       [&](double t) { return t >= from && t < to; });
}

TEST(FalseGates, OneOnTheWayIsCountedAndACleanRaceHasNone) {
  RaceConfig race = ideal({});
  const RaceResult clean = fly(race, {});
  EXPECT_TRUE(clean.finished);
  EXPECT_EQ(clean.through_false_gates, 0);
  EXPECT_EQ(clean.through_other_gates, 0);
  // A quarter of the way from the pad to the first gate, which is flown through by the same pilot.
  world::WorldGate on_the_way = race.sim.world.gates.front();
  on_the_way.p_EG.head<2>() = 0.75 * race.pilot.track.start + 0.25 * on_the_way.p_EG.head<2>();
  on_the_way.side = 2.0;
  race.sim.world.false_gates.push_back(on_the_way);
  EXPECT_EQ(fly(race, {}).through_false_gates, 1);
}

TEST(CameraFaults, ABurstIsAGapAndNothingElse) {
  const Arrived arrived = flown_until(ideal({.camera_out = {2.0, 1.0}}), 5.0);
  EXPECT_GT(pictures(arrived, 1.0, 2.0), 12);
  EXPECT_EQ(pictures(arrived, 2.15, 3.0), 0);  // what was exposed before has arrived by then
  EXPECT_GT(pictures(arrived, 3.2, 4.2), 12);
}

// From how the picture turns with the drone: also where it turns otherwise by the time that was told.
TEST(CameraFaults, PicturesThatComeMuchLaterThanToldAreFoundOut) {
  RaceConfig race = race_on("oval", 1003, 2, {}, "none", {.camera_delay = 0.060});
  race.vision = Vision::kIdeal;
  const RaceResult result = fly(race, [](const flight_log::Tick&) { return true; });
  ASSERT_TRUE(result.finished);
  ASSERT_TRUE(result.findings.has_value());
  EXPECT_NEAR(result.truth.latency, 0.060, 1e-9);
  EXPECT_NEAR(-result.findings->delay.value, 0.060, 0.006)
      << "findings count what pictures are younger";
}

TEST(CameraFaults, StuckItShowsTheSamePixelsWithNewStamps) {
  const RaceConfig race = race_on("oval", 1003, 1, {}, "", {.camera_stuck = {1.0, 1.0}});
  const Arrived arrived = flown_until(race, 2.6);
  int same = 0, different = 0;
  for (std::size_t i = 1; i < arrived.bytes.size(); ++i) {
    const bool stuck = arrived.pictures[i] > 1.15 && arrived.pictures[i] < 2.0;
    const bool repeated = arrived.bytes[i] == arrived.bytes[i - 1];
    EXPECT_GT(arrived.pictures[i], arrived.pictures[i - 1]);
    const bool healthy = arrived.pictures[i] < 1.0 || arrived.pictures[i] > 2.2;
    EXPECT_TRUE(repeated || !stuck) << arrived.pictures[i];
    EXPECT_FALSE(repeated && healthy) << arrived.pictures[i];
    ++(repeated ? same : different);
  }
  EXPECT_GT(same, 8);
  EXPECT_GT(different, 12);
}

TEST(CameraFaults, WithTheLampsOutPicturesAreDarkOrShowNothing) {
  const RaceConfig race = race_on("oval", 1003, 1, {}, "", {.light_out = {1.0, 0.3}});
  const Arrived rendered = flown_until(race, 1.3);
  const auto mean = [](const std::vector<std::uint8_t>& uyvy) {
    double sum = 0.0;
    for (std::size_t i = 1; i < uyvy.size(); i += 2) sum += uyvy[i];
    return 2.0 * sum / static_cast<double>(uyvy.size());
  };
  double light = 0.0, dark = 255.0;
  for (std::size_t i = 0; i < rendered.bytes.size(); ++i)
    (rendered.pictures[i] < 1.0 ? light : dark) = mean(rendered.bytes[i]);
  EXPECT_LT(dark, light - 20.0);

  for (const std::size_t gates : flown_until(ideal({.light_out = {0.0, 100.0}}), 4.0).whole_gates)
    EXPECT_EQ(gates, 0u);
}

TEST(SensorFaultsInFlight, ReachTheirSensors) {
  const Arrived healthy = flown_until(ideal({}), 3.0);
  EXPECT_EQ(healthy.not_numbers, 0);
  EXPECT_GT(healthy.sonar, 50);
  const Arrived broken = flown_until(
      ideal({.imu_nan = {1.0, 0.05}, .time_jump = {2.0, 10.0}, .sonar_out = {0.0, 100.0}}), 3.0);
  EXPECT_NEAR(broken.not_numbers, 0.05 * 512, 2);
  EXPECT_EQ(broken.sonar, 0);
  const double last = broken.stamps.back();
  EXPECT_NEAR(last - healthy.stamps.back(), 10.0, 0.1);
}

// In the first lap, where the drone is fast and turns.
TEST(SensorFaultsInFlight, AClockThatJumpsIsFollowedAndTheRaceGoesOn) {
  for (const double jump : {0.1, -0.1, 10.0, -10.0}) {
    const RaceResult result = fly(ideal({.time_jump = {5.0, jump}}), {});
    EXPECT_TRUE(result.finished) << jump << ' ' << result.crash_object << result.abort_reason;
    EXPECT_EQ(result.sensor_health.clock_jumps, 1u) << jump;
    EXPECT_LT(result.estimation_rmse.norm(), 0.5) << jump;
  }
}

// Between gates: whoever falls falls on what is below.
TEST(SensorFaultsInFlight, AStuckImuEndsOnTheFloorAndSaysWhy) {
  const RaceResult result = fly(ideal({.imu_stuck = {4.0, 1000.0}}), {});
  EXPECT_EQ(result.stop_reason, "abort") << result.crash_object;
  EXPECT_EQ(result.abort_reason, "the IMU went silent");
  EXPECT_GT(result.sensor_health.imu_stuck, 0u);
  EXPECT_LT(result.flight_time, 5.0) << "0.1 s until it knows, then a fall";
}

TEST(SensorFaultsInFlight, ACameraThatDiesEndsOnTheFloorWithinThreeSeconds) {
  const RaceResult result = fly(ideal({.camera_out = {5.0, 1000.0}}), {});
  EXPECT_EQ(result.stop_reason, "abort") << result.crash_object;
  EXPECT_EQ(result.abort_reason, "no pictures come");
  EXPECT_LT(result.flight_time, 8.0);
}

TEST(SensorFaultsInFlight, HealthySensorsAreNotSuspected) {
  const RaceResult result = fly(ideal({}), {});
  EXPECT_TRUE(result.finished);
  for (const SensorCount& each : kSensorCounts)
    EXPECT_EQ(result.sensor_health.*each.count, 0u) << each.key;
}

TEST(GateFaultsInFlight, AMissingGateIsNeverPassed) {
  const RaceResult result = fly(ideal({.missing_gate = 1}), {});
  EXPECT_EQ(result.gates_passed, 0);
  EXPECT_FALSE(result.finished);
}

TEST(GateFaultsInFlight, WithoutItsFirstGateADroneComesDownAtThePad) {
  const RaceResult result = fly(ideal({.missing_gate = 1}), {});
  EXPECT_FALSE(result.crash_time) << result.crash_object;
  EXPECT_EQ(result.abort_reason, text_of(AbortReason::kGateNotFound));
}

}  // namespace
}  // namespace gatefly::simulated_race
