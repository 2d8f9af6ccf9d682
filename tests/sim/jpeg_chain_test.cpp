// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/jpeg_chain.hpp"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

namespace gatefly::sim {
namespace {

constexpr int kWidth = 64, kHeight = 48;

std::size_t at(int x, int y) { return static_cast<std::size_t>(2 * (y * kWidth + x)); }

std::vector<std::uint8_t> flat(std::uint8_t y, std::uint8_t cb, std::uint8_t cr) {
  std::vector<std::uint8_t> uyvy(2 * kWidth * kHeight);
  for (std::size_t i = 0; i < uyvy.size(); i += 4)
    uyvy[i] = cb, uyvy[i + 1] = y, uyvy[i + 2] = cr, uyvy[i + 3] = y;
  return uyvy;
}

/// Luma with fine detail that JPEG cannot keep cheaply.
std::vector<std::uint8_t> busy() {
  auto uyvy = flat(0, 128, 128);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      uyvy[at(x, y) + 1] = static_cast<std::uint8_t>(40 + (x * x * 7 + y * y * 13 + x * y) % 170);
  return uyvy;
}

double luma_error(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double sum = 0.0;
  for (std::size_t i = 1; i < a.size(); i += 2) sum += std::abs(a[i] - b[i]);
  return sum / (0.5 * static_cast<double>(a.size()));
}

TEST(JpegChain, KeepsAFlatPicture) {
  auto uyvy = flat(120, 90, 170);
  through_jpeg(uyvy, kWidth, kHeight, 80);
  const auto before = flat(120, 90, 170);
  for (std::size_t i = 0; i < uyvy.size(); ++i) EXPECT_NEAR(uyvy[i], before[i], 2) << i;
}

TEST(JpegChain, LosesMoreTheLowerTheQuality) {
  double last = 0.0;
  for (const int quality : {95, 80, 50, 20}) {
    auto uyvy = busy();
    through_jpeg(uyvy, kWidth, kHeight, quality);
    const double error = luma_error(uyvy, busy());
    EXPECT_GT(error, last) << quality;
    last = error;
  }
}

// 4:2:0: lines of alternating colour become one; 4:2:2 would keep them.
TEST(JpegChain, HasOneChromaForTwoLines) {
  auto uyvy = flat(120, 128, 128);
  for (int y = 0; y < kHeight; y += 2)
    for (int x = 0; x < kWidth; x += 2) uyvy[at(x, y)] = 60, uyvy[at(x, y + 1)] = 180;
  through_jpeg(uyvy, kWidth, kHeight, 95);
  for (int x = 16; x < 48; x += 2) EXPECT_NEAR(uyvy[at(x, 20)], uyvy[at(x, 21)], 8) << x;
}

TEST(JpegChain, GivesTheSameBytesEachTime) {
  auto one = busy(), two = busy();
  through_jpeg(one, kWidth, kHeight, 70);
  through_jpeg(two, kWidth, kHeight, 70);
  EXPECT_EQ(one, two);
}

}  // namespace
}  // namespace gatefly::sim
