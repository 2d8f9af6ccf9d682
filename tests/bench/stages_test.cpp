// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/experiments/bench/flight_stages.hpp"
#include "gatefly/experiments/bench/pose_stages.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::bench {
namespace {

PilotConfig config() {
  PilotConfig c;
  c.track.gates = {{{4, 0, -1.5}, 0.0}, {{2, 4, -1.5}, kPi}};
  c.camera = {AnyCamera{Pinhole{}}, camera_mount(20 * kDegree), Eigen::Vector3d::Zero()};
  return c;
}

/// Hovering 2.5 m before a gate.
std::shared_ptr<const RecordedFlight> hover() {
  auto flight = std::make_shared<RecordedFlight>();
  flight->moments.assign(256, {.imu = {.gyro_B = {0.01, 0, 0}, .accel_B = {0.1, 0, -9.81}},
                               .attitude = {},
                               .v_B = Eigen::Vector3d::Zero(),
                               .command = {}});
  const CameraRig rig = config().camera;
  RecordedFlight::Sight sight{.corners_px = {}, .R_GB = {Eigen::Matrix3d::Identity()}};
  const std::array<Eigen::Vector3d, 4> corners{
      {{2.5, -.5, -.5}, {2.5, .5, -.5}, {2.5, .5, .5}, {2.5, -.5, .5}}};
  for (std::size_t i = 0; i < 4; ++i)
    sight.corners_px[i] = *rig.lens.project(rig.R_BC.matrix.transpose() * corners[i]);
  flight->sights.assign(4, sight);
  return flight;
}

TEST(Stages, HaveNamesOfTheirOwnAndBaselinesThatExist) {
  for (const auto& stages : {pose_stages(), flight_stages(hover(), config())}) {
    std::set<std::string> names;
    for (const Stage& stage : stages) {
      EXPECT_TRUE(names.insert(stage.name).second) << stage.name;
      EXPECT_TRUE(stage.baseline.empty() || find(stages, stage.baseline) != nullptr) << stage.name;
      EXPECT_GE(stage.inputs, stage.at_once) << stage.name << " would never be measured";
    }
  }
}

// `gatefly bench` says which stages are compared.
TEST(Stages, AreEachMeasured) {
  for (std::vector<Stage> stages : {pose_stages(), flight_stages(hover(), config())}) {
    std::erase_if(stages, [](const Stage& s) { return s.name == "plan"; });  // it takes seconds
    const auto costs = measure(stages, 1, [] { return false; });
    ASSERT_EQ(costs.size(), stages.size());
    for (std::size_t i = 0; i < costs.size(); ++i) {
      EXPECT_GT(costs[i].median, 0.0) << stages[i].name;
      EXPECT_LE(costs[i].median, costs[i].p99) << stages[i].name;
      EXPECT_LE(costs[i].p99, costs[i].most) << stages[i].name;
    }
  }
}

TEST(Measure, StoppedItEndsAndStillAnswersForEveryStage) {
  int calls = 0;
  const std::vector<Stage> stages{
      {.name = "a", .what = {}, .inputs = 10, .call = [&](std::size_t) { ++calls; }},
      {.name = "b", .what = {}, .inputs = 10, .call = [&](std::size_t) { ++calls; }}};
  EXPECT_EQ(measure(stages, 1, [] { return true; }).size(), 2u);
  EXPECT_EQ(calls, 0);
  EXPECT_EQ(measure(stages, 2, [] { return false; }).size(), 2u);
  EXPECT_EQ(calls, 2 * 10 * 3) << "two rounds and one that does not count";
}

TEST(Measure, AStageIsCalledOnEachOfItsInputsAndWithManyAtOnceOnWholeLots) {
  std::vector<int> calls(10);
  const std::vector<Stage> stages{{.name = "a",
                                   .what = {},
                                   .inputs = 10,
                                   .call = [&](std::size_t i) { ++calls[i]; },
                                   .at_once = 4}};
  (void)measure(stages, 0, [] { return false; });
  EXPECT_EQ(calls, (std::vector{1, 1, 1, 1, 1, 1, 1, 1, 0, 0}));
}

}  // namespace
}  // namespace gatefly::bench
