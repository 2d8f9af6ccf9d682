// SPDX-License-Identifier: Apache-2.0
// The map that several flights agree on, and its track file.
#include "gatefly/tasks/smoothing/learnt_map.hpp"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/config/track_file.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/tasks/smoothing/track_with_map.hpp"

#include "support/generators.hpp"
#include "support/matchers.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::smoothing {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using eskf::kPerGate;
using test::IsNear;
using test::normal;

std::vector<eskf::Landmark> three_gates() {
  return {{{5, 0, -1.5}, 0.0, {}}, {{9, 4, -1.5}, 1.5, {}}, {{2, 7, -1.5}, 3.0, {}}};
}

VectorXd prior_variance() {
  VectorXd variance(3 * kPerGate);
  for (int i = 0; i < 3; ++i)
    variance.segment<kPerGate>(kPerGate * i) = prior_of(eskf::Landmark{}, {}).cwiseAbs2();
  return variance;
}

// A flight that measured each gate with a sigma of `by`, in metres, radians and parts alike.
FlightMap flight_with(const VectorXd& truth, double by, Rng* rng = nullptr) {
  const VectorXd prior = prior_variance();
  VectorXd measured = truth;
  if (rng != nullptr)
    for (double& one : measured) one += by * normal(*rng);
  const VectorXd P = (prior.cwiseInverse().array() + 1.0 / (by * by)).inverse();
  return {three_gates(), P.cwiseProduct(measured) / (by * by), P.asDiagonal(),
          std::vector<bool>(3, true)};
}

// All gates moved by (0.3, -0.2) m and turned by 2° about their middle.
VectorXd moved_as_a_whole() {
  const auto gates = three_gates();
  const Eigen::Vector2d middle{16.0 / 3, 11.0 / 3};
  const double turn = 2.0 * kDegree;
  VectorXd errors = VectorXd::Zero(3 * kPerGate);
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector2d arm = gates[static_cast<std::size_t>(i)].p_EG.head<2>() - middle;
    errors.segment<2>(kPerGate * i) << 0.3 - turn * arm.y(), -0.2 + turn * arm.x();
    errors(kPerGate * i + eskf::kGateYaw) = turn;
  }
  return errors;
}

TEST(LearntMap, FourFlightsThatSayTheSameAreTwiceAsSure) {
  VectorXd truth = VectorXd::Zero(3 * kPerGate);
  truth(2) = 0.06;  // the first gate hangs lower: nothing that all have in common
  const FlightMap one = flight_with(truth, 0.05);
  const std::vector<FlightMap> four(4, one);
  const LearntMap by_one = fused({&one, 1}, {}), by_four = fused(four, {});
  // The map's own word counts once, not four times.
  const double prior = std::pow(eskf::Priors{}.map_height, -2), each = std::pow(0.05, -2);
  EXPECT_NEAR(by_one.gates[0].sigmas(2), 1.0 / std::sqrt(prior + each), 1e-9);
  EXPECT_NEAR(by_four.gates[0].sigmas(2), 1.0 / std::sqrt(prior + 4 * each), 1e-9);
  EXPECT_NEAR(by_four.gates[0].belief.p_EG.z(), -1.5 + 0.06 * 4 * each / (prior + 4 * each), 1e-9);
}

TEST(LearntMap, WhereTheCourseStandsAsAWholeStaysAsTheMapHasIt) {
  const FlightMap flight = flight_with(moved_as_a_whole(), 0.001);
  const LearntMap map = fused({&flight, 1}, {});
  const auto before = three_gates();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_THAT(map.gates[i].belief.p_EG, IsNear(before[i].p_EG, 1e-3));
    EXPECT_NEAR(map.gates[i].belief.yaw_EG, before[i].yaw_EG, 1e-3);
  }
}

TEST(LearntMap, WhatIsSaidOfEachGateIsAsSureAsItIsRight) {
  Rng rng{5};
  double squares = 0.0;
  int numbers = 0;
  for (int trial = 0; trial < 60; ++trial) {
    VectorXd truth = prior_variance().cwiseSqrt();
    for (double& one : truth) one *= normal(rng);
    const std::vector<FlightMap> flights{flight_with(truth, 0.04, &rng),
                                         flight_with(truth, 0.03, &rng)};
    const LearntMap map = fused(flights, {});
    const MatrixXd keep = without_common(flights[0].gates, prior_variance().cwiseInverse());
    const VectorXd within = keep * truth;
    for (int i = 0; i < 3; ++i) {
      const LearntGate& gate = map.gates[static_cast<std::size_t>(i)];
      const Vector3d off = gate.belief.p_EG - three_gates()[static_cast<std::size_t>(i)].p_EG -
                           within.segment<3>(kPerGate * i);
      for (int axis = 0; axis < 3; ++axis, ++numbers)
        squares += std::pow(off(axis) / gate.sigmas(axis), 2);
    }
  }
  EXPECT_NEAR(squares / numbers, 1.0, 0.2);  // 540 numbers: 0.06
}

TEST(LearntMap, AGateThatWasMovedBetweenFlightsShows) {
  VectorXd moved = VectorXd::Zero(3 * kPerGate);
  moved(0) = 0.6;
  const std::vector<FlightMap> same{flight_with(0.0 * moved, 0.03), flight_with(0.0 * moved, 0.03)};
  const std::vector<FlightMap> other{flight_with(0.0 * moved, 0.03), flight_with(moved, 0.03)};
  EXPECT_LT(fused(same, {}).worst[1], 1.0);
  EXPECT_GT(fused(other, {}).worst[1], 4.0);
}

TEST(LearntMap, ATrackFileOfItIsReadBackWithItsSigmas) {
  const test::TempFolder folder;
  const auto path = folder.path() / "learnt.toml";
  const auto old = config::find_track("showroom");
  const config::TrackFile before = config::read_track(old);
  Track learnt = before.track;
  learnt.gates[2].p_EG += Vector3d{0.1, -0.2, 0.03};
  learnt.gates[2].yaw_EG += 0.05;
  learnt.gates[2].position_sigma = Vector3d{0.02, 0.03, 0.01};
  learnt.gates[2].yaw_sigma = 1.5 * kDegree;
  learnt.gates[2].side_sigma = 0.004;
  std::ofstream{path} << track_file_with(old, learnt, {"out/one", "out/two"});
  const config::TrackFile after = config::read_track(path);
  EXPECT_EQ(after.track.name, before.track.name);
  EXPECT_EQ(after.track.laps, before.track.laps);
  EXPECT_EQ(after.track.obstacles.size(), before.track.obstacles.size());
  EXPECT_EQ(after.world.look, before.world.look);
  const MapGate& gate = after.track.gates[2];
  EXPECT_THAT(gate.p_EG, IsNear(learnt.gates[2].p_EG, 1e-3));
  EXPECT_NEAR(gate.yaw_EG, learnt.gates[2].yaw_EG, 0.01 * kDegree);
  EXPECT_THAT(*gate.position_sigma, IsNear(*learnt.gates[2].position_sigma, 1e-9));
  EXPECT_NEAR(*gate.yaw_sigma, 1.5 * kDegree, 1e-9);
  EXPECT_NEAR(*gate.side_sigma, 0.004, 1e-9);
  EXPECT_FALSE(after.track.gates[1].position_sigma);
}

}  // namespace
}  // namespace gatefly::smoothing
