// SPDX-License-Identifier: Apache-2.0
// Races by way of an autopilot between pilot and rotors.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/simulated_race/closed_loop/race.hpp"

#include "support/race_setup.hpp"

namespace gatefly::simulated_race {
namespace {

using Takes = world::AutopilotTruth::Takes;

RaceConfig race_by(Output output, std::uint64_t seed) {
  RaceConfig race = test::race_on("oval", seed, 1, {"betaflight"});
  race.vision = Vision::kIdeal;
  race.pilot.output = output;
  race.sim.autopilot.takes = output == Output::kAttitudeThrust ? Takes::kAngles : Takes::kRates;
  return race;
}

TEST(ByWayOfAnAutopilot, ARaceIsFlownByRatesAndByAngles) {
  for (const Output output : {Output::kRatesThrust, Output::kAttitudeThrust}) {
    const RaceResult result = fly(race_by(output, 1104), {});
    EXPECT_TRUE(result.finished) << result.crash_object << result.abort_reason;
    EXPECT_EQ(result.landing_contact, "") << "it comes down on the floor and nowhere else";
  }
}

TEST(ByWayOfAnAutopilot, ThePilotGetsNoImuButTheOneThatIsHandedOn) {
  RaceConfig race = race_by(Output::kRatesThrust, 1105);
  race.timeout = 8.0;
  int samples = 0, fresh = 0;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  (void)fly(race, [&](const flight_log::Tick& tick) {
    const Imu& imu = tick.sensors.imu;
    ++samples;
    if (!imu.gyro_B.allFinite()) return true;
    fresh += imu.gyro_B != last;
    last = imu.gyro_B;
    EXPECT_FALSE(tick.sensors.navigation_imu && tick.sensors.navigation_imu->gyro_B != last);
    return true;
  });
  EXPECT_NEAR(fresh, samples * 50.0 / 512.0, 10.0);
}

TEST(ByWayOfAnAutopilot, EveryRotorIsMeantToGiveTheSameThrust) {
  RaceConfig race = race_by(Output::kRatesThrust, 1106);
  race.timeout = 8.0;
  bool flew = false;
  (void)fly(race, [&](const flight_log::Tick& tick) {
    const auto& motors = tick.command.motors;
    EXPECT_EQ(motors[0], motors[3]);
    flew = flew || motors[0] > 0.0;
    EXPECT_TRUE(motors[0] > 0.0 || tick.command.rates_B.isZero());
    return true;
  });
  EXPECT_TRUE(flew);
}

// A pilot that turns the rotors itself is not asked for rates, and nothing of the autopilot is drawn.
TEST(ByWayOfAnAutopilot, IsNotHowItFliesUnasked) {
  RaceConfig race = test::race_on("oval", 1107, 1);
  EXPECT_EQ(race.sim.autopilot.takes, Takes::kNone);
  EXPECT_EQ(race.pilot.output, Output::kMotors);
  race.vision = Vision::kIdeal, race.timeout = 6.0;
  RaceConfig other = race;
  other.sim.autopilot.hz = 7.0, other.sim.autopilot.delay = 0.4;
  std::vector<double> a, b;
  const auto keep = [](std::vector<double>& numbers) {
    return [&numbers](const flight_log::Tick& tick) {
      for (const double x : tick.command.motors) numbers.push_back(x);
      EXPECT_TRUE(tick.command.rates_B.isZero());
      return true;
    };
  };
  (void)fly(race, keep(a));
  (void)fly(other, keep(b));
  EXPECT_EQ(a, b);
}

}  // namespace
}  // namespace gatefly::simulated_race
