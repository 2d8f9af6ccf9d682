// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/msp_axes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/matchers.hpp"

namespace gatefly::msp {
namespace {

using Eigen::Vector3d;
using test::IsNear;
using testing::ElementsAre;

constexpr ImuScale kQualifier{.gyro_counts_per_deg_per_s = 16.384, .accel_counts_per_g = 512.0};

TEST(MspAxes, AtRestTheAccelerometerReadsGravityUpwards) {
  const Imu imu = imu_of({.accel = {0, 0, 512}}, kQualifier);
  EXPECT_THAT(imu.accel_B, IsNear(Vector3d(0, 0, -kGravity), 1e-12));
}

// Nose down by 30°: gravity pulls forward, so the specific force points back.
TEST(MspAxes, SpecificForceAndAttitudeAgreeAboutANoseThatPointsDown) {
  const Imu imu = imu_of({.accel = {-256, 0, 443}}, kQualifier);
  const gatefly::Attitude attitude = attitude_of({.roll = 0, .pitch = 300, .yaw = 0});
  EXPECT_NEAR(attitude.pitch, -30 * kDegree, 1e-12);
  const Vector3d gravity_B = rotation_EB(attitude).inverse() * Vector3d(0, 0, -kGravity);
  EXPECT_THAT(imu.accel_B, IsNear(gravity_B, 0.02));
}

// Right side down by 30°: gravity pulls to the right, the specific force points left, up.
TEST(MspAxes, SpecificForceAndAttitudeAgreeAboutARightSideThatIsDown) {
  const Imu imu = imu_of({.accel = {0, 256, 443}}, kQualifier);
  const gatefly::Attitude attitude = attitude_of({.roll = 300, .pitch = 0, .yaw = 0});
  const Vector3d gravity_B = rotation_EB(attitude).inverse() * Vector3d(0, 0, -kGravity);
  EXPECT_THAT(imu.accel_B, IsNear(gravity_B, 0.02));
}

TEST(MspAxes, GyroCountsAreNotDegrees) {
  const Imu imu = imu_of({.gyro = {1638, 0, 0}}, kQualifier);
  EXPECT_NEAR(imu.gyro_B.x(), 99.976 * kDegree, 1e-4);
}

// As flown: nose down is positive on attitude and gyro; yaw has opposite signs on the two.
TEST(MspAxes, AMotionHasTheSameSignOnGyroAndAttitudeOnceBothAreOurs) {
  const Imu imu = imu_of({.gyro = {100, 100, 100}}, kQualifier);
  EXPECT_GT(imu.gyro_B.x(), 0.0);
  EXPECT_LT(imu.gyro_B.y(), 0.0);
  EXPECT_LT(imu.gyro_B.z(), 0.0);
  const gatefly::Attitude attitude = attitude_of({.roll = 10, .pitch = 10, .yaw = 270});
  EXPECT_NEAR(attitude.roll, kDegree, 1e-12);
  EXPECT_NEAR(attitude.pitch, -kDegree, 1e-12);
  EXPECT_NEAR(attitude.yaw, -90 * kDegree, 1e-12);
}

TEST(MspAxes, TheMostNegativeCountIsANumberLikeAnyOther) {
  const Imu imu =
      imu_of({.accel = {-32768, -32768, -32768}, .gyro = {-32768, -32768, -32768}}, kQualifier);
  EXPECT_NEAR(imu.gyro_B.y(), 2000 * kDegree, 1e-9);
  EXPECT_NEAR(imu.accel_B.x(), -64 * kGravity, 1e-9);
}

TEST(MspAxes, SticksForwardTurnTheNoseDown) {
  EXPECT_THAT(stick_rates({1, 2, 3}), IsNear(Vector3d(1, -2, 3), 0));
  EXPECT_THAT(body_rates(stick_rates({1, 2, 3})), IsNear(Vector3d(1, 2, 3), 0));
}

TEST(MspAxes, SticksAreSentWithThrottleThirdAndReadWithThrottleFourth) {
  const Sticks sticks{.roll = 1501, .pitch = 1502, .yaw = 1503, .throttle = 1104};
  const auto bytes = ChannelOrder{}.set_raw_rc(sticks);
  const auto channel = [&](std::size_t i) { return bytes[2 * i] + 256 * bytes[2 * i + 1]; };
  EXPECT_EQ(channel(0), 1501);
  EXPECT_EQ(channel(1), 1502);
  EXPECT_EQ(channel(2), 1104);
  EXPECT_EQ(channel(3), 1503);
  const std::array<std::uint16_t, 6> rc{1501, 1502, 1503, 1104, 1800, 1000};
  EXPECT_EQ(sticks_in_rc(rc), sticks);
  EXPECT_EQ(sticks_in_rc(std::span{rc}.first(3)), std::nullopt);
}

TEST(MspAxes, AnotherChannelMapIsFollowedAndANonsensicalOneRefused) {
  const auto taer = ChannelOrder::from({.place = {1, 2, 3, 0, 4, 5, 6, 7}});
  ASSERT_TRUE(taer);
  const auto bytes = taer->set_raw_rc({.roll = 1, .pitch = 2, .yaw = 3, .throttle = 4});
  EXPECT_THAT(bytes, ElementsAre(4, 0, 1, 0, 2, 0, 3, 0));
  EXPECT_FALSE(ChannelOrder::from({.place = {0, 0, 1, 2}}));
  EXPECT_FALSE(ChannelOrder::from({.place = {0, 1, 2, 4}}));
  EXPECT_TRUE(ChannelOrder::from({.place = {0, 1, 3, 2}}));
}

}  // namespace
}  // namespace gatefly::msp
