// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/velocity_observer.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using drag_model::Input;
using drag_model::State;
using Eigen::Vector3d;

constexpr double kObserverPeriod = 1.0 / 512;

TEST(VelocityObserver, ConvergesToDragsVelocityInSteadyFlight) {
  const drag_model::Params model;
  const double pitch = -5 * kDegree, v_x = model.gravity * std::sin(pitch) / model.drag.x();
  State x = State::Zero();
  x(drag_model::kVz) = v_x * std::tan(pitch);
  Input u;
  u.pitch = pitch;
  u.accel_B = {model.drag.x() * v_x, 0, -model.gravity * std::cos(pitch)};
  VelocityObserver observer{{}};
  for (int i = 0; i < 5 * 512; ++i) observer.update(x, u, model, kObserverPeriod);
  EXPECT_THAT(observer.v_B(), IsNear(Vector3d{v_x, 0, v_x * std::tan(pitch)}, 1e-4));
}

// A drone that obeys Newton with linear drag: the observer follows it without lag.
TEST(VelocityObserver, FollowsAnAccelerationWithoutLag) {
  const drag_model::Params model;
  Vector3d v = Vector3d::Zero();
  VelocityObserver observer{{}};
  for (int i = 0; i < 1024; ++i) {
    Input u;
    u.pitch = -0.15 * std::sin(0.01 * i);
    u.roll = 0.2 * std::sin(0.02 * i);
    const Vector3d g_B = rotation_EB(Attitude{u.roll, u.pitch, 0}).matrix.transpose() *
                         Vector3d{0, 0, model.gravity};
    u.accel_B = {model.drag.x() * v.x(), model.drag.y() * v.y(), -g_B.z()};
    v.x() += kObserverPeriod * (g_B.x() + u.accel_B.x());
    v.y() += kObserverPeriod * (g_B.y() + u.accel_B.y());
    observer.update(State::Zero(), u, model, kObserverPeriod);
    EXPECT_NEAR(observer.v_B().x(), v.x(), 0.01);
    EXPECT_NEAR(observer.v_B().y(), v.y(), 0.01);
  }
}

// Level, coasting ahead, yawing to the right: in the body the velocity turns to the left.
TEST(VelocityObserver, TurnsTheVelocityAgainstTheBodysTurn) {
  const drag_model::Params model;
  VelocityObserver observer{{}};
  Vector3d v{1.5, 0, 0};
  observer.start(v);
  for (int i = 0; i < 512; ++i) {
    Input u;
    u.gyro_B = {0, 0, 2.0};
    u.accel_B = {model.drag.x() * v.x(), model.drag.y() * v.y(), -model.gravity};
    v += kObserverPeriod * (Vector3d{u.accel_B.x(), u.accel_B.y(), 0} - u.gyro_B.cross(v));
    observer.update(State::Zero(), u, model, kObserverPeriod);
    EXPECT_THAT(observer.v_B(), IsNear(v, 0.01));
  }
  EXPECT_LT(v.y(), -0.5);
}

TEST(VelocityObserver, QuietensTheAccelerometersVibration) {
  const drag_model::Params model;
  Rng rng{3};
  VelocityObserver observer{{}};
  double raw = 0, smooth = 0;
  for (int i = 0; i < 20'000; ++i) {
    Input u;
    u.accel_B = Vector3d{0.15 * normal(rng), 0, -9.81};
    observer.update(State::Zero(), u, model, kObserverPeriod);
    if (i < 2000) continue;
    raw += std::pow(drag_model::velocity_B(State::Zero(), u, model).x(), 2);
    smooth += std::pow(observer.v_B().x(), 2);
  }
  EXPECT_LT(smooth, 0.02 * raw);
}

TEST(VelocityObserver, NastyInputChangesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  VelocityObserver observer{{}};
  observer.start({1, 2, 0});
  Input u;
  u.accel_B = {nan, 0, 0};
  observer.update(State::Zero(), u, {}, kObserverPeriod);
  u.accel_B = {0, 0, -9.81};
  observer.update(State::Zero(), u, {}, 0.0);
  observer.update(State::Zero(), u, {}, -1.0);
  observer.update(State::Zero(), u, {}, nan);
  EXPECT_EQ(observer.v_B(), Vector3d(1, 2, 0));
}

}  // namespace
}  // namespace gatefly
