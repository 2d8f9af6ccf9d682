// SPDX-License-Identifier: Apache-2.0
#include "gatefly/control/indi.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector3d;
using Motors = std::array<double, 4>;

constexpr double kIndiDt = 1.0 / 512;

AttitudeCommand level_hover() {
  AttitudeCommand c;
  c.thrust = 9.81;
  return c;
}

// A rigid body with first-order rotors: the vehicle of the params, or one that differs from it.
struct Body {
  VehicleParams vehicle;
  Quaternion q;
  Vector3d rate = Vector3d::Zero();
  std::array<double, 4> thrust{};
  Vector3d torque_offset = Vector3d::Zero();

  void fly(const Motors& motors) {
    for (std::size_t i = 0; i < 4; ++i)
      thrust[i] += kIndiDt / vehicle.rotor_time_constant *
                   (vehicle.thrust_coefficient * motors[i] * motors[i] - thrust[i]);
    const double lx = vehicle.arm_x, ly = vehicle.arm_y, c = vehicle.torque_coefficient;
    const Vector3d torque{ly * (thrust[0] - thrust[1] - thrust[2] + thrust[3]),
                          lx * (thrust[0] + thrust[1] - thrust[2] - thrust[3]),
                          c * (-thrust[0] + thrust[1] - thrust[2] + thrust[3])};
    const Vector3d momentum = vehicle.inertia.cwiseProduct(rate);
    rate +=
        kIndiDt * (torque + torque_offset - rate.cross(momentum)).cwiseQuotient(vehicle.inertia);
    q = integrated(q, rate, kIndiDt);
  }
};

TEST(Indi, AtRestAndLevelAllRotorsTurnAlikeAndCarryTheWeight) {
  const VehicleParams vehicle;
  Indi indi{{}, vehicle};
  Motors motors{};
  for (int i = 0; i < 100; ++i) motors = indi.step(level_hover(), {}, Vector3d::Zero(), kIndiDt);
  double thrust = 0;
  for (const double w : motors) {
    EXPECT_NEAR(w, motors[0], 1e-6);
    thrust += vehicle.thrust_coefficient * w * w;
  }
  EXPECT_NEAR(thrust, vehicle.mass * 9.81, 1e-6);
}

TEST(Indi, EachCommandTurnsTheRotorsThatDoIt) {
  const auto motors_for = [](AttitudeCommand c) {
    Indi indi{{}, {}};
    c.thrust = 9.81;
    return indi.step(c, {}, Vector3d::Zero(), kIndiDt);
  };
  // Order: left front, right front, right back, left back.
  const Motors roll = motors_for({.roll = 0.1}), pitch = motors_for({.pitch = 0.1}),
               yaw = motors_for({.yaw = 0.1});
  EXPECT_GT(roll[0], roll[1]) << "roll right: the left ones lift";
  EXPECT_GT(roll[3], roll[2]);
  EXPECT_GT(pitch[0], pitch[3]) << "nose up: the front ones lift";
  EXPECT_GT(pitch[1], pitch[2]);
  EXPECT_NEAR(yaw[0], yaw[2], 1e-9) << "yaw: the diagonals";
  EXPECT_NEAR(yaw[1], yaw[3], 1e-9);
  EXPECT_NE(yaw[0], yaw[1]);
}

TEST(Indi, AMirroredCommandGivesMirroredRotors) {
  for_all(200, [](Rng& rng) {
    const AttitudeCommand c{.roll = rng.uniform(-0.3, 0.3),
                            .pitch = rng.uniform(-0.2, 0.2),
                            .yaw = rng.uniform(-0.2, 0.2),
                            .yaw_rate = 0.0,
                            .thrust = 9.81};
    const AttitudeCommand m{
        .roll = -c.roll, .pitch = c.pitch, .yaw = -c.yaw, .yaw_rate = 0.0, .thrust = 9.81};
    Indi a{{}, {}}, b{{}, {}};
    const Motors p = a.step(c, {}, Vector3d::Zero(), kIndiDt),
                 q = b.step(m, {}, Vector3d::Zero(), kIndiDt);
    EXPECT_NEAR(p[0], q[1], 1e-6);
    EXPECT_NEAR(p[1], q[0], 1e-6);
    EXPECT_NEAR(p[2], q[3], 1e-6);
    EXPECT_NEAR(p[3], q[2], 1e-6);
  });
}

