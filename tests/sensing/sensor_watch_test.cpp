// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sensing/sensor_watch.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace gatefly {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN(),
                 kInfinite = std::numeric_limits<double>::infinity();
constexpr bool kRotorsTurn = true;

const Imu kSample{{0.1, 0.2, -0.3}, {0.5, 0.1, -9.7}};

// A sample of a sensor that lives.
Imu shaken(int i) { return {kSample.gyro_B, kSample.accel_B * (1.0 + 1e-3 * (i % 7))}; }

// When the watch first says so, of samples that are all the same [s]; -1: never.
double stuck_after(ImuWatch& watch, double hz, double seconds, bool rotors_turn) {
  for (int i = 0; i < hz * seconds; ++i)
    if (watch.judge(kSample, i / hz, rotors_turn) == SensorFault::kStuck) return i / hz;
  return -1.0;
}

TEST(ImuWatch, RefusesWhatIsNoSampleAndSaysWhy) {
  ImuWatch watch;
  Imu imu = kSample;
  imu.gyro_B.y() = kNoNumber;
  EXPECT_EQ(watch.judge(imu, 0.0, kRotorsTurn), SensorFault::kNotFinite);
  imu = kSample, imu.accel_B.z() = -kInfinite;
  EXPECT_EQ(watch.judge(imu, 0.1, kRotorsTurn), SensorFault::kNotFinite);
  imu = kSample, imu.gyro_B.x() = 101.0;
  EXPECT_EQ(watch.judge(imu, 0.2, kRotorsTurn), SensorFault::kOutOfRange);
  imu = kSample, imu.accel_B.x() = -401.0;
  EXPECT_EQ(watch.judge(imu, 0.3, kRotorsTurn), SensorFault::kOutOfRange);
  EXPECT_EQ(watch.judge(kSample, 0.4, kRotorsTurn), SensorFault::kNone);
}

TEST(ImuWatch, FindsOneThatIsStuckAfterATenthOfASecond) {
  for (const double hz : {100.0, 512.0, 2000.0}) {
    ImuWatch watch;
    const double after = stuck_after(watch, hz, 1.0, kRotorsTurn);
    EXPECT_GE(after, 0.1) << hz;
    EXPECT_LE(after, 0.1 + 1.5 / hz) << hz;
    EXPECT_TRUE(watch.stuck());
  }
  ImuWatch slow;
  EXPECT_NEAR(stuck_after(slow, 25.0, 1.0, kRotorsTurn), 8.0 / 25.0, 1e-9) << "few are chance";
}

TEST(ImuWatch, OnTheGroundACoarseOneMayStandStill) {
  ImuWatch watch;
  EXPECT_LT(stuck_after(watch, 512.0, 10.0, false), 0.0);
  EXPECT_EQ(watch.judge(kSample, 10.0, kRotorsTurn), SensorFault::kNone) << "it begins in the air";
}

TEST(ImuWatch, OneThatLivesAgainIsUsedAgain) {
  ImuWatch watch;
  (void)stuck_after(watch, 512.0, 1.0, kRotorsTurn);
  EXPECT_EQ(watch.judge(shaken(1), 1.0, kRotorsTurn), SensorFault::kNone);
  EXPECT_FALSE(watch.stuck());
  for (int i = 2; i < 5000; ++i)
    EXPECT_EQ(watch.judge(shaken(i), 1.0 + i / 512.0, kRotorsTurn), SensorFault::kNone);
}

TEST(ImuWatch, SamplesBetweenThatAreNoNumbersDoNotHideIt) {
  ImuWatch watch;
  bool found = false;
  for (int i = 0; i < 200; ++i) {
    Imu imu = kSample;
    if (i % 5 == 0) imu.gyro_B.x() = kNoNumber;
    found = found || watch.judge(imu, i / 512.0, kRotorsTurn) == SensorFault::kStuck;
  }
  EXPECT_TRUE(found);
}

