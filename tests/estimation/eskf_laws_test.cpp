// SPDX-License-Identifier: Apache-2.0
// What the error-state filter is made of: its models against numbers.
#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/estimation/eskf/correction.hpp"
#include "gatefly/estimation/eskf/gate_sight.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly::eskf {
namespace {

using Eigen::Vector3d;
using test::for_all;
using test::IsCovariance;
using test::IsNear;

const int kStates = gate_at(1);  // one gate
const CameraModel kCamera{{0.1, 0.0, 0.02}, 0.006};
const GateShape kGate{1.0, 0.05};

Nominal any_belief(Rng& rng) {
  Nominal x;
  x.p_EB = test::any_vector3(rng, 3.0), x.v_E = test::any_vector3(rng, 2.0);
  x.R_EB = rotation_EB(test::any_attitude(rng, 0.4)).matrix;
  x.R_BC = camera_mount(rng.uniform(0.0, 0.4)).matrix;
  x.gyro_bias = test::any_vector3(rng, 0.02), x.accel_bias = test::any_vector3(rng, 0.3);
  x.gust = test::any_vector2(rng, 0.5), x.wind = test::any_vector2(rng, 0.5);
  x.drag = test::any_vector2(rng, 0.1);
  x.focal = rng.uniform(-0.02, 0.02), x.bend = rng.uniform(-0.02, 0.02);
  x.delay = rng.uniform(-0.01, 0.01);
  x.corner = test::any_vector3(rng, 0.003);
  x.rate_B = test::any_vector3(rng, 1.0);
  x.gust_sigma = 0.3;
  return x;
}

ErrorVector unit(int i, double size) {
  ErrorVector e = ErrorVector::Zero(kStates);
  e(i) = size;
  return e;
}

Nominal with(Nominal x, int i, double size) {
  add(x, unit(i, size));
  return x;
}

// The error that leads from `a` to `b`, of what moves.
Eigen::Matrix<double, kMoving, 1> error_between(const Nominal& a, const Nominal& b) {
  Eigen::Matrix<double, kMoving, 1> e;
  e << b.p_EB - a.p_EB, b.v_E - a.v_E, turn_of(b.R_EB * a.R_EB.transpose()),
      b.gyro_bias - a.gyro_bias, b.accel_bias - a.accel_bias, b.gust - a.gust;
  return e;
}

// Two samples of one kind, so that their mean stands for both.
TEST(EskfProcess, TransitionMatchesCentralDifferences) {
  constexpr double kH = 1e-4;
  for_all(100, [](Rng& rng) {
    const Params params;
    const Nominal x = any_belief(rng);
    const Sample sample{{test::any_vector3(rng, 2.0), test::any_vector3(rng, 8.0)}, 0.002};
    const std::array<Sample, 4> samples{sample, sample, sample, sample};
    const double left = gust_left(x, 0.008, params);
    const auto after = [&](Nominal y) {
      for (const Sample& one : samples) propagate(y, one, params.gravity);
      y.gust *= left;  // how fast gusts pass is taken as known
      return y;
    };
    const Transition F = transition(x, mean_of(samples), params);
    for (int i = 0; i < kMoving; ++i) {
      const auto high = after(with(x, i, kH)), low = after(with(x, i, -kH));
      const Eigen::Matrix<double, kMoving, 1> column = error_between(low, high) / (2 * kH);
      EXPECT_THAT(F.col(i), IsNear(column, 3e-4)) << "state " << i;
    }
  });
}

TEST(EskfProcess, CovarianceIsCarriedAsTheTransitionSaysAndStaysOne) {
  for_all(50, [](Rng& rng) {
    Params params;
    params.noise = {.position = 0,
                    .accel = 0,
                    .accel_z = 0,
                    .attitude = 0,
                    .gyro_scale = 0,
                    .accel_bias = 0,
                    .gyro_bias = 0,
                    .wind = 0,
                    .drag = 0};
    params.sight.lasting = params.sight.lasting_size = 0.0;
    Nominal x = any_belief(rng);
    x.gust_sigma = 0.0;
    Eigen::MatrixXd root = Eigen::MatrixXd::Zero(kStates, kStates);
    for (int i = 0; i < kStates; ++i)
      for (int j = 0; j < kStates; ++j) root(i, j) = rng.uniform(-1.0, 1.0);
    Covariance P = root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(kStates, kStates);
    const Sample sample{{test::any_vector3(rng, 2.0), test::any_vector3(rng, 8.0)}, 0.004};
    const std::array<Sample, 2> samples{sample, sample};
    Eigen::MatrixXd F = Eigen::MatrixXd::Identity(kStates, kStates);
    F.topLeftCorner<kMoving, kMoving>() = transition(x, mean_of(samples), params);
    const double corner = 1.0 - 0.008 / params.sight.lasts;
    F.diagonal().segment<3>(kCorner).setConstant(corner);
    const Eigen::MatrixXd expected = F * P * F.transpose();
    predict(x, P, samples, params, kCamera.radians_per_px);
    EXPECT_THAT(P, IsNear(expected, 1e-3));
    EXPECT_THAT(P, IsCovariance());
  });
}

TEST(EskfDrag, JacobianMatchesCentralDifferences) {
  constexpr double kH = 1e-5;
  for_all(100, [](Rng& rng) {
    const Params params;
    const Nominal x = any_belief(rng);
    const Interval interval{{test::any_vector3(rng, 1.0), test::any_vector3(rng, 3.0)}, 0.01};
    for (const int axis : {0, 1}) {
      const DragMeasurement at = drag_measurement(x, interval, axis, params);
      ErrorVector H = ErrorVector::Zero(kStates);
      for (std::size_t i = 0; i < at.states.size(); ++i) H(at.states[i]) = at.jacobian[i];
      for (int i = 0; i < kStates; ++i) {
        const double high = drag_measurement(with(x, i, kH), interval, axis, params).residual;
        const double low = drag_measurement(with(x, i, -kH), interval, axis, params).residual;
        EXPECT_NEAR(H(i), -(high - low) / (2 * kH), 1e-7) << "state " << i;
      }
    }
  });
}

TEST(EskfThrust, JacobianMatchesCentralDifferences) {
  constexpr double kH = 1e-5;
  for_all(100, [](Rng& rng) {
    const Params params;
    const Nominal x = any_belief(rng);
    const Interval interval{
        {test::any_vector3(rng, 1.0), test::any_vector3(rng, 3.0)}, 0.01, rng.uniform(6.0, 14.0)};
    const ThrustMeasurement at = thrust_measurement(x, interval, params);
    ErrorVector H = ErrorVector::Zero(kStates);
    for (std::size_t i = 0; i < at.states.size(); ++i) H(at.states[i]) = at.jacobian[i];
    for (int i = 0; i < kStates; ++i) {
      const double high = thrust_measurement(with(x, i, kH), interval, params).residual;
      const double low = thrust_measurement(with(x, i, -kH), interval, params).residual;
      EXPECT_NEAR(H(i), -(high - low) / (2 * kH), 1e-7) << "state " << i;
    }
  });
}

// On the pad the floor carries; at idle rotors do not; and nobody may know what was commanded.
TEST(EskfThrust, SaysNothingWhereRotorsDoNotCarryTheDrone) {
  const Params params;
  Nominal x;
  Covariance P = Eigen::MatrixXd::Identity(kStates, kStates);
  const auto changed = [&](double height, double thrust) {
    Nominal y = x;
    Covariance Q = P;
    y.p_EB.z() = -height;
    correct_by_thrust(y, Q, {{Vector3d::Zero(), {0, 0, -10.8}}, 0.01, thrust}, params);
    return Q != P;
  };
  EXPECT_TRUE(changed(1.5, 9.8));
  EXPECT_FALSE(changed(0.05, 9.8));
  EXPECT_FALSE(changed(1.5, 2.0));
  EXPECT_FALSE(changed(1.5, 0.0));
}

// The gate as it would show from where the drone is believed to be.
GateSight sight_from(const Nominal& x, GateSight::Quality quality, bool bars) {
  GateSight sight;
  sight.quality = quality;
  const auto corners = gate_corners_G(kGate.side);
  const Eigen::Matrix3d R_EG = rotation_z(x.gates[0].yaw_EG);
  const double half = 0.5 * (kGate.side - kGate.bar);
  for (std::size_t i = 0; i < (bars ? 2u : 4u); ++i) {
    const Vector3d p_G = bars ? Vector3d{0, i == 0 ? -half : half, 0.2} : corners[i];
    const Vector3d c =
        x.R_BC.transpose() *
        (x.R_EB.transpose() * (x.gates[0].p_EG + R_EG * p_G - x.p_EB) - kCamera.p_BC);
    (void)sight.features.push_back(
        {.kind = bars ? Feature::Kind::kBar : Feature::Kind::kCorner,
         .which = static_cast<std::uint8_t>(i),
         .late = 0.002 * (static_cast<double>(i) - 1.5),
         .bearing_C = c.normalized(),
         .from_middle_px = {i == 1 || i == 2 ? 20.0 : -20.0, i < 2 ? -20.0 : 20.0}});
  }
  return sight;
}

// Two to six metres before the gate, looking towards it.
Nominal any_view(Rng& rng) {
  Nominal x = any_belief(rng);
  x.R_EB = rotation_EB(Attitude{rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), 0.0}).matrix;
  x.gates[0].p_EG = x.p_EB + Vector3d{rng.uniform(2.0, 6.0), rng.uniform(-0.5, 0.5), 0.3};
  x.gates[0].yaw_EG = rng.uniform(-0.4, 0.4);
  return x;
}

