// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/drag_filter.hpp"

#include <cmath>
#include <limits>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using drag_model::Input;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kInterval = 1.0 / 512;

DragFilter started(const Vector3d& p = {-4, 0, 0.3}, const Vector3d& bias = Vector3d::Zero()) {
  DragFilter filter{DragFilterParams{}};
  filter.start(p, bias);
  return filter;
}

Fix fix_at(const Vector3d& p, double sigma = 0.05) {
  Fix fix;
  fix.p_GB = p;
  fix.covariance = sigma * sigma * Matrix3d::Identity();
  return fix;
}

Input hover() {
  Input u;
  u.accel_B = {0, 0, -9.81};
  return u;
}

TEST(DragFilter, HoveringStaysWhereItIs) {
  DragFilter filter = started();
  for (int i = 0; i < 1024; ++i) filter.predict(hover(), kInterval);
  EXPECT_THAT(filter.position(), IsNear(Vector3d{-4, 0, 0.3}, 1e-9));
}

// Straight and level at the speed at which drag holds the pull: x grows by v t, nothing else moves.
TEST(DragFilter, SteadyStraightFlightMovesWithDragsVelocity) {
  DragFilterParams params;
  // biases are known: heights tell v_z
  params.start_bias_sigma.setConstant(1e-3), params.bias_noise = 0.0;
  DragFilter filter{params};
  filter.start({-4, 0, 0.3}, Vector3d::Zero());
  const drag_model::Params model;
  const double pitch = -5 * kDegree, v_x = model.gravity * std::sin(pitch) / model.drag.x();
  Input u;
  u.pitch = pitch;
  u.accel_B = {model.drag.x() * v_x, 0, -model.gravity * std::cos(pitch)};
  // The filter starts with v_z = 0; fuse the height until it knows.
  for (int i = 0; i < 20 * 512; ++i) {
    filter.predict(u, kInterval);
    (void)filter.correct_altitude(0.3, 0.03);
  }
  const double before = filter.position().x();
  for (int i = 0; i < 512; ++i) filter.predict(u, kInterval);
  // The height only tells the sum of what v_x and v_z add to it: a little goes to the wrong one.
  EXPECT_NEAR(filter.position().x() - before, v_x / std::cos(pitch), 0.05);
  EXPECT_NEAR(filter.position().y(), 0, 1e-6);
  EXPECT_NEAR(filter.state()(drag_model::kVz), v_x * std::tan(pitch), 0.02);
}

TEST(DragFilter, CovarianceStaysACovarianceWhateverHappens) {
  for_all(200, [](Rng& rng) {
    DragFilter filter = started(any_vector3(rng, 3), any_vector3(rng, 0.2));
    for (int i = 0; i < 300; ++i) {
      Input input = any_input(rng);
      input.yaw_sigma = rng.uniform(0, 0.1);
      filter.predict(input, rng.uniform(0, 0.02));
      if (i % 34 == 0) {
        Fix fix = fix_at(filter.position() + any_vector3(rng, 0.3), rng.uniform(0.005, 0.5));
        fix.has_height = rng.uniform_index(2) == 0;
        for (int k = 0; k < systematic::kCount && i % 68 == 0; ++k)
          fix.systematic.col(k) = any_vector3(rng, 0.3);
        fix.random_covariance = 1e-4 * Matrix3d::Identity();
        (void)filter.correct(fix);
      }
      if (i % 26 == 0)
        (void)filter.correct_altitude(filter.position().z() + rng.uniform(-2, 2), 0.04);
      if (i == 150)
        filter.change_frame(rotation_z(rng.uniform(-3, 3)), any_vector3(rng, 5), {0.1, 0.05, 0.05});
    }
    EXPECT_THAT(filter.covariance(), IsCovariance());
    EXPECT_TRUE(filter.state().allFinite());
  });
}

