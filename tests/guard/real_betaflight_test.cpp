// SPDX-License-Identifier: Apache-2.0
// A Betaflight itself is asked for its constants, and turned by hand.
#include "support/real_betaflight.hpp"

#include <chrono>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/guard/axis_check.hpp"
#include "gatefly/guard/interview.hpp"

namespace gatefly::guard {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using test::RealBetaflight;

TEST_F(RealBetaflight, IsAskedForItsConstantsAndOnlyWhatItLacksIsComplainedAbout) {
  Interview interview;
  for (int i = 0; i < 20 && interview.question(); ++i) {
    const std::uint16_t id = *interview.question();
    const auto payload = client_.ask(id);
    ASSERT_TRUE(payload) << id;
    interview.take({.id = id, .payload = *payload, .direction = msp::Direction::kFromController});
  }
  ASSERT_TRUE(interview.facts().rates());
  EXPECT_NEAR(interview.facts().rates()->pitch.rate(2000) / kDegree, 440, 1e-9);
  const Complaints found = complaints_about(interview.facts());
  // This version has another throttle curve, and the simulator has no switch set up: two complaints are right.
  EXPECT_THAT(std::vector(found.begin(), found.end()),
              testing::ElementsAre(Complaint::kThrottleCurve, Complaint::kNoArmSwitch,
                                   Complaint::kNoOverride));
}

TEST_F(RealBetaflight, TurnedByHandItsGyroAgreesWithItsAttitudeAndInCountsItDoesNot) {
  AxisCheck check, counts;
  (void)body_->longest_gap();
  auto last = body_->time();
  const auto turn = [&](const Vector3d& rate_B, std::chrono::milliseconds time_span) {
    body_->turn(rate_B);
    for (const auto end = body_->time() + time_span; body_->time() < end;) {
      body_->lasts(20ms);
      const Imu sample = imu();
      const Attitude said = attitude();
      const auto now = body_->time();
      const double dt = std::chrono::duration<double>(now - last).count();
      last = now;
      check.take(sample.gyro_B, said, dt);
      counts.take(16.384 * sample.gyro_B, said, dt);
    }
  };
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)}) {
    turn(axis, 800ms);
    turn(-axis, 800ms);
    turn({0, 0, 0}, 300ms);
  }
  if (const auto gap = body_->longest_gap(); gap > test::kBusy)
    GTEST_SKIP() << "the machine is too busy: " << gap.count() << " ms without a sample";
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(check.verdict(axis), AxisVerdict::kAgrees)
        << axis << ": " << check.scale(axis).value_or(0);
    EXPECT_EQ(counts.verdict(axis), AxisVerdict::kWrongScale) << axis;
  }
}

}  // namespace
}  // namespace gatefly::guard
