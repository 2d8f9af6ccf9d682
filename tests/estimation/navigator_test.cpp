// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/navigator.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/allocation_counter.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using Eigen::Vector3d;
using test::IsNear;

constexpr double kImuPeriod = 1.0 / 512;
const Imu kStill{Vector3d::Zero(), {0, 0, -9.81}};
const GateFrame kGate{{4, 1, -1.5}, 0.5};

/// A navigator that has rested for a second on a pad.
struct Rested {
  explicit Rested(const NavigatorParams& params = {}) : navigator{params} {
    navigator.start({0.3, -0.2, 0.0}, 0.4, kGate, {0.0, 0.05, 0.06});
    for (int i = 0; i < 512; ++i) navigator.rest(kStill, t += kImuPeriod);
  }
  void fly(int ticks, const Imu& imu = kStill) {
    for (int i = 0; i < ticks; ++i) navigator.predict(imu, t += kImuPeriod);
  }
  Navigator navigator;
  double t = 0.0;
};

TEST(Navigator, StandsWhereItWasToldWhileItRests) {
  const Rested pad;
  const NavigationState now = pad.navigator.state();
  EXPECT_THAT(now.p_EB, IsNear(Vector3d{0.3, -0.2, 0.0}, 1e-9));
  EXPECT_THAT(now.v_E, IsNear(Vector3d{0, 0, 0}, 1e-9));
  EXPECT_NEAR(now.attitude.yaw, 0.4, 1e-9);
  EXPECT_EQ(now.rest_samples, 512);
  EXPECT_THAT(now.p_GB, IsNear(Vector3d{rotation_z(-0.5) * Vector3d{-3.7, -1.2, 1.5}}, 1e-9));
}

// 0.8 m/s² of drag along the body's x is 1.54 m/s forward (k_x = -0.52), on a heading of 0.4.
TEST(Navigator, DragCarriesThePosition) {
  Rested drone;
  drone.fly(5 * 512, {Vector3d::Zero(), {-0.8, 0, -9.81}});
  const NavigationState now = drone.navigator.state();
  EXPECT_NEAR(now.v_B.x(), 0.8 / 0.52, 0.1);
  EXPECT_GT(now.p_EB.x(), 5.0);
  EXPECT_THAT(now.p_EB, IsNear(drone.navigator.p_EB(), 1e-12));
}

TEST(Navigator, AFixOfThePastCorrectsThePresent) {
  Rested drone;
  drone.fly(256);
  const Vector3d before = drone.navigator.state().p_GB;
  Fix fix{.p_GB = before + Vector3d{0.1, 0.0, 0.0}};
  fix.covariance = 1e-4 * Eigen::Matrix3d::Identity();
  EXPECT_FALSE(drone.navigator.has_fix());
  EXPECT_EQ(drone.navigator.correct(fix, drone.t - 0.1), Fusion::kAccepted);
  EXPECT_TRUE(drone.navigator.has_fix());
  EXPECT_NEAR(drone.navigator.state().p_GB.x() - before.x(), 0.1, 0.02);
  EXPECT_EQ(drone.navigator.state().since_fix, 0.0);
}

TEST(Navigator, RemembersForAsLongAsItIsToldAtEveryRate) {
  for (const double hz : {200.0, 512.0, 1000.0}) {
    NavigatorParams params;
    params.imu_hz = hz, params.filter_memory = 0.15;
    Navigator navigator{params};
    navigator.start(Vector3d::Zero(), 0.0);
    double t = 0.0;
    for (int i = 0; i < static_cast<int>(hz); ++i) navigator.rest(kStill, t += 1.0 / hz);
    for (int i = 0; i < static_cast<int>(hz); ++i) navigator.predict(kStill, t += 1.0 / hz);
    EXPECT_NE(navigator.at(t - 0.14), nullptr) << hz;
    EXPECT_EQ(navigator.at(t - 0.17), nullptr) << hz;
  }
}

