// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/px4_end.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/link/mavlink_commands.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"
#include "gatefly/live/port.hpp"
#include "gatefly/simulated_race/link_sim/safety_pilot.hpp"

namespace gatefly::link_sim {
namespace {

using namespace std::chrono_literals;
using live::Clock;
using live::Port;
using testing::ElementsAre;
using testing::FloatEq;

/// Ports that nobody has now.
int free_port_of(int kind) {
  const int fd = socket(AF_INET, kind, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof at;
  bind(fd, reinterpret_cast<const sockaddr*>(&at), size);
  getsockname(fd, reinterpret_cast<sockaddr*>(&at), &size);
  close(fd);
  return ntohs(at.sin_port);
}

template <class Message>
void say(Port& port, const Message& message, const mavlink::Sender& sender) {
  std::array<std::uint8_t, mavlink::kLongestFrame> frame{};
  const std::size_t size = mavlink::encode_message(message, sender, frame);
  ASSERT_TRUE(port.write(link::Bytes{frame}.first(size), Clock::now() + 1s));
}

/// All messages of that kind that have arrived.
template <class Message>
std::vector<Message> heard(Port& port, std::chrono::milliseconds wait = 20ms) {
  std::vector<Message> all;
  mavlink::Stream stream;
  std::array<std::uint8_t, 4096> room{};
  const live::Moment end = Clock::now() + wait;
  while (const auto got = port.read(room, end)) {
    if (*got == 0) break;
    stream.feed(link::Bytes{room}.first(*got), [&](const mavlink::Frame& frame) {
      if (const auto is = mavlink::message_in<Message>(frame)) all.push_back(*is);
    });
  }
  return all;
}

/// A PX4 that the test plays, of which nothing waits: its three lines, and the program's.
class Px4Lines : public testing::Test {
 protected:
  Px4Lines()
      : params_{.simulator = free_port_of(SOCK_STREAM),
                .companion = free_port_of(SOCK_DGRAM),
                .station = free_port_of(SOCK_DGRAM),
                .port = free_port_of(SOCK_DGRAM),
                .network = {}},
        end_{params_, {}},
        companion_{Port::udp_to("127.0.0.1", params_.companion, "127.0.0.1")},
        station_{Port::udp("127.0.0.1", params_.station, "127.0.0.1")},
        program_{Port::udp("127.0.0.1", params_.port, "127.0.0.1")} {}

  /// The program's words go to whoever has called it, from now on.
  Port answering() {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    std::array<char, 1> room{};
    EXPECT_EQ(recvfrom(program_.fd(), room.data(), 1, MSG_PEEK, reinterpret_cast<sockaddr*>(&from),
                       &size),
              1);
    const int fd = dup(program_.fd());
    EXPECT_EQ(connect(fd, reinterpret_cast<const sockaddr*>(&from), size), 0);
    return {fd, "program"};
  }

  Port call() const { return Port::tcp("127.0.0.1", params_.simulator, Clock::now() + 1s); }

  /// Steps of a millisecond, level and at rest.
  void steps(int count) {
    for (int i = 0; i < count; ++i) {
      now_ += 1e-3;
      end_.listen(now_);
      end_.feel({.time = std::chrono::nanoseconds{std::llround(1e9 * now_)},
                 .imu = {Eigen::Vector3d{0.01, 0, 0}, Eigen::Vector3d{0, 0, -kGravity}}},
                {});
    }
  }
  void switches(bool armed, bool override_on) {
    end_.hear_radio({}, msp::kNeutral, switches_of(armed, override_on));
  }
  void beats(bool armed, std::uint32_t main_mode) {
    say(companion_,
        mavlink::Heartbeat{.custom_mode = main_mode << 16,
                           .type = 2,
                           .autopilot = 12,
                           .base_mode = std::uint8_t(armed ? 157 : 29)},
        {1, 1, 0});
    steps(20);
  }
  /// Commands of the ground station.
  std::vector<std::string> commands() {
    std::vector<std::string> all;
    for (const auto& command : heard<mavlink::CommandLong>(station_))
      all.push_back(
          std::to_string(command.command) + " " +
          std::to_string(std::lround(command.command == 400 ? command.param1 : command.param2)));
    return all;
  }

  Px4End::Params params_;
  Px4End end_;
  Port companion_, station_, program_;
  double now_ = 0.0;
};

TEST_F(Px4Lines, HearsItsSensorsEveryFourMillisecondsAndWhereItIsTenTimesASecond) {
  steps(50);  // it calls late
  Port px4 = call();
  steps(201);
  const auto sensors = heard<mavlink::HilSensor>(px4);
  ASSERT_GE(sensors.size(), 50U);
  EXPECT_EQ(sensors[1].time_usec - sensors[0].time_usec, 4000U);
  EXPECT_NEAR(sensors[3].zacc, -kGravity, 1e-3);
  EXPECT_NEAR(sensors[3].xgyro, 0.01, 1e-6);
  EXPECT_NEAR(sensors[3].abs_pressure, 1013.25, 1.0);
  EXPECT_NEAR(sensors[3].zmag, 0.45, 0.02) << "the field points down, too";
  EXPECT_EQ(sensors[3].fields_updated, 0x1FFFU);
  steps(400);
  EXPECT_EQ(heard<mavlink::HilGps>(px4).size(), 4U);
}

TEST_F(Px4Lines, MotorsArriveInOurOrderAndAnArmedOneMayStand) {
  Port px4 = call();
  steps(10);
  EXPECT_FALSE(end_.ever());
  mavlink::HilActuatorControls told{.mode = 129};
  say(px4, told, {1, 1, 0});
  steps(1);
  EXPECT_TRUE(end_.turn()) << "armed";
  EXPECT_TRUE(end_.ever());
  told.controls = {0.1f, 0.2f, 0.3f, 0.4f};  // front right, rear left, front left, rear right
  say(px4, told, {1, 1, 1});
  steps(1);
  EXPECT_THAT(std::vector<float>(end_.motors().begin(), end_.motors().end()),
              ElementsAre(FloatEq(0.3f), FloatEq(0.1f), FloatEq(0.4f), FloatEq(0.2f)));
  told.mode = 1;
  say(px4, told, {1, 1, 2});
  steps(1);
  EXPECT_FALSE(end_.turn());
}

TEST_F(Px4Lines, MotorsOfOneThatHangsUpStopAndOneThatCallsAgainIsHeard) {
  {
    Port px4 = call();
    steps(1);
    say(px4, mavlink::HilActuatorControls{.controls = {0.5f, 0.5f, 0.5f, 0.5f}, .mode = 129},
        {1, 1, 0});
    steps(1);
    EXPECT_GT(end_.motors()[0], 0.0);
  }
  steps(600);
  EXPECT_FALSE(end_.turn());
  EXPECT_EQ(end_.motors()[0], 0.0);
  Port again = call();
  steps(9);
  EXPECT_GE(heard<mavlink::HilSensor>(again).size(), 2U);
  say(again, mavlink::HilActuatorControls{.mode = 129}, {1, 1, 0});
  steps(1);
  EXPECT_TRUE(end_.turn());
}

TEST_F(Px4Lines, WhatItSaysGoesToTheProgramAndBack) {
  beats(false, 4);
  Port program = answering();
  EXPECT_EQ(heard<mavlink::Heartbeat>(program).size(), 1U);
  EXPECT_FALSE(end_.called());
  say(program, mavlink::Heartbeat{.type = 18}, {1, 191, 0});
  say(program, mavlink::SetAttitudeTarget{.thrust = 0.3f}, {1, 191, 1});
  steps(1);
  EXPECT_TRUE(end_.called());
  const auto targets = heard<mavlink::SetAttitudeTarget>(companion_);
  ASSERT_EQ(targets.size(), 1U);
  EXPECT_EQ(targets[0].thrust, 0.3f);
  steps(100);
  EXPECT_NEAR(end_.held_for(), 0.1, 1e-9) << "so old is the last set point";
  end_.cut();
  say(program, mavlink::SetAttitudeTarget{}, {1, 191, 2});
  beats(false, 4);
  EXPECT_TRUE(heard<mavlink::SetAttitudeTarget>(companion_).empty());
  EXPECT_TRUE(heard<mavlink::Heartbeat>(program).empty());
}

TEST_F(Px4Lines, ArmsFirstAndChoosesTheModeThenAndSaysItUntilItIsSo) {
  beats(false, 4);
  switches(false, false);
  EXPECT_THAT(commands(), ElementsAre());
  switches(true, false);
  steps(100), switches(true, false);
  EXPECT_THAT(commands(), ElementsAre("400 1"));
  steps(200), switches(true, true);
  EXPECT_THAT(commands(), ElementsAre("400 1")) << "again, and no mode before it is armed";
  beats(true, 4), switches(true, true);
  EXPECT_THAT(commands(), ElementsAre("176 6"));
  steps(300), switches(true, true);
  EXPECT_THAT(commands(), ElementsAre("176 6"));
  beats(true, 6);
  steps(300), switches(true, true);
  EXPECT_THAT(commands(), ElementsAre());
  // A drone that disarms by itself is not armed again: the switch has not been moved.
  beats(false, 6);
  steps(300), switches(true, true);
  EXPECT_THAT(commands(), ElementsAre());
}

TEST_F(Px4Lines, TakenBackItIsDisarmedAtOnceAndOutOfTheMode) {
  beats(false, 4);
  switches(true, true);
  beats(true, 4), switches(true, true);
  beats(true, 6), switches(true, true);
  (void)commands();
  switches(false, false);
  const auto all = heard<mavlink::CommandLong>(station_);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].command, 400);
  EXPECT_EQ(all[0].param1, 0.0f);
  EXPECT_EQ(all[0].param2, 21196.0f) << "in the air, too";
  EXPECT_EQ(all[1].command, 176);
  EXPECT_EQ(all[1].param2, 4.0f);
}

}  // namespace
}  // namespace gatefly::link_sim
