// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/replay_score.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::flight_log {
namespace {

const MapGate kStands{.p_EG = {4.0, 1.0, -1.5}, .yaw_EG = 0.5 * kPi};

ScoredEstimate believed(double t, const Eigen::Vector3d& p_EB, const Eigen::Vector3d& p_GB) {
  return {.t = t,
          .p_EB = p_EB,
          .p_GB = p_GB,
          .covariance_EB = 0.04 * Eigen::Matrix3d::Identity(),
          .covariance_GB = 0.01 * Eigen::Matrix3d::Identity()};
}

TEST(ReplayScorer, ErrorsFromTheGateAreInItsOwnFrame) {
  ReplayScorer scorer{{kStands}};
  const Eigen::Vector3d truth{4.0, -1.0, -1.5};  // 2 m before it
  scorer.add(believed(0.0, truth, {-1.9, 0.2, 0.0}), truth, 0);
  EXPECT_TRUE(scorer.score().gate.rms().isApprox(Eigen::Vector3d{0.1, 0.2, 0.0}, 1e-9));
  EXPECT_EQ(scorer.score().earth.rms(), Eigen::Vector3d::Zero());
}

// A drone and a gate both half a metre to the north: it flies through the gate.
TEST(ReplayScorer, AMapThatIsShiftedAsAWholeIsNoErrorFromTheGate) {
  ReplayScorer scorer{{kStands}};
  const Eigen::Vector3d truth{4.0, -1.0, -1.5}, shift{0.5, 0.0, 0.0};
  scorer.add(believed(0.0, truth + shift, {-2.0, 0.0, 0.0}), truth, 0);
  EXPECT_LT(scorer.score().gate.rms().norm(), 1e-9);
  EXPECT_NEAR(scorer.score().earth.rms().x(), 0.5, 1e-12);
}

TEST(ReplayScorer, NeesIsCountedAtTwentyHertz) {
  ReplayScorer scorer{{kStands}};
  const Eigen::Vector3d truth{4.0, -1.0, -1.5};
  for (int i = 0; i < 512; ++i) scorer.add(believed(i / 512.0, truth, {-1.9, 0.1, 0.1}), truth, 0);
  const FrameErrors& gate = scorer.score().gate;
  EXPECT_EQ(gate.samples, 512);
  EXPECT_NEAR(gate.nees.samples, 20, 1);
  EXPECT_NEAR(gate.nees.sum_per_dof / gate.nees.samples, 1.0, 1e-9);  // 1 sigma each
  EXPECT_EQ(gate.nees.inside, gate.nees.samples);
}

TEST(ReplayScorer, WithoutKnownGatesOnlyTheEarthIsScored) {
  ReplayScorer scorer{{}};
  scorer.add(believed(0.0, {1, 0, 0}, {}), {0, 0, 0}, 0);
  EXPECT_EQ(scorer.score().gate.samples, 0);
  EXPECT_EQ(scorer.score().earth.samples, 1);
}

TEST(ReplayScorer, OnlySightingsThatWereTakenCount) {
  ReplayScorer scorer{{}};
  Sighting sighting;
  sighting.nis = 8.0, sighting.nis_dof = 8;
  scorer.add_sighting(sighting);
  EXPECT_EQ(scorer.score().nis.samples, 0);
  sighting.source = Sighting::Source::kCorners;
  scorer.add_sighting(sighting);
  EXPECT_EQ(scorer.score().nis.samples, 1);
}

TEST(FrameErrors, ThoseOfTwoFlightsArePooled) {
  FrameErrors a, b;
  a.add({3.0, 0.0, 0.0}), b.add({4.0, 0.0, 0.0});
  a.add(b);
  EXPECT_EQ(a.samples, 2);
  EXPECT_NEAR(a.rms().x(), std::sqrt(12.5), 1e-12);
  EXPECT_NEAR(a.deviation().x(), 0.5, 1e-12);
}

}  // namespace
}  // namespace gatefly::flight_log