// Flies the body to 15° roll, -8° pitch and 0.5 rad heading, from level.
TEST(Indi, BringsTheAttitudeThereAndKeepsIt) {
  Body body;
  Indi indi{{}, body.vehicle};
  const AttitudeCommand c{
      .roll = 15 * kDegree, .pitch = -8 * kDegree, .yaw = 0.5, .yaw_rate = 0, .thrust = 9.81};
  double most = 0;
  for (int i = 0; i < 3 * 512; ++i) {
    const RotationEB R = rotation_EB(body.q);
    body.fly(indi.step(c, R, body.rate, kIndiDt));
    most = std::max(most, attitude_of(R).roll);
  }
  const Attitude a = attitude_of(rotation_EB(body.q));
  EXPECT_NEAR(a.roll, c.roll, 0.01);
  EXPECT_NEAR(a.pitch, c.pitch, 0.01);
  EXPECT_NEAR(a.yaw, c.yaw, 0.02);
  EXPECT_LT(most, 1.25 * c.roll) << "overshoot";
}

// Errors of the model show in the measurement: 30 % more inertia, 20 % less thrust, a
// crooked arm.
TEST(Indi, CopesWithAVehicleItDoesNotKnow) {
  Body body;
  body.vehicle.inertia *= 1.3;
  body.vehicle.thrust_coefficient *= 0.8;
  body.torque_offset = {0.01, -0.01, 0.001};
  Indi indi{{}, VehicleParams{}};
  const AttitudeCommand c{.roll = 0.2, .pitch = -0.1, .yaw = 0, .yaw_rate = 0, .thrust = 9.81};
  for (int i = 0; i < 4 * 512; ++i) body.fly(indi.step(c, rotation_EB(body.q), body.rate, kIndiDt));
  const Attitude a = attitude_of(rotation_EB(body.q));
  EXPECT_NEAR(a.roll, c.roll, 0.02);
  EXPECT_NEAR(a.pitch, c.pitch, 0.02);
  EXPECT_NEAR(a.yaw, 0, 0.05);
}

// Told to look the other way and to lean, it leans to where it was told while it still turns: a drone
// that brakes at a stop and turns round there goes on the way it came from otherwise.
TEST(Indi, TiltsAtOnceHoweverFarTheHeadingIsOff) {
  for (const double yaw : {0.0, 1.5, 3.0, -2.4}) {
    Body body;
    Indi indi{{}, body.vehicle};
    const AttitudeCommand c{.roll = 0, .pitch = -0.2, .yaw = yaw, .yaw_rate = 0, .thrust = 9.81};
    const Vector3d wanted = rotation_EB(Attitude{c.roll, c.pitch, c.yaw}).matrix.col(2);
    for (int i = 0; i < 200; ++i) body.fly(indi.step(c, rotation_EB(body.q), body.rate, kIndiDt));
    const Vector3d is = rotation_EB(body.q).matrix.col(2);
    EXPECT_LT((is - wanted).norm(), 0.35 * std::sin(0.2)) << "0.4 s after, yaw " << yaw;
  }
}

TEST(Indi, TurnsTheShortWayRoundThroughSouth) {
  Body body;
  body.q = quaternion_of({0, 0, 3.0});
  Indi indi{{}, body.vehicle};
  AttitudeCommand c = level_hover();
  c.yaw = -3.0;  // 0.28 rad clockwise, across ±180°
  for (int i = 0; i < 3 * 512; ++i) {
    body.fly(indi.step(c, rotation_EB(body.q), body.rate, kIndiDt));
    EXPECT_GT(std::abs(attitude_of(rotation_EB(body.q)).yaw), 2.8);
  }
  EXPECT_NEAR(wrap_angle(attitude_of(rotation_EB(body.q)).yaw - c.yaw), 0, 0.03);
}

