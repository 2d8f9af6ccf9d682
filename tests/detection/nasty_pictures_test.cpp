// SPDX-License-Identifier: Apache-2.0
// Pictures that no detector may crash on, hang on, or answer with what cannot be. tests/fuzz looks
// for more.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/all_detectors.hpp"
#include "support/draw_gate.hpp"

namespace gatefly {
namespace {

using namespace test;

constexpr std::array<double, 3> kNastyOrange{130, 80, 185}, kGrey{110, 128, 128};
constexpr std::array kFormats{PixelFormat::kUyvy, PixelFormat::kRgb, PixelFormat::kYuv444};

/// In an allocation of exactly its bytes, for the sanitizers' sake.
std::vector<std::uint8_t> bytes_of(PixelFormat format, int width, int height,
                                   const std::function<std::array<double, 3>(int, int)>& color) {
  std::vector<std::uint8_t> bytes(image_bytes(format, width, height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto c = color(x, y);
      const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                         static_cast<std::size_t>(x);
      const auto byte = [&](std::size_t k) { return static_cast<std::uint8_t>(c[k]); };
      if (format == PixelFormat::kUyvy)
        bytes[2 * pixel] = byte(x % 2 == 0 ? 1 : 2), bytes[2 * pixel + 1] = byte(0);
      else
        bytes[3 * pixel] = byte(0), bytes[3 * pixel + 1] = byte(1), bytes[3 * pixel + 2] = byte(2);
    }
  return bytes;
}

std::string complaint(const Canvas& canvas, const DetectorSettings& settings = {}) {
  const auto bytes = canvas.yuv444();
  return AllDetectors{}.complaint(
      {bytes.data(), PixelFormat::kYuv444, canvas.width(), canvas.height()}, settings);
}

class NastySize : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(NastySize, AllColourCheckersNoiseAndHalvesAreSurvivedInEveryLayoutAndTurn) {
  const auto [width, height] = GetParam();
  Rng rng{7};
  const std::vector<std::function<std::array<double, 3>(int, int)>> fills{
      [](int, int) { return kNastyOrange; },
      [](int x, int y) { return (x + y) % 2 == 0 ? kNastyOrange : kGrey; },
      [](int x, int y) { return (x / 8 + y / 8) % 2 == 0 ? kNastyOrange : kGrey; },
      [&](int, int) {
        return std::array{rng.uniform(0, 256), rng.uniform(0, 256), rng.uniform(0, 256)};
      },
      [&rng](int, int) { return rng.uniform(0, 1) < 0.05 ? kNastyOrange : kGrey; },
      [w = width](int x, int) { return x < w / 2 ? kNastyOrange : kGrey; }};
  for (const auto& fill : fills)
    for (const PixelFormat format : kFormats)
      for (const int turn : {0, 90, 180, 270}) {
        const auto bytes = bytes_of(format, width, height, fill);
        EXPECT_EQ(AllDetectors{}.complaint({bytes.data(), format, width, height, turn}, {}), "")
            << width << " x " << height << ", turned " << turn;
      }
}

INSTANTIATE_TEST_SUITE_P(Sizes, NastySize,
                         ::testing::Values(std::pair{0, 0}, std::pair{1, 1}, std::pair{1, 97},
                                           std::pair{97, 1}, std::pair{2, 2}, std::pair{3, 5},
                                           std::pair{16, 16}, std::pair{17, 31}, std::pair{33, 160},
                                           std::pair{161, 83}));

TEST(NastyPictures, LongAndThinOnesOfOneColourAreSurvived) {
  for (const auto& [width, height] : {std::pair{1, 5000}, {5000, 1}, {17, 4001}, {4001, 17}}) {
    const auto bytes =
        bytes_of(PixelFormat::kYuv444, width, height, [](int, int) { return kNastyOrange; });
    EXPECT_EQ(AllDetectors{}.complaint({bytes.data(), PixelFormat::kYuv444, width, height}, {}), "")
        << width << " x " << height;
  }
}

TEST(NastyPictures, GatesEdgeOnTinyFillingThePictureOrAroundTheCameraAreSurvived) {
  const CameraRig rig = bebop_rig();
  for (const View& view :
       {View{{-0.02, -3.0, 0}, {0, 0, 90 * kDegree}},                          // edge on
        View{{-0.2, -3.0, 0}, {0, 0, 85 * kDegree}}, View{{-60, 0, 0}, {}},    // a pixel
        View{{-25, 0, 0}, {}}, View{{-0.45, 0, 0}, {}},                        // fills the picture
        View{{-0.05, 0, 0}, {}}, View{{-0.6, 0.45, 0}, {60 * kDegree, 0, 0}},  // cut on every side
        View{{-2.0, 0, 0}, {180 * kDegree, 0, 0}},                             // upside down
        View{{-2.0, 0, 0}, {0, 85 * kDegree, 0}}}) {
    Canvas canvas(315, 160);
    canvas.draw_gate(view, rig);
    EXPECT_EQ(complaint(canvas), "") << view.p_GB.transpose();
  }
}

TEST(NastyPictures, SettingsAtTheirEndsAreSurvived) {
  Canvas canvas(315, 160);
  canvas.draw_gate({{-2.5, 0, 0}, {}}, bebop_rig());
  Rng rng{1};
  canvas.add_noise(rng);
  for (const double roll : {0.0, 9.9, 60.0, 90.0})
    for (const double side : {1.0, 500.0})
      for (const double score : {-5.0, 10.0})
        for (const double aspect : {1.0, 20.0}) {
          DetectorSettings s;
          s.search.max_roll_deg = roll, s.search.min_side_px = side, s.search.min_score = score,
          s.search.max_aspect = aspect;
          EXPECT_EQ(complaint(canvas, s), "");
        }
}

}  // namespace
}  // namespace gatefly
