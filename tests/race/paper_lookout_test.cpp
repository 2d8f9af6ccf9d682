// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/paper/paper_lookout.hpp"

#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/draw_gate.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector3d;

constexpr double kPaperTick = 1.0 / 512;
const Imu kPaperStill{Vector3d::Zero(), {0, 0, -9.81}};

/// A drone with the paper's filter that believes to be before the first gate of an oval.
struct PaperWatch {
  explicit PaperWatch(double x = -3.0) : course{Course::by_exits(track())}, lookout{params()} {
    navigator.start({6.0 + x, 0, -1.5}, 0.0, frame_of(course.gate()));
    for (int i = 0; i < 100; ++i) navigator.rest(kPaperStill, t += kPaperTick);
    for (int i = 0; i < 100; ++i) navigator.predict(kPaperStill, t += kPaperTick);
  }
  static NavigatorParams filter() {
    NavigatorParams params;
    params.use = use_of_paper();
    params.filter.gate_sigma = 100.0;
    params.filter.start_sigma = {1.0, 1.0, 0.05};
    return params;
  }
  static Track track() {
    Track track;
    const GateExit exit{.run = 0.5, .angle = kPi, .radius = 1.5};
    track.gates = {{.p_EG = {6, 0, -1.5}, .yaw_EG = 0.0, .exit = exit},
                   {.p_EG = {0, 3, -1.5}, .yaw_EG = kPi, .exit = exit}};
    track.laps = 2;
    return track;
  }
  static LookoutParams params() {
    LookoutParams params;
    params.camera = bebop_rig();
    params.pose.max_distance = 100.0;
    return params;
  }
  static GateDetection seen_from(const Vector3d& p_GB, double fitness = 1.0) {
    return {*corners_of(1.0, {.p_GB = p_GB, .attitude_GB = {}}, bebop_rig()), fitness};
  }
  /// The filter's use of it.
  Sighting::Source see(const std::vector<GateDetection>& gates,
                       const std::optional<GateBars>& bars = std::nullopt) {
    Sensors sensors;
    sensors.seen.emplace();
    for (const auto& gate : gates) (void)sensors.seen->gates.push_back(gate);
    sensors.seen->bars = bars;
    lookout.look(sensors, true, course, navigator);
    return lookout.sighting().source;
  }

  Course course;
  PaperLookout lookout;
  Navigator navigator{filter()};
  double t = 0.0;
};

// No innovation gate, no second sighting: a gate 2 m beside is believed at once.
TEST(PaperLookout, BelievesWhateverIsTheBestGate) {
  PaperWatch drone;
  EXPECT_EQ(
      drone.see({PaperWatch::seen_from({-3, 0, 0}, 0.6), PaperWatch::seen_from({-3, 2, 0}, 0.9)}),
      Sighting::Source::kCorners);
  EXPECT_GT(drone.navigator.state().p_GB.y(), 1.5);
}

TEST(PaperLookout, OfEquallyGoodGatesTheOneInTheMiddleCounts) {
  PaperWatch drone;
  EXPECT_EQ(drone.see({PaperWatch::seen_from({-3, 1.2, 0}), PaperWatch::seen_from({-3, 0.1, 0})}),
            Sighting::Source::kCorners);
  EXPECT_LT(drone.navigator.state().p_GB.y(), 0.2);
}

TEST(PaperLookout, NothingFromFartherThanTheLegBegins) {
  PaperWatch drone;  // the leg begins 6 m before the gate
  EXPECT_EQ(drone.see({PaperWatch::seen_from({-8, 0, 0})}), Sighting::Source::kNone);
  EXPECT_EQ(drone.see({PaperWatch::seen_from({-7, 0, 0})}), Sighting::Source::kCorners);
}

TEST(PaperLookout, InTheGateCornersAreNoLongerBelieved) {
  PaperWatch drone{-0.2};
  EXPECT_EQ(drone.see({PaperWatch::seen_from({-3, 0, 0})}), Sighting::Source::kNone);
}

TEST(PaperLookout, SideBarsComeBeforeCornersWhereTheyAreNear) {
  const auto bars = [](double x) {
    const auto px = [&](double y) {
      return *pixel_of({0, y, 0}, {.p_GB = {-x, 0, 0}, .attitude_GB = {}}, bebop_rig());
    };
    return GateBars{px(-0.475), px(0.475)};
  };
  PaperWatch drone{-1.2};
  EXPECT_EQ(drone.see({PaperWatch::seen_from({-3, 0, 0})}, bars(1.2)), Sighting::Source::kBars);
  EXPECT_EQ(drone.lookout.sighting().used, -1);
  EXPECT_NEAR(drone.navigator.state().p_GB.x(), -1.2, 0.1);
  EXPECT_EQ(drone.see({PaperWatch::seen_from({-3, 0, 0})}, bars(2.5)), Sighting::Source::kCorners)
      << "too far for bars";
}

}  // namespace
}  // namespace gatefly