TEST(DragFilter, CoastingGrowsTheCovarianceAndAFixShrinksIt) {
  DragFilter filter = started();
  Vector3d last = filter.covariance().diagonal().head<3>();
  for (int second = 0; second < 5; ++second) {
    for (int i = 0; i < 512; ++i) filter.predict(hover(), kInterval);
    const Vector3d now = filter.covariance().diagonal().head<3>();
    EXPECT_TRUE((now.array() > last.array()).all()) << second;
    last = now;
  }
  EXPECT_EQ(filter.correct(fix_at(filter.position())), Fusion::kAccepted);
  const Vector3d after = filter.covariance().diagonal().head<3>();
  EXPECT_TRUE((after.array() < last.array()).all());
  EXPECT_LT(after.maxCoeff(), 0.05 * 0.05);
}

TEST(DragFilter, AJumpOfFiveMetresIsRefusedAndChangesNothing) {
  DragFilter filter = started();
  for (int i = 0; i < 100; ++i) filter.predict(hover(), kInterval);
  for (const Vector3d& jump : {Vector3d{5, 0, 0}, Vector3d{0, -5, 0}, Vector3d{0, 0, 5}}) {
    const drag_model::State x = filter.state();
    const drag_model::StateMatrix P = filter.covariance();
    EXPECT_EQ(filter.correct(fix_at(filter.position() + jump)), Fusion::kRefused);
    EXPECT_EQ(filter.state(), x);
    EXPECT_EQ(filter.covariance(), P);
  }
}

TEST(DragFilter, NonFiniteInputChangesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  DragFilter filter = started();
  const drag_model::State x = filter.state();
  Input bad = hover();
  bad.accel_B.y() = nan;
  filter.predict(bad, kInterval);
  bad = hover();
  bad.gyro_B.z() = nan;
  filter.predict(bad, kInterval);
  filter.predict(hover(), nan);
  filter.predict(hover(), 0.0);
  filter.predict(hover(), -1.0);
  EXPECT_EQ(filter.correct(fix_at({nan, 0, 0})), Fusion::kRefused);
  EXPECT_EQ(filter.correct(fix_at(filter.position(), nan)), Fusion::kRefused);
  EXPECT_EQ(filter.correct_altitude(nan, 0.04), Fusion::kRefused);
  EXPECT_EQ(filter.correct_altitude(0.3, nan), Fusion::kRefused);
  EXPECT_EQ(filter.state(), x);
  EXPECT_TRUE(filter.covariance().allFinite());
}

TEST(DragFilter, AngleInputThatIsNotANumberChangesNothing) {
  for (double Input::*const angle : {&Input::roll, &Input::pitch, &Input::yaw, &Input::yaw_sigma}) {
    DragFilter filter = started();
    const drag_model::State x = filter.state();
    const drag_model::StateMatrix P = filter.covariance();
    Input bad = hover();
    bad.*angle = std::numeric_limits<double>::quiet_NaN();
    filter.predict(bad, kInterval);
    EXPECT_EQ(filter.state(), x);
    EXPECT_EQ(filter.covariance(), P);
  }
}

TEST(DragFilter, LearnsTheBiasThatMakesAHoveringDroneDrift) {
  DragFilter filter = started({-3, 0, 0});
  const Vector3d bias{0.10, -0.08, 0.15};
  Input u = hover();
  u.accel_B += bias;
  Rng rng{5};
  for (int i = 0; i < 20 * 512; ++i) {
    filter.predict(u, kInterval);
    if (i % 34 == 0)
      (void)filter.correct(
          fix_at(Vector3d{-3 + 0.05 * normal(rng), 0.05 * normal(rng), 0.05 * normal(rng)}));
  }
  EXPECT_THAT(filter.state().segment<3>(drag_model::kBiasX), IsNear(bias, 0.06));
  EXPECT_THAT(filter.position(), IsNear(Vector3d{-3, 0, 0}, 0.08));
}

TEST(DragFilter, BarsCorrectWithoutHeight) {
  DragFilter filter = started({-1, 0.1, 0.25});
  Fix bars = fix_at({-1.05, 0.0, 0});
  bars.has_height = false;
  EXPECT_EQ(filter.correct(bars), Fusion::kAccepted);
  EXPECT_NEAR(filter.position().y(), 0.01, 0.01);
  EXPECT_NEAR(filter.position().z(), 0.25, 1e-9);
}

