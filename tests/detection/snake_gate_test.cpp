// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/snake_gate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;
using Eigen::Vector3d;

GateDetections gates_in(const Canvas& canvas, std::uint64_t seed = 1) {
  const auto bytes = canvas.yuv444();
  Rng rng{seed};
  return detect_gates({bytes.data(), PixelFormat::kYuv444, canvas.width(), canvas.height()}, ColorRange{}, {}, rng);
}

double worst_corner(const Quad& a, const Quad& b) {
  double worst = 0;
  for (std::size_t i = 0; i < 4; ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

double median(std::vector<double> x) {
  if (x.empty()) return 1e9;
  std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
  return x[x.size() / 2];
}

// A view from which the whole gate shows.
std::optional<View> view_from(double distance, double roll, Rng& rng, const CameraRig& rig) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    const View view{{-distance, rng.uniform(-0.4, 0.4), rng.uniform(-0.3, 0.4)},
                    {roll + rng.uniform(-0.03, 0.03), rng.uniform(-0.12, 0.0), rng.uniform(-0.15, 0.15)}};
    const auto corners = corners_of(1.0, view, rig);
    if (corners && inside_picture(*corners, 315, 160, 4)) return view;
  }
  return std::nullopt;
}

class SnakeGateAtDistance : public ::testing::TestWithParam<double> {};

// 30 views a distance, seeds 1..30: clean frame, noisy wall. Median over all corners.
TEST_P(SnakeGateAtDistance, RecoversTheOuterCornersToAPixel) {
  const CameraRig rig = bebop_rig();
  std::vector<double> errors;
  int found = 0, views = 0;
  Vector2d growth = Vector2d::Zero();  // found size - true size: inner corners would be 10 % short
  for_all(30, [&](Rng& rng) {
    const auto view = view_from(GetParam(), 0.0, rng, rig);
    if (!view) return;
    ++views;
    Canvas canvas{315, 160};
    canvas.add_noise(rng);
    canvas.draw_gate(*view, rig);
    const Quad truth = *corners_of(1.0, *view, rig);
    const auto gates = gates_in(canvas);
    if (gates.empty() || worst_corner(gates[0].corners_px, truth) > 12) return;
    ++found;
    for (std::size_t i = 0; i < 4; ++i) errors.push_back((gates[0].corners_px[i] - truth[i]).norm());
    growth += Vector2d{std::sqrt(area(gates[0].corners_px)) - std::sqrt(area(truth)), 0};
  });
  ASSERT_GT(views, 20);
  EXPECT_GE(found, views * 9 / 10);
  EXPECT_LT(median(errors), 1.0);
  EXPECT_LT(std::abs(growth.x() / std::max(1, found)), 1.0) << "mean error of the side: outer corners are wanted";
  RecordProperty("median_px_x1000", static_cast<int>(1000 * median(errors)));
}
INSTANTIATE_TEST_SUITE_P(Distances, SnakeGateAtDistance, ::testing::Values(1.7, 2.0, 3.0, 4.0, 5.0));

TEST(SnakeGate, SeesAGateRolledByThirtyDegrees) {
  const CameraRig rig = bebop_rig();
  for (const double roll : {-30 * kDegree, -15 * kDegree, 15 * kDegree, 30 * kDegree}) {
    int found = 0, views = 0;
    std::vector<double> errors;
    for_all(20, [&](Rng& rng) {
      const auto view = view_from(2.8, roll, rng, rig);
      if (!view) return;
      ++views;
      Canvas canvas{315, 160};
      canvas.add_noise(rng);
      canvas.draw_gate(*view, rig);
      const auto gates = gates_in(canvas);
      const Quad truth = *corners_of(1.0, *view, rig);
      if (gates.empty() || worst_corner(gates[0].corners_px, truth) > 12) return;
      ++found;
      for (std::size_t i = 0; i < 4; ++i) errors.push_back((gates[0].corners_px[i] - truth[i]).norm());
    });
    ASSERT_GT(views, 10) << roll / kDegree;
    EXPECT_GE(found, views * 7 / 10) << "of " << views << " at roll " << roll / kDegree;
    EXPECT_LT(median(errors), 1.5) << roll / kDegree;
  }
}

TEST(SnakeGate, ReadsUyvyAsWell) {
  const CameraRig rig = bebop_rig();
  Canvas canvas{316, 160};
  const View view{{-2.5, 0.1, 0.1}, {0, -5 * kDegree, 0}};
  canvas.draw_gate(view, rig);
  const auto bytes = canvas.uyvy();
  Rng rng{1};
  const auto gates = detect_gates({bytes.data(), PixelFormat::kUyvy, 316, 160}, ColorRange{}, {}, rng);
  ASSERT_EQ(gates.size(), 1u);
  EXPECT_LT(worst_corner(gates[0].corners_px, *corners_of(1.0, view, rig)), 2.0);
}