TEST(Navigator, AnotherGateIsAnotherFrameAndTheSamePlace) {
  Rested drone;
  drone.fly(256, {Vector3d::Zero(), {-0.8, 0.2, -9.81}});
  const NavigationState before = drone.navigator.state();
  drone.navigator.change_gate({{-2, 5, -1.2}, -2.0}, {0.12, 0.05, 0.06});
  const NavigationState after = drone.navigator.state();
  EXPECT_THAT(after.p_EB, IsNear(before.p_EB, 1e-9));
  EXPECT_THAT(after.v_E, IsNear(before.v_E, 1e-12));
  EXPECT_THAT(after.p_GB,
              IsNear(Vector3d{rotation_z(2.0) * (before.p_EB - Vector3d{-2, 5, -1.2})}, 1e-9));
  drone.fly(256, {Vector3d::Zero(), {-0.8, 0.2, -9.81}});
  const Vector3d moved = drone.navigator.state().p_EB - after.p_EB;
  EXPECT_GT(moved.dot(before.v_E), 0.0) << "goes on the way it went";
}

TEST(Navigator, ACorrectedHeadingTurnsWhatIsFlownFromNowOn) {
  Rested drone;
  drone.navigator.correct_heading(0.05, 1e-6);
  EXPECT_NEAR(drone.navigator.state().attitude.yaw, 0.45, 1e-3);
}

TEST(Navigator, SamplesThatAreNoNumbersLetTheLastOneGoOn) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Rested drone;
  drone.fly(512, {Vector3d::Zero(), {-0.8, 0, -9.81}});
  const double x = drone.navigator.state().p_GB.x();
  drone.fly(51, {Vector3d::Constant(kNan), Vector3d::Constant(kNan)});
  const NavigationState now = drone.navigator.state();
  EXPECT_TRUE(now.p_EB.allFinite());
  EXPECT_GT(now.p_GB.x(), x + 0.05) << "dead reckoning with what was last known";
  EXPECT_NEAR(now.since_imu, 0.1, 0.01);
}

TEST(Navigator, ARepeatedTimeStampLetsNoTimePass) {
  Rested drone;
  drone.fly(512, {Vector3d::Zero(), {-0.8, 0, -9.81}});
  const Vector3d p = drone.navigator.p_EB();
  for (int i = 0; i < 10; ++i) drone.navigator.predict({{1, 1, 1}, {3, 3, -12}}, drone.t);
  EXPECT_EQ(drone.navigator.p_EB(), p);
  EXPECT_EQ(drone.navigator.state().dt, 0.0);
}

// Sonar and barometer see 12 cm where dead reckoning stays on the floor.
TEST(Navigator, HeightsPullTheAltitude) {
  Rested drone;
  for (int i = 0; i < 1024; ++i) {
    drone.fly(1);
    if (i % 26 == 0) drone.navigator.measure_heights(0.12, std::nullopt);
    if (i % 20 == 0) drone.navigator.measure_heights(std::nullopt, 0.12);
  }
  EXPECT_NEAR(-drone.navigator.p_EB().z(), 0.12, 0.02);
}

TEST(Navigator, WithoutDragOnlyTheAttitudeGoesOn) {
  Rested hand;
  for (int i = 0; i < 512; ++i)
    hand.navigator.predict_attitude({{0, 0, 0.5}, {0, 0, -9.81}}, hand.t += kImuPeriod);
  EXPECT_NEAR(hand.navigator.state().attitude.yaw, 0.9, 0.01);
  EXPECT_THAT(hand.navigator.p_EB(), IsNear(Vector3d{0.3, -0.2, 0.0}, 1e-9));
}

TEST(Navigator, AllocatesNothingOnceBuilt) {
  Rested drone;
  Fix fix{.p_GB = drone.navigator.state().p_GB};
  const long before = test::allocations;
  for (int i = 0; i < 600; ++i) {
    drone.fly(1);
    if (i % 34 == 0) (void)drone.navigator.correct(fix, drone.t - 0.08);
    if (i % 26 == 0) drone.navigator.measure_heights(0.1, 0.1);
  }
  drone.navigator.change_gate({{1, 2, -1}, 0.0}, {});
  EXPECT_EQ(test::allocations - before, 0);
  test::expect_that_allocations_are_counted();
}

NavigatorParams with_map() {
  NavigatorParams params;
  params.ours.emplace();
  for (int i = 0; i < 12; ++i) params.ours->map.push_back({{4.0 + 3.0 * i, 1, -1.5}, 0.5, {}});
  return params;
}

