// SPDX-License-Identifier: Apache-2.0
// A drone that speaks TS-002: it answers nothing but its clock, nobody else flies it, and in the second round it tells no attitude.
#include <chrono>
#include <cmath>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"
#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/hand_over_mark.hpp"
#include "gatefly/live/mavlink_speaker.hpp"
#include "gatefly/live/ts002_introduction.hpp"

#include "support/real_data.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;
using test::error_of;
using testing::HasSubstr;

DroneFile ts002_drone() {
  return read_drone(support::source_folder() / "tests" / "live" / "ts002.toml");
}

const Eigen::Vector3d kStill = Eigen::Vector3d::Zero(), kUpright{0, 0, -kGravity};

/// A frame of the drone.
template <class Message>
std::vector<std::uint8_t> said(const Message& message) {
  std::array<std::uint8_t, mavlink::kLongestFrame> frame{};
  const std::size_t size = mavlink::encode_message(message, {1, 1, 0}, frame);
  return {frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size)};
}

mavlink::HighresImu imu(double seconds, const Eigen::Vector3d& gyro, const Eigen::Vector3d& force) {
  const auto f = [](double value) { return static_cast<float>(value); };
  // An IMU that repeats itself is stuck.
  const double noise = 1e-3 * std::sin(1e3 * seconds);
  return {static_cast<std::uint64_t>(1e6 * seconds),
          f(force.x() + noise),
          f(force.y()),
          f(force.z()),
          f(gyro.x()),
          f(gyro.y()),
          f(gyro.z())};
}

nanoseconds after(double seconds) { return nanoseconds{std::llround(1e9 * seconds)}; }

TEST(Ts002Speaker, ItAsksForNothingButTheClockAndBeats) {
  const DroneFile drone = ts002_drone();
  MavlinkSpeaker speaker{drone, 120.0};
  mavlink::Stream stream;
  int beats = 0, clocks = 0, others = 0;
  for (int tick = 0; tick < 400; ++tick) {
    stream.feed(speaker.request(after(0.01 * tick)), [&](const mavlink::Frame& frame) {
      if (frame.id == mavlink::Heartbeat::kId)
        ++beats;
      else if (frame.id == mavlink::Timesync::kId)
        ++clocks;
      else
        ++others;
    });
  }
  EXPECT_GE(beats, 8) << "two a second, as TS-002 asks";
  EXPECT_GE(clocks, 8);
  EXPECT_EQ(others, 0);
}

TEST(Ts002Speaker, ItIsOursAsLongAsItIsArmed) {
  const DroneFile drone = ts002_drone();
  MavlinkSpeaker speaker{drone, 120.0};
  (void)speaker.take(said(mavlink::Heartbeat{.base_mode = 0}), 1s);
  EXPECT_FALSE(speaker.state().override_on);
  (void)speaker.take(said(mavlink::Heartbeat{.base_mode = 128}), 2s);
  EXPECT_TRUE(speaker.state().armed && speaker.state().override_on);
}

TEST(Ts002Speaker, BetweenTwoHeartbeatsItsStateHoldsButNotWithoutAny) {
  const DroneFile drone = ts002_drone();
  MavlinkSpeaker speaker{drone, 120.0};
  (void)speaker.take(said(mavlink::Heartbeat{.base_mode = 128}), 1s);
  for (int i = 0; i < 500; ++i)
    (void)speaker.take(said(imu(1.0 + 0.01 * i, kStill, kUpright)), after(1.0 + 0.01 * i));
  EXPECT_GT(speaker.state().status_at, 3900ms);
  EXPECT_LE(speaker.state().status_at, 4s) << "three seconds after the last heartbeat, and no more";
}

