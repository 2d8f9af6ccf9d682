// SPDX-License-Identifier: Apache-2.0
// Wide gates through the camera of the Grand Prix's drones, cameras/imx477.toml, and the course of its
// physical qualifier, tracks/aigp-pq.toml, by the drone that flew it, vehicles/archer-b2.toml.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"

#include "support/race_setup.hpp"

namespace gatefly::simulated_race {
namespace {

/// As `gatefly fly TRACK --config NAME...`, one lap: the pilot knows the track's gates.
RaceConfig race_with(const std::string& track_name, const std::vector<std::string>& names,
                     std::uint64_t seed, const std::string& level = "") {
  const config::Config config = config::load_config(config::config_files(names));
  RaceConfig race = test::race_on(track_name, seed, 1, names, level);
  const Track track = race.pilot.track;
  race.pilot = config::on_course(config, config::read_track(config::find_track(track_name))).pilot;
  race.pilot.track = track;
  return race;
}

RaceConfig imx477_race(const std::string& level = "") {
  return race_with("grandprix", {"imx477"}, 1001, level);
}

RaceConfig qualifier(std::uint64_t seed, const std::string& level = "") {
  return race_with("aigp-pq", {"cameras/imx477.toml", "vehicles/archer-b2.toml"}, seed, level);
}

TEST(Imx477, IsToldToThePilotAndSimulatedAlike) {
  const RaceConfig race = imx477_race("none");
  const world::CameraTruth& truth = race.sim.camera;
  EXPECT_EQ(truth.width(), 640);
  EXPECT_EQ(truth.height(), 360);
  EXPECT_DOUBLE_EQ(truth.p_BC.x(), 0.12);
  EXPECT_DOUBLE_EQ(truth.p_BC.y(), 0.02);
  EXPECT_TRUE(race.pilot.camera.p_BC.isApprox(truth.p_BC));
  const Eigen::Vector3d corner{0.7, 0.4, 1.0};  // near the picture's corner
  const auto drawn = truth.lens.project(corner), told = race.pilot.camera.lens.project(corner);
  ASSERT_TRUE(drawn && told);
  EXPECT_LT((*drawn - *told).norm(), 1e-9);
  EXPECT_GT((*drawn - Eigen::Vector2d(322 + 425 * 0.7, 168 + 425 * 0.4)).norm(), 1.0) << "bent";
}

TEST(Imx477, FliesALapOfTheGrandPrixOnIdealVision) {
  RaceConfig race = imx477_race();
  race.vision = Vision::kIdeal;
  const RaceResult result = fly(race, {});
  EXPECT_TRUE(result.finished) << result.stop_reason << ' ' << result.crash_object;
  EXPECT_EQ(result.gates_passed, 4);
}

// Rendered pictures cost four times the Bebop's: half a lap, near gates of which only upper corners are in
// view, and the turn behind the second one not.
TEST(Imx477, FliesThroughTwoWideGatesOnRenderedPictures) {
  RaceConfig race = imx477_race();
  race.timeout = 16.0;
  const RaceResult result = fly(race, {});
  EXPECT_EQ(result.crash_object, "");
  EXPECT_GE(result.gates_passed, 2);
  EXPECT_GT(result.true_positives, 20);
}

// The organisers' table: feet from the boundary's top left corner, y down the map, 85 x 165 feet.
TEST(Qualifier, GatesStandWhereTheOrganisersTableHasThem) {
  constexpr double kFoot = 0.3048;
  const Track track = config::read_track(config::find_track("aigp-pq")).track;
  ASSERT_EQ(track.gates.size(), 11u);
  EXPECT_EQ(track.laps, 2);
  const MapGate &third = track.gates[2], &upper = track.gates[8], &lower = track.gates[9];
  EXPECT_NEAR(third.p_EG.x(), -17.0 * kFoot, 0.006);
  EXPECT_NEAR(third.p_EG.y(), 40.0 * kFoot, 0.006);
  EXPECT_NEAR(third.yaw_EG, kPi / 2, 1e-9) << "to the right on the map: east";
  EXPECT_EQ(upper.p_EG.head<2>(), lower.p_EG.head<2>());
  EXPECT_NEAR(std::abs(wrap_angle(upper.yaw_EG - lower.yaw_EG)), kPi, 1e-9);
  EXPECT_NEAR(track.gates[0].p_EG.x() - track.start.x(), 7.4, 0.01);
  for (const MapGate& gate : track.gates) {
    EXPECT_EQ(gate.side, 2.7);
    EXPECT_NEAR(gate.side - 2 * gate.bar, 1.5, 1e-12);
    EXPECT_GE(-gate.p_EG.z(), 1.35 - 1e-9) << "stands on the floor, or higher";
    EXPECT_LT(gate.p_EG.y(), 85 * kFoot);
    EXPECT_GT(gate.p_EG.x(), -165 * kFoot);
  }
}

// Up to the stacked gate's upper opening, behind it down, and back through the lower one; what nobody has
// measured of drone and course is drawn wide, so that one of four may be lost.
TEST(Qualifier, LapsAreFlownOnIdealVision) {
  int finished = 0;
  for (const std::uint64_t seed : {1101u, 1102u, 1103u, 1104u}) {
    RaceConfig race = qualifier(seed);
    race.vision = Vision::kIdeal;
    const RaceResult result = fly(race, {});
    finished += result.finished;
    EXPECT_TRUE(!result.finished || result.gates_passed == 11);
  }
  EXPECT_GE(finished, 3);
}

// With pictures, an autopilot in between and no heights, in wind: a lap and the gate after it, where what
// the map and the first lap say of that gate meets. Disabled because
// it computes for three minutes: the test qualifier_with_pictures of --full runs it.
TEST(Qualifier, DISABLED_ALapAndTheNextGateAreFlownOnRenderedPictures) {
  for (const std::uint64_t seed : {1301u, 1302u}) {
    RaceConfig race = race_with(
        "aigp-pq", {"betaflight", "cameras/imx477.toml", "vehicles/archer-b2.toml"}, seed);
    race.pilot.track.laps = 2;
    race.timeout = 95.0;
    const RaceResult result = fly(race, {});
    EXPECT_EQ(result.crash_object, "") << seed;
    EXPECT_GE(result.gates_passed, 12) << seed << ' ' << result.stop_reason;
  }
}

// tracks/wide.toml, made for vehicles/racer.toml and cameras/grandprix.toml, at 5 m/s.
RaceConfig wide_race(std::uint64_t seed) {
  const std::vector<std::string> names{"vehicles/racer.toml", "cameras/grandprix.toml"};
  RaceConfig race = race_with("wide", names, seed);
  race.pilot.plan.speed = 5.0;
  race.pilot.plan.max_lateral = 7.0;
  return race;
}

TEST(Wide, ALapIsFlownAtFiveMetresASecondOnIdealVision) {
  RaceConfig race = wide_race(1101);
  race.vision = Vision::kIdeal;
  const RaceResult result = fly(race, {});
  EXPECT_TRUE(result.finished) << result.stop_reason << ' ' << result.crash_object;
  EXPECT_EQ(result.gates_passed, 8);
  EXPECT_GT(result.mean_speed, 4.2) << "from rest";
}

// Half a lap, as above.
TEST(Wide, FourGatesArePassedOnRenderedPictures) {
  RaceConfig race = wide_race(1101);
  race.timeout = 16.0;
  const RaceResult result = fly(race, {});
  EXPECT_EQ(result.crash_object, "");
  EXPECT_GE(result.gates_passed, 4);
}

}  // namespace
}  // namespace gatefly::simulated_race
