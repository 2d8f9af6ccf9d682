// SPDX-License-Identifier: Apache-2.0
// A gate that cannot be seen: wait before it, look around, go on once it is there.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <variant>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/race/pilot.hpp"

#include "support/draw_gate.hpp"

namespace gatefly {
namespace {

using Eigen::Vector3d;

PilotConfig two_gates_apart(FilterModel model, double start_x) {
  PilotConfig c;
  c.filter_model = model;
  c.track.start = {start_x, 0.0};
  c.track.gates = {{{4, 0, -1.5}, 0.0}, {{2, 4, -1.5}, kPi}};
  c.camera = test::bebop_rig();
  return c;
}

/// A pilot whose drone flies as the test says, level, whatever the pilot commands. The
/// accelerometer shows the drag of that speed, by which the pilot knows it.
class LedDrone {
 public:
  /// @param start_x  the first gate stands at 4 m.
  explicit LedDrone(FilterModel model = FilterModel::kDrag, double start_x = 0.0)
      : config{two_gates_apart(model, start_x)}, p_EB_{start_x, 0.0, 0.0} {
    fly({0, 0}, 10.0, [&] { return in<Straight>(); });
    EXPECT_TRUE(in<Straight>()) << name_of(pilot.phase());
  }

  /// For `seconds`, or until `enough` says so.
  void fly(
      const Eigen::Vector2d& v_B, double seconds,
      const std::function<bool()>& enough = [] { return false; }) {
    for (int i = 0; i < static_cast<int>(512 * seconds) && !enough(); ++i, ++tick_) {
      Sensors s;
      s.time = std::chrono::nanoseconds{tick_ * 1'953'125LL};  // 512 Hz
      const Vector3d drag{config.filter.model.drag.x() * v_B.x(),
                          config.filter.model.drag.y() * v_B.y(), 0.0};
      s.imu = {Vector3d::Zero(), drag - Vector3d{0, 0, config.filter.model.gravity}};
      s.imu.gyro_B.x() =
          tick_ % 2 == 0 ? 0.0 : 1e-12;  // no IMU says the same twice while rotors turn
      if (!in<OnGround>()) height_ = std::min(1.5, height_ + 0.8 / 512.0);
      p_EB_ += Vector3d{v_B.x(), v_B.y(), 0.0} / 512.0;
      if (tick_ % 26 == 0) s.sonar = height_;
      if (tick_ % 20 == 0) s.baro = height_;
      const Vector3d moved = -config.camera_timing.latency * Vector3d{v_B.x(), v_B.y(), 0.0};
      if (sees_gate && tick_ % 34 == 0) s.seen = target_gate(moved);
      const double off = tick_ % 68 == 0 ? 1.6 : -1.6;
      if (is_contradicted && tick_ % 34 == 0) s.seen = target_gate(moved + Vector3d{0, off, 0});
      if (sees_bars && tick_ % 34 == 0) s.seen = bars_beside(moved);
      command = pilot.step(s);
    }
  }

  template <class P>
  [[nodiscard]] bool in() const {
    return std::holds_alternative<P>(pilot.phase());
  }
  [[nodiscard]] double x() const { return pilot.estimate().p_GB.x(); }

  PilotConfig config;
  Pilot pilot{config};
  Command command;
  bool sees_gate = false;        ///< Exactly where it shows.
  bool is_contradicted = false;  ///< Now to one side of where it shows, now to the other.
  bool sees_bars =
      false;           ///< Two side bars, as of a gate that stands this far to the right [m] ...
  double aside = 0.0;  ///< ... of the one that is flown to.

 private:
  /// From where the drone was, `moved` from where it is.
  [[nodiscard]] SeenGates target_gate(const Vector3d& moved) const {
    const MapGate& gate = config.track.gates[static_cast<std::size_t>(pilot.target_gate())];
    // No two pictures are alike to the bit.
    const Vector3d p_EB = p_EB_ + moved - Vector3d{0, 0, height_ + (tick_ % 68 == 0 ? 1e-9 : 0.0)};
    const auto corners = test::corners_of(
        gate.side, {rotation_z(-gate.yaw_EG) * (p_EB - gate.p_EG), {0, 0, -gate.yaw_EG}},
        config.camera);
    SeenGates seen;
    if (corners) (void)seen.gates.push_back({*corners, 1.0});
    return seen;
  }