void expect_jacobian(const Nominal& x, const GateSight& sight, double tolerance) {
  constexpr double kH = 1e-5;
  const auto at = gate_rows(x, sight, kGate, 0.003, false, kCamera, {});
  ASSERT_TRUE(at.has_value());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(at->residual.size(), kStates);
  for (int c = 0; c < GateRows::kColumns; ++c)
    H.col(at->states[static_cast<std::size_t>(c)]) = at->jacobian.col(c);
  for (int i = 0; i < kStates; ++i) {
    const auto high = gate_rows(with(x, i, kH), sight, kGate, 0.003, false, kCamera, {});
    const auto low = gate_rows(with(x, i, -kH), sight, kGate, 0.003, false, kCamera, {});
    ASSERT_TRUE(high && low);
    const Eigen::VectorXd column = -(high->residual - low->residual) / (2 * kH);
    EXPECT_THAT(H.col(i), IsNear(column, tolerance)) << "state " << i;
  }
}

TEST(EskfGate, JacobianOfCornersMatchesCentralDifferences) {
  for_all(100, [](Rng& rng) {
    const Nominal x = any_view(rng);
    expect_jacobian(x, sight_from(x, GateSight::Quality::kWhole, false), 1e-6);
  });
}

TEST(EskfGate, JacobianOfBarsMatchesCentralDifferencesOnThem) {
  for_all(100, [](Rng& rng) {
    Nominal x = any_view(rng);
    x.focal = x.bend = x.delay = 0.0, x.rate_B.setZero();
    GateSight sight = sight_from(x, GateSight::Quality::kPart, true);
    for (Feature& feature : sight.features) feature.late = -0.003;  // exactly at the belief
    expect_jacobian(x, sight, 1e-5);
  });
}

