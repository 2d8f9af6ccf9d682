// SPDX-License-Identifier: Apache-2.0
#include "gatefly.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<double, 3> kStill{0.0, 0.0, 0.0}, kRest{0.0, 0.0, -9.81};
constexpr const char* kTrack = "[[gates]]\nposition_m = [4, 0, -1.5]\nheading_deg = 0\n";
constexpr std::uint32_t kTick = 1953;  // µs

template <class Struct>
Struct sized() {
  Struct s{};
  s.struct_size = sizeof s;
  return s;
}

gatefly_setup setup_of_texts() {
  auto setup = sized<gatefly_setup>();
  setup.track_text = kTrack;
  return setup;
}

/// A pilot on the floor, whose clock begins at `stamp`.
class CPilot : public ::testing::Test {
 protected:
  void SetUp() override {
    const gatefly_setup setup = setup_of_texts();
    std::array<char, GATEFLY_ERROR_SIZE> error{};
    ASSERT_EQ(gatefly_create(nullptr, 0, &setup, &pilot, error.data(), error.size()), GATEFLY_OK)
        << error.data();
  }
  void TearDown() override { gatefly_destroy(pilot); }

  gatefly_status step(const std::array<double, 3>& gyro = kStill,
                      const std::array<double, 3>& accel = kRest) {
    stamp += kTick;
    auto shaken = gyro;  // no IMU says the same twice while rotors turn
    shaken[0] += stamp / kTick % 2 * 1e-12;
    return gatefly_step(pilot, stamp, shaken.data(), accel.data(), &command);
  }
  void rest(int steps) {
    for (int i = 0; i < steps; ++i) ASSERT_EQ(step(), GATEFLY_OK);
  }
  gatefly_health health() {
    auto h = sized<gatefly_health>();
    EXPECT_EQ(gatefly_get_health(pilot, &h), GATEFLY_OK);
    return h;
  }
  gatefly_state state() {
    auto s = sized<gatefly_state>();
    EXPECT_EQ(gatefly_get_state(pilot, &s), GATEFLY_OK);
    return s;
  }
  int phase() { return static_cast<int>(state().phase); }

  gatefly_pilot* pilot = nullptr;
  gatefly_command command = sized<gatefly_command>();
  std::uint32_t stamp = 0;
};

TEST_F(CPilot, RestsThenStartsItsMotors) {
  rest(512);
  EXPECT_EQ(phase(), GATEFLY_ON_GROUND);
  EXPECT_EQ(command.motors_off, 1u);
  rest(512);
  EXPECT_EQ(phase(), GATEFLY_TAKE_OFF);
  EXPECT_EQ(command.motors_off, 0u);
  EXPECT_GT(command.thrust_mps2, 9.0);
  auto again = sized<gatefly_command>();
  ASSERT_EQ(gatefly_get_command(pilot, &again), GATEFLY_OK);
  EXPECT_EQ(std::memcmp(&again, &command, sizeof again), 0);
}

TEST_F(CPilot, StampsThatWrapGoOn) {
  stamp = 0xffffffffu - 100 * kTick;
  rest(200);
  const std::uint64_t before = 0xffffffffull - 99 * kTick;
  EXPECT_EQ(state().time_us, before + 199 * kTick);
  EXPECT_EQ(health().clock_wraps, 1u);
  EXPECT_EQ(health().clock_jumps, 0u);
}