TEST(ImuWatch, TheEndOfARangeIsSaidAndTheSampleUsed) {
  ImuWatch watch;
  Imu a = shaken(1), b = shaken(2);
  a.accel_B.z() = b.accel_B.z() = -39.2;
  EXPECT_EQ(watch.judge(a, 0.0, kRotorsTurn), SensorFault::kNone);
  EXPECT_FALSE(watch.saturated());
  EXPECT_EQ(watch.judge(b, 0.002, kRotorsTurn), SensorFault::kNone);
  EXPECT_TRUE(watch.saturated());
  EXPECT_EQ(watch.judge(shaken(3), 0.004, kRotorsTurn), SensorFault::kNone);
  EXPECT_FALSE(watch.saturated()) << "a gyro that repeats a small value is only coarse";
}

TEST(HeightWatch, RefusesWhatIsNoHeight) {
  EXPECT_EQ(fault_of_sonar(kNoNumber), SensorFault::kNotFinite);
  EXPECT_EQ(fault_of_sonar(0.0), SensorFault::kOutOfRange);
  EXPECT_EQ(fault_of_sonar(100.0), SensorFault::kOutOfRange);
  EXPECT_EQ(fault_of_sonar(1.5), SensorFault::kNone);
  EXPECT_EQ(fault_of_baro(-kInfinite), SensorFault::kNotFinite);
  EXPECT_EQ(fault_of_baro(-1e4), SensorFault::kOutOfRange);
  EXPECT_EQ(fault_of_baro(-2.0), SensorFault::kNone);
}

TEST(HeightWatch, FindsOneThatIsStuckInTheAirOnly) {
  HeightWatch air, ground;
  int refused = 0;
  for (int i = 0; i < 100; ++i) {
    refused += air.judge(1.5, SensorFault::kNone, i / 20.0, kRotorsTurn) == SensorFault::kStuck;
    EXPECT_EQ(ground.judge(1.5, SensorFault::kNone, i / 20.0, false), SensorFault::kNone);
  }
  EXPECT_EQ(refused, 60) << "from 2 s on";
  EXPECT_EQ(air.judge(1.51, SensorFault::kNone, 5.0, kRotorsTurn), SensorFault::kNone);
}

TEST(Fingerprint, TellsPicturesApartAndKnowsThemAgain) {
  std::vector<std::uint8_t> bytes(std::size_t{2} * 160 * 315);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * i / 7);
  const auto of = [](const std::vector<std::uint8_t>& b) {
    return fingerprint_of(Image{b.data(), PixelFormat::kUyvy, 160, 315, 90});
  };
  const std::vector<std::uint8_t> copy = bytes;
  EXPECT_NE(of(bytes), 0u);
  EXPECT_EQ(of(bytes), of(copy));
  for (std::size_t i = 0; i < bytes.size(); i += 2) bytes[i] ^= 1;  // noise of one step
  EXPECT_NE(of(bytes), of(copy));
}

TEST(Fingerprint, OfNothingAndOfASingleColourIsNone) {
  EXPECT_EQ(fingerprint_of(Image{}), 0u);
  std::vector<std::uint8_t> rgb;
  for (int i = 0; i < 64 * 48; ++i) rgb.insert(rgb.end(), {200, 100, 50});
  EXPECT_EQ(fingerprint_of(Image{rgb.data(), PixelFormat::kRgb, 64, 48}), 0u);
  const std::vector<std::uint8_t> grey(std::size_t{2} * 64 * 48, 128);
  EXPECT_EQ(fingerprint_of(Image{grey.data(), PixelFormat::kUyvy, 64, 48}), 0u);
  const std::vector<std::uint8_t> tiny(6, 1);
  EXPECT_EQ(fingerprint_of(Image{tiny.data(), PixelFormat::kRgb, 2, 1}), 0u);
}

}  // namespace
}  // namespace gatefly