TEST(SnakeGate, TwoGatesAreTwoDetections) {
  const CameraRig rig = bebop_rig();
  const View left{{-3.5, 1.3, 0.1}, {0, -5 * kDegree, 0}}, right{{-3.5, -1.3, 0.1}, {0, -5 * kDegree, 0}};
  Rng rng{4};
  Canvas canvas{315, 160};
  canvas.add_noise(rng);
  canvas.draw_gate(left, rig);
  canvas.draw_gate(right, rig);
  int both = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto gates = gates_in(canvas, seed);
    EXPECT_LE(gates.size(), 2u) << "seed " << seed;
    if (gates.size() != 2) continue;
    const bool first_is_left = center(gates[0].corners_px).x() < center(gates[1].corners_px).x();
    const double error_left = worst_corner(gates[first_is_left ? 0 : 1].corners_px, *corners_of(1.0, left, rig));
    const double error_right = worst_corner(gates[first_is_left ? 1 : 0].corners_px, *corners_of(1.0, right, rig));
    both += error_left < 3 && error_right < 3;
    EXPECT_GE(gates[0].color_fitness, gates[1].color_fitness) << "best first";
  }
  EXPECT_GE(both, 18);
}

TEST(SnakeGate, SameImageSameGeneratorSameAnswer) {
  const CameraRig rig = bebop_rig();
  Rng rng{3};
  Canvas canvas{315, 160};
  canvas.add_noise(rng);
  canvas.draw_gate({{-3, 0.2, 0}, {0.05, -0.08, 0.1}}, rig);
  const auto a = gates_in(canvas, 9), b = gates_in(canvas, 9);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(a[i].corners_px[k], b[i].corners_px[k]);
}

TEST(SnakeGate, AGateCutByTheBorderIsNotMeasured) {
  const CameraRig rig = bebop_rig();
  for_all(30, [&](Rng& rng) {
    // A side bar wholly outside.
    const View view{{-2.2, rng.uniform(1.6, 1.9), 0.1}, {0, -5 * kDegree, 0}};
    const auto truth = corners_of(1.0, view, rig);
    if (!truth || (*truth)[0].x() > -6 || (*truth)[1].x() < 20) return;
    Canvas canvas{315, 160};
    canvas.draw_gate(view, rig);
    EXPECT_TRUE(gates_in(canvas, 1).empty());
  });
}

TEST(SnakeGate, WallsAndPostersAreNoGates) {
  Rng rng{2};
  Canvas wall{315, 160};
  wall.add_noise(rng, 60, 25);
  EXPECT_TRUE(gates_in(wall).empty());

  const CameraRig rig = bebop_rig();
  Canvas poster{315, 160};
  poster.draw_gate({{-2.5, 0, 0}, {0, -0.08, 0}}, rig, 1.0, 0.5);  // bars as wide as half the gate: filled
  EXPECT_TRUE(gates_in(poster).empty());
}

TEST(SnakeGate, EmptyAndTinyPicturesHaveNoGate) {
  Rng rng{1};
  EXPECT_TRUE(detect_gates(Image{}, ColorRange{}, {}, rng).empty());
  EXPECT_TRUE(detect_gates_near(Image{}, ColorRange{}, {}, Quad{}).empty());
  for (const auto& [w, h] : {std::pair{1, 1}, std::pair{2, 2}, std::pair{1, 200}, std::pair{200, 1}}) {
    Canvas canvas{w, h};
    canvas.fill({120, 90, 190});
    EXPECT_TRUE(gates_in(canvas).empty()) << w << " x " << h;
    const auto bytes = canvas.yuv444();
    const Quad previous{{{10, 10}, {50, 10}, {50, 50}, {10, 50}}};
    EXPECT_TRUE(detect_gates_near({bytes.data(), PixelFormat::kYuv444, w, h}, ColorRange{}, {}, previous).empty());
  }
}

TEST(SnakeGate, APictureFullOfTheColourHasNoGateAndBoundedCost) {
  Canvas canvas{315, 160};
  canvas.fill({120, 90, 190});
  const auto before = std::chrono::steady_clock::now();
  EXPECT_TRUE(gates_in(canvas).empty());
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::milliseconds{500});

  Canvas large{3150, 1600};
  large.fill({120, 90, 190});
  const auto bytes = large.yuv444();
  Rng rng{1};
  const auto start = std::chrono::steady_clock::now();
  EXPECT_TRUE(detect_gates({bytes.data(), PixelFormat::kYuv444, 3150, 1600}, ColorRange{}, {}, rng).empty());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds{2000});
}

TEST(SnakeGateNear, FindsTheGateAgainAfterItMovedAndNotWhenItIsGone) {
  const CameraRig rig = bebop_rig();
  const View before{{-2.6, 0.1, 0.1}, {0, -0.08, 0.0}}, now{{-2.5, 0.1, 0.1}, {0.01, -0.08, 0.03}};
  Canvas canvas{315, 160};
  canvas.draw_gate(now, rig);
  const auto bytes = canvas.yuv444();
  const Quad previous = *corners_of(1.0, before, rig);
  const auto found = detect_gates_near({bytes.data(), PixelFormat::kYuv444, 315, 160}, ColorRange{}, {}, previous);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(worst_corner(found[0].corners_px, *corners_of(1.0, now, rig)), 2.0);

  const auto nothing = Canvas{315, 160}.yuv444();
  EXPECT_TRUE(detect_gates_near({nothing.data(), PixelFormat::kYuv444, 315, 160}, ColorRange{}, {}, previous).empty());
}

}  // namespace
}  // namespace gatefly
