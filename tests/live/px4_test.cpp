// SPDX-License-Identifier: Apache-2.0
// The link to a PX4: what differs from an ArduCopter's. Its parameters of whole numbers, its mode, its heartbeats, its file.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/live/ardu_bench.hpp"
#include "gatefly/live/drone_answers.hpp"
#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/hand_over_mark.hpp"
#include "gatefly/live/mavlink_speaker.hpp"
#include "gatefly/live/px4_introduction.hpp"

#include "support/drone_file_keys.hpp"
#include "support/real_data.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint32_t kOffboard = 6U << 16, kHold = 4U << 16 | 3U << 24;

std::filesystem::path px4_file() {
  return support::source_folder() / "tests" / "live" / "px4_sim.toml";
}

/// A PX4 that answers what it is asked, in a thread of its own.
class ServedPx4 {
 public:
  explicit ServedPx4(std::map<std::string, float> floats = {},
                     std::map<std::string, int> wholes = {}, std::uint8_t autopilot = 12)
      : autopilot_{autopilot} {
    floats_.insert(floats.begin(), floats.end());
    floats_.merge(std::map<std::string, float>{
        {"COM_OF_LOSS_T", 0.5f}, {"MPC_THR_HOVER", 0.166f}, {"THR_MDL_FAC", 1.0f}});
    wholes_ = std::move(wholes);
    wholes_.merge(std::map<std::string, int>{{"COM_OBL_RC_ACT", 4}, {"EKF2_IMU_CTRL", 1}});
    std::array<int, 2> ends{};
    socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data());
    ours_.emplace(ends[0], "px4");
    theirs_.emplace(ends[1], "program");
    thread_ = std::thread{[this] { work(); }};
  }
  ~ServedPx4() { over_ = true, thread_.join(); }
  Port& port() { return *ours_; }

 private:
  void work() {
    mavlink::Stream stream;
    std::array<std::uint8_t, 2048> room{};
    Moment beat = Clock::now();
    while (!over_) {
      if (Clock::now() >= beat) say_beat(), beat = Clock::now() + 1s;
      const auto got = theirs_->read(room, Clock::now() + 2ms);
      if (!got) return;
      stream.feed(link::Bytes{room}.first(*got), [this](const mavlink::Frame& f) { answer(f); });
    }
  }
  void say_beat() {
    say(mavlink::Heartbeat{
        .custom_mode = kHold, .type = 2, .autopilot = autopilot_, .base_mode = 29});
  }
  void answer(const mavlink::Frame& frame) {
    if (const auto asked = mavlink::message_in<mavlink::CommandLong>(frame);
        asked && asked->command == 512) {
      if (asked->param1 == float(mavlink::AutopilotVersion::kId))
        say(mavlink::AutopilotVersion{.flight_sw_version = 0x010E0000});
      if (asked->param1 == float(mavlink::SysStatus::kId))
        say(mavlink::SysStatus{.onboard_control_sensors_present = 1,
                               .onboard_control_sensors_health = 3});
    }
    const auto asked = mavlink::message_in<mavlink::ParamRequestRead>(frame);
    if (!asked) return;
    const std::string name{asked->param_id.begin(),
                           std::find(asked->param_id.begin(), asked->param_id.end(), '\0')};
    mavlink::ParamValue value{.param_id = asked->param_id};
    if (const auto it = floats_.find(name); it != floats_.end())
      value.param_value = it->second, value.param_type = 9;
    if (const auto it = wholes_.find(name); it != wholes_.end())
      value.param_value = std::bit_cast<float>(it->second), value.param_type = 6;
    if (value.param_type != 0) say(value);
  }
  template <class Message>
  void say(const Message& message) {
    std::array<std::uint8_t, mavlink::kLongestFrame> frame{};
    const std::size_t size = mavlink::encode_message(message, {1, 1, sequence_++}, frame);
    (void)theirs_->write(link::Bytes{frame}.first(size), Clock::now() + 1s);
  }

  std::map<std::string, float> floats_;
  std::map<std::string, int> wholes_;
  std::uint8_t autopilot_, sequence_ = 0;
  std::optional<Port> ours_, theirs_;
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

TEST(Px4Introduction, AllOfItIsUnderstoodWholeNumbersToo) {
  ServedPx4 served;
  const Px4Introduction said = px4_introduction_of(served.port(), 1);
  EXPECT_FALSE(said.other_client);
  EXPECT_TRUE(guard::complaints_about(said.facts).empty());
  EXPECT_EQ(said.facts.parameter(guard::Px4Parameter::kOffboardLoss), 4.0f);
  EXPECT_THAT(differences(read_drone(px4_file()), said.facts), IsEmpty());
}

TEST(Px4Introduction, WhatADroneMustNotBeSetToIsNamed) {
  ServedPx4 served{{{"COM_OF_LOSS_T", 3.0f}}, {{"COM_OBL_RC_ACT", 3}}};
  const auto complaints = guard::complaints_about(px4_introduction_of(served.port(), 1).facts);
  const std::vector<guard::Px4Complaint> all(complaints.begin(), complaints.end());
  EXPECT_THAT(all, ElementsAre(guard::Px4Complaint::kTimeout, guard::Px4Complaint::kDoesNotLand));
}

