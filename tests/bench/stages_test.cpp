// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/bench/flight_stages.hpp"
#include "gatefly/bench/opencv_baseline.hpp"
#include "gatefly/bench/pose_stages.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::bench {
namespace {

#ifdef __SANITIZE_ADDRESS__
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

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

double median(const std::vector<Stage>& stages, const std::vector<Cost>& costs,
              const std::string& name) {
  const Stage* stage = find(stages, name);
  return stage == nullptr ? 0.0 : costs[static_cast<std::size_t>(stage - stages.data())].median;
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

// 0.27 and 0.16 on this project's machine.
TEST(FlightStages, TheDragFilterCostsLessThanHalfOfTheClassicOne) {
  if (kSanitized) GTEST_SKIP() << "sanitizers have costs of their own";
  std::vector<Stage> stages = flight_stages(hover(), config());
  std::erase_if(stages, [](const Stage& s) { return s.name == "plan" || s.name == "pnp"; });
  const auto costs = measure(stages, 15, [] { return false; });
  ASSERT_GT(median(stages, costs, "correct"), 0.0);
  EXPECT_LT(median(stages, costs, "predict"), 0.5 * median(stages, costs, "predict15"));
  EXPECT_LT(median(stages, costs, "correct"), 0.5 * median(stages, costs, "correct15"));
}

// 0.04 and 0.34 on this project's machine.
TEST(PoseStages, OursCostLessThanOpenCvsQuickest) {
  if (kSanitized) GTEST_SKIP() << "sanitizers have costs of their own";
  if (!has_opencv()) GTEST_SKIP() << "built without OpenCV";
  const auto stages = pose_stages();
  const auto costs = measure(stages, 3, [] { return false; });
  EXPECT_LT(median(stages, costs, "rays"), 0.2 * median(stages, costs, "p3p"));
  EXPECT_LT(median(stages, costs, "map"), median(stages, costs, "ippe_square"));
}

}  // namespace
}  // namespace gatefly::bench
