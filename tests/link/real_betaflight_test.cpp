// SPDX-License-Identifier: Apache-2.0
// MSP against Betaflight itself.
#include "support/real_betaflight.hpp"

#include <array>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/link/msp_axes.hpp"
#include "gatefly/link/msp_lists.hpp"
#include "gatefly/link/msp_messages.hpp"
#include "gatefly/link/rate_curve.hpp"
#include "gatefly/link/throttle_curve.hpp"

#include "support/matchers.hpp"

namespace gatefly::msp {
namespace {

using namespace std::chrono_literals;
using Data = std::vector<std::uint8_t>;
using Eigen::Vector3d;
using test::IsNear;
using test::RealBetaflight;

TEST_F(RealBetaflight, SaysWhoItIsAndHowItIsSet) {
  const auto variant = client_.ask<FcVariant>();
  ASSERT_TRUE(variant);
  EXPECT_THAT(variant->name, testing::ElementsAre('B', 'T', 'F', 'L'));
  const auto api = client_.ask<ApiVersion>();
  ASSERT_TRUE(api);
  EXPECT_EQ(api->major, 1);
  EXPECT_GE(api->minor, 45);
  ASSERT_TRUE(client_.ask<FcVersion>());

  const auto tuning = client_.ask<RcTuning>();
  const auto receiver = client_.ask<RxConfig>();
  const auto deadband = client_.ask<RcDeadband>();
  ASSERT_TRUE(tuning && receiver && deadband);
  const auto profile = RateProfile::from(*tuning, *deadband, *receiver);
  ASSERT_TRUE(profile);
  EXPECT_NEAR(profile->roll.rate(2000) / kDegree, 440, 1e-9);
  EXPECT_NEAR(profile->pitch.rate(1750) / kDegree, 88, 1e-9);
  EXPECT_NEAR(profile->yaw.rate(2000) / kDegree, 380, 1e-9);
  EXPECT_EQ(ThrottleCurve::from(*tuning, *receiver).has_value(), api->minor < 47);

  const auto map = client_.ask<RxMap>();
  ASSERT_TRUE(map);
  EXPECT_TRUE(ChannelOrder::from(*map));
  EXPECT_TRUE(client_.ask<BatteryState>() && client_.ask<Analog>() && client_.ask<Altitude>());

  // The same question in the other version has the same answer; one that nobody knows is refused.
  EXPECT_EQ(client_.ask(RcTuning::kId, {}, Version::k1), client_.ask(RcTuning::kId));
  EXPECT_FALSE(client_.ask(0x3FFF));
  EXPECT_EQ(client_.skipped(), 0u);
}

TEST_F(RealBetaflight, TellsModesAndAnswersSeveralQuestionsInOneFrame) {
  const auto id_bytes = client_.ask(kBoxIds);
  const auto names = client_.ask(kBoxNames);
  ASSERT_TRUE(id_bytes && names);
  const auto ids = box_ids_in(*id_bytes);
  ASSERT_TRUE(ids);
  for (std::size_t i = 0; i < ids->size(); ++i) {
    const std::string_view name = box_name_in(*names, i);
    EXPECT_NE(name, "");
    EXPECT_EQ(name == "ARM", (*ids)[i] == static_cast<std::uint8_t>(Box::kArm));
    EXPECT_EQ(name == "ANGLE", (*ids)[i] == static_cast<std::uint8_t>(Box::kAngle));
    EXPECT_EQ(name == "FAILSAFE", (*ids)[i] == static_cast<std::uint8_t>(Box::kFailsafe));
    EXPECT_EQ(name == "MSP OVERRIDE", (*ids)[i] == static_cast<std::uint8_t>(Box::kMspOverride));
  }
  const auto ranges = client_.ask(kModeRanges);
  ASSERT_TRUE(ranges);
  EXPECT_TRUE(mode_ranges_in(*ranges));

  const Data questions{108, 102, 150, 105};
  const auto together = client_.ask(kMultiple, questions);
  ASSERT_TRUE(together);
  std::vector<int> answered;
  EXPECT_TRUE(each_answer(questions, *together, [&](std::uint16_t id, link::Bytes payload) {
    answered.push_back(id);
    if (id == kStatusEx) {
      const auto status = status_in(payload);
      ASSERT_TRUE(status);
      EXPECT_EQ(status->on(Box::kArm, *ids), false);
      EXPECT_TRUE(status->gyro && status->accelerometer);
      EXPECT_NE(status->arming_refused, 0u) << "there is no receiver yet";
    }
  }));
  EXPECT_THAT(answered, testing::ElementsAre(108, 102, 150, 105));
}

TEST_F(RealBetaflight, FliesByTheSticksThatAreSentInItsOrder) {
  const auto map = client_.ask<RxMap>();
  ASSERT_TRUE(map);
  const auto order = ChannelOrder::from(*map);
  ASSERT_TRUE(order);
  const Sticks sticks{.roll = 1601, .pitch = 1402, .yaw = 1553, .throttle = 1104};
  const auto sent = order->set_raw_rc(sticks);
  (void)body_->longest_gap();
  for (int i = 0; i < 25; ++i) {
    ASSERT_TRUE(client_.ask(kSetRawRc, {sent.begin(), sent.end()}));
    std::this_thread::sleep_for(20ms);
  }
  if (const auto gap = body_->longest_gap(); gap > test::kBusy)
    GTEST_SKIP() << "the machine is too busy: " << gap.count() << " ms without a sample";
  const auto rc = client_.ask(kRc);
  ASSERT_TRUE(rc);
  const auto channels = channels_in(*rc);
  ASSERT_TRUE(channels);
  EXPECT_EQ(sticks_in_rc({channels->begin(), channels->size()}), sticks);
}

TEST_F(RealBetaflight, TurnsAreOursInUnitAndSignOnGyroAccelerometerAndAttitude) {
  EXPECT_THAT(imu().accel_B, IsNear(Vector3d(0, 0, -kGravity), 0.1));
  EXPECT_THAT(imu().gyro_B, IsNear(Vector3d(0, 0, 0), 0.01));
  EXPECT_NEAR(attitude().yaw, 0.0, 4 * kDegree);
  (void)body_->longest_gap();
  // Right side down, nose up, nose right, one after the other, and back.
  const std::array<Vector3d, 3> turns{{{0.8, 0, 0}, {0, 0.8, 0}, {0, 0, 0.8}}};
  std::array<gatefly::Attitude, 3> truth{}, said{};
  std::array<Imu, 3> turning{}, still{};
  for (std::size_t i = 0; i < turns.size(); ++i) {
    body_->turn(turns[i]);
    body_->lasts(300ms);
    turning[i] = imu();
    body_->lasts(200ms);
    body_->turn({0, 0, 0});
    body_->lasts(100ms);
    truth[i] = body_->attitude(), said[i] = attitude();
    still[i] = imu();
    body_->turn(-turns[i]);
    body_->lasts(500ms);
    body_->turn({0, 0, 0});
    body_->lasts(100ms);
  }
  if (const auto gap = body_->longest_gap(); gap > test::kBusy)
    GTEST_SKIP() << "the machine is too busy: " << gap.count() << " ms without a sample";
  for (std::size_t i = 0; i < turns.size(); ++i) {
    SCOPED_TRACE(i);
    const Vector3d gravity_B = rotation_EB(truth[i]).inverse() * Vector3d(0, 0, -kGravity);
    EXPECT_THAT(turning[i].gyro_B, IsNear(turns[i], 0.02));
    EXPECT_THAT(still[i].accel_B, IsNear(gravity_B, 0.1));
    EXPECT_NEAR(said[i].roll, truth[i].roll, 3 * kDegree);
    EXPECT_NEAR(said[i].pitch, truth[i].pitch, 3 * kDegree);
    EXPECT_NEAR(wrap_angle(said[i].yaw - truth[i].yaw), 0.0, 4 * kDegree);
  }
}

}  // namespace
}  // namespace gatefly::msp
