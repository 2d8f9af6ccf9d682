// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/open_gate.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

#include <gtest/gtest.h>

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"

namespace gatefly {
namespace {

using namespace test;

std::optional<OpenGate> open_gate_in(const Canvas& canvas, std::uint64_t seed = 1) {
  const auto bytes = canvas.yuv444();
  Rng rng{seed};
  return detect_open_gate({bytes.data(), PixelFormat::kYuv444, canvas.width(), canvas.height()}, ColorRange{}, {}, rng);
}

// 40 views, seeds 1..40: near enough that the upper bar is out of the picture, lower corners in it.
TEST(OpenGate, RecoversTheOuterLowerCornersOfAGateCutOffAbove) {
  const CameraRig rig = bebop_rig();
  int views = 0, found = 0;
  std::vector<double> errors;
  for_all(40, [&](Rng& rng) {
    const View view{{rng.uniform(-2.0, -1.3), rng.uniform(-0.25, 0.25), rng.uniform(-0.1, 0.2)},
                    {rng.uniform(-0.08, 0.08), rng.uniform(-0.17, -0.05), rng.uniform(-0.1, 0.1)}};
    const auto corners = corners_of(1.0, view, rig);
    if (!corners) return;
    const Quad& q = *corners;
    const bool open = q[0].y() < -4 && q[1].y() < -4;
    const bool lower_in = q[2].y() < 150 && q[3].y() < 150 && q[3].x() > 5 && q[2].x() < 309;
    if (!open || !lower_in) return;
    ++views;
    Canvas canvas{315, 160};
    canvas.add_noise(rng);
    canvas.draw_gate(view, rig);
    const auto gate = open_gate_in(canvas);
    if (!gate) return;
    ++found;
    errors.push_back((gate->bottom_right_px - q[2]).norm());
    errors.push_back((gate->bottom_left_px - q[3]).norm());
  });
  ASSERT_GT(views, 15);
  EXPECT_GE(found, views * 8 / 10) << "of " << views;
  ASSERT_FALSE(errors.empty());
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 1.5) << "median";
  EXPECT_LT(errors[errors.size() * 9 / 10], 4.0) << "nine of ten";
}

TEST(OpenGate, AWholeGateIsNoOpenOne) {
  const CameraRig rig = bebop_rig();
  Canvas canvas{315, 160};
  canvas.draw_gate({{-3, 0.1, 0.1}, {0, -0.05, 0}}, rig);
  EXPECT_FALSE(open_gate_in(canvas));
}

TEST(OpenGate, NothingAndEverythingAreNoGateAndCostLittle) {
  Rng rng{1};
  EXPECT_FALSE(detect_open_gate(Image{}, ColorRange{}, {}, rng));
  Canvas wall{315, 160};
  wall.add_noise(rng, 60, 25);
  EXPECT_FALSE(open_gate_in(wall));
  for (const auto& [w, h] : {std::pair{1, 1}, std::pair{1, 100}, std::pair{100, 1}, std::pair{315, 160}}) {
    Canvas all{w, h};
    all.fill({120, 90, 190});
    const auto start = std::chrono::steady_clock::now();
    EXPECT_FALSE(open_gate_in(all)) << w << " x " << h;
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds{500});
  }
}

}  // namespace
}  // namespace gatefly
