// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/track_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::config {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const char* const kGate = "[[gates]]\nposition_m = [3.0, 1.0, -1.5]\nheading_deg = 90\n";

TrackFile read(const std::string& content) {
  const test::TempFolder folder;
  return read_track(folder.file("t.toml", content));
}
std::string error_of(const std::string& content) {
  return test::error_of([&] { (void)read(content); });
}

TEST(TrackFile, AnExitTurnsToItsSide) {
  for (const auto& [turn, angle] : {std::pair{"left", -90.0}, {"right", 90.0}}) {
    const TrackFile file = read(std::string{kGate} + "exit = { run_m = 0.1, turn = \"" + turn +
                                "\", angle_deg = 90.0, radius_m = 1.2 }\n");
    ASSERT_TRUE(file.track.gates[0].exit);
    EXPECT_EQ(file.track.gates[0].exit->run, 0.1);
    EXPECT_NEAR(file.track.gates[0].exit->angle, angle * kDegree, 1e-12);
    EXPECT_EQ(file.track.gates[0].exit->radius, 1.2);
  }
}

TEST(TrackFile, PilotAndWorldGetTheSameNominalCourse) {
  const TrackFile file =
      read("name = \"two\"\nlaps = 2\nstart = { position_m = [0.5, -0.5], heading_deg = 10.0 }\n" +
           std::string{kGate} +
           "side_m = 1.4\nbar_m = 0.1\ncolor = [0.1, 0.2, 0.3]\n"
           "[[obstacles]]\nbox_m = [0.3, 0.4, 2.2]\nposition_m = [2.0, -2.0]\nheading_deg = 45\n"
           "[[obstacles]]\npole_m = [0.1, 1.8]\nposition_m = [1.0, 2.0]\n"
           "[room]\nsize_m = [10.0, 12.0, 3.5]\ncenter_m = [1.0, 0.5]\nlook = \"showroom\"\n");
  EXPECT_EQ(file.track.name, "two");
  EXPECT_EQ(file.track.laps, 2);
  EXPECT_EQ(file.track.start, Eigen::Vector2d(0.5, -0.5));
  EXPECT_DOUBLE_EQ(file.start.heading, 10 * kDegree);
  ASSERT_EQ(file.track.gates.size(), 1u);
  EXPECT_FALSE(file.track.gates[0].exit);
  EXPECT_EQ(file.track.gates[0].p_EG, Eigen::Vector3d(3, 1, -1.5));
  EXPECT_DOUBLE_EQ(file.track.gates[0].yaw_EG, kPi / 2);
  EXPECT_EQ(file.world.gates[0].side, 1.4);
  EXPECT_EQ(file.world.gates[0].color, Eigen::Vector3d(0.1, 0.2, 0.3));
  ASSERT_EQ(file.world.obstacles.size(), 2u);
  EXPECT_EQ(file.track.obstacles[0].size, Eigen::Vector2d(0.3, 0.4));
  EXPECT_EQ(file.track.obstacles[0].height, 2.2);
  EXPECT_TRUE(file.world.obstacles[1].pole);
  EXPECT_EQ(file.world.obstacles[1].size, Eigen::Vector2d(0.2, 0.2));  // radius -> diameter
  EXPECT_EQ(file.track.ceiling, 3.5);
  EXPECT_EQ(file.world.look, "showroom");
}

TEST(TrackFile, ReadsTheExampleOfTheContract) {
  const TrackFile file = read(R"(name = "two corners"
laps = 2
start = { position_m = [0.0, 0.0], heading_deg = 0.0 }
[[gates]]
position_m = [6.0, 0.0, -1.5]
heading_deg = 0.0
side_m = 1.0
bar_m = 0.05
color = "orange"
exit = { run_m = 0.1, turn = "left", angle_deg = 90.0, radius_m = 1.0 }
[[obstacles]]
box_m = [0.3, 0.3, 2.2]
position_m = [3.6, -2.3]
heading_deg = 0.0
[room]
size_m = [14.0, 16.0, 3.2]
center_m = [1.5, -6.5]
look = "showroom"
[randomize]
level = "race"
gate_position_m = 0.20
gate_heading_deg = 4.0
start_position_m = 0.10
)");
  EXPECT_DOUBLE_EQ(file.randomize.gate_position, 0.20);
  EXPECT_DOUBLE_EQ(file.randomize.gate_heading, 4 * kDegree);
  EXPECT_GT(file.randomize.gate_height, 0.0);  // from the level
}

