// SPDX-License-Identifier: Apache-2.0
// Datagrams to and from the simulators of two autopilots.
#include <array>
#include <charconv>
#include <chrono>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/link/ardupilot_json.hpp"
#include "gatefly/link/betaflight_sitl.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using test::for_all;
using test::IsNear;
using Data = std::vector<std::uint8_t>;

std::string line_of(const ardupilot::State& state) {
  std::array<char, ardupilot::kLongestLine> out{};
  return {out.data(), ardupilot::encode_state(state, out)};
}

/// As its reader does: the number behind the text of a key.
double number_behind(const std::string& line, std::string_view key, int place = 0) {
  std::size_t at = line.find(key) + key.size();
  for (; place > 0; --place) at = line.find(", ", at) + 2;
  if (line[at] == '[') ++at;
  double value = 0;
  (void)std::from_chars(line.data() + at, line.data() + line.size(), value);
  return value;
}

TEST(ArdupilotJson, ALineIsAsItsReaderWantsIt) {
  EXPECT_EQ(line_of({.time = 1500ms,
                     .imu = {.gyro_B = {0.1, -0.2, 0.3}, .accel_B = {0, 0, -9.81}},
                     .p_EB = {1, 2, -3},
                     .v_E = {4, 5, 6},
                     .attitude = {1, 0, 0, 0}}),
            "\n{\"timestamp\":1.5,\"imu\":{\"gyro\":[0.1, -0.2, 0.3],\"accel_body\":[0, 0, -9.81]},"
            "\"position\":[1, 2, -3],\"quaternion\":[1, 0, 0, 0],\"velocity\":[4, 5, 6]}\n");
}

