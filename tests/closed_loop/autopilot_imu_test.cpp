// SPDX-License-Identifier: Apache-2.0
// An autopilot hands its IMU on: what of it arrives, when, and that a flight by it is replayed to the bit.
#include "gatefly/simulated_race/closed_loop/autopilot_imu.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/flight_log/flight_recorder.hpp"
#include "gatefly/flight_log/recording.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"

#include "support/race_setup.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::simulated_race {
namespace {

constexpr double kHz = 512.0;

world::SensorTruth autopilot(double hz, double cutoff_hz, double jitter) {
  world::SensorTruth truth;
  truth.autopilot_imu_hz = hz, truth.autopilot_imu_jitter = jitter;
  truth.autopilot_gyro_cutoff = truth.autopilot_accel_cutoff = cutoff_hz;
  return truth;
}

Imu count(int i) { return {Eigen::Vector3d::Constant(i), Eigen::Vector3d::Constant(-i)}; }

TEST(AutopilotImu, HandsOnSoManyASecondEachALittleLateAndInOrder) {
  for (const double hz : {25.0, 50.0, 100.0, 500.0}) {
    AutopilotImu passing{autopilot(hz, 0.0, 0.004), 7};
    int arrived = 0, last = -1;
    double late = 0.0;
    for (int i = 0; i < 5120; ++i) {
      const auto imu = passing.pass_on(count(i), i / kHz);
      if (!imu) continue;
      const int taken = static_cast<int>(imu->gyro_B.x());
      EXPECT_GT(taken, last);
      last = taken, ++arrived, late += (i - taken) / kHz;
    }
    EXPECT_NEAR(arrived, 10 * hz, 0.012 * hz + 1) << hz;  // the last ones are on their way
    EXPECT_GT(late / arrived, 0.0025) << hz;
    EXPECT_LT(late / arrived, hz > 200.0 ? 0.012 : 0.006) << hz;
  }
}

TEST(AutopilotImu, FiltersEverySampleAndNotOnlyThoseItHandsOn) {
  const auto strength = [](double vibration_hz) {
    AutopilotImu passing{autopilot(50.0, 25.0, 0.0), 7};
    double most = 0.0;
    for (int i = 0; i < 2560; ++i) {
      const double s = std::sin(2 * kPi * vibration_hz * i / kHz);
      const auto imu = passing.pass_on({{s, 0, 0}, {0, 0, s}}, i / kHz);
      if (imu && i > 512) most = std::max({most, imu->gyro_B.x(), imu->accel_B.z()});
    }
    return most;
  };
  EXPECT_NEAR(strength(2.0), 1.0, 0.05);
  EXPECT_LT(strength(123.0), 0.06) << "(25 / 123)², folded down to 23 Hz";
}

TEST(AutopilotImu, WhatIsNoNumberGoesThroughAndIsForgotten) {
  AutopilotImu passing{autopilot(500.0, 25.0, 0.0), 7};
  std::optional<Imu> last;
  bool broken = false;
  for (int i = 0; i < 512; ++i) {
    Imu imu = count(1);
    if (i == 200) imu.gyro_B.y() = std::nan("");
    if (const auto arrived = passing.pass_on(imu, i / kHz)) {
      broken = broken || !arrived->gyro_B.allFinite();
      last = arrived;
    }
  }
  EXPECT_TRUE(broken);
  ASSERT_TRUE(last);
  EXPECT_NEAR(last->gyro_B.y(), 1.0, 1e-6);
}

RaceConfig race_by(double hz, std::uint64_t seed) {
  RaceConfig race = test::race_on("oval", seed, 1);
  race.vision = Vision::kIdeal;
  race.sim.sensors.autopilot_imu_hz = race.pilot.filter_imu_hz = hz;
  return race;
}

// The same pilot, fed with what the log says and with what it saw, which an ideal flight does not keep.
TEST(AutopilotImu, AFlightByItIsReplayedToTheBitFromItsLog) {
  const test::TempFolder folder;
  RaceConfig race = race_by(50.0, 1601);
  race.timeout = 25.0;
  flight_log::FlightRecorder recorder(folder.path() / "flight", {.navigation_imu = true});
  std::vector<std::optional<SeenGates>> seen;
  std::vector<Eigen::Vector3d> positions;
  (void)fly(race, [&](const flight_log::Tick& tick) {
    recorder.record(tick);
    seen.push_back(tick.sensors.seen);
    positions.push_back(tick.pilot.estimate().p_EB);
    return true;
  });
  recorder.finish("{}");

  const auto flight = flight_log::read_flight_folder(folder.path() / "flight");
  const auto ticks = flight_log::ticks_of(flight);
  ASSERT_EQ(ticks.size(), seen.size());
  Pilot again{race.pilot};
  int handed_on = 0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    Sensors sensors = ticks[i].sensors;
    sensors.seen = seen[i];
    handed_on += sensors.navigation_imu.has_value();
    const Command command = again.step(sensors);
    ASSERT_EQ(again.estimate().p_EB, positions[i]) << i;
    ASSERT_EQ(command.motors, flight.samples[i].motors.value()) << i;
  }
  EXPECT_NEAR(handed_on, 50.0 / kHz * static_cast<double>(ticks.size()), 10.0);
  EXPECT_GT(again.estimate().gates_passed, 1);
}

TEST(AutopilotImu, RacesAreFlownByItAsByEverySample) {
  for (const double hz : {25.0, 50.0, 100.0}) {
    const RaceResult result = fly(race_by(hz, 1602), {});
    EXPECT_TRUE(result.finished) << hz;
    EXPECT_LT(result.estimation_rmse.norm(), 0.35) << hz;
  }
}

// It changes what the estimator gets, and no other number that is drawn.
TEST(AutopilotImu, ChangesNothingForAPilotThatIsNotToldOfIt) {
  RaceConfig with = race_by(50.0, 1603), without = race_by(0.0, 1603);
  with.pilot.filter_imu_hz = 0.0;
  with.timeout = without.timeout = 12.0;
  std::vector<double> a, b;
  const auto keep = [](std::vector<double>& numbers) {
    return [&numbers](const flight_log::Tick& tick) {
      for (const double x : tick.sensors.imu.accel_B) numbers.push_back(x);
      for (const double x : tick.command.motors) numbers.push_back(x);
      return true;
    };
  };
  (void)fly(with, keep(a));
  (void)fly(without, keep(b));
  EXPECT_EQ(a, b);
}

}  // namespace
}  // namespace gatefly::simulated_race