TEST(DragFilter, ShiftingDroneAndFixesTogetherChangesNothing) {
  for_all(50, [](Rng& rng) {
    const Vector3d shift = any_vector3(rng, 20);
    DragFilter a = started({-3, 0, 0}), b = started(Vector3d{-3, 0, 0} + shift);
    for (int i = 0; i < 200; ++i) {
      const Input u = any_input(rng);
      a.predict(u, kInterval), b.predict(u, kInterval);
      if (i % 20 == 0) {
        const Vector3d p = a.position() + any_vector3(rng, 0.1);
        (void)a.correct(fix_at(p));
        (void)b.correct(fix_at(p + shift));
      }
    }
    EXPECT_THAT(b.position() - shift, IsNear(a.position(), 1e-9));
    EXPECT_THAT(b.covariance(), IsNear(a.covariance(), 1e-9));
  });
}

// A gate 5 m ahead whose heading is off by δ moves the drone 5 δ to the side.
TEST(DragFilter, AGatesUncertainHeadingIsUncertaintyAcrossTheWay) {
  DragFilter filter = started({-5, 0, 0});
  const drag_model::StateMatrix before = filter.covariance();
  filter.change_frame(Matrix3d::Identity(), Vector3d::Zero(),
                      {.position = 0.0, .height = 0.3, .yaw = 0.06});
  EXPECT_NEAR(filter.covariance()(1, 1) - before(1, 1), 0.3 * 0.3, 1e-12);
  EXPECT_NEAR(filter.covariance()(0, 0) - before(0, 0), 0.0, 1e-12);
  EXPECT_NEAR(filter.covariance()(2, 2) - before(2, 2), 0.3 * 0.3, 1e-12);
}

// A thousand heights say nothing about how high the gate hangs.
TEST(DragFilter, AltitudeDoesNotTellTheHeightOfTheGate) {
  DragFilter filter = started({-5, 0, 0});
  filter.change_frame(Matrix3d::Identity(), Vector3d::Zero(),
                      {.position = 0.0, .height = 0.05, .yaw = 0.0});
  for (int i = 0; i < 1000; ++i) (void)filter.correct_altitude(0.0, 0.04, 0.05);
  EXPECT_NEAR(std::sqrt(filter.covariance()(2, 2)), 0.05, 0.001);
  for (int i = 0; i < 1000; ++i) (void)filter.correct_altitude(0.0, 0.04);
  EXPECT_LT(filter.covariance()(2, 2), 0.01 * 0.01);
}

// A fix that is off as the one before it: 0.02 m of noise, and 0.2 m to the side that stay.
Fix fix_with_systematic_error(const Vector3d& p) {
  Fix fix = fix_at(p, 0.2);
  fix.random_covariance = 0.02 * 0.02 * Matrix3d::Identity();
  fix.systematic(1, systematic::kTiltX) = 0.2;
  return fix;
}

// Two bars do not tell how high they are seen from.
TEST(DragFilter, ARestartFromBarsLeavesTheHeight) {
  DragFilter filter = started({-3, 0, 0.25});
  const double before = filter.covariance()(2, 2);
  Fix bars = fix_with_systematic_error({-1, 0.4, 0});
  bars.has_height = false;
  filter.restart(bars);
  EXPECT_THAT(filter.position(), IsNear(Vector3d{-1, 0.4, 0.25}, 1e-12));
  EXPECT_EQ(filter.covariance()(2, 2), before);
  EXPECT_THAT(filter.covariance(), IsCovariance());
}

TEST(DragFilter, SystematicErrorsAreNotAveragedAway) {
  DragFilter filter = started();
  for (int i = 0; i < 200; ++i) (void)filter.correct(fix_with_systematic_error(filter.position()));
  EXPECT_GT(filter.covariance()(1, 1), 0.9 * 0.15 * 0.15 * 0.2 * 0.2 / (0.15 * 0.15 + 0.2 * 0.2))
      << "pad and gate together";
  EXPECT_LT(filter.covariance()(0, 0), 0.01 * 0.01);
}