// Pictures that say where it stands, which is behind what it would see: still they are worked through.
TEST(OwnFilter, AllocatesNothingOnceBuilt) {
  Rested drone{with_map()};
  eskf::GateSight sight{.features = {}};
  for (std::uint8_t i = 0; i < 4; ++i)
    (void)sight.features.push_back(
        {.which = i,
         .bearing_C = Vector3d{i == 1 || i == 2 ? 0.1 : -0.1, i < 2 ? -0.1 : 0.1, 1.0}});
  const test::NothingAllocated watch;
  for (int i = 0; i < 600; ++i) {
    drone.fly(1);
    sight.time = drone.t - 0.08;
    if (i % 34 == 33) (void)drone.navigator.error_state()->innovation_of(sight);
    if (i % 34 == 33) (void)drone.navigator.correct({&sight, 1}, true);
    if (i % 26 == 0) drone.navigator.measure_heights(0.1, 0.1);
    if (i % 100 == 0) drone.navigator.change_gate({{4.0 + 0.03 * i, 1, -1.5}, 0.5}, {});
    (void)drone.navigator.state();
    (void)drone.navigator.covariance_GB();
  }
}

// At rest nothing moves it; in flight drag is air speed, which is not yet ground speed.
TEST(OwnFilter, StandsWhereItWasToldAndFliesByTheImu) {
  Rested drone{with_map()};
  EXPECT_THAT(drone.navigator.state().p_EB, IsNear(Vector3d{0.3, -0.2, 0.0}, 1e-9));
  EXPECT_THAT(drone.navigator.state().p_GB,
              IsNear(Vector3d{rotation_z(-0.5) * Vector3d{-3.7, -1.2, 1.5}}, 1e-9));
  drone.fly(512);
  EXPECT_THAT(drone.navigator.state().p_EB, IsNear(Vector3d{0.3, -0.2, 0.0}, 0.05));
  EXPECT_NEAR(drone.navigator.state().attitude.yaw, 0.4, 1e-3);
  EXPECT_GT(drone.navigator.velocity_sigma().x(), 0.01);
  EXPECT_GT(drone.navigator.heading_sigma(), 0.05);
}

// --- an autopilot's IMU: 50 Hz of the 512 ---

NavigatorParams by_autopilot() {
  NavigatorParams params = with_map();
  params.slow_imu_hz = 51.2;
  return params;
}

/// At rest for a second, then in flight; every tenth sample is handed on, or what `hand_on` makes of it.
struct ByAutopilot {
  ByAutopilot() : navigator{by_autopilot()} {
    navigator.start({0.3, -0.2, 0.0}, 0.4, kGate, {0.0, 0.05, 0.06});
    for (int i = 0; i < 512; ++i, t += kImuPeriod)
      navigator.rest(kStill, t, i % 10 == 0 ? std::optional{kStill} : std::nullopt);
  }
  void fly(int ticks, const Imu& imu, const std::optional<Imu>& handed_on) {
    for (int i = 0; i < ticks; ++i, t += kImuPeriod)
      navigator.predict(imu, t, i % 10 == 0 ? handed_on : std::nullopt);
  }
  Navigator navigator;
  double t = kImuPeriod;
};

TEST(ByAutopilotsImu, TheRestIsTaughtByItAlone) {
  EXPECT_EQ(ByAutopilot{}.navigator.state().rest_samples, 52);
}

TEST(ByAutopilotsImu, TheFilterGoesByItAndWhoSteersByTheVehiclesGyro) {
  ByAutopilot drone;
  const Imu turning{{0, 0, 0.5}, {0, 0, -9.81}};
  drone.fly(512, turning, turning);
  EXPECT_NEAR(drone.navigator.state().attitude.yaw, 0.9, 0.01);
  // Another gyro between the samples: shown at once, gone with the next sample.
  drone.fly(5, {{0, 0, 2.0}, {0, 0, -9.81}}, turning);
  EXPECT_NEAR(drone.navigator.state().rate_B.z(), 2.0, 0.01);
  const double ahead = drone.navigator.state().attitude.yaw;
  drone.fly(512, turning, turning);
  EXPECT_NEAR(drone.navigator.state().attitude.yaw, 1.405, 0.01);
  EXPECT_GT(ahead, 0.9);
}

