// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/sensing/image.hpp"

namespace gatefly::sim {
namespace {

constexpr int kSensorWidth = 64,
              kSensorHeight = 126;  // stored; a small sensor does for most statements
constexpr int kMidX = kSensorWidth / 2, kMidY = kSensorHeight / 2;
constexpr double kBlack = 66.0;  // docs/simulation.md

using Radiance = std::function<Float4(int x, int y)>;

Radiance grey(float level) {
  return [level](int, int) { return Float4{level, level, level, 0}; };
}

world::CameraTruth small() {
  world::CameraTruth truth;
  truth.stored_width = kSensorWidth, truth.stored_height = kSensorHeight;
  return truth;
}

std::vector<Float4> picture_of(const Radiance& radiance) {
  std::vector<Float4> picture;
  for (int y = 0; y < kSensorHeight; ++y)
    for (int x = 0; x < kSensorWidth; ++x) picture.push_back(radiance(x, y));
  return picture;
}

world::LightConditions without_noise() {
  world::LightConditions light;
  light.noise_scale = 0.0;
  return light;
}

/// A camera that has metered one scene and goes on looking.
class Camera {
 public:
  explicit Camera(const world::LightConditions& light = without_noise(), std::uint64_t seed = 1)
      : sensor_{small(), light, seed} {}

  /// As for a first frame.
  Camera& meter(const Radiance& radiance) {
    sensor_.meter(picture_of(radiance));
    return *this;
  }
  /// Takes the next picture, a fifteenth of a second later.
  Camera& look(const Radiance& radiance) {
    auto picture = picture_of(radiance);
    sensor_.develop(frame_++, t_, picture, bytes_);
    t_ += 1.0 / 15.0;
    return *this;
  }
  [[nodiscard]] int y(int column, int line) const { return bytes_[at(column, line) + 1]; }
  /// Cb and Cr of the pair that a stored pixel is in.
  [[nodiscard]] int cb(int column, int line) const { return bytes_[at(column & ~1, line)]; }
  [[nodiscard]] int cr(int column, int line) const { return bytes_[at(column & ~1, line) + 2]; }
  /// Reading of the meter: bright places cut at 165.
  [[nodiscard]] double mean() const {
    double sum = 0.0;
    for (std::size_t i = 1; i < bytes_.size(); i += 2) sum += std::min<int>(bytes_[i], 165);
    return sum / (0.5 * static_cast<double>(bytes_.size()));
  }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  [[nodiscard]] double exposure() const { return sensor_.exposure(); }