// 200 flights of 20 s over a gate whose every fix is off alike, seed base 1. Position errors and
// innovations are both as large as the filter thinks: 3 degrees of freedom each; 200 flights give
// ±0.69 at 4 σ, 200 × 290 innovations less.
TEST(DragFilter, NeesAndNisAreConsistent) {
  double nees = 0, nis = 0;
  int fixes = 0;
  constexpr int kFlights = 200;
  DragFilterParams params;
  params.gate_sigma = 100.0;
  for_all(kFlights, [&](Rng& rng) {
    const Vector3d truth{-4, 0, 0};
    DragFilter filter{params};
    filter.start(
        truth + Vector3d{params.start_sigma.x() * normal(rng), params.start_sigma.y() * normal(rng),
                         params.start_sigma.z() * normal(rng)},
        Vector3d::Zero());
    const double off = normal(rng);
    for (int i = 0; i < 300; ++i) {
      Fix fix =
          fix_with_systematic_error(truth + 0.02 * Vector3d{normal(rng), normal(rng), normal(rng)});
      fix.p_GB += off * fix.systematic.col(systematic::kTiltX);
      nis += filter.nis(fix), ++fixes;
      (void)filter.correct(fix);
    }
    const Vector3d error = filter.position() - truth;
    nees += error.dot(filter.covariance().topLeftCorner<3, 3>().inverse() * error);
  });
  EXPECT_NEAR(nees / kFlights, 3.0, 4 * std::sqrt(6.0 / kFlights));
  EXPECT_NEAR(nis / fixes, 3.0, 4 * std::sqrt(6.0 / fixes));
}

// With the gate's heading assumed 0.1 rad too large, fixes and the way flown are turned alike: the
// innovations stay small, and the position error shrinks with the distance.
TEST(DragFilter, AWrongHeadingTurnsFixesAndWayAlike) {
  DragFilter filter = started({-8, 0, 0});
  filter.change_frame(Matrix3d::Identity(), Vector3d::Zero(),
                      {.position = 0.01, .height = 0.0, .yaw = 0.1});
  EXPECT_NEAR(std::sqrt(filter.covariance()(1, 1)), 0.8, 0.02);
  const drag_model::Params model;
  Input u = hover();
  u.accel_B.x() = model.drag.x() * 1.5;
  for (int i = 0; i < 4 * 512; ++i) {
    filter.predict(u, kInterval);
    if (i % 34 != 0) continue;
    Fix fix = fix_at(filter.position(), 0.5);
    fix.random_covariance = 0.02 * 0.02 * Matrix3d::Identity();
    fix.systematic.col(systematic::kGateYaw) = 0.1 * Vector3d::UnitZ().cross(filter.position());
    EXPECT_LT(filter.innovation_covariance(fix)(1, 1), 0.3 * 0.3) << filter.position().x();
    (void)filter.correct(fix);
  }
  EXPECT_NEAR(filter.position().x(), -2, 0.1);
  EXPECT_NEAR(std::sqrt(filter.covariance()(1, 1)), 0.2, 0.05);
}

// Which way the gate faces says nothing about whether the drone is in it.
TEST(DragFilter, LateralSigmaLeavesOutTheGatesHeading) {
  DragFilter filter = started({-5, 0, 0});
  const double before = filter.lateral_sigma();
  filter.change_frame(Matrix3d::Identity(), Vector3d::Zero(),
                      {.position = 0.0, .height = 0.0, .yaw = 0.1});
  EXPECT_GT(std::sqrt(filter.covariance()(1, 1)), 0.5);
  EXPECT_NEAR(filter.lateral_sigma(), before, 1e-9);
}