// A heading error of 180° has no short side; more than 90° off must not turn more slowly than 90°
// does, or it hangs.
TEST(Indi, TurnsRoundFromFarOff) {
  Body body;
  body.q = quaternion_of({0, 0, 2.9});
  Indi indi{{}, body.vehicle};
  for (int i = 0; i < 6 * 512; ++i)
    body.fly(indi.step(level_hover(), rotation_EB(body.q), body.rate, kIndiDt));
  EXPECT_NEAR(attitude_of(rotation_EB(body.q)).yaw, 0, 0.05);
}

TEST(Indi, RotorsStayWithinTheirLimitsWhateverIsAsked) {
  const VehicleParams vehicle;
  for_all(200, [&](Rng& rng) {
    Indi indi{{}, vehicle};
    for (int i = 0; i < 50; ++i) {
      const AttitudeCommand c{.roll = rng.uniform(-3, 3),
                              .pitch = rng.uniform(-3, 3),
                              .yaw = rng.uniform(-3, 3),
                              .yaw_rate = rng.uniform(-9, 9),
                              .thrust = rng.uniform(-50, 50)};
      const double dt = i % 5 == 0 ? 0.0 : kIndiDt;
      for (const double w :
           indi.step(c, rotation_EB(any_attitude(rng, 1.5)), any_vector3(rng, 20), dt)) {
        ASSERT_GE(w, vehicle.min_speed - 1e-6);
        ASSERT_LE(w, vehicle.max_speed + 1e-6);
      }
    }
  });
}

TEST(Indi, ResetForgetsEverything) {
  Indi used{{}, {}}, fresh{{}, {}};
  for (int i = 0; i < 100; ++i)
    (void)used.step({.roll = 0.3, .thrust = 12}, {}, Vector3d{1, 2, 3}, kIndiDt);
  used.reset();
  EXPECT_EQ(used.step(level_hover(), {}, Vector3d{0.1, 0, 0}, kIndiDt),
            fresh.step(level_hover(), {}, Vector3d{0.1, 0, 0}, kIndiDt));
}

// A body whose roll and pitch obey half as well as the team thinks, and yaw twice as well.
Vector3d learnt(bool adaptive, double command) {
  IndiParams params;
  params.adaptive = adaptive;
  const VehicleParams believed;
  VehicleParams real = believed;
  real.inertia = believed.inertia.cwiseProduct(Vector3d{2.0, 2.0, 0.5});
  Body body{.vehicle = real, .q = {}};
  body.thrust.fill(0.25 * real.mass * 9.81);
  Indi indi{params, believed};
  for (int i = 0; i < 10 * 512; ++i) {
    AttitudeCommand c = level_hover();
    const double t = i * kIndiDt;
    c.roll = command * std::sin(7.0 * t), c.pitch = command * std::sin(5.0 * t + 1.0);
    c.yaw = 2.0 * command * std::sin(6.0 * t);
    body.fly(indi.step(c, rotation_EB(body.q), body.rate, kIndiDt));
  }
  return indi.effectiveness();
}

// Smeur et al. 2016: the effectiveness is learnt from what increments of the rotors do.
TEST(Indi, LearnsHowWellTheDroneObeysWhenAsked) {
  const Vector3d factor = learnt(true, 0.2);
  EXPECT_NEAR(factor.x(), 0.5, 0.1);
  EXPECT_NEAR(factor.y(), 0.5, 0.1);
  EXPECT_GT(factor.z(), 1.1) << "yaw is slow, and learnt slowly";
}

TEST(Indi, LearnsNothingUnaskedNorAtRest) {
  EXPECT_EQ(learnt(false, 0.2), Vector3d::Ones());
  EXPECT_NEAR(learnt(true, 0.0).x(), 1.0, 1e-6);
}

}  // namespace
}  // namespace gatefly