// From either side the nearer face is seen.
TEST(EskfGate, ABoardIsAGateHalfItsDepthNearer) {
  constexpr double kNear = 0.13;
  for_all(50, [](Rng& rng) {
    for (const bool behind : {false, true}) {
      const Nominal x = any_view(rng);
      GateSight sight = sight_from(x, GateSight::Quality::kPart, true);
      sight.behind = behind;
      Nominal nearer = x;
      nearer.gates[0].p_EG -= (behind ? -kNear : kNear) * rotation_z(x.gates[0].yaw_EG).col(0);
      const GateShape board{kGate.side, kGate.bar, kNear};
      const auto rows = gate_rows(x, sight, board, 0.003, false, kCamera, {});
      const auto same = gate_rows(nearer, sight, kGate, 0.003, false, kCamera, {});
      ASSERT_TRUE(rows && same);
      EXPECT_THAT(rows->residual, IsNear(same->residual, 1e-12));
    }
  });
}

// What is drawn where a frame of boards, or its opening, shows is what was expected.
TEST(EskfGate, CornersOfBoardsAreExpectedWhereTheirOutlinesCross) {
  const GateShape board{2.7, 0.6, 0.13};
  for_all(100, [&](Rng& rng) {
    Nominal x = any_view(rng);
    x.focal = x.bend = x.delay = 0.0, x.rate_B.setZero(), x.v_E.setZero(), x.corner.setZero();
    x.gates[0].size = 0.0;
    x.gates[0].p_EG.y() += rng.uniform(-3.0, 3.0);  // from beside it, too
    const Eigen::Matrix3d R_EG = rotation_z(x.gates[0].yaw_EG);
    const Vector3d eye_E = x.p_EB + x.R_EB * kCamera.p_BC,
                   eye_G = R_EG.transpose() * (eye_E - x.gates[0].p_EG);
    if (eye_G.x() > -0.5) return test::not_a_case();
    for (const auto kind : {Feature::Kind::kCorner, Feature::Kind::kOpening}) {
      const bool opening = kind == Feature::Kind::kOpening;
      GateSight sight;
      sight.quality = GateSight::Quality::kPart;
      for (std::uint8_t i = 0; i < 4; ++i) {
        const Vector3d corner_G = gate_corners_G(opening ? 1.5 : 2.7)[i],
                       shown_G = corner_G - Vector3d{board.near_face, 0, 0} +
                                 outline_shift_G(corner_G, eye_G, board.near_face,
                                                 opening ? CornerOf::kOpening : CornerOf::kFrame);
        const Vector3d ray_E = x.gates[0].p_EG + R_EG * shown_G - eye_E;
        (void)sight.features.push_back(
            {.kind = kind,
             .which = i,
             .bearing_C = (x.R_BC.transpose() * x.R_EB.transpose() * ray_E).normalized()});
      }
      const auto rows = gate_rows(x, sight, board, 0.0, false, kCamera, {});
      if (!rows) return test::not_a_case();
      EXPECT_LT(rows->residual.norm(), 1e-9);
    }
  });
}