// A tilt is another one ten seconds later, so that fixes may differ from what they were; a gate's
// height stays what it is.
TEST(DragFilter, ADecorrelatedErrorWidensTheInnovation) {
  const auto sigma_after = [](systematic::Index column) {
    DragFilter filter = started();
    Fix fix = fix_at(filter.position(), 0.2);
    fix.random_covariance = 0.02 * 0.02 * Matrix3d::Identity();
    fix.systematic(1, column) = 0.2;
    for (int i = 0; i < 200; ++i) (void)filter.correct(fix);
    for (int i = 0; i < 10 * 512; ++i) filter.predict(hover(), kInterval);
    return filter.innovation_covariance(fix)(1, 1);
  };
  EXPECT_GT(sigma_after(systematic::kTiltX), sigma_after(systematic::kHeight) + 0.5 * 0.12 * 0.12);
}

TEST(DragFilter, ChangingFramesThereAndBackChangesNothing) {
  for_all(100, [](Rng& rng) {
    DragFilter filter = started(any_vector3(rng, 3));
    for (int i = 0; i < 100; ++i) filter.predict(any_input(rng), kInterval);
    const drag_model::State x = filter.state();
    const drag_model::StateMatrix P = filter.covariance();
    const Matrix3d R = rotation_z(rng.uniform(-3, 3));
    const Vector3d offset = any_vector3(rng, 8);
    filter.change_frame(R, offset, {});
    EXPECT_NEAR((filter.covariance().topLeftCorner<3, 3>().trace()),
                (P.topLeftCorner<3, 3>().trace()), 1e-12);
    filter.change_frame(R.transpose(), -(R.transpose() * offset), {});
    EXPECT_THAT(filter.state(), IsNear(x, 1e-9));
    EXPECT_THAT(filter.covariance(), IsNear(P, 1e-12));
  });
}

// 100 flights of 6 s, seed base 1: process noise as the filter believes (spectral densities on
// position, v_z and bias), 15 Hz fixes of 5 cm. NEES of the position has mean 3; 100 flights give
// ±0.98 at 4 σ.
TEST(DragFilter, IsConsistentWithItsOwnNoise) {
  const DragFilterParams params;
  double nees = 0;
  constexpr int kFlights = 100;
  for_all(kFlights, [&](Rng& rng) {
    drag_model::State truth = drag_model::State::Zero();
    truth(drag_model::kX) = -4;
    DragFilter filter{params};
    drag_model::State guess = truth;
    for (int i = 0; i < 3; ++i) {
      guess(i) += params.start_sigma(i) * normal(rng);
      truth(drag_model::kBiasX + i) = params.start_bias_sigma(i) * normal(rng);
    }
    truth(drag_model::kVz) = 0.1 * normal(rng);
    filter.start(guess.head<3>(), Vector3d::Zero());
    const double dt = 1.0 / 256;
    Input u = hover();
    for (int i = 0; i < 6 * 256; ++i) {
      u.roll = 0.2 * std::sin(0.01 * i), u.yaw = 0.3 * std::sin(0.004 * i);
      u.accel_B = Vector3d{-0.8, 0.3 * std::cos(0.01 * i), -9.81 * std::cos(u.roll)} +
                  truth.segment<3>(drag_model::kBiasX);
      filter.predict(u, dt);
      truth += dt * drag_model::derivative(truth, u, params.model);
      for (int k = 0; k < 3; ++k) {
        truth(k) += std::sqrt(params.position_noise * dt) * normal(rng);
        truth(drag_model::kBiasX + k) += std::sqrt(params.bias_noise * dt) * normal(rng);
      }
      truth(drag_model::kVz) += std::sqrt(params.vertical_noise * dt) * normal(rng);
      if (i % 17 == 16) {
        const Vector3d noise{normal(rng), normal(rng), normal(rng)};
        (void)filter.correct(fix_at(truth.head<3>() + 0.05 * noise));
      }
    }
    const Vector3d error = filter.position() - truth.head<3>();
    nees += error.dot(filter.covariance().topLeftCorner<3, 3>().inverse() * error);
  });
  EXPECT_NEAR(nees / kFlights, 3.0, 4 * std::sqrt(6.0 / kFlights));
}

}  // namespace
}  // namespace gatefly