TEST(ByAutopilotsImu, ASampleThatIsNoNumberIsAsOneThatNeverCame) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  ByAutopilot broken, none;
  const Imu turning{{0.1, 0, 0.5}, {-0.8, 0, -9.81}};
  for (ByAutopilot* drone : {&broken, &none}) drone->fly(300, turning, turning);
  broken.fly(40, turning, Imu{Vector3d::Constant(kNan), {0, 0, -9.81}});
  none.fly(40, turning, std::nullopt);
  EXPECT_EQ(broken.navigator.state().p_EB, none.navigator.state().p_EB);
  EXPECT_EQ(broken.navigator.state().R_EB.matrix, none.navigator.state().R_EB.matrix);
  EXPECT_NEAR(broken.navigator.state().since_imu, 0.1, 0.02) << "the autopilot fell silent";
}

TEST(ByAutopilotsImu, TheVehiclesGyroThatFallsSilentIsToldToo) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  ByAutopilot drone;
  drone.fly(256, {Vector3d::Constant(kNan), Vector3d::Constant(kNan)}, kStill);
  EXPECT_NEAR(drone.navigator.state().since_imu, 0.5, 0.01);
  EXPECT_TRUE(drone.navigator.state().R_EB.matrix.allFinite());
}

TEST(ByAutopilotsImu, AllocatesNothingOnceBuilt) {
  ByAutopilot drone;
  const test::NothingAllocated watch;
  drone.fly(1000, kStill, kStill);
  drone.navigator.measure_heights(0.1, 0.1);
}

NavigatorParams as_paper() {
  NavigatorParams params;
  params.use = use_of_paper();
  params.filter.start_bias_sigma.setConstant(1.0);
  params.filter.bias_noise = 0.0;
  params.filter.gate_sigma = 100.0;
  return params;
}

// R is what the flight code has, whatever the picture says of itself; the fix is of now.
TEST(PaperFilter, AFixCountsAsOfNowWithAFixedCovariance) {
  Rested drone{as_paper()};
  drone.fly(256, {Vector3d::Zero(), {-0.8, 0, -9.81}});
  EXPECT_EQ(drone.navigator.at(drone.t - 0.1), drone.navigator.at(drone.t));
  const Vector3d before = drone.navigator.state().p_GB;
  Navigator vague = drone.navigator, sure = drone.navigator;
  Fix fix{.p_GB = before + Vector3d{0.5, 0.5, 0.0}};
  fix.covariance *= 25.0;
  EXPECT_EQ(vague.correct(fix, drone.t - 0.1), Fusion::kAccepted);
  fix.covariance *= 1e-6;
  EXPECT_EQ(sure.correct(fix, drone.t), Fusion::kAccepted);
  EXPECT_THAT(vague.state().p_GB, IsNear(sure.state().p_GB, 1e-12));
  const Vector3d moved = vague.state().p_GB - before;
  EXPECT_GT(moved.y(), moved.x()) << "y is trusted ten times as much";
  EXPECT_NEAR(moved.z(), 0.0, 0.01) << "the height is the altimeter's";
}

TEST(PaperFilter, ALegBeginsWhereThePlanSaysAndItsBiasesStay) {
  Rested drone{as_paper()};
  drone.fly(256);
  drone.navigator.begin_leg({1.0, 0.5});
  EXPECT_THAT(drone.navigator.p_EB().head<2>(), IsNear(Eigen::Vector2d{1.0, 0.5}, 1e-9));
  const Vector3d bias = drone.navigator.filter().state().segment<3>(drag_model::kBiasX);
  for (int i = 0; i < 20; ++i) {
    drone.fly(30);
    (void)drone.navigator.correct({.p_GB = drone.navigator.state().p_GB + Vector3d{0.3, 0.3, 0}},
                                  drone.t);
  }
  const Vector3d after = drone.navigator.filter().state().segment<3>(drag_model::kBiasX);
  EXPECT_THAT(after.head<2>(), IsNear(bias.head<2>(), 1e-12));
}

TEST(PaperFilter, OursKnowsBetterThanAPlanWhereItIs) {
  Rested drone;
  drone.fly(256);
  const Vector3d before = drone.navigator.p_EB();
  drone.navigator.begin_leg({1.0, 0.5});
  EXPECT_THAT(drone.navigator.p_EB(), IsNear(before, 1e-12));
}

}  // namespace
}  // namespace gatefly