TEST(Px4Introduction, AnotherThrustCurveIsAnotherDroneAndAHoverThatItHasLearntIsNot) {
  ServedPx4 served{{{"THR_MDL_FAC", 0.3f}, {"MPC_THR_HOVER", 0.175f}}};
  EXPECT_THAT(differences(read_drone(px4_file()), px4_introduction_of(served.port(), 1).facts),
              ElementsAre("THR_MDL_FAC is 0.3, in the file 1"));
}

TEST(Px4Introduction, ItIsKnownByItsHeartbeat) {
  ServedPx4 px4, ardupilot{{}, {}, 3};
  EXPECT_TRUE(is_px4(px4.port(), 1));
  EXPECT_FALSE(is_px4(ardupilot.port(), 1));
}

/// Reads a PX4's heartbeat as a listener does.
const ControllerState& after(MavlinkListener& listener, std::uint32_t mode, std::uint8_t base) {
  std::array<std::uint8_t, mavlink::kLongestFrame> frame{};
  const std::size_t size = mavlink::encode_message(
      mavlink::Heartbeat{.custom_mode = mode, .autopilot = 12, .base_mode = base}, {1, 1}, frame);
  (void)listener.take(link::Bytes{frame}.first(size), 1s);
  return listener.state();
}

TEST(Px4Listener, IsOverriddenInOffboardAloneAndArmedByItsBit) {
  MavlinkListener listener{{.px4 = true}};
  EXPECT_FALSE(after(listener, kHold, 29).override_on);
  EXPECT_FALSE(listener.state().armed);
  EXPECT_TRUE(after(listener, kOffboard, 129).override_on);
  EXPECT_TRUE(listener.state().armed);
  EXPECT_FALSE(after(listener, mavlink::kGuidedNoGps, 129).override_on) << "an ArduCopter's mode";
  EXPECT_FALSE(after(listener, 4U << 16 | 6U << 24, 129).override_on) << "it lands by itself";
}

TEST(Px4Listener, AsksForEveryHeartbeatForItSaysOneASecondByItself) {
  MavlinkListener listener{{.px4 = true}};
  int asked = 0, streams = 0;
  mavlink::Stream stream;
  for (std::chrono::nanoseconds now{0}; now < 1s; now += 10ms)
    stream.feed(listener.request(now), [&](const mavlink::Frame& frame) {
      const auto command = mavlink::message_in<mavlink::CommandLong>(frame);
      if (!command || command->param1 != 0.0f) return;
      asked += command->command == 512, streams += command->command == 511;
    });
  EXPECT_GE(asked, 9);
  EXPECT_LE(asked, 11);
  EXPECT_EQ(streams, 0);
}

TEST(Px4Speaker, RatesAreSentAsTheyAreAndThrustAsAPartOfWhatHovers) {
  const DroneFile drone = read_drone(px4_file());
  MavlinkSpeaker speaker{drone, 100};
  mavlink::Stream stream;
  std::optional<mavlink::SetAttitudeTarget> sent;
  stream.feed(
      speaker.set_point({.rests = false, .rates_B = {1.0, -0.5, 0.25}, .thrust = 2 * kGravity}, 2s),
      [&](const mavlink::Frame& frame) {
        if (const auto target = mavlink::message_in<mavlink::SetAttitudeTarget>(frame))
          sent = target;
      });
  ASSERT_TRUE(sent);
  EXPECT_FLOAT_EQ(sent->body_pitch_rate, -0.5f);
  EXPECT_NEAR(sent->thrust, 2 * 0.166, 1e-6);
  EXPECT_EQ(sent->type_mask, 128) << "no attitude";
}

TEST(Px4File, EveryKeyMustBeThereAndNoOtherMay) {
  test::expect_every_key_is_needed(files::read_file(px4_file()));
}

TEST(Px4File, EveryConstantIsOfTheHandOverTest) {
  const DroneFile drone = read_drone(px4_file());
  EXPECT_FALSE(hand_over_tested(drone, "p"));
  const std::string mark = hand_over_mark(drone, "p");
  for (const auto& change : std::vector<void (*)(DroneFile&)>{
           [](DroneFile& d) { d.px4->version = "1.15.0"; }, [](DroneFile& d) { d.px4->system = 2; },
           [](DroneFile& d) { d.px4->offboard_timeout_s = 0.6; },
           [](DroneFile& d) { d.px4->offboard_loss = 7; }, [](DroneFile& d) { d.px4->hover = 0.2; },
           [](DroneFile& d) { d.px4->model_factor = 0.3; },
           [](DroneFile& d) { d.hover.exponent = 1.1; },
           [](DroneFile& d) { d.least_battery_v = 3.0; }}) {
    DroneFile other = drone;
    change(other);
    EXPECT_NE(hand_over_mark(other, "p"), mark);
  }
}

TEST(Px4Bench, WhatIsWrittenReadsBackAsTheDrone) {
  ServedPx4 served;
  const Px4Introduction said = px4_introduction_of(served.port(), 1);
  EXPECT_TRUE(all_well(of_introduction(said)));
  const test::TempFolder folder;
  const auto file = folder.file(
      "drone.toml",
      drone_toml(px4_drone_of(said.facts), {.name = "px4-sim", .exponent = 1.0, .least_v = 0.0}));
  EXPECT_EQ(hand_over_mark(read_drone(file), "p"), hand_over_mark(read_drone(px4_file()), "p"));
}

}  // namespace
}  // namespace gatefly::live
