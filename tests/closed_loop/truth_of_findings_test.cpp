// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/truth_of_findings.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

#include "support/race_setup.hpp"

namespace gatefly::simulated_race {
namespace {

TruthOfFindings truth_with(const world::Faults& faults, const std::string& level = "none") {
  const RaceConfig race = test::race_on("showroom", 1001, 1, {}, level, faults);
  return truth_of_findings(race.sim, race.pilot);
}

TEST(TruthOfFindings, IsNothingWhereAllIsAsTold) {
  const TruthOfFindings truth = truth_with({});
  for (const double off :
       {truth.tilt, truth.pan, truth.roll, truth.center_as_tilt, truth.center_as_pan, truth.latency,
        truth.latency_jitter, truth.focal, truth.start_heading, truth.hover_thrust - 1.0})
    EXPECT_NEAR(off, 0.0, 1e-9);
  EXPECT_EQ(truth.moved_gate, 0);
}

TEST(TruthOfFindings, NamesEveryFaultWithItsSignAndSize) {
  const world::Faults faults{.camera_delay = -0.020,
                             .camera_tilt = 5 * kDegree,
                             .moved_gate = -1,
                             .start_heading = -5 * kDegree,
                             .hover_thrust = 0.25};
  const TruthOfFindings truth = truth_with(faults);
  EXPECT_NEAR(truth.tilt, 5 * kDegree, 1e-9);
  EXPECT_NEAR(truth.pan, 0.0, 1e-9);
  EXPECT_NEAR(truth.roll, 0.0, 1e-9);
  EXPECT_NEAR(truth.latency, -0.020, 1e-9);
  EXPECT_NEAR(truth.start_heading, -5 * kDegree, 1e-9);
  EXPECT_NEAR(truth.hover_thrust, 0.8, 1e-9);
  EXPECT_GE(truth.moved_gate, 1);
  EXPECT_LE(truth.moved_gate, 5);
}

// The filter sees the direction of a pixel and knows one lens only: where it looks when its own
// camera is turned by what is said, the true camera looks, too.
TEST(TruthOfFindings, ACentreElsewhereIsWorthTheTurnThatShowsTheSame) {
  RaceConfig race = test::race_on("showroom", 1001, 1, {}, "none");
  std::get<DhaneFisheye>(race.sim.camera.lens.model).center_px += Eigen::Vector2d{4.0, -3.0};
  const TruthOfFindings truth = truth_of_findings(race.sim, race.pilot);
  EXPECT_NEAR(truth.tilt, 0.0, 1e-9);
  EXPECT_LT(truth.center_as_pan, -0.02) << "all is farther right than it should be";
  EXPECT_GT(truth.center_as_tilt, 0.015) << "and higher";
  const RotationBC turned = camera_mount(race.sim.camera.tilt_down + truth.center_as_tilt);
  const Eigen::Vector3d ahead_B =
      turned.matrix * rotation_y(truth.center_as_pan) * Eigen::Vector3d{0, 0, 1};
  const Eigen::Vector2d px = std::get<DhaneFisheye>(race.pilot.camera.lens.model).center_px;
  const Eigen::Vector3d really_B =
      camera_mount(race.sim.camera.tilt_down).matrix * *race.sim.camera.lens.bearing(px);
  EXPECT_LT((ahead_B - really_B).norm(), 1e-3);
}

// Dhane's k scales the middle of a picture: a pilot that knows no k finds another focal length.
TEST(TruthOfFindings, AnotherKIsWorthTheFocalLengthThatShowsTheSame) {
  RaceConfig race = test::race_on("showroom", 1001, 1, {}, "none");
  const Eigen::Vector3d beside_axis{0.01, 0.0, 1.0};
  const auto shown = [&] { return *race.sim.camera.lens.project(beside_axis); };
  auto& lens = std::get<DhaneFisheye>(race.sim.camera.lens.model);
  const double before = shown().x() - lens.center_px.x();
  lens.k *= 1.1;
  EXPECT_NEAR(truth_of_findings(race.sim, race.pilot).focal,
              (shown().x() - lens.center_px.x()) / before - 1.0, 1e-4);
}

TEST(TruthOfFindings, SaysWhatTheSeedDrew) {
  const RaceConfig race = test::race_on("showroom", 1001, 1, {}, "race");
  const TruthOfFindings truth = truth_of_findings(race.sim, race.pilot);
  EXPECT_NEAR(truth.latency, race.sim.sensors.camera_latency - 0.030, 1e-9);
  EXPECT_NEAR(truth.latency_jitter, 0.0077, 1e-4);
  EXPECT_NEAR(truth.start_heading, race.sim.start.heading - race.pilot.track.start_heading, 1e-9);
  EXPECT_NEAR(truth.hover_thrust,
              race.sim.vehicle.thrust_coefficient / race.sim.vehicle.mass / (1.72e-6 / 0.42), 1e-9);
}

}  // namespace
}  // namespace gatefly::simulated_race
