// SPDX-License-Identifier: Apache-2.0
#include "gatefly/world/faults.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/drawn.hpp"
#include "gatefly/sim/ideal_vision.hpp"
#include "gatefly/sim/sensor_faults.hpp"
#include "gatefly/sim/solids.hpp"

#include "support/matchers.hpp"

namespace gatefly::sim {
namespace {

using test::IsNear;

Imu sample(double x) { return {.gyro_B = {x, 0.5 * x, -x}, .accel_B = {2 * x, -x, -9.81}}; }

TEST(SensorFaults, WithoutFaultsEverythingComesThroughToTheBit) {
  SensorFaults faults{{}};
  for (const double t : {0.0, 1.0, 100.0}) {
    EXPECT_EQ(faults.broken(sample(t / 50), t).gyro_B, sample(t / 50).gyro_B);
    EXPECT_EQ(faults.broken(sample(t / 50), t).accel_B, sample(t / 50).accel_B);
    EXPECT_EQ(faults.stamp(t).count(), std::llround(t * 1e9));
    EXPECT_EQ(faults.broken(std::optional{1.5}, t), 1.5);
  }
}

TEST(SensorFaults, AStuckImuSaysTheLastSampleAgain) {
  SensorFaults faults{{.imu_stuck = {1.0, 0.5}}};
  (void)faults.broken(sample(0.3), 0.99);
  EXPECT_EQ(faults.broken(sample(0.7), 1.0).gyro_B, sample(0.3).gyro_B);
  EXPECT_EQ(faults.broken(sample(0.8), 1.49).accel_B, sample(0.3).accel_B);
  EXPECT_EQ(faults.broken(sample(0.9), 1.5).gyro_B, sample(0.9).gyro_B);
}

TEST(SensorFaults, SamplesThatAreNoNumbersComeForAsLongAsIsSaid) {
  SensorFaults faults{{.imu_nan = {2.0, 0.05}}};
  EXPECT_TRUE(faults.broken(sample(1), 1.99).accel_B.allFinite());
  EXPECT_TRUE(faults.broken(sample(1), 2.02).accel_B.array().isNaN().all());
  EXPECT_TRUE(faults.broken(sample(1), 2.02).gyro_B.array().isNaN().all());
  EXPECT_TRUE(faults.broken(sample(1), 2.06).gyro_B.allFinite());
}

TEST(SensorFaults, TheImuSaturatesWhereItIsSaid) {
  SensorFaults faults{{.accel_range = 4.0, .gyro_range = 0.5}};
  const Imu imu = faults.broken(sample(1.0), 0.0);
  EXPECT_EQ(imu.accel_B, Eigen::Vector3d(2.0, -1.0, -4.0));
  EXPECT_EQ(imu.gyro_B, Eigen::Vector3d(0.5, 0.5, -0.5));
}

TEST(SensorFaults, BiasesStepAtTheirTime) {
  SensorFaults faults{
      {.bias_step_at = 3.0, .accel_bias_step = {0.3, 0, -1}, .gyro_bias_step = {0, 0.1, 0}}};
  EXPECT_EQ(faults.broken(sample(1), 2.99).accel_B, sample(1).accel_B);
  EXPECT_THAT(faults.broken(sample(1), 3.0).accel_B - sample(1).accel_B,
              IsNear(Eigen::Vector3d{0.3, 0, -1}, 1e-12));
  EXPECT_THAT(faults.broken(sample(1), 9.0).gyro_B - sample(1).gyro_B,
              IsNear(Eigen::Vector3d{0, 0.1, 0}, 1e-12));
}

TEST(SensorFaults, ATiltedImuFeelsGravityFromTheSide) {
  SensorFaults faults{{.imu_tilt = {3 * kDegree, 0.0}}};
  const Imu imu = faults.broken(Imu{.gyro_B = {0, 0, 1}, .accel_B = {0, 0, -9.81}}, 0.0);
  EXPECT_THAT(imu.accel_B, IsNear(Eigen::Vector3d{0, -9.81 * std::sin(3 * kDegree),
                                                  -9.81 * std::cos(3 * kDegree)},
                                  1e-9));
  EXPECT_NEAR(imu.gyro_B.y(), std::sin(3 * kDegree), 1e-9);
}

TEST(SensorFaults, TheClockJumpsBothWays) {
  for (const double jump : {0.1, -10.0}) {
    const SensorFaults faults{{.time_jump = {5.0, jump}}};
    EXPECT_EQ(faults.stamp(4.999).count(), 4'999'000'000);
    EXPECT_EQ(faults.stamp(5.0).count(), std::llround((5.0 + jump) * 1e9));
  }
}

TEST(SensorFaults, TheSonarIsSilentForAsLongAsIsSaid) {
  const SensorFaults faults{{.sonar_out = {1.0, 2.0}}};
  EXPECT_EQ(faults.broken(std::optional{1.5}, 0.9), 1.5);
  EXPECT_EQ(faults.broken(std::optional{1.5}, 2.9), std::nullopt);
  EXPECT_EQ(faults.broken(std::optional{1.5}, 3.0), 1.5);
}

world::SimConfig two_gates() {
  world::SimConfig config;
  config.world.gates = {{.p_EG = {3, 0, -1.5}}, {.p_EG = {6, 0, -1.5}}};
  config.world.room_size = {20, 20, 4};
  return config;
}

TEST(GateFaults, AMovedGateStandsElsewhereThanInTheMap) {
  world::SimConfig config = two_gates();
  config.faults = {.moved_gate = 2, .gate_moved = {0.3, -0.5, 0.1}, .gate_turned = 0.2};
  const world::SimConfig real = drawn(config, {}, 1);
  EXPECT_EQ(real.world.gates[0].p_EG, config.world.gates[0].p_EG);
  EXPECT_THAT(real.world.gates[1].p_EG, IsNear(Eigen::Vector3d{6.3, -0.5, -1.4}, 1e-12));
  EXPECT_EQ(real.world.gates[1].yaw_EG, 0.2);
}

TEST(GateFaults, AGateIsMovedToItsOwnRightHoweverItStands) {
  world::SimConfig config = two_gates();
  config.world.gates[1].yaw_EG = 90 * kDegree;  // flown to the east: its right is south
  config.faults = {.moved_gate = 2, .gate_moved = {0.0, 0.0, 0.2}, .gate_aside = 0.5};
  EXPECT_THAT(drawn(config, {}, 1).world.gates[1].p_EG,
              IsNear(Eigen::Vector3d{5.5, 0.0, -1.3}, 1e-12));
}

TEST(GateFaults, TheSeedDrawsWhichGateIsMovedAndTheTruthSaysWhich) {
  world::SimConfig config = two_gates();
  config.world.gates.push_back({.p_EG = {9, 0, -1.5}});
  config.faults = {.moved_gate = -1, .gate_aside = 0.5};
  std::array<int, 3> drawn_of{};
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const world::SimConfig real = drawn(config, {}, seed);
    ASSERT_GE(real.faults.moved_gate, 1);
    ASSERT_LE(real.faults.moved_gate, 3);
    const auto moved = static_cast<std::size_t>(real.faults.moved_gate - 1);
    ++drawn_of[moved];
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(real.world.gates[i].p_EG.y(), i == moved ? 0.5 : 0.0) << "seed " << seed;
  }
  for (const int times : drawn_of) EXPECT_GE(times, 8);  // 20 are expected
}

TEST(GateFaults, ACourseThatIsSmallerThanItsMapHasItsGatesNearerToThePad) {
  world::SimConfig config = two_gates();
  config.start.position = {1, 2};
  config.faults.course_scale = -0.07;
  const world::SimConfig real = drawn(config, {}, 1);
  EXPECT_THAT(real.world.gates[1].p_EG,
              IsNear(Eigen::Vector3d{1 + 0.93 * 5, 2 - 0.93 * 2, -1.5}, 1e-12));
  EXPECT_EQ(real.world.gates[1].side, config.world.gates[1].side);
}

TEST(Faults, ALensIsLongerThanToldBesideWhatTheSeedDraws) {
  world::SimConfig config = two_gates();
  const world::Randomize sigma = world::randomize_level("race");
  const auto focal = [&] {
    return std::visit([](const auto& lens) -> Eigen::Vector2d { return lens.focal_px; },
                      drawn(config, sigma, 4).camera.lens.model);
  };
  const Eigen::Vector2d usual = focal();
  config.faults.focal = 0.02;
  EXPECT_THAT(focal(), IsNear(Eigen::Vector2d{1.02 * usual}, 1e-9));
}

TEST(Faults, OffsetsOfMountAndStartAddToWhatTheSeedDraws) {
  world::SimConfig config = two_gates();
  const world::Randomize sigma = world::randomize_level("race");
  const world::SimConfig usual = drawn(config, sigma, 4);
  config.faults = {.camera_tilt = -5 * kDegree, .start_heading = 5 * kDegree};
  const world::SimConfig real = drawn(config, sigma, 4);
  EXPECT_NEAR(real.camera.tilt_down - usual.camera.tilt_down, -5 * kDegree, 1e-12);
  EXPECT_NEAR(real.start.heading - usual.start.heading, 5 * kDegree, 1e-12);
}

TEST(Faults, PicturesComeYoungerThanToldButNotBeforeReadOutHasEnded) {
  world::SimConfig config = two_gates();
  config.faults.camera_delay = -0.020;
  EXPECT_NEAR(drawn(config, {}, 1).sensors.camera_latency, 0.010, 1e-12);
  config.faults.camera_delay = -0.050;
  EXPECT_EQ(drawn(config, {}, 1).sensors.camera_latency, 0.0);
}

// x more of the thrust command: the rotor speed that hovered gives 1 / (1 + x) of the weight.
TEST(Faults, HoveringTakesSoMuchMoreOrLessThrust) {
  const world::SimConfig told = two_gates();
  for (const double more : {0.10, -0.10, 1.0}) {
    world::SimConfig config = told;
    config.faults.hover_thrust = more;
    const world::SimConfig real = drawn(config, {}, 1);
    EXPECT_NEAR(real.vehicle.thrust_coefficient * (1.0 + more), told.vehicle.thrust_coefficient,
                1e-18);
    EXPECT_EQ(real.vehicle.mass, told.vehicle.mass);
  }
}

TEST(GateFaults, AnotherHueIsTurnedAboutTheGreyAxis) {
  world::SimConfig config = two_gates();
  config.faults.hue = 120 * kDegree;
  const Eigen::Vector3d was = config.world.gates[0].color,
                        is = drawn(config, {}, 1).world.gates[0].color;
  EXPECT_THAT(is, IsNear(Eigen::Vector3d{was.z(), was.x(), was.y()}, 1e-9));
}

/// Which gates a camera at the origin sees, 1.5 m up, looking north.
std::vector<int> seen(const world::SimConfig& config, double x = 0.0) {
  const SolidSight sight{config.world};
  const std::vector<BodyPose> history{{0.0, {x, 0, -1.5}, {1, 0, 0, 0}}};
  world::CameraTruth level = config.camera;
  level.tilt_down = 0.0;
  std::vector<int> gates;
  for (const GateView& view : gates_in_view(config.world, level, sight, 0.0, history))
    if (view.whole) gates.push_back(view.gate + 1);
  return gates;
}

TEST(GateFaults, AMissingGateIsNeitherSeenNorSolid) {
  world::SimConfig config = two_gates();
  ASSERT_EQ(seen(drawn(config, {}, 1)), (std::vector{1, 2}));
  config.faults.missing_gate = 1;
  const world::SimConfig real = drawn(config, {}, 1);
  EXPECT_EQ(seen(real), std::vector{2});
  for (const Solid& solid : solids_of(real.world)) EXPECT_FALSE(solid.name.starts_with("gate 1"));
}

TEST(GateFaults, AHiddenGateIsSeenFromNearOnly) {
  world::SimConfig config = two_gates();
  config.faults.hidden_gate = 2, config.faults.gate_hidden = 4.0;
  const world::SimConfig real = drawn(config, {}, 1);
  EXPECT_EQ(seen(real, 0.0), std::vector{1});
  EXPECT_EQ(seen(real, 2.5), std::vector{2});
}

TEST(GateFaults, FalseGatesStandOffTheLanesAndAreSolid) {
  world::SimConfig config = two_gates();
  config.faults.false_gates = 3;
  const world::SimConfig real = drawn(config, {}, 1);
  ASSERT_EQ(real.world.false_gates.size(), 3u);
  EXPECT_EQ(real.world.gates.size(), 2u);
  for (const world::WorldGate& gate : real.world.false_gates) {
    EXPECT_EQ(gate.color, real.world.gates[0].color);
    EXPECT_LT(gate.p_EG.head<2>().cwiseAbs().maxCoeff(), 9.5);
    EXPECT_TRUE(std::abs(gate.p_EG.y()) > 1.0 || gate.p_EG.x() < -3.0 || gate.p_EG.x() > 9.0);
  }
  int bars = 0;
  for (const Solid& solid : solids_of(real.world)) bars += solid.name.starts_with("false gate");
  EXPECT_EQ(bars, 3 * 5);
}

}  // namespace
}  // namespace gatefly::sim
