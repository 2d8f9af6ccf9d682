// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/random_course.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "gatefly/config/course_check.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/race/path.hpp"

namespace gatefly::config {
namespace {

TrackFile course_of(const std::string& text) {
  const std::filesystem::path path =
      std::filesystem::path{testing::TempDir()} / "random_course_test.toml";
  std::ofstream{path} << text;
  return read_track(path);
}

TEST(RandomCourse, TwoHundredAreValidAndPlannedOrRefusedWithTheReason) {
  int planned = 0;
  std::map<std::string, int> refused;
  std::set<std::string> looks;
  std::set<std::size_t> gates;
  int stacked = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const TrackFile course = course_of(random_course(seed));
    for (const std::string& problem : course_problems(course.track)) ADD_FAILURE() << problem;
    looks.insert(course.world.look);
    gates.insert(course.track.gates.size());
    for (std::size_t i = 1; i < course.track.gates.size(); ++i) {
      const Eigen::Vector3d apart = course.track.gates[i].p_EG - course.track.gates[i - 1].p_EG;
      stacked += apart.head<2>().norm() < 0.01 && apart.z() < -1.0 ? 1 : 0;
    }
    try {
      const RacePlan plan = plan_race(course.track, {});
      const std::size_t back = course.track.laps > 1 ? 1 : 0;  // the leg to the next lap
      EXPECT_EQ(plan.legs.size(), course.track.gates.size() - 1 + back);
      ++planned;
    } catch (const std::invalid_argument& reason) {
      const std::string text = reason.what();
      EXPECT_TRUE(text.starts_with("no way from ")) << text;
      EXPECT_NE(text.find(": "), std::string::npos) << text;
      ++refused[text.substr(text.find(": ") + 2)];
    }
  }
  std::cout << "planned " << planned << " of 200\n";
  for (const auto& [reason, count] : refused) std::cout << count << " x " << reason << '\n';
  EXPECT_GE(planned, 190) << "most courses are for flying";
  EXPECT_EQ(looks.size(), 4u);
  EXPECT_GE(stacked, 50) << "a third have one gate above another";
  EXPECT_LE(stacked, 85);
  EXPECT_EQ(gates, (std::set<std::size_t>{6, 7, 8, 9, 10, 11, 12}));
}

TEST(RandomCourse, TheSameSeedGivesTheSameTextAndAnotherAnother) {
  EXPECT_EQ(random_course(7), random_course(7));
  EXPECT_NE(random_course(7), random_course(8));
}

/// One gate at (6, 0) flown north, a start at the origin, a big room.
Track plain() {
  Track track;
  track.gates = {{.p_EG = {6, 0, -1.5}}};
  track.room_size = {20, 20};
  track.ceiling = 4.0;
  return track;
}

std::string only_problem(const Track& track) {
  const auto problems = course_problems(track);
  return problems.size() == 1 ? problems[0] : std::to_string(problems.size()) + " problems";
}

TEST(CourseCheck, NamesWhatIsWrong) {
  EXPECT_TRUE(course_problems(plain()).empty());
  Track track = plain();
  track.gates[0].p_EG.x() = 9.9, track.gates[0].yaw_EG = 1.57;
  EXPECT_EQ(only_problem(track), "gate 1 is too near a wall");
  track = plain();
  track.gates[0].p_EG.z() = -0.5;
  EXPECT_TRUE(course_problems(track).empty()) << "it stands on the floor";
  track.gates[0].p_EG.z() = -0.4;
  EXPECT_EQ(only_problem(track), "gate 1 reaches into the floor");
  track.gates[0].p_EG.z() = -3.6;
  EXPECT_EQ(only_problem(track), "gate 1 reaches the ceiling");
  track = plain();
  track.gates.push_back({.p_EG = {6.0, 1.3, -1.5}});
  EXPECT_EQ(only_problem(track), "gate 1 and gate 2 are too near each other");
  track.gates[1].p_EG = {6.8, 0.2, -1.5};
  EXPECT_EQ(course_problems(track).size(), 2u) << "each in the other's way";
  track.gates[1].p_EG = {6.0, 0.0, -2.5};
  EXPECT_TRUE(course_problems(track).empty()) << "one on top of the other";
  track = plain();
  track.obstacles = {{.center = {5.2, 0.2}, .size = {0.3, 0.3}, .height = 2.0}};
  EXPECT_EQ(only_problem(track), "obstacle 1 stands in the way through gate 1");
  track.obstacles[0].height = 0.8;
  EXPECT_TRUE(course_problems(track).empty()) << "flown over";
  track.obstacles = {{.center = {6.0, 0.7}, .size = {0.3, 0.3}, .height = 0.5}};
  EXPECT_EQ(only_problem(track), "obstacle 1 is too near gate 1");
  track.obstacles = {{.center = {9.9, 5.0}, .size = {0.3, 0.3}, .height = 0.5}};
  EXPECT_EQ(only_problem(track), "obstacle 1 is not inside the room");
  track.obstacles = {{.center = {0.4, 0.0}, .size = {0.3, 0.3}, .height = 0.5}};
  EXPECT_EQ(only_problem(track), "the start is too near obstacle 1");
  track = plain();
  track.start = {-9.8, 0.0};
  EXPECT_EQ(only_problem(track), "the start is too near a wall");
}

}  // namespace
}  // namespace gatefly::config
