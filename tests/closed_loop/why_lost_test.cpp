// SPDX-License-Identifier: Apache-2.0
// Errors of one kind are planted; the attribution has to name that kind.
#include "gatefly/simulated_race/closed_loop/why_lost.hpp"

#include <cmath>
#include <string>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/simulated_race/closed_loop/error_ledger.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"

#include "support/race_setup.hpp"

namespace gatefly::simulated_race {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A filter of the position alone, wrong in ways that are planted.
struct PlantedFlight {
  Vector3d truth{0, 0, -1.5}, believed{0, 0, -1.5}, map_shift = Vector3d::Zero();
  Matrix3d P = 1e-4 * Matrix3d::Identity();
  ErrorLedger ledger;

  void tick(const Vector3d& drift) {
    truth += drift;
    P += 1e-4 * Matrix3d::Identity();
    ledger.add({truth, believed, P, map_shift});
  }
  /// A fix of the target as it stands, wrong by `error`.
  void see(const Vector3d& error, double sigma) {
    const Vector3d fix = truth + map_shift - error;
    const Matrix3d R = sigma * sigma * Matrix3d::Identity();
    const Matrix3d K = P * (P + R).inverse();
    believed += K * (fix - believed);
    P = (Matrix3d::Identity() - K) * P;
    ledger.add({truth, believed, P, map_shift, ErrorLedger::Fix{fix, R}});
  }
  [[nodiscard]] Vector3d error() const { return truth + map_shift - believed; }
  [[nodiscard]] Vector3d sum() const {
    return ledger.estimate() + ledger.detection() + ledger.map();
  }
};

void expect_near(const Vector3d& a, const Vector3d& b, double tolerance, const char* what) {
  EXPECT_LT((a - b).norm(), tolerance) << what << ": " << a.transpose() << " | " << b.transpose();
}

TEST(ErrorLedger, WhatDriftsInWithoutAFixIsTheEstimates) {
  PlantedFlight flight;
  for (int i = 0; i < 100; ++i) flight.tick({0, 0.002, 0});
  expect_near(flight.ledger.estimate(), {0, 0.2, 0}, 1e-12, "estimate");
  expect_near(flight.ledger.map(), {0, 0, 0}, 1e-12, "map");
  expect_near(flight.ledger.detection(), {0, 0, 0}, 1e-12, "detection");
}

TEST(ErrorLedger, ADriftThatRightFixesOnlyHoldDownStaysTheEstimates) {
  PlantedFlight flight;
  for (int i = 0; i < 200; ++i) {
    flight.tick({0, 0.01, 0});
    flight.see({0, 0, 0}, 0.2);
  }
  EXPECT_GT(flight.error().y(), 0.02) << "a drift that shows";
  expect_near(flight.ledger.estimate(), flight.error(), 1e-9, "estimate");
  EXPECT_EQ(flight.ledger.fix_error()->norm(), 0.0);
}

TEST(ErrorLedger, AGateThatStandsElsewhereIsTheMapsUntilItIsSeen) {
  PlantedFlight flight;
  flight.tick({0, 0, 0});
  flight.map_shift = {0, 0.15, -0.05};  // the next gate
  flight.tick({0, 0, 0});
  expect_near(flight.ledger.map(), {0, 0.15, -0.05}, 1e-12, "map, unseen");
  expect_near(flight.ledger.estimate(), {0, 0, 0}, 1e-12, "estimate, unseen");
  for (int i = 0; i < 100; ++i) flight.see({0, 0, 0}, 0.01);
  EXPECT_LT(flight.ledger.map().norm(), 0.01) << "seen";
  expect_near(flight.ledger.estimate(), {0, 0, 0}, 1e-9, "estimate, seen");
  flight.map_shift = {0, 0, 0};  // and on to one that stands right: now the way there is wrong
  flight.tick({0, 0, 0});
  EXPECT_NEAR(flight.ledger.map().y(), -0.15, 0.01);
}

TEST(ErrorLedger, WhatFixesAreWrongByIsDetections) {
  PlantedFlight flight;
  for (int i = 0; i < 300; ++i) {
    flight.tick({0, 0, 0});
    flight.see({0.02, 0.12, 0}, 0.05);
  }
  expect_near(flight.ledger.detection(), {0.02, 0.12, 0}, 0.002, "detection");
  expect_near(flight.ledger.estimate(), {0, 0, 0}, 1e-9, "estimate");
  expect_near(*flight.ledger.fix_error(), {0.02, 0.12, 0}, 1e-9, "the fix itself");
}

TEST(ErrorLedger, AFilterThatBeginsAnewAtAWrongFixHasItsErrorAlone) {
  PlantedFlight flight;
  for (int i = 0; i < 100; ++i) flight.tick({0, 0.01, 0});
  flight.believed = flight.truth - Vector3d{0, -0.4, 0.1};
  flight.ledger.add({flight.truth,
                     flight.believed,
                     flight.P,
                     {0, 0, 0},
                     ErrorLedger::Fix{flight.believed, flight.P, true, true}});
  expect_near(flight.ledger.detection(), {0, -0.4, 0.1}, 1e-12, "detection");
  expect_near(flight.ledger.estimate(), {0, 0, 0}, 1e-12, "estimate");
}

TEST(ErrorLedger, AFixWithoutHeightLeavesTheHeightsErrorsAlone) {
  PlantedFlight flight;
  for (int i = 0; i < 100; ++i) flight.tick({0, 0, 0.001});
  const Vector3d wrong = flight.truth - Vector3d{0.3, 0, 5.0};
  flight.believed.x() = wrong.x();
  flight.ledger.add({flight.truth,
                     flight.believed,
                     flight.P,
                     {0, 0, 0},
                     ErrorLedger::Fix{wrong, 1e-12 * Matrix3d::Identity(), false, false}});
  expect_near(flight.ledger.detection(), {0.3, 0, 0}, 1e-6, "detection");
  expect_near(flight.ledger.estimate(), {0, 0, 0.1}, 1e-6, "estimate");
}

TEST(ErrorLedger, TheThreeAddUpToTheErrorWhateverHappens) {
  sim::Stream stream{1, "ledger"};
  const auto any = [&](double size) {
    return Vector3d{size * Vector3d{stream.normal(), stream.normal(), stream.normal()}};
  };
  PlantedFlight flight;
  for (int i = 0; i < 1000; ++i) {
    if (i % 100 == 0) flight.map_shift = any(0.2);
    flight.tick(any(0.01));
    if (i % 7 == 0) flight.see(any(0.1), 0.1);
    if (i % 31 == 0) flight.believed += any(0.1);  // whatever else a filter does
    if (i % 31 == 0) flight.tick(any(0.01));
    expect_near(flight.sum(), flight.error(), 1e-9, "sum");
  }
}

/// One gate that the map has 10 cm too far to the left and 3° turned, at the end of a straight.
struct OneGate {
  OneGate() {
    const double yaw = 0.7;
    gate_yaw = yaw;
    const Matrix3d R = rotation_z(yaw);
    const Vector3d p{4, 2, -1.5};
    world.gates = {{.p_EG = p, .yaw_EG = yaw}};
    map.gates = {{.p_EG = p + R * Vector3d{0, -0.10, 0}, .yaw_EG = yaw - 0.05}};
    const Vector3d from = map.gates[0].p_EG - rotation_z(yaw - 0.05) * Vector3d{4, 0, 0};
    (void)plan.start.segments.push_back(
        {.start = from.head<2>(), .heading = yaw - 0.05, .curvature = 0.0, .length = 4.0});
    (void)plan.start.levels.push_back({0.0, -1.5});
  }
  /// A drone there in the gate's own axes, whose error is told apart, in those axes too.
  [[nodiscard]] LossMoment at(const Vector3d& true_G, const Vector3d& estimate_G,
                              const Vector3d& map_G, const Vector3d& detection_G) const {
    const Matrix3d R = rotation_z(gate_yaw);
    const Vector3d shift = map.gates[0].p_EG - world.gates[0].p_EG;
    LossMoment now;
    now.true_p_EB = world.gates[0].p_EG + R * true_G;
    now.estimate = R * estimate_G, now.map = R * map_G, now.detection = R * detection_G;
    now.p_EB = now.true_p_EB + shift - now.estimate - now.map - now.detection;
    return now;
  }
  [[nodiscard]] WhyLost why(const LossMoment& now, WhyLost::How how,
                            const std::string& object) const {
    return why_lost(now, {world, map, plan}, how, object);
  }
  world::World world;
  Track map;
  RacePlan plan;
  double gate_yaw;
};

TEST(WhyLost, AMissAtAGateIsFromItsTrueMiddleAndAddsUp) {
  const OneGate course;
  const LossMoment now =
      course.at({-0.2, 0.21, 0.04}, {0.05, 0.17, 0.01}, {0, 0.01, 0}, {0.01, -0.02, 0.02});
  const WhyLost why = course.why(now, WhyLost::How::kContact, "gate 1 right bar");
  EXPECT_TRUE(why.from_gate);
  EXPECT_TRUE(why.at_its_gate);
  EXPECT_EQ(why.object, "right bar of gate 1");
  EXPECT_NEAR(why.miss.y(), 0.21, 1e-12);
  EXPECT_NEAR(why.miss.z(), 0.04, 1e-12);
  expect_near(why.estimate, {0.05, 0.17, 0.01}, 1e-12, "estimate");
  EXPECT_NEAR(why.guidance.y(), 0.21 - 0.17 - 0.01 + 0.02, 1e-12);
  EXPECT_EQ(why.cause, WhyLost::Cause::kEstimate);
  double sum = 0.0;
  for (const double share : why.shares) sum += share;
  EXPECT_NEAR(sum, std::hypot(0.21, 0.04), 1e-12);
}

TEST(WhyLost, EachPlantedErrorIsTheCause) {
  const OneGate course;
  const Vector3d off{0, 0.3, 0}, none = Vector3d::Zero();
  const auto cause = [&](const LossMoment& now) {
    return course.why(now, WhyLost::How::kContact, "gate 1 right bar").cause;
  };
  EXPECT_EQ(cause(course.at(off, off, none, none)), WhyLost::Cause::kEstimate);
  EXPECT_EQ(cause(course.at(off, none, off, none)), WhyLost::Cause::kMap);
  EXPECT_EQ(cause(course.at(off, none, none, off)), WhyLost::Cause::kDetection);
  EXPECT_EQ(cause(course.at(off, none, none, none)), WhyLost::Cause::kGuidance);
}

TEST(WhyLost, AWallIsMissedFromThePlannedWay) {
  const OneGate course;
  // 1.5 m before the gate, 0.6 m to the left of its axis, and the drone believes to be on its way.
  const Vector3d true_G{-1.5, -0.6, 0.0};
  LossMoment now = course.at(true_G, {0, -0.4, 0}, {0, 0, 0}, {0, 0, 0});
  const WhyLost why = course.why(now, WhyLost::How::kContact, "west wall");
  EXPECT_FALSE(why.from_gate);
  EXPECT_EQ(why.object, "west wall");
  EXPECT_NEAR(why.estimate.y(), -0.4, 0.01);
  EXPECT_NEAR(why.map.y(), 0.10, 0.01) << "seen, the gate pulls the drone to where it stands";
  const Vector3d sum = why.estimate + why.guidance + why.map + why.detection;
  expect_near(sum, why.miss, 1e-12, "sum");
  EXPECT_EQ(why.cause, WhyLost::Cause::kEstimate);
}

TEST(WhyLost, WhoStandsInTheWayIsTheCause) {
  const OneGate course;
  const LossMoment near = course.at({-2, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
  EXPECT_EQ(course.why(near, WhyLost::How::kContact, "person 1").cause, WhyLost::Cause::kInTheWay);
  const LossMoment astray = course.at({-2, 0.9, 0}, {0, 0.9, 0}, {0, 0, 0}, {0, 0, 0});
  EXPECT_EQ(course.why(astray, WhyLost::How::kContact, "person 1").cause,
            WhyLost::Cause::kEstimate);
}

TEST(WhyLost, BeforeTakeOffTheAimIsThePad) {
  OneGate course;
  course.map.start = {0, 0}, course.map.start_heading = 0.0;
  LossMoment now = course.at({-4.5, 0, 0}, {0, 0, 0}, {0, 0.1, 0}, {0, 0, 0});
  now.flying = LossMoment::Flying::kTakeOff;
  now.p_EB = {0.05, 0.30, -0.4};
  now.true_p_EB = {0.05, 0.50, -0.4};
  now.estimate = {0, 0.2, 0};
  now.map = course.map.gates[0].p_EG - course.world.gates[0].p_EG;
  now.detection = {0, 0, 0};
  const WhyLost why = course.why(now, WhyLost::How::kContact, "obstacle 1");
  expect_near(why.miss, {0.05, 0.5, 0}, 1e-12, "miss");
  expect_near(why.guidance, {0.05, 0.3, 0}, 1e-12, "guidance");
  expect_near(why.map, {0, 0, 0}, 1e-12, "map");
}

TEST(WhyLost, ASearchThatDoesNotFindWhatIsInViewIsDetections) {
  const OneGate course;
  LossMoment now = course.at({-2.2, 0.6, 0}, {0, 0.6, 0}, {0, 0, 0}, {0, 0, 0});
  now.flying = LossMoment::Flying::kSearch, now.wait_x = -2.2;
  EXPECT_EQ(course.why(now, WhyLost::How::kNotFound, "").cause, WhyLost::Cause::kEstimate);
  now.looks = {.pictures = 200, .gate_in_view = 40, .gate_found = 0};
  EXPECT_EQ(course.why(now, WhyLost::How::kNotFound, "").cause, WhyLost::Cause::kDetection);
}

TEST(Named, ThingsAreCalledAsAPersonCallsThem) {
  world::World world;
  world.obstacles = {world::WorldBox{}, world::WorldBox{.pole = true}};
  EXPECT_EQ(named("gate 4 left bar", world), "left bar of gate 4");
  EXPECT_EQ(named("false gate 2 pole", world), "pole of false gate 2");
  EXPECT_EQ(named("obstacle 2", world), "obstacle 2 (a pole)");
  EXPECT_EQ(named("obstacle 1", world), "obstacle 1 (a box)");
  EXPECT_EQ(named("east wall", world), "east wall");
  EXPECT_EQ(named("person 1", world), "person 1");
}

// Whole races on the level that varies nothing: the one error is the planted one.

RaceConfig flawless(const std::string& track) {
  RaceConfig race = test::race_on(track, 1, 1, {}, "none");
  race.vision = Vision::kIdeal;
  return race;
}

void expect_sum_is_the_true_miss(const RaceResult& result, const RaceConfig& race,
                                 const Vector3d& true_p_EB) {
  const WhyLost& why = *result.why_lost;
  if (!why.from_gate) return;
  const auto index = static_cast<std::size_t>(why.gate - 1) % race.sim.world.gates.size();
  const world::WorldGate& gate = race.sim.world.gates[index];
  const Vector3d miss = rotation_z(-gate.yaw_EG) * (true_p_EB - gate.p_EG);
  EXPECT_NEAR(why.miss.y(), miss.y(), 1e-9);
  EXPECT_NEAR(why.miss.z(), miss.z(), 1e-9);
}

RaceResult lost(const RaceConfig& race) {
  Vector3d last = Vector3d::Zero();
  const RaceResult result = fly(race, [&](const flight_log::Tick& tick) {
    last = tick.truth.p_EB;
    return true;
  });
  EXPECT_FALSE(result.finished);
  EXPECT_TRUE(result.why_lost.has_value());
  if (result.why_lost && result.why_lost->how == WhyLost::How::kContact)
    expect_sum_is_the_true_miss(result, race, last);
  return result;
}

TEST(WhyLost, AGateThatWasMovedAndIsNotSeenIsTheMaps) {
  RaceConfig race = flawless("oval");
  race.sim.world.gates[0].p_EG +=
      rotation_z(race.sim.world.gates[0].yaw_EG) * Vector3d{0, -0.45, 0};
  race.sim.faults.camera_out = {0.0, 1e3};
  race.pilot.phase.goes_around = false;
  race.pilot.filter_model =
      FilterModel::kDrag;  // blind from the start it comes to gate 1, and touches it
  const RaceResult result = lost(race);
  ASSERT_TRUE(result.why_lost.has_value());
  EXPECT_EQ(result.why_lost->cause, WhyLost::Cause::kMap) << result.crash_object;
  EXPECT_NEAR(result.why_lost->map.y(), 0.45, 0.01) << "it flies to the right of where the gate is";
}

TEST(WhyLost, WindThatNoFixCorrectsIsTheEstimates) {
  RaceConfig race = flawless("oval");
  race.sim.wind.mean = {0.0, 0.6};
  race.sim.faults.camera_out = {0.0, 1e3};
  race.pilot.phase.goes_around = false;
  const RaceResult result = lost(race);
  ASSERT_TRUE(result.why_lost.has_value());
  EXPECT_EQ(result.why_lost->cause, WhyLost::Cause::kEstimate) << result.crash_object;
  EXPECT_NEAR(result.why_lost->wind_mean, 0.6, 1e-6);
  EXPECT_FALSE(result.why_lost->since_fix.has_value());
}

TEST(WhyLost, AFinishedRaceHasNoReason) {
  EXPECT_FALSE(fly(flawless("oval"), {}).why_lost.has_value());
}

TEST(Flight, AfterACrashTheWorldGoesOnWithoutThePilotAndTheResultStays) {
  RaceConfig race = flawless("oval");
  race.sim.wind.mean = {0.0, 0.6};
  race.sim.faults.camera_out = {0.0, 1e3};
  race.pilot.phase.goes_around = false;
  race.pilot.filter_model = FilterModel::kDrag;  // takes the wind for its own motion, and crashes
  Flight flight{race};
  EXPECT_FALSE(flight.fall()) << "it flies";
  while (flight.step()) {
  }
  const RaceResult before = flight.result();
  ASSERT_EQ(before.stop_reason, "crash");
  const double height = -flight.tick().truth.p_EB.z();
  double until = 0.0;
  while (flight.fall()) until = 1e-9 * static_cast<double>(flight.tick().sensors.time.count());
  EXPECT_NEAR(until, *before.crash_time + 1.5, 0.01);
  EXPECT_LT(-flight.tick().truth.p_EB.z(), height - 0.5) << "it falls";
  const RaceResult after = flight.result();
  EXPECT_NEAR(after.flight_time, before.flight_time, 1e-9);
  EXPECT_EQ(after.crash_object, before.crash_object);
  EXPECT_EQ(after.why_lost->miss, before.why_lost->miss);
}

}  // namespace
}  // namespace gatefly::simulated_race