TEST(TrackFile, ErrorsNameFileKeyValueAndWhatIsAllowed) {
  const std::string two = std::string{kGate} + kGate + kGate;
  EXPECT_THAT(error_of(two + "side_m = -1\n"),
              AllOf(HasSubstr("t.toml:10: gate 3: side_m = -1, must be in 0.3..5")));
  EXPECT_THAT(error_of("[[gates]]\nposition_m = [3.0, nan, -1.5]\n"),
              HasSubstr("gate 1: position_m = [3, nan, -1.5], must be 3 numbers"));
  EXPECT_THAT(error_of("[[gates]]\nheading_deg = 0\n"), HasSubstr("gate 1: position_m is missing"));
  EXPECT_THAT(error_of(std::string{kGate} + "bar_m = 0.5\n"),
              HasSubstr("bar_m = 0.5, must be less than half"));
  EXPECT_THAT(error_of(std::string{kGate} + "color = \"orang\"\n"),
              HasSubstr("one of orange, red"));
  EXPECT_THAT(error_of(std::string{kGate} + "color = [1, 2, 0]\n"), HasSubstr("gate 1: color"));
  EXPECT_THAT(error_of("laps = 1.5\n" + std::string{kGate}),
              HasSubstr("laps = 1.5, must be a whole number in 1..100"));
  EXPECT_THAT(error_of("laps = 2\n"), HasSubstr("gates is missing"));
  EXPECT_THAT(error_of("gates = 3\n"), HasSubstr("gates = 3"));
  EXPECT_THAT(error_of("gates = [1]\n"), HasSubstr("gate 1 = 1, must be a table"));
  EXPECT_THAT(error_of(std::string{kGate} +
                       "exit = { run_m = 1.0, turn = \"up\", angle_deg = 90, radius_m = 1 }\n"),
              HasSubstr("gate 1: exit.turn = \"up\""));
  EXPECT_THAT(error_of(std::string{kGate} + "[randomize]\nlevel = \"wild\"\n"),
              HasSubstr("randomize.level"));
  EXPECT_THAT(error_of(std::string{kGate} + "[randomize]\ngate_position_m = -0.1\n"),
              HasSubstr("randomize.gate_position_m = -0.1"));
  EXPECT_THAT(error_of(std::string{kGate} + "[room]\nlook = \"cave\"\n"),
              AllOf(HasSubstr("room.look"), HasSubstr("hall, showroom, dark_hall, exhibition")));
  EXPECT_THAT(error_of(std::string{kGate} + "[[obstacles]]\nposition_m = [0, 0]\n"),
              HasSubstr("obstacle 1: box_m is missing"));
}

TEST(TrackFile, UnknownKeysAreRefusedWithTheNearest) {
  EXPECT_THAT(error_of(std::string{kGate} + "sidem = 1\n"),
              AllOf(HasSubstr("gate 1: sidem"), HasSubstr("'side_m'")));
  EXPECT_THAT(error_of("lap = 2\n" + std::string{kGate}), HasSubstr("'laps'"));
  EXPECT_THAT(error_of(std::string{kGate} + "[randomize]\ngate_pos_m = 1\n"),
              HasSubstr("'gate_position_m'"));
}

TEST(TrackFile, RefusesWhatCannotStandInTheRoom) {
  EXPECT_THAT(error_of("[[gates]]\nposition_m = [3.0, 0.0, -0.4]\n"), HasSubstr("lower bar"));
  EXPECT_THAT(error_of("[[gates]]\nposition_m = [3.0, 0.0, -3.0]\n"), HasSubstr("ceiling"));
  EXPECT_THAT(error_of("[[gates]]\nposition_m = [30.0, 0.0, -1.5]\n"),
              HasSubstr("inside the room"));
  EXPECT_THAT(error_of("start = { position_m = [50, 0] }\n" + std::string{kGate}),
              HasSubstr("start.position_m"));
  EXPECT_THAT(
      error_of(std::string{kGate} + "[[obstacles]]\nbox_m = [1, 1, 1]\nposition_m = [6.9, 0]\n"),
      HasSubstr("obstacle 1: position_m"));
}

TEST(TrackFile, BrokenTomlNamesTheLineAndAMissingFileItsName) {
  EXPECT_THAT(error_of("name = \"x\"\nlaps = = 3\n"), HasSubstr("t.toml:2: not valid TOML"));
  EXPECT_THAT(test::error_of([] { (void)read_track("/nowhere/t.toml"); }),
              HasSubstr("/nowhere/t.toml"));
}

TEST(TrackFile, UnknownNamesListTheTracksThereAre) {
  EXPECT_THAT(
      test::error_of([] { (void)find_track("shworoom"); }),
      AllOf(HasSubstr("aigp-pq, darkhall, exhibition, figure8, flights, grandprix, lanes, oval"),
            HasSubstr("did you mean 'showroom'")));
}

TEST(TrackFile, ShowroomHasFiveGatesTwentyThreeBoxesAndThreeLaps) {
  const TrackFile file = read_track(find_track("showroom"));
  EXPECT_EQ(file.track.gates.size(), 5u);
  EXPECT_EQ(file.track.obstacles.size(), 23u);
  EXPECT_EQ(file.track.laps, 3);
}

TEST(TrackFile, OvalHasTwoGatesOnTwoLanes) {
  const TrackFile file = read_track(find_track("oval"));
  ASSERT_EQ(file.track.gates.size(), 2u);
  EXPECT_EQ(file.track.gates[1].p_EG, Eigen::Vector3d(0, 3, -1.4));
}

}  // namespace
}  // namespace gatefly::config
