// SPDX-License-Identifier: Apache-2.0
// Wide gates through the camera of the Grand Prix's drones: cameras/imx477.toml.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/closed_loop/race.hpp"

#include "support/race_setup.hpp"

namespace gatefly::closed_loop {
namespace {

/// As `gatefly fly grandprix --camera imx477`: the pilot knows the track's gates.
RaceConfig imx477_race(const std::string& level = "") {
  const std::vector<std::string> names{"imx477"};
  const io::Config config = io::load_config(io::config_files(names));
  RaceConfig race = test::race_on("grandprix", 1001, 1, names, level);
  const Track track = race.pilot.track;
  race.pilot = io::on_course(config, io::read_track(io::find_track("grandprix"))).pilot;
  race.pilot.track = track;
  return race;
}

TEST(Imx477, IsToldToThePilotAndSimulatedAlike) {
  const RaceConfig race = imx477_race("none");
  const sim::CameraTruth& truth = race.sim.camera;
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

// Rendered pictures cost four times the Bebop's: the first seconds, in which the first gate is seen.
TEST(Imx477, SeesTheFirstGateOnRenderedPictures) {
  RaceConfig race = imx477_race();
  race.timeout = 5.0;
  const RaceResult result = fly(race, {});
  EXPECT_EQ(result.crash_object, "");
  EXPECT_GT(result.frames_with_gate, 20);
  EXPECT_GT(result.true_positives, 10);
}

}  // namespace
}  // namespace gatefly::closed_loop