TEST(EskfGate, ACorrectionBringsTheBeliefTowardsWhatWasSeenAndIsMoreCertain) {
  for_all(50, [](Rng& rng) {
    Nominal truth = any_view(rng);
    truth.corner.setZero(), truth.focal = truth.bend = truth.delay = 0.0;
    truth.rate_B.setZero(), truth.v_E.setZero();
    GateSight sight = sight_from(truth, GateSight::Quality::kWhole, false);
    for (Feature& feature : sight.features) feature.late = 0.0;
    Nominal x = truth;
    x.p_EB += test::any_vector3(rng, 0.2);
    Covariance P = 1e-6 * Eigen::MatrixXd::Identity(kStates, kStates);
    P.diagonal().segment<3>(kP).setConstant(0.04);
    const double off = (x.p_EB - truth.p_EB).norm();
    ASSERT_TRUE(correct_by_gate(x, P, sight, kGate, 0.0, kCamera, {}));
    EXPECT_LT((x.p_EB - truth.p_EB).norm(), 0.35 * off + 0.02);
    EXPECT_LT(P.diagonal().segment<3>(kP).maxCoeff(), 0.03);
    EXPECT_THAT(P, IsCovariance());
  });
}

// A drone that is more than half a metre beside its belief, and says so. What it sees is no outlier:
// only the line through its belief is too short to reach it.
TEST(EskfGate, AGateNearByExplainsItselfToADroneThatKnowsLittleOfItsPlace) {
  for_all(50, [](Rng& rng) {
    Nominal truth = any_view(rng);
    truth.corner.setZero(), truth.focal = truth.bend = truth.delay = 0.0;
    truth.rate_B.setZero(), truth.v_E.setZero();
    truth.gates[0].p_EG.x() = truth.p_EB.x() + 2.0;
    GateSight sight = sight_from(truth, GateSight::Quality::kWhole, false);
    for (Feature& feature : sight.features) feature.late = 0.0;
    Nominal x = truth;
    x.p_EB.y() += rng.uniform(0.0, 1.0) < 0.5 ? -0.6 : 0.6;
    Covariance P = 1e-6 * Eigen::MatrixXd::Identity(kStates, kStates);
    P.diagonal().segment<2>(kP).setConstant(0.36);
    const auto found = innovation(x, P, sight, kGate, 0.0, false, kCamera, {});
    ASSERT_TRUE(found.has_value());
    EXPECT_LT(found->nis, 10.0) << "one sigma off, and true in everything else";
    GateSight other = sight;  // half as large as any gate there can be
    for (Feature& feature : other.features)
      feature.bearing_C = (feature.bearing_C + 2.0 * Vector3d::UnitZ()).normalized();
    const auto wrong = innovation(x, P, other, kGate, 0.0, false, kCamera, {});
    ASSERT_TRUE(wrong.has_value());
    EXPECT_GT(wrong->nis, 25.0);
  });
}