  [[nodiscard]] SeenGates bars_beside(const Vector3d& moved) const {
    const SeenGates whole = target_gate(moved - Vector3d{0, aside, 0});
    SeenGates seen;
    if (whole.gates.empty()) return seen;
    const Quad& at = whole.gates[0].corners_px;
    seen.bars = GateBars{0.5 * (at[0] + at[3]), 0.5 * (at[1] + at[2])};
    return seen;
  }

  long long tick_ = 1;
  double height_ = 0.0;
  Vector3d p_EB_;  ///< Place where it stands, or above which it flies.
};

/// Waited in the air until the pilot no longer knows well enough where it is, then flew on.
LedDrone searching_before_the_first_gate() {
  LedDrone drone;
  drone.fly({0, 0}, 8.0);
  drone.fly({1.0, 0}, 6.0, [&] { return drone.in<Search>(); });
  EXPECT_TRUE(drone.in<Search>()) << name_of(drone.pilot.phase()) << " at " << drone.x();
  return drone;
}

TEST(Search, BeginsBeforeAnUnseenGateWhereThePilotIsUncertain) {
  const LedDrone drone = searching_before_the_first_gate();
  EXPECT_LT(drone.x(), -drone.config.phase.search_until + 0.02);
  EXPECT_GT(drone.x(), -drone.config.phase.search_before - 0.02);
  EXPECT_EQ(drone.pilot.target_gate(), 0);
  EXPECT_EQ(drone.pilot.estimate().gates_passed, 0);
}

TEST(Search, DoesNotBeginWhereTheGateIsSeen) {
  LedDrone drone;
  drone.sees_gate = true;
  drone.fly({0, 0}, 8.0);
  drone.fly({1.0, 0}, 6.0, [&] {
    EXPECT_FALSE(drone.in<Search>()) << "at " << drone.x();
    return drone.pilot.estimate().gates_passed > 0 || ::testing::Test::HasFailure();
  });
  EXPECT_EQ(drone.pilot.estimate().gates_passed, 1);
}

// Bars do not say whose they are. Without corners of the gate that is looked for they may be any other's,
// and an estimate that follows them flies into a wall.
TEST(Search, SideBarsAloneDoNotMoveTheEstimate) {
  const auto moved_by = [](bool corners_before) {
    LedDrone drone{FilterModel::kOurs, 1.4};
    drone.sees_gate = corners_before;
    drone.fly({0, 0}, 0.5);
    drone.sees_gate = false;
    drone.fly({0, 0}, 0.2);
    drone.sees_bars = true, drone.aside = 0.1;
    const double before = drone.pilot.estimate().p_GB.y();
    drone.fly({0, 0}, 0.5);
    return std::abs(drone.pilot.estimate().p_GB.y() - before);
  };
  EXPECT_LT(moved_by(false), 0.001);
  EXPECT_GT(moved_by(true), 0.005)
      << "of a gate whose corners have just been seen they are believed";
}

// They put the place in doubt, which is no drift: the drone goes on, and the next gate settles it.
TEST(Search, GatesThatContradictAreNoReasonToStand) {
  LedDrone drone{FilterModel::kOurs};
  drone.sees_gate = true;
  drone.fly({0, 0}, 2.0);
  drone.fly({1.0, 0}, 6.0, [&] { return drone.x() > -1.3; });
  drone.sees_gate = false, drone.is_contradicted = true;
  double most_lateral = 0.0;
  drone.fly({1.0, 0}, 3.0, [&] {
    EXPECT_FALSE(drone.in<Search>()) << "at " << drone.x();
    const Eigen::Matrix3d covariance = drone.pilot.estimate().covariance_GB;
    most_lateral = std::max(most_lateral, std::sqrt(covariance(1, 1)));
    return ::testing::Test::HasFailure();
  });
  EXPECT_GT(most_lateral, drone.config.phase.lost_sigma) << "it was put in doubt";
  EXPECT_EQ(drone.pilot.estimate().gates_passed, 1);
}

TEST(Search, LooksToBothSidesOfTheGate) {
  LedDrone drone = searching_before_the_first_gate();
  double left = 0.0, right = 0.0;
  drone.fly({0, 0}, 7.0, [&] {
    left = std::min(left, drone.command.attitude.yaw);
    right = std::max(right, drone.command.attitude.yaw);
    return false;
  });
  EXPECT_TRUE(drone.in<Search>());
  EXPECT_LT(left, -30 * kDegree);
  EXPECT_GT(right, 30 * kDegree);
}

TEST(Search, FoundAgainTheGateIsPassedAndTheNextOneIsTheTarget) {
  LedDrone drone = searching_before_the_first_gate();
  drone.fly({0, 0}, 2.0);
  EXPECT_TRUE(drone.in<Search>()) << "nothing seen yet";

  drone.sees_gate = true;
  drone.fly({0, 0}, 4.0, [&] { return !drone.in<Search>(); });
  EXPECT_TRUE(drone.in<Straight>()) << name_of(drone.pilot.phase());
  EXPECT_EQ(drone.pilot.target_gate(), 0) << "found, not passed";

  Vector3d before = Vector3d::Zero();
  drone.fly({1.0, 0}, 6.0, [&] {
    EXPECT_FALSE(drone.in<Search>());
    if (drone.pilot.estimate().gates_passed == 0) before = drone.pilot.estimate().p_EB;
    return drone.pilot.estimate().gates_passed > 0;
  });
  EXPECT_EQ(drone.pilot.estimate().gates_passed, 1);
  EXPECT_EQ(drone.pilot.target_gate(), 1);
  EXPECT_NEAR(before.x(), 4.1, 0.02) << "just behind the gate";
  EXPECT_LT((drone.pilot.estimate().p_EB - before).norm(), 0.01) << "the place is the same";
  EXPECT_NEAR(drone.x(), -2.1, 0.1) << "seen from the second gate, which faces the other way";
  EXPECT_EQ(drone.pilot.abort_reason(), AbortReason::kNone);
}

TEST(Search, ADriftThroughTheOpeningIsAPass) {
  LedDrone drone = searching_before_the_first_gate();
  drone.fly({0.5, 0}, 6.0, [&] {
    const bool passed = drone.pilot.estimate().gates_passed > 0;
    EXPECT_TRUE(passed || drone.in<Search>());
    return passed;
  });
  EXPECT_EQ(drone.pilot.estimate().gates_passed, 1);
  EXPECT_EQ(drone.pilot.target_gate(), 1);
  EXPECT_NEAR(drone.pilot.estimate().p_EB.x(), 4.1, 0.02);
  EXPECT_TRUE(drone.in<Straight>() || drone.in<Turn>())
      << "on the planned way to the next gate, not to a place to wait at before it";
}

TEST(Search, ADriftPastTheGateIsNone) {
  LedDrone drone = searching_before_the_first_gate();
  drone.fly({0, 0.5}, 1.6);  // 0.8 m to the right: the opening ends at 0.5
  drone.fly({0.5, 0}, 5.6);
  EXPECT_GT(drone.x(), 0.3);
  EXPECT_GT(drone.pilot.estimate().p_GB.y(), 0.6);
  EXPECT_EQ(drone.pilot.estimate().gates_passed, 0);
  EXPECT_EQ(drone.pilot.target_gate(), 0);
  EXPECT_TRUE(drone.in<Search>()) << name_of(drone.pilot.phase());
}

TEST(Search, EndsWithALandingAndAReasonWhereNoGateIsFound) {
  LedDrone drone = searching_before_the_first_gate();
  drone.fly({0, 0}, drone.config.phase.search_timeout + 0.1, [&] { return !drone.in<Search>(); });
  EXPECT_TRUE(drone.in<Land>()) << name_of(drone.pilot.phase());
  EXPECT_EQ(drone.pilot.abort_reason(), AbortReason::kGateNotFound);
}

}  // namespace
}  // namespace gatefly