TEST_F(CPilot, ARepeatedOrOlderStampIsNoStep) {
  rest(10);
  const std::uint64_t steps = health().steps;
  stamp -= kTick;
  EXPECT_EQ(step(), GATEFLY_STALE);
  EXPECT_EQ(gatefly_step(pilot, stamp - 100'000, kStill.data(), kRest.data(), &command),
            GATEFLY_STALE);
  EXPECT_EQ(health().steps, steps);
  EXPECT_EQ(health().imu_stale, 2u);
  EXPECT_EQ(health().problems & GATEFLY_PROBLEM_CLOCK, unsigned{GATEFLY_PROBLEM_CLOCK});
  EXPECT_EQ(step(), GATEFLY_OK);
  EXPECT_EQ(health().problems, 0u);
}

TEST_F(CPilot, AClockThatWasSetIsFollowedWithoutAJump) {
  for (const std::uint32_t set_by : {10'000'000u, 0u - 10'000'000u, 0u - 100'000u}) {
    rest(10);
    const std::uint64_t before = state().time_us;
    stamp += set_by;
    EXPECT_EQ(step(), GATEFLY_STALE);
    EXPECT_EQ(step(), GATEFLY_STALE);
    EXPECT_EQ(step(), GATEFLY_OK);
    EXPECT_EQ(state().time_us, before + kTick);
  }
  EXPECT_EQ(health().clock_jumps, 3u);
  EXPECT_EQ(health().clock_wraps, 0u);
}

TEST_F(CPilot, OneStampOfGarbageIsLetBe) {
  rest(10);
  const std::uint64_t before = state().time_us;
  EXPECT_EQ(gatefly_step(pilot, stamp + 12'345'678, kStill.data(), kRest.data(), &command),
            GATEFLY_STALE);
  rest(1);
  EXPECT_EQ(state().time_us, before + kTick);
  EXPECT_EQ(health().clock_jumps, 0u);
}

TEST_F(CPilot, AClockThatStandsEndsTheFlight) {
  rest(1024);
  ASSERT_EQ(phase(), GATEFLY_TAKE_OFF);
  for (int i = 0; i < 512; ++i)
    EXPECT_EQ(gatefly_step(pilot, stamp, kStill.data(), kRest.data(), &command), GATEFLY_STALE);
  EXPECT_GE(phase(), GATEFLY_LAND);
  EXPECT_EQ(state().abort_reason, GATEFLY_SENSORS_LOST);
}

TEST_F(CPilot, SamplesThatAreNoNumbersAreSaidAndSteppedOver) {
  rest(10);
  const std::uint64_t before = state().time_us;
  EXPECT_EQ(step({kNan, 0, 0}), GATEFLY_NOT_FINITE);
  EXPECT_EQ(step(kStill, {0, 0, std::numeric_limits<double>::infinity()}), GATEFLY_NOT_FINITE);
  EXPECT_EQ(step({0, 0, 101.0}), GATEFLY_OUT_OF_RANGE);
  EXPECT_EQ(state().time_us, before + 3 * kTick);
  const gatefly_health h = health();
  EXPECT_EQ(h.imu_not_finite, 2u);
  EXPECT_EQ(h.imu_out_of_range, 1u);
  EXPECT_EQ(h.since_imu_us, 3u * kTick);
  for (const double value : state().position_m) EXPECT_TRUE(std::isfinite(value));
}

TEST_F(CPilot, WithoutUsableSamplesItGivesUp) {
  rest(1024);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(step({kNan, kNan, kNan}), GATEFLY_NOT_FINITE);
  EXPECT_EQ(state().abort_reason, GATEFLY_SENSORS_LOST);
  const unsigned both = GATEFLY_PROBLEM_IMU | GATEFLY_PROBLEM_ABORTED;
  EXPECT_EQ(health().problems & both, both);
}

TEST_F(CPilot, HeightsAreCheckedWhereTheyEnter) {
  rest(10);
  EXPECT_EQ(gatefly_push_sonar(pilot, stamp, 1.0), GATEFLY_OK);
  EXPECT_EQ(gatefly_push_sonar(pilot, stamp, 1.0), GATEFLY_STALE);
  EXPECT_EQ(gatefly_push_sonar(pilot, stamp + 1, kNan), GATEFLY_NOT_FINITE);
  EXPECT_EQ(gatefly_push_sonar(pilot, stamp + 1, 0.0), GATEFLY_OUT_OF_RANGE);
  EXPECT_EQ(gatefly_push_baro(pilot, stamp, -3.0), GATEFLY_OK);
  EXPECT_EQ(gatefly_push_baro(pilot, stamp + 5'000'000, 1.0), GATEFLY_STALE);
  EXPECT_EQ(health().heights, 2u);
  EXPECT_EQ(health().heights_refused, 4u);
}

TEST_F(CPilot, PicturesOfAnotherSizeOrTimeAreRefused) {
  rest(10);
  const std::vector<std::uint8_t> bytes(std::size_t{2} * 160 * 315, 128);
  const auto push = [&](std::uint32_t at, gatefly_format format, std::uint32_t width,
                        std::size_t size) {
    return gatefly_push_image(pilot, at, format, width, 315, bytes.data(), size);
  };
  EXPECT_EQ(push(stamp, GATEFLY_UYVY, 160, bytes.size()), GATEFLY_OK);
  EXPECT_EQ(push(stamp, GATEFLY_UYVY, 160, bytes.size()), GATEFLY_STALE);
  EXPECT_EQ(push(stamp + 1, GATEFLY_UYVY, 160, bytes.size() - 1), GATEFLY_WRONG_IMAGE);
  EXPECT_EQ(push(stamp + 1, GATEFLY_RGB, 160, bytes.size()), GATEFLY_WRONG_IMAGE);
  EXPECT_EQ(push(stamp + 1, GATEFLY_UYVY, 162, bytes.size()), GATEFLY_WRONG_IMAGE);
  EXPECT_EQ(push(stamp + 1, 7, 160, bytes.size()), GATEFLY_WRONG_ARGUMENT);
  EXPECT_EQ(gatefly_push_image(pilot, stamp + 1, GATEFLY_UYVY, 160, 315, nullptr, bytes.size()),
            GATEFLY_NULL);
  EXPECT_EQ(push(stamp + 2, GATEFLY_UYVY, 160, bytes.size()), GATEFLY_OK);
  rest(1);
  const gatefly_health h = health();
  EXPECT_EQ(h.images, 1u);
  EXPECT_EQ(h.images_overtaken, 1u);
  EXPECT_EQ(h.images_refused, 4u);
  EXPECT_EQ(h.since_image_us, 0u);
}

TEST_F(CPilot, NullAndForeignPointersAreAnError) {
  auto s = sized<gatefly_state>();
  std::vector<std::uint64_t> no_pilot(gatefly_size() / 8 + 1);
  for (gatefly_pilot* none :
       {static_cast<gatefly_pilot*>(nullptr), reinterpret_cast<gatefly_pilot*>(no_pilot.data())}) {
    EXPECT_EQ(gatefly_step(none, 1, kStill.data(), kRest.data(), &command), GATEFLY_NULL);
    EXPECT_EQ(gatefly_push_sonar(none, 1, 1.0), GATEFLY_NULL);
    EXPECT_EQ(gatefly_push_baro(none, 1, 1.0), GATEFLY_NULL);
    EXPECT_EQ(gatefly_look_on(none, 0, nullptr), GATEFLY_NULL);
    EXPECT_EQ(gatefly_get_state(none, &s), GATEFLY_NULL);
    gatefly_destroy(none);
  }
  EXPECT_EQ(gatefly_step(pilot, 1, nullptr, kRest.data(), &command), GATEFLY_NULL);
  EXPECT_EQ(gatefly_step(pilot, 1, kStill.data(), nullptr, &command), GATEFLY_NULL);
  EXPECT_EQ(gatefly_step(pilot, 1, kStill.data(), kRest.data(), nullptr), GATEFLY_NULL);
  EXPECT_EQ(gatefly_get_state(pilot, nullptr), GATEFLY_NULL);
  EXPECT_EQ(gatefly_get_health(pilot, nullptr), GATEFLY_NULL);
}

TEST_F(CPilot, AStructureOfNoVersionIsRefusedAndALongerOneServed) {
  gatefly_state s{};
  s.struct_size = sizeof s - 8;
  EXPECT_EQ(gatefly_get_state(pilot, &s), GATEFLY_WRONG_SIZE);
  command.struct_size = 0;
  EXPECT_EQ(step(), GATEFLY_WRONG_SIZE);
  struct Later {
    gatefly_state known;
    double more;
  } later{};
  later.known.struct_size = sizeof later, later.more = 7.0;
  EXPECT_EQ(gatefly_get_state(pilot, &later.known), GATEFLY_OK);
  EXPECT_EQ(later.more, 7.0);
}

TEST(CSetup, WhatCannotBeFlownIsSaidInOneLine) {
  std::array<char, GATEFLY_ERROR_SIZE> error{};
  gatefly_pilot* pilot = nullptr;
  const auto made = [&](const gatefly_setup& setup) {
    return gatefly_create(nullptr, 0, &setup, &pilot, error.data(), error.size());
  };
  gatefly_setup setup = setup_of_texts();
  setup.track_text = "laps = 0\n";
  EXPECT_EQ(made(setup), GATEFLY_WRONG_SETUP);
  EXPECT_THAT(error.data(), testing::StartsWith("track text:1: "));
  setup = setup_of_texts();
  setup.config_text = "[camera]\nwidht = 3\n";
  EXPECT_EQ(made(setup), GATEFLY_WRONG_SETUP);
  EXPECT_THAT(error.data(), testing::StartsWith("config text:2: camera.widht is not a known key"));
  setup = setup_of_texts();
  const char* settings[] = {"camera.latency_ms=-1"};
  setup.settings = settings, setup.setting_count = 1;
  EXPECT_EQ(made(setup), GATEFLY_WRONG_SETUP);
  EXPECT_THAT(error.data(), testing::HasSubstr("camera.latency_ms"));
  setup.settings = nullptr;
  EXPECT_EQ(made(setup), GATEFLY_NULL);
  setup = setup_of_texts();
  setup.track = "oval";
  EXPECT_EQ(made(setup), GATEFLY_WRONG_SETUP) << "both a file and a text";
  setup.track = "no_such_track", setup.track_text = nullptr;
  EXPECT_EQ(made(setup), GATEFLY_WRONG_SETUP);
  EXPECT_EQ(std::strchr(error.data(), '\n'), nullptr);
  setup = setup_of_texts();
  setup.struct_size = 8;
  EXPECT_EQ(made(setup), GATEFLY_WRONG_SIZE);
  EXPECT_EQ(pilot, nullptr);
  EXPECT_EQ(gatefly_create(nullptr, 0, nullptr, &pilot, nullptr, 0), GATEFLY_NULL);
}

TEST(CSetup, ALongErrorIsCutAndEnds) {
  gatefly_setup setup = setup_of_texts();
  setup.track_text = "laps = 0\n";
  gatefly_pilot* pilot = nullptr;
  std::array<char, 8> error{};
  EXPECT_EQ(gatefly_create(nullptr, 0, &setup, &pilot, error.data(), error.size()),
            GATEFLY_WRONG_SETUP);
  EXPECT_STREQ(error.data(), "track t");
}

TEST(CSetup, ThePilotLivesInTheCallersMemory) {
  const gatefly_setup setup = setup_of_texts();
  gatefly_pilot* pilot = nullptr;
  std::vector<unsigned char> memory(gatefly_size() + 1);
  EXPECT_EQ(gatefly_create(memory.data(), gatefly_size() - 1, &setup, &pilot, nullptr, 0),
            GATEFLY_NO_MEMORY);
  // Any start address will do.
  ASSERT_EQ(gatefly_create(memory.data() + 1, gatefly_size(), &setup, &pilot, nullptr, 0),
            GATEFLY_OK);
  EXPECT_GT(reinterpret_cast<unsigned char*>(pilot), memory.data());
  EXPECT_LT(reinterpret_cast<unsigned char*>(pilot), memory.data() + memory.size());
  gatefly_destroy(pilot);
  EXPECT_EQ(gatefly_push_baro(pilot, 1, 1.0), GATEFLY_NULL) << "it is none any more";
}

TEST(CSetup, EveryStatusHasItsWords) {
  for (const int status : {0, 1, 2, 3, 4, 16, 17, 18, 19, 20, 21})
    EXPECT_STRNE(gatefly_status_text(status), "no status");
  EXPECT_STREQ(gatefly_status_text(99), "no status");
  EXPECT_EQ(gatefly_abi(), GATEFLY_ABI);
}

}  // namespace
