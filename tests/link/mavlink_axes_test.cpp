// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/mavlink_axes.hpp"

#include <chrono>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly::mavlink {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using test::for_all;
using test::IsNear;

TEST(MavlinkAxes, UnitsAreSiAndAxesOurs) {
  const Imu imu = imu_of(ScaledImu{.xacc = 100, .zacc = -1000, .ygyro = 500, .zgyro = -250});
  EXPECT_THAT(imu.accel_B, IsNear(Vector3d(0.1 * kGravity, 0, -kGravity), 1e-12));
  EXPECT_THAT(imu.gyro_B, IsNear(Vector3d(0, 0.5, -0.25), 1e-12));
  const Imu high =
      imu_of(HighresImu{.xacc = 1, .yacc = 2, .zacc = 3, .xgyro = 4, .ygyro = 5, .zgyro = 6});
  EXPECT_THAT(high.accel_B, IsNear(Vector3d(1, 2, 3), 0));
  EXPECT_THAT(high.gyro_B, IsNear(Vector3d(4, 5, 6), 0));
  const Place place = place_of({.x = 1, .y = 2, .z = -3, .vx = 4, .vy = 5, .vz = 6});
  EXPECT_THAT(place.p_EB, IsNear(Vector3d(1, 2, -3), 0));
  EXPECT_THAT(place.v_E, IsNear(Vector3d(4, 5, 6), 0));
}

TEST(MavlinkAxes, AnAttitudeThatIsCommandedIsTheOneThatWouldBeReported) {
  for_all(200, [](Rng& rng) {
    const gatefly::Attitude wanted = test::any_attitude(rng, 1.4);
    const SetAttitudeTarget target = attitude_target({}, wanted, 0.5, 0ms);
    const gatefly::Attitude reported = attitude_of(AttitudeQuaternion{
        .q1 = target.q[0], .q2 = target.q[1], .q3 = target.q[2], .q4 = target.q[3]});
    EXPECT_THAT(rotation_EB(reported).matrix, IsNear(rotation_EB(wanted).matrix, 1e-6));
  });
}

TEST(MavlinkAxes, ACommandSaysWhatOfItCounts) {
  const SetAttitudeTarget attitude =
      attitude_target({.system = 7, .component = 9}, {}, 0.4, 1500ms);
  EXPECT_EQ(attitude.type_mask, 0b00000111);
  EXPECT_EQ(attitude.target_system, 7);
  EXPECT_EQ(attitude.target_component, 9);
  EXPECT_EQ(attitude.time_boot_ms, 1500u);
  const SetAttitudeTarget rates = rate_target({}, {1, 2, 3}, 0.4, 0ms);
  EXPECT_EQ(rates.type_mask, 0b10000000);
  EXPECT_FLOAT_EQ(rates.body_pitch_rate, 2);
  const SetPositionTargetLocalNed velocity = velocity_target({}, {1, 2, 3}, 0.5, 0ms);
  EXPECT_EQ(velocity.type_mask, 0b100111000111);
  EXPECT_FLOAT_EQ(velocity.vz, 3);
  EXPECT_EQ(velocity.coordinate_frame, 1);
}

TEST(MavlinkAxes, ThrustIsAPartAndWhatIsNoNumberLiftsNothing) {
  EXPECT_EQ(rate_target({}, {0, 0, 0}, 7, 0ms).thrust, 1.0F);
  EXPECT_EQ(rate_target({}, {0, 0, 0}, -7, 0ms).thrust, 0.0F);
  EXPECT_EQ(rate_target({}, {0, 0, 0}, std::numeric_limits<double>::quiet_NaN(), 0ms).thrust, 0.0F);
}

TEST(MavlinkClock, TheOffsetIsExactWhenBothWaysTakeAsLong) {
  // Ours reads 1000 when it asks and 1030 when it hears; the peer's, 5,000,000 ahead, is asked at 1015.
  const Timesync question = clock_question(1000ns);
  const auto answer = clock_answer(question, 5'001'015ns);
  ASSERT_TRUE(answer);
  const auto offset = clock_offset(*answer, 1030ns);
  ASSERT_TRUE(offset);
  EXPECT_EQ(offset->offset, 5'000'000ns);
  EXPECT_EQ(offset->round_trip, 30ns);
}

TEST(MavlinkClock, IsNeverOffByMoreThanHalfTheRoundTrip) {
  for_all(200, [](Rng& rng) {
    const std::int64_t truth = rng.uniform_index(1'000'000) - 500'000,
                       there = rng.uniform_index(1000), back = rng.uniform_index(1000),
                       sent = 1'000'000;
    const auto answer = clock_answer(clock_question(std::chrono::nanoseconds{sent}),
                                     std::chrono::nanoseconds{sent + there + truth});
    const auto offset = clock_offset(*answer, std::chrono::nanoseconds{sent + there + back});
    ASSERT_TRUE(offset);
    EXPECT_LE(std::abs(offset->offset.count() - truth), offset->round_trip.count() / 2 + 1);
  });
}

TEST(MavlinkClock, QuestionsAreNoAnswersAndNonsenseIsRefused) {
  EXPECT_FALSE(clock_offset(clock_question(5ns), 10ns));
  EXPECT_FALSE(clock_answer({.tc1 = 5, .ts1 = 1}, 10ns));
  EXPECT_FALSE(clock_offset({.tc1 = 5, .ts1 = 20}, 10ns)) << "asked in the future";
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  constexpr auto kLeast = std::numeric_limits<std::int64_t>::min();
  for (const std::int64_t a : {kMost, kLeast, std::int64_t{1}})
    for (const std::int64_t b : {kMost, kLeast})
      EXPECT_FALSE(clock_offset({.tc1 = a, .ts1 = b}, 10ns));
}

}  // namespace
}  // namespace gatefly::mavlink
