// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/lookout.hpp"

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/draw_gate.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector3d;

constexpr double kLookoutDt = 1.0 / 512;
const Imu kStill{Vector3d::Zero(), {0, 0, -9.81}};

/// A drone that hovers 3 m before the first gate of two, and what its eye makes of what it is shown.
struct Watch {
  Watch() : course{track(), {}}, lookout{params()} {
    navigator.start({1, 0, -1.5}, 0.0, frame_of(course.gate()), {0.0, 0.05, 0.06});
    for (int i = 0; i < 512; ++i) navigator.rest(kStill, t += kLookoutDt);
    wait(200);
  }
  static Track track() {
    Track track;
    track.gates = {{{4, 0, -1.5}, 0.0}, {{4, 4, -1.5}, kPi}};
    track.laps = 2;
    return track;
  }
  static LookoutParams params() {
    LookoutParams params;
    params.camera = bebop_rig();
    return params;
  }
  void wait(int ticks) {
    for (int i = 0; i < ticks; ++i) navigator.predict(kStill, t += kLookoutDt);
  }
  /// The target seen as from `off` beside where the drone believes to be; whether that corrected it.
  bool see(const Vector3d& off, double fitness = 1.0) {
    const View view{.p_GB = navigator.state().p_GB + off,
                    .attitude_GB = navigator.state().attitude};
    Sensors sensors;
    sensors.seen.emplace();
    (void)sensors.seen->gates.push_back({*corners_of(1.0, view, bebop_rig()), fitness});
    lookout.look(sensors, true, course, navigator);
    return lookout.sighting().source != Sighting::Source::kNone;
  }

  Course course;
  Lookout lookout;
  Navigator navigator{{}};
  double t = 0.0;
};

TEST(Lookout, AGateWhereTheMapHasOneCorrectsTheNavigator) {
  Watch drone;
  const double sigma = drone.navigator.state().lateral_sigma;
  EXPECT_TRUE(drone.see({0.0, 0.1, 0.0}));
  EXPECT_EQ(drone.lookout.sighting().used, 0);
  EXPECT_EQ(drone.lookout.sighting().nis_dof, 3);
  EXPECT_TRUE(drone.navigator.has_fix());
  EXPECT_LT(drone.navigator.state().lateral_sigma, sigma);
  EXPECT_GT(drone.navigator.state().p_GB.y(), 0.02);
}

TEST(Lookout, APictureIsLookedAtOnlyWhenWanted) {
  Watch drone;
  Canvas canvas{316, 160};
  canvas.draw_gate({.p_GB = {-3, 0, 0}, .attitude_GB = {}}, bebop_rig());
  const auto bytes = canvas.uyvy();
  Sensors sensors;
  sensors.image = Image{bytes.data(), PixelFormat::kUyvy, 316, 160};
  drone.lookout.look(sensors, false, drone.course, drone.navigator);
  EXPECT_FALSE(drone.lookout.sighting().seen);
  drone.lookout.look(sensors, true, drone.course, drone.navigator);
  EXPECT_TRUE(drone.lookout.sighting().seen);
  EXPECT_EQ(drone.lookout.sighting().source, Sighting::Source::kCorners);
}

TEST(Lookout, NothingArrivedLeavesTheLastSightingButSeesNothing) {
  Watch drone;
  ASSERT_TRUE(drone.see(Vector3d::Zero()));
  drone.lookout.look({}, true, drone.course, drone.navigator);
  EXPECT_FALSE(drone.lookout.sighting().seen);
  EXPECT_EQ(drone.lookout.sighting().source, Sighting::Source::kCorners);
  Sensors broken;
  broken.image = Image{};
  drone.lookout.look(broken, true, drone.course, drone.navigator);
  EXPECT_EQ(drone.lookout.sighting().source, Sighting::Source::kNone);
}

// A gate that stands where the map has the other one, seen from behind: no fix of the target.
TEST(Lookout, AnotherGateOfTheMapIsNotTheTarget) {
  Watch drone;
  const MapGate& other = drone.course.track().gates[1];
  drone.navigator.start({2, 4, -1.5}, 0.0, frame_of(drone.course.gate()), {0.0, 0.05, 0.06});
  for (int i = 0; i < 512; ++i) drone.navigator.rest(kStill, drone.t += kLookoutDt);
  drone.wait(200);
  const View view{.p_GB = drone.navigator.p_EB() - other.p_EG, .attitude_GB = {}};
  Sensors sensors;
  sensors.seen.emplace();
  (void)sensors.seen->gates.push_back({*corners_of(1.0, view, bebop_rig()), 1.0});
  drone.lookout.look(sensors, true, drone.course, drone.navigator);
  EXPECT_TRUE(drone.lookout.sighting().seen);
  EXPECT_FALSE(drone.lookout.sighting().offered);
}

TEST(Lookout, WhatIsLittleSureCountsOnlyWhereAGateIsExpected) {
  Watch drone;
  ASSERT_TRUE(drone.see(Vector3d::Zero()));
  drone.wait(34);
  EXPECT_TRUE(drone.see({0.05, 0, 0}, 0.5));
  drone.wait(34);
  EXPECT_FALSE(drone.see({0.6, 0, 0}, 0.5));
}

// After a blind leg one sighting aside waits for a second that agrees.
TEST(Lookout, AfterABlindLegTwoSightingsHaveToAgree) {
  for (const double second : {0.4, -0.4}) {
    Watch drone;
    ASSERT_TRUE(drone.see(Vector3d::Zero()));
    drone.wait(600);
    EXPECT_FALSE(drone.see({0, 0.4, 0}));
    drone.wait(34);
    EXPECT_EQ(drone.see({0, second, 0}), second == 0.4);
  }
}

// Too near for a whole gate: the side bars are enough.
TEST(Lookout, SideBarsCorrectUpClose) {
  Watch drone;
  drone.navigator.start({2.6, 0, -1.5}, 0.0, frame_of(drone.course.gate()), {0.0, 0.05, 0.06});
  for (int i = 0; i < 512; ++i) drone.navigator.rest(kStill, drone.t += kLookoutDt);
  drone.wait(100);
  const View view{.p_GB = drone.navigator.state().p_GB, .attitude_GB = {}};
  const Quad middle = *corners_of(0.95, view, bebop_rig());
  Sensors sensors;
  sensors.seen.emplace();
  sensors.seen->bars = GateBars{0.5 * (middle[0] + middle[3]), 0.5 * (middle[1] + middle[2])};
  drone.lookout.look(sensors, true, drone.course, drone.navigator);
  EXPECT_EQ(drone.lookout.sighting().source, Sighting::Source::kBars);
  EXPECT_EQ(drone.lookout.sighting().nis_dof, 2) << "bars tell no height";
  EXPECT_NEAR(drone.navigator.state().p_GB.x(), -1.4, 0.1);
}

}  // namespace
}  // namespace gatefly