TEST(Ts002Speaker, WithoutAnAttitudeRollAndPitchFollowFromTheImu) {
  const DroneFile drone = ts002_drone();
  MavlinkSpeaker speaker{drone, 120.0};
  (void)speaker.request(0s);
  double t = 0.0;
  const auto felt = [&](double seconds, const Eigen::Vector3d& gyro, const Eigen::Vector3d& force) {
    for (const double end = t + seconds; t < end; t += 0.01)
      (void)speaker.take(said(imu(t, gyro, force)), after(t));
  };
  (void)speaker.take(said(mavlink::Heartbeat{.base_mode = 0}), 0s);
  felt(3.0, kStill, kUpright);
  EXPECT_NEAR(speaker.state().attitude.roll, 0.0, 1e-3);
  (void)speaker.take(said(mavlink::Heartbeat{.base_mode = 128}), after(t));
  felt(0.3, {1.0, 0, 0}, kUpright);
  EXPECT_NEAR(speaker.state().attitude.roll, 0.3, 0.03);
  EXPECT_NEAR(speaker.state().attitude.pitch, 0.0, 0.01);
  EXPECT_GT(speaker.state().attitude_at, after(t - 0.02));
}

TEST(Ts002Speaker, WhoHearsItInTheAirFirstDoesNotKnowWhatIsLevel) {
  const DroneFile drone = ts002_drone();
  MavlinkSpeaker speaker{drone, 120.0};
  (void)speaker.request(0s);
  (void)speaker.take(said(mavlink::Heartbeat{.base_mode = 128}), 0s);
  for (int i = 0; i < 500; ++i)
    (void)speaker.take(said(imu(0.01 * i, kStill, kUpright)), after(0.01 * i));
  EXPECT_EQ(speaker.state().attitude_at, ControllerState::kNever);
}

TEST(Ts002Speaker, OnlyASimulatorsAttitudeFollowsFromItsImu) {
  const DroneFile drone =
      read_drone(support::source_folder() / "tests" / "live" / "fake_arducopter.toml");
  MavlinkSpeaker speaker{drone, 100.0};
  (void)speaker.request(0s);
  (void)speaker.take(said(mavlink::Heartbeat{.autopilot = 3, .base_mode = 0}), 0s);
  for (int i = 0; i < 500; ++i)
    (void)speaker.take(said(imu(0.01 * i, kStill, kUpright)), after(0.01 * i));
  EXPECT_EQ(speaker.state().attitude_at, ControllerState::kNever) << "nothing is turned then";
}

TEST(Ts002Speaker, ARealAutopilotThatComesLaterIsSomebodyElse) {
  const DroneFile drone = ts002_drone();
  MavlinkSpeaker speaker{drone, 120.0};
  (void)speaker.take(said(mavlink::Heartbeat{.autopilot = 8}), 1s);
  EXPECT_FALSE(speaker.state().other_client);
  (void)speaker.take(said(mavlink::Heartbeat{.autopilot = 12}), 2s);
  (void)speaker.take(said(mavlink::Heartbeat{.autopilot = 0}), 3s);
  EXPECT_TRUE(speaker.state().other_client);
}

TEST(Ts002Speaker, WhatHoversIsWhatTheFileSays) {
  const DroneFile drone = ts002_drone();
  EXPECT_NEAR(drone.thrust_part(kGravity, 0.9), 0.16, 1e-9) << "it adds nothing when it is tilted";
  EXPECT_NEAR(drone.thrust_part(2 * kGravity, 1.0), 0.32, 1e-9);
}

TEST(Ts002File, NobodyHandsItOverAndNothingElseIsInIt) {
  EXPECT_TRUE(hand_over_tested(ts002_drone(), "any program"));
  const std::string text =
      files::read_file(support::source_folder() / "tests" / "live" / "ts002.toml");
  const test::TempFolder folder;
  const auto refused = [&](const std::string& content) {
    const auto file = folder.file("drone.toml", content);
    return error_of([&] { (void)read_drone(file); });
  };
  EXPECT_EQ(refused(text), "");
  EXPECT_THAT(refused(text + "[battery]\nleast_v = 14\n"), HasSubstr("battery"));
  EXPECT_THAT(refused(text.substr(0, text.find("exponent"))), HasSubstr("exponent"));
}

}  // namespace
}  // namespace gatefly::live