TEST(EskfGate, WhatIsBehindTheCameraChangesNothing) {
  Rng rng{1};
  Nominal x = any_view(rng);
  const GateSight sight = sight_from(x, GateSight::Quality::kPart, false);
  x.gates[0].p_EG = x.p_EB - (x.gates[0].p_EG - x.p_EB);
  Covariance P = Eigen::MatrixXd::Identity(kStates, kStates);
  const Covariance before = P;
  EXPECT_FALSE(correct_by_gate(x, P, sight, kGate, 0.0, kCamera, {}));
  EXPECT_EQ(P, before);
}

TEST(EskfHeight, AHeightThatIsFarOffIsLeftAndOneThatStaysWinsInTheEnd) {
  Nominal x;
  x.p_EB.z() = -1.5;
  Covariance P = 1e-4 * Eigen::MatrixXd::Identity(kStates, kStates);
  EXPECT_FALSE(correct_by_height(x, P, 0.7, 0.04));
  EXPECT_EQ(x.p_EB.z(), -1.5);
  int times = 1;
  while (!correct_by_height(x, P, 0.7, 0.04) && times < 100) ++times;
  EXPECT_GT(times, 3) << "one table";
  EXPECT_LT(times, 40) << "two seconds at 20 Hz";
  EXPECT_TRUE(correct_by_height(x, P, 0.7, 0.04));
}

// On a level pad the specific force is the bias'; on a tilted one it cannot be told from tilt.
TEST(EskfRest, TellsBiasAndTiltTogether) {
  Params params;
  Nominal x;
  Covariance P = 1e-8 * Eigen::MatrixXd::Identity(kStates, kStates);
  P.diagonal().segment<3>(kAccelBias).setConstant(0.16);
  P.diagonal().segment<2>(kTheta).setConstant(1e-4);
  correct_by_rest(x, P, {0.3, -0.1, -9.6}, params);
  const double both = x.accel_bias.x() + 9.81 * turn_of(x.R_EB).y();
  EXPECT_NEAR(both, 0.3, 0.01);
  EXPECT_NEAR(x.accel_bias.z(), 0.21, 0.01);
  EXPECT_GT(std::sqrt(P(kAccelBias, kAccelBias)), 0.09) << "neither alone is known";
  EXPECT_THAT(P, IsCovariance());
}

// How much rotors are believed to give, half a second after what they give has changed, of a filter that was
// sure of them.
Nominal after_rotors_change_by(double part, Covariance& P) {
  const Params params;
  Nominal x;
  x.p_EB.z() = -1.5;
  P = 1e-6 * Covariance::Identity(kGates, kGates);
  const double thrust = params.gravity, given = (1.0 + part) * thrust;
  for (int i = 0; i < 256; ++i)
    correct_by_thrust(x, P, {{Vector3d::Zero(), {0, 0, -given}}, 1.0 / 512, thrust}, params);
  return x;
}

TEST(EskfThrust, RotorsThatLoseAThirdFromOneMomentToTheNextAreLearntAnew) {
  Covariance P;
  for (const double part : {-0.3, -0.2, 0.25})
    EXPECT_NEAR(after_rotors_change_by(part, P).thrust, part, 0.04);
  EXPECT_LT(P(kThrust, kThrust), 1e-3) << "and are known again";
}

TEST(EskfThrust, ALittleLessThrustIsForTheRandomWalk) {
  Covariance P;
  EXPECT_NEAR(after_rotors_change_by(-0.05, P).thrust, 0.0, 0.005);
  EXPECT_LT(P(kThrust, kThrust), 1.1e-6);
}

}  // namespace
}  // namespace gatefly::eskf