TEST(ArdupilotJson, NumbersComeBackToTheLastBit) {
  for_all(200, [](Rng& rng) {
    const ardupilot::State state{
        .time = std::chrono::nanoseconds{rng.uniform_index(1'000'000'000)},
        .imu = {.gyro_B = test::any_vector3(rng, 10), .accel_B = test::any_vector3(rng, 1e-9)},
        .p_EB = test::any_vector3(rng, 1e6),
        .range_down = rng.uniform(0, 4)};
    const std::string line = line_of(state);
    EXPECT_EQ(number_behind(line, "\"gyro\":", 2), state.imu.gyro_B.z());
    EXPECT_EQ(number_behind(line, "\"accel_body\":", 1), state.imu.accel_B.y());
    EXPECT_EQ(number_behind(line, "\"position\":"), state.p_EB.x());
    EXPECT_EQ(number_behind(line, "\"rng_1\":"), *state.range_down);
  });
}

TEST(ArdupilotJson, WhatIsNoNumberOrDoesNotFitIsNotWritten) {
  EXPECT_EQ(line_of({.v_E = {0, std::numeric_limits<double>::quiet_NaN(), 0}}), "");
  EXPECT_EQ(line_of({.range_down = std::numeric_limits<double>::infinity()}), "");
  const ardupilot::State state{.p_EB = {1.0 / 3, 1.0 / 3, 1.0 / 3}};
  const std::size_t size = line_of(state).size();
  std::array<char, ardupilot::kLongestLine> out{};
  for (std::size_t room = 0; room < size; ++room)
    EXPECT_EQ(ardupilot::encode_state(state, std::span{out}.first(room)), 0u);
  EXPECT_EQ(ardupilot::encode_state(state, std::span{out}.first(size)), size);
}

TEST(ArdupilotJson, ALongestLineFitsItsRoom) {
  const double most = -std::numeric_limits<double>::denorm_min();
  const Vector3d v{most, most, most};
  EXPECT_GT(line_of({.time = -9223372036854775807ns,
                     .imu = {v, v},
                     .p_EB = v,
                     .v_E = v,
                     .attitude = {most, most, most, most},
                     .range_down = most})
                .size(),
            100u);
}

TEST(ArdupilotJson, PulsesOf16And32ChannelsAreReadAndNothingElse) {
  Data bytes{0x1A, 0x48, 0x90, 0x01, 5, 0, 0, 0};
  for (int i = 0; i < 16; ++i) bytes.push_back(std::uint8_t(i)), bytes.push_back(4);
  const auto servos = ardupilot::servos_in(bytes);
  ASSERT_TRUE(servos);
  EXPECT_EQ(servos->steps_per_second, 400);
  EXPECT_EQ(servos->frame, 5u);
  EXPECT_EQ(servos->channels, 16u);
  EXPECT_EQ(servos->pulse_us[3], 1027);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(ardupilot::servos_in(link::Bytes{bytes}.first(size)));
  bytes[0] = 0x81, bytes[1] = 0x73;  // 29569
  EXPECT_FALSE(ardupilot::servos_in(bytes)) << "it says 32 channels";
  bytes.resize(8 + 64, 0);
  EXPECT_EQ(ardupilot::servos_in(bytes)->channels, 32u);
  bytes[0] = 0;
  EXPECT_FALSE(ardupilot::servos_in(bytes));
}

std::array<double, 18> doubles_of(const betaflight_sitl::State& state) {
  const auto bytes = betaflight_sitl::encode_state(state);
  return link::ByteReader{bytes}.take_array<double, 18>();
}

TEST(BetaflightSitl, StateHasTheSignsThatItsReaderUndoes) {
  const auto d = doubles_of({.time = 1500ms,
                             .imu = {.gyro_B = {1, 2, 3}, .accel_B = {4, 5, 6}},
                             .p_EB = {0, 0, -10},
                             .v_E = {7, 8, 9}});
  EXPECT_EQ(d[0], 1.5);
  EXPECT_THAT(Vector3d(d[1], d[2], d[3]), IsNear(Vector3d(1, 2, -3), 0));
  EXPECT_THAT(Vector3d(d[4], d[5], d[6]), IsNear(Vector3d(-4, 5, 6), 0));
  EXPECT_THAT(Vector3d(d[11], d[12], d[13]), IsNear(Vector3d(8, 7, -9), 0)) << "east, north, up";
  EXPECT_EQ(
      betaflight_sitl::encode_state({.imu = {.gyro_B = {0, 0, 3}}}, betaflight_sitl::Release::k4_5),
      betaflight_sitl::encode_state({.imu = {.gyro_B = {0, 0, -3}}}))
      << "4.5 reads the yaw's gyro with the other sign";
  EXPECT_EQ(d[16], 10);
  EXPECT_NEAR(d[17], 101325 - 117, 1);
}

// As its source has it (2026.12, Gazebo's bridge): half a turn about x, then a quarter to the left.
TEST(BetaflightSitl, AttitudeIsThatOfTheBodyInNorthWestUpOnceItsReaderHasTurnedIt) {
  for_all(200, [](Rng& rng) {
    const Attitude attitude = test::any_attitude(rng, 1.4);
    const auto d = doubles_of({.attitude = attitude});
    const Eigen::Quaterniond half_turned{d[7], d[8], -d[9], -d[10]};
    const Eigen::Quaterniond quarter_left{Eigen::AngleAxisd{kPi / 2, Vector3d::UnitZ()}};
    const Eigen::Vector3d half_turn{1, -1, -1};  // of axes, about x: down is up
    EXPECT_THAT(
        (quarter_left * half_turned).toRotationMatrix(),
        IsNear(half_turn.asDiagonal() * rotation_EB(attitude).matrix * half_turn.asDiagonal(),
               1e-12));
  });
}

TEST(BetaflightSitl, MotorsAndPulsesAreReadAndNothingElse) {
  Data bytes(16, 0);
  bytes[3] = 0x3F;  // 0.5
  bytes[15] = 0x3F, bytes[14] = 0x80;
  const auto motors = betaflight_sitl::motors_in(bytes);
  ASSERT_TRUE(motors);
  EXPECT_EQ((*motors)[0], 0.5F);
  EXPECT_EQ((*motors)[3], 1.0F);
  EXPECT_FALSE(betaflight_sitl::motors_in(link::Bytes{bytes}.first(15)));
  Data raw(68, 0);
  raw[0] = 4;
  raw[4] = 0, raw[5] = 0, raw[6] = 0x7A, raw[7] = 0x44;  // 1000
  const auto servos = betaflight_sitl::raw_servos_in(raw);
  ASSERT_TRUE(servos);
  EXPECT_EQ(servos->motors, 4);
  EXPECT_EQ(servos->pulse_us[0], 1000.0F);
  raw[0] = 17;
  EXPECT_FALSE(betaflight_sitl::raw_servos_in(raw));
  raw.push_back(0);
  EXPECT_FALSE(betaflight_sitl::raw_servos_in(raw));
}

TEST(BetaflightSitl, AReceiverSendsThrottleThird) {
  const auto bytes = betaflight_sitl::encode_receiver(
      2s, {.roll = 1501, .pitch = 1502, .yaw = 1503, .throttle = 1104}, {1800});
  link::ByteReader in{bytes};
  EXPECT_EQ(in.take<double>(), 2.0);
  EXPECT_THAT((in.take_array<std::uint16_t, 6>()),
              testing::ElementsAre(1501, 1502, 1104, 1503, 1800, 0));
  EXPECT_EQ(bytes.size(), 40u);
}

}  // namespace
}  // namespace gatefly
