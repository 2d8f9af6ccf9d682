// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/gate_bars.hpp"

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

std::optional<GateBars> bars_in(const Canvas& canvas, const std::optional<Vector2d>& nadir_px = std::nullopt) {
  const auto bytes = canvas.yuv444();
  return detect_bars({bytes.data(), PixelFormat::kYuv444, canvas.width(), canvas.height()}, ColorRange{}, {}, nadir_px);
}

std::optional<Vector2d> nadir_of(const View& view, const CameraRig& rig) {
  return vanishing_point_px(rig.lens, (rotation_EB(view.attitude_GB).matrix * rig.R_BC.matrix).transpose() * Vector3d::UnitZ());
}

class BarsAtPitch : public ::testing::TestWithParam<double> {};

// A tilted camera draws upright bars slanted: 25° down (pitch -5°) spreads one over 25 columns.
TEST_P(BarsAtPitch, BothBarsOfAGateTooNearToBeSeenWholeAreFound) {
  const CameraRig rig = bebop_rig();
  int found = 0;
  constexpr int kViews = 25;
  for_all(kViews, [&](Rng& rng) {
    const View view{{rng.uniform(-1.3, -0.9), rng.uniform(-0.15, 0.15), rng.uniform(-0.1, 0.1)},
                    {rng.uniform(-0.04, 0.04), GetParam() * kDegree, rng.uniform(-0.08, 0.08)}};
    Canvas canvas{315, 160};
    canvas.draw_gate(view, rig);
    const auto bars = bars_in(canvas, nadir_of(view, rig));
    if (!bars) return;
    ++found;
    // The answer lies on the bar: same u as the bar's middle line has at that v.
    for (const double side : {-1.0, 1.0}) {
      const Vector2d px = side < 0 ? bars->left_px : bars->right_px;
      double nearest = 1e9;
      for (double z = -0.5; z <= 0.5; z += 0.005)
        if (const auto on_bar = pixel_of({0, side * 0.475, z}, view, rig)) nearest = std::min(nearest, (*on_bar - px).norm());
      EXPECT_LT(nearest, 4.0) << (side < 0 ? "left" : "right");
    }
    EXPECT_LT(bars->left_px.x(), bars->right_px.x());
  });
  EXPECT_GE(found, kViews * 8 / 10);
}
INSTANTIATE_TEST_SUITE_P(Pitch, BarsAtPitch, ::testing::Values(0.0, -5.0, -10.0));

TEST(DetectBars, RefusesWhatIsNoPairOfBars) {
  Rng rng{1};
  Canvas nothing{315, 160};
  nothing.add_noise(rng);
  EXPECT_FALSE(bars_in(nothing));

  Canvas all{315, 160};
  all.fill({120, 90, 190});
  EXPECT_FALSE(bars_in(all)) << "no valley between the peaks";

  // One bar only: the right half is blanked.
  Canvas one{315, 160};
  one.draw_gate({{-1.2, 0, 0}, {0, 0, 0}}, bebop_rig());
  EXPECT_TRUE(bars_in(one));
  one.blank(170, 315);
  EXPECT_FALSE(bars_in(one));
}

TEST(DetectBars, NastySizes) {
  EXPECT_FALSE(detect_bars(Image{}, ColorRange{}, {}));
  for (const auto& [w, h] : {std::pair{1, 1}, std::pair{1, 100}, std::pair{100, 1}, std::pair{3, 2}, std::pair{4000, 3}}) {
    Canvas canvas{w, h};
    canvas.fill({120, 90, 190});
    EXPECT_FALSE(bars_in(canvas)) << w << " x " << h;
  }
}

}  // namespace
}  // namespace gatefly