 private:
  [[nodiscard]] static std::size_t at(int column, int line) {
    return 2 * static_cast<std::size_t>(line * kSensorWidth + column);
  }
  Sensor sensor_;
  std::uint32_t frame_ = 1;
  double t_ = 1.0;
  std::vector<std::uint8_t> bytes_;
};

/// A room: a gradient, so that not all is one grey.
Radiance room(float brightness) {
  return [brightness](int x, int y) {
    const float level = brightness * (0.1f + 0.4f * static_cast<float>(y) / kSensorHeight +
                                      0.2f * static_cast<float>(x) / kSensorWidth);
    return Float4{level, level, level, 0};
  };
}

// Blacks of the real pictures: Cb 138, Cr 130.
TEST(Sensor, BlackIsTheBlackLevelAndPurple) {
  Camera camera;
  camera.look(grey(0.0f));
  for (int line = 0; line < kSensorHeight; line += 5) {
    EXPECT_EQ(camera.y(kMidX, line), kBlack);
    EXPECT_NEAR(camera.cb(kMidX, line), 138, 1);
    EXPECT_NEAR(camera.cr(kMidX, line), 130, 1);
  }
}

TEST(Sensor, LampsAreClippedBelowWhite) {
  Camera camera;
  camera.look(grey(1000.0f));
  EXPECT_GT(camera.y(kMidX, kMidY), 225);
  EXPECT_LE(camera.y(kMidX, kMidY), 255);
  EXPECT_GT(camera.cr(kMidX, kMidY), 128 + 5) << "and come out pink";
}

TEST(Sensor, TheCornersAreDarkerThanTheMiddle) {
  Camera camera;
  camera.meter(grey(1.0f)).look(grey(1.0f));
  EXPECT_GT(camera.y(kMidX, kMidY), camera.y(kMidX, 2) + 5);
  EXPECT_GT(camera.y(kMidX, 2), camera.y(1, 2));
  EXPECT_NEAR(camera.y(1, 2), camera.y(kSensorWidth - 2, kSensorHeight - 3), 1);
}

// Stored as U Y0 V Y1: each colour moves its own bytes, in its own direction.
TEST(Sensor, StoresUyvy) {
  const float low = 0.1f, high = 0.4f;
  struct Case {
    Float4 color;
    int cb, cr;  // signs of the change against grey, where it is plain
  };
  Camera neutral;
  neutral.look(grey(low));
  for (const Case& one : {Case{{high, low, low, 0}, 0, +1}, Case{{low, high, low, 0}, -1, -1},
                          Case{{low, low, high, 0}, +1, 0}}) {
    Camera camera;
    camera.look([&](int, int) { return one.color; });
    if (one.cb != 0) {
      EXPECT_GT(one.cb * (camera.cb(kMidX, kMidY) - neutral.cb(kMidX, kMidY)), 20);
    }
    if (one.cr != 0) {
      EXPECT_GT(one.cr * (camera.cr(kMidX, kMidY) - neutral.cr(kMidX, kMidY)), 20);
    }
    const Image image{camera.bytes().data(), PixelFormat::kUyvy, kSensorWidth, kSensorHeight, 90};
    const Yuv seen = image.at(kMidY, kSensorWidth - 1 - kMidX);
    EXPECT_EQ(seen.y, camera.y(kMidX, kMidY));
    EXPECT_EQ(seen.u, camera.cb(kMidX, kMidY));
    EXPECT_EQ(seen.v, camera.cr(kMidX, kMidY));
  }
}

TEST(Sensor, TwoNeighboursOfALineShareTheMeanOfTheirColours) {
  // Left half grey, right half red; the edge splits a pair.
  const auto scene = [](int x, int) {
    return x < kMidX + 1 ? Float4{0.3f, 0.3f, 0.3f, 0} : Float4{0.6f, 0.1f, 0.1f, 0};
  };
  Camera camera;
  camera.look(scene);
  const int left = camera.cr(kMidX - 12, kMidY), right = camera.cr(kMidX + 12, kMidY),
            split = camera.cr(kMidX, kMidY);
  EXPECT_GT(split, left + (right - left) / 5) << left << ' ' << right;
  EXPECT_LT(split, right - (right - left) / 5) << left << ' ' << right;
}

TEST(Sensor, AWhiteBalanceGainLiftsItsChannel) {
  Camera nominal;
  nominal.look(grey(0.3f));
  world::LightConditions light = without_noise();
  light.white_balance = {1.2, 1.0, 1.0};
  Camera red{light};
  red.look(grey(0.3f));
  EXPECT_GT(red.cr(kMidX, kMidY), nominal.cr(kMidX, kMidY) + 3);
  light.white_balance = {1.0, 1.0, 1.2};
  Camera blue{light};
  blue.look(grey(0.3f));
  EXPECT_GT(blue.cb(kMidX, kMidY), nominal.cb(kMidX, kMidY) + 3);
}

// The page's formula: black level + (117 - black level) target^(1/2.2).
TEST(Sensor, TheMeanGreyBecomesWhatTheExposureTargetSays) {
  for (const double target : {0.5, 0.7, 1.0, 1.3})
    for (const float brightness : {0.3f, 1.0f, 5.0f}) {
      world::LightConditions light = without_noise();
      light.exposure_target = target;
      Camera camera{light};
      camera.meter(room(brightness));
      for (int i = 0; i < 45; ++i) camera.look(room(brightness));
      EXPECT_NEAR(camera.mean(), kBlack + (117 - kBlack) * std::pow(target, 1 / 2.2), 1.0)
          << target << ' ' << brightness;
    }
}

TEST(Sensor, TheFirstFrameIsMetered) {
  for (const float brightness : {0.2f, 1.0f, 10.0f}) {
    Camera camera;
    camera.meter(room(brightness)).look(room(brightness));
    EXPECT_NEAR(camera.mean(), 117, 5) << brightness;
  }
}

TEST(Sensor, BrightLightShortensTheExposureAndDimLightRaisesTheGain) {
  const auto exposure = [](float brightness) {
    return Camera{}.meter(room(brightness)).exposure();
  };
  const double longest = world::CameraTruth{}.exposure;
  EXPECT_EQ(exposure(0.01f), longest);
  EXPECT_LT(exposure(0.6f), longest);
  EXPECT_NEAR(exposure(0.6f) / exposure(1.2f), 2.0, 1e-6) << "the same light in half the time";
  EXPECT_GE(exposure(1e4f), 4.9e-4);
  // Gain makes up for darkness, up to 12.
  EXPECT_NEAR(Camera{}.meter(room(0.2f)).look(room(0.2f)).mean(), 117, 5);
  EXPECT_LT(Camera{}.meter(room(0.005f)).look(room(0.005f)).mean(), 100);
}

// A first-order lag of 0.4 s: the logarithm of the error falls to between a half and a fifth.
TEST(Sensor, ExposureFollowsAStepOfLightWithALag) {
  for (const float step : {0.5f, 2.0f}) {
    Camera camera;
    camera.meter(room(1.0f));
    for (int i = 0; i < 45; ++i) camera.look(room(1.0f));
    const double before = camera.exposure();
    std::vector<double> error;  // of the light, as a logarithm
    for (int i = 0; i < 30; ++i) {
      error.push_back(std::abs(std::log(camera.exposure() * static_cast<double>(step) / before)));
      camera.look(room(step));
    }
    EXPECT_NEAR(error[0], std::log(2.0), 1e-9);
    EXPECT_LT(error[6], 0.5 * error[0]) << step;
    EXPECT_GT(error[6], 0.2 * error[0]) << step;
    EXPECT_LT(error[29], 0.1 * error[0]) << step;
  }
}

/// Variance of Y in the middle of a picture of one grey, without what rounding to bytes adds.
double noise_variance(const world::LightConditions& light, float level) {
  // The whole sensor: the middle is lit evenly.
  Sensor sensor{world::CameraTruth{}, light, 1};
  std::vector<Float4> picture(std::size_t{160} * 315, Float4{level, level, level, 0});
  sensor.meter(picture);
  std::vector<std::uint8_t> bytes;
  sensor.develop(1, 0.0, picture, bytes);
  double sum = 0.0, sum2 = 0.0;
  int count = 0;
  for (std::size_t line = 140; line < 175; ++line)
    for (std::size_t x = 60; x < 100; ++x, ++count) {
      const double y = bytes[2 * (160 * line + x) + 1];
      sum += y, sum2 += y * y;
    }
  return sum2 / count - sum * sum / (count * count) - 1.0 / 12.0;
}

// The exposure brings the middle of the picture to the same signal s, so that Y's variance is that
// of the signal times the same slope: shot noise gain s / 12,000 and read noise (gain 12 / 12,000)².
// 1400 pixels: the ratio of two variances is good to 4 · √(4 / 1400) = 21 %.
TEST(Sensor, NoiseGrowsWithGainAsShotAndReadNoiseDo) {
  const world::LightConditions light;
  const double longest = world::CameraTruth{}.exposure;
  // The level whose metered exposure just reaches the longest: gain 1.
  const float one = static_cast<float>(Camera{}.meter(grey(1.0f)).exposure() / longest);
  const double signal = 250.0 * longest * static_cast<double>(one);
  const auto expected = [&](double gain) { return gain * signal / 12000.0 + gain * gain * 1e-6; };
  const double at_one = noise_variance(light, one);
  for (const float gain : {2.0f, 3.0f, 3.9f})
    EXPECT_NEAR(noise_variance(light, one / gain) / at_one,
                expected(static_cast<double>(gain)) / expected(1.0),
                0.21 * expected(static_cast<double>(gain)) / expected(1.0))
        << gain;
}

TEST(Sensor, NoiseScaleScalesTheNoise) {
  world::LightConditions twice;
  twice.noise_scale = 2.0;
  EXPECT_NEAR(noise_variance(twice, 0.02f) / noise_variance({}, 0.02f), 4.0, 0.84);
  EXPECT_LT(noise_variance(without_noise(), 0.02f), 0.5);
}

TEST(Sensor, TheSameSeedAndFrameGiveTheSameBytesAndOthersOtherNoise) {
  const auto picture = [](std::uint64_t seed, std::uint32_t frame) {
    Sensor sensor{small(), world::LightConditions{}, seed};
    auto radiance = picture_of(room(0.1f));
    sensor.meter(radiance);
    std::vector<std::uint8_t> bytes;
    sensor.develop(frame, 0.0, radiance, bytes);
    return bytes;
  };
  const auto one = picture(3, 5);
  EXPECT_EQ(one.size(), 2u * kSensorWidth * kSensorHeight);
  EXPECT_EQ(one, picture(3, 5));
  const auto clean = [] {
    Sensor sensor{small(), without_noise(), 3};
    auto radiance = picture_of(room(0.1f));
    sensor.meter(radiance);
    std::vector<std::uint8_t> bytes;
    sensor.develop(5, 0.0, radiance, bytes);
    return bytes;
  }();
  for (const auto& other : {picture(4, 5), picture(3, 6)}) {
    // Noise of its own. A little is alike: rounding, and what the tone curve makes of the mean.
    double both = 0.0, one2 = 0.0, other2 = 0.0;
    for (std::size_t i = 1; i < one.size(); i += 2) {
      const double a = one[i] - clean[i], b = other[i] - clean[i];
      both += a * b, one2 += a * a, other2 += b * b;
    }
    EXPECT_NEAR(both / std::sqrt(one2 * other2), 0.0, 0.15);
  }
}

}  // namespace
}  // namespace gatefly::sim
