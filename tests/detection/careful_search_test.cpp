// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/careful_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/orange.hpp"
#include "support/views_of_a_gate.hpp"
#include "support/worst_corner.hpp"

namespace gatefly {
namespace {

using namespace test;

GateDetections careful_gates_in(const Canvas& canvas) {
  static CarefulSearch search;
  const auto bytes = canvas.yuv444();
  return search.detect({bytes.data(), PixelFormat::kYuv444, canvas.width(), canvas.height()},
                       kOrange);
}

class CarefulSearchFrom : public ::testing::TestWithParam<Place> {};

// 20 views each, clean frame, noisy wall: found, and the median of the worst corners is small.
TEST_P(CarefulSearchFrom, FindsTheOuterCorners) {
  const FoundCorners corners = found_corners(GetParam(), careful_gates_in);
  ASSERT_GE(corners.views, 5);
  EXPECT_GE(corners.found(), corners.views - corners.views / 10);
  EXPECT_LT(corners.median(), 1.5);
}

INSTANTIATE_TEST_SUITE_P(Places, CarefulSearchFrom,
                         ::testing::Values(Place{2.0, 0}, Place{3.0, 0}, Place{4.5, 0},
                                           Place{6.0, 0}, Place{3.0, 30}, Place{3.0, -45},
                                           Place{3.5, 60}));

TEST(CarefulSearch, AWashedOutGateIsFound) {
  const CameraRig rig = bebop_rig();
  int found = 0;
  for_all(10, [&](Rng& rng) {
    const View view{{-3.0, rng.uniform(-0.3, 0.3), 0.1}, {}};
    Canvas canvas(315, 160);
    canvas.draw_gate(view, rig, 1.0, 0.05, {150, 116, 140});  // a few levels from the wall's grey
    canvas.add_noise(rng, 8.0, 2.0);
    const auto gates = careful_gates_in(canvas);
    found += !gates.empty() &&
             worst_corner(gates[0].corners_px, corners_of(1.0, view, rig).value()) < 6.0;
  });
  EXPECT_GE(found, 9);
}

// The window of a caller who knows roughly where, how large and how turned the gate is.
SearchWindow window_around(const Quad& corners, double margin) {
  SearchWindow window{1e9, 1e9, -1e9, -1e9, 0.0, 0.0};
  for (const auto& p : corners) {
    window.left = std::min(window.left, p.x() - margin);
    window.right = std::max(window.right, p.x() + margin);
    window.top = std::min(window.top, p.y() - margin);
    window.bottom = std::max(window.bottom, p.y() + margin);
  }
  const Eigen::Vector2d down = corners[3] - corners[0];
  const double side = down.norm(), roll = std::atan2(-down.x(), down.y());
  window.least_side = 0.6 * side, window.most_side = 1.6 * side;
  window.least_roll = roll - 0.15, window.most_roll = roll + 0.15, window.for_one = true;
  return window;
}

TEST(CarefulSearch, InAWindowTheGateIsTheOneThatIsFoundInAllOfThePicture) {
  CarefulSearch search;
  const CameraRig rig = bebop_rig();
  int found = 0, same = 0;
  for_all(60, [&](Rng& rng) {
    View view = any_view(rng);
    const auto truth = corners_of(1.0, view, rig);
    if (!truth || !inside_picture(*truth, 315, 160)) return;
    Canvas canvas(315, 160);
    canvas.draw_gate(view, rig, 1.0, 0.05, {140, 110, 150});
    canvas.add_noise(rng, 8.0, 2.0);
    const auto bytes = canvas.yuv444();
    const Image image{bytes.data(), PixelFormat::kYuv444, 315, 160};
    const auto all = search.detect(image, kOrange);
    const SearchWindow window = window_around(*truth, 25.0);
    const auto here = search.detect(image, kOrange, &window);
    if (all.empty() || worst_corner(all[0].corners_px, *truth) > 6.0) return;
    ++found;
    same += !here.empty() && worst_corner(here[0].corners_px, all[0].corners_px) < 1.0;
  });
  EXPECT_GE(found, 15);
  EXPECT_GE(same, found - found / 20);
}

TEST(CarefulSearch, OutsideOfTheWindowAndOfAnotherSizeNothingIsFound) {
  CarefulSearch search;
  const CameraRig rig = bebop_rig();
  const View view{{-3.0, 0.1, 0.1}, {}};
  const Quad truth = corners_of(1.0, view, rig).value();
  Canvas canvas(315, 160);
  canvas.draw_gate(view, rig, 1.0, 0.05, {140, 80, 180});
  const auto bytes = canvas.yuv444();
  const Image image{bytes.data(), PixelFormat::kYuv444, 315, 160};
  const auto gates_in = [&](const SearchWindow& window) {
    return search.detect(image, kOrange, &window).size();
  };
  const SearchWindow right = window_around(truth, 20.0);
  EXPECT_EQ(gates_in(right), 1u);
  SearchWindow aside = right, small = right, empty = right;
  aside.left = truth[1].x() + 4.0, aside.right = 400.0;
  small.most_side = 0.5 * right.least_side, small.least_side = 0.0;
  empty.right = empty.left - 5.0;
  const double none = std::nan(""), any = 1e300;
  for (double SearchWindow::*const edge :
       {&SearchWindow::left, &SearchWindow::top, &SearchWindow::right, &SearchWindow::bottom})
    for (const double value : {none, any, -any, HUGE_VAL, -HUGE_VAL}) {
      SearchWindow nasty = right;
      nasty.*edge = value;
      EXPECT_LE(gates_in(nasty), 1u);
    }
  EXPECT_EQ(gates_in(aside), 0u);
  EXPECT_EQ(gates_in(small), 0u);
  EXPECT_EQ(gates_in(empty), 0u);
}

TEST(CarefulSearch, ATraceChangesNothingAndSaysWhatWasTaken) {
  Canvas canvas(315, 160);
  const CameraRig rig = bebop_rig();
  const View view{{-3.0, 0.1, 0.1}, {}};
  canvas.draw_gate(view, rig, 1.0, 0.05, {140, 80, 180});
  const auto bytes = canvas.yuv444();
  const Image image{bytes.data(), PixelFormat::kYuv444, 315, 160};
  CarefulSearch search;
  SearchTrace trace;
  const GateDetections plain = search.detect(image, kOrange),
                       traced = search.detect(image, kOrange, nullptr, &trace);
  ASSERT_EQ(plain.size(), 1u);
  ASSERT_EQ(traced.size(), 1u);
  EXPECT_EQ(plain[0].corners_px, traced[0].corners_px);
  EXPECT_EQ(plain[0].fitness, traced[0].fitness);
  EXPECT_GT(trace.places.size(), 0u);
  const auto taken = std::count_if(trace.finished.begin(), trace.finished.end(),
                                   [](const auto& frame) { return frame.taken; });
  ASSERT_EQ(taken, 1);
  EXPECT_TRUE(trace.finished[0].taken);
  EXPECT_DOUBLE_EQ(confidence_of(trace.finished[0].score.total), traced[0].fitness);
  EXPECT_TRUE(same_place(trace.finished[0].frame_px, traced[0].corners_px));
}

TEST(CarefulSearch, ATraceSaysWhyAFilledSquareWasRefused) {
  Canvas canvas(315, 160);
  canvas.paint(100, 170, 40, 110, {140, 80, 180});
  const auto bytes = canvas.yuv444();
  CarefulSearch search;
  SearchTrace trace;
  EXPECT_TRUE(
      search.detect({bytes.data(), PixelFormat::kYuv444, 315, 160}, kOrange, nullptr, &trace)
          .empty());
  ASSERT_FALSE(trace.places.empty()) << "a template finds its sides";
  for (const auto& frame : trace.finished) EXPECT_FALSE(frame.taken);
  // Refused as a rough frame, for its score, or pixel by pixel.
  const bool at_once = trace.finished.empty();
  EXPECT_TRUE(!at_once || trace.places[0].score.total < trace.least_rough ||
              !trace.places[0].has_shape);
}

TEST(CarefulSearch, NoiseIsNoGate) {
  for_all(30, [](Rng& rng) {
    Canvas canvas(315, 160);
    canvas.add_noise(rng, 60.0, 20.0);
    EXPECT_TRUE(careful_gates_in(canvas).empty());
  });
}

TEST(CarefulSearch, AFilledSquareIsNoGate) {
  const CameraRig rig = bebop_rig();
  Canvas canvas(315, 160);
  canvas.draw_gate({{-3.0, 0, 0}, {}}, rig, 1.0, 0.5);
  EXPECT_TRUE(careful_gates_in(canvas).empty());
}

// Beside each other, and one seen through the opening of the other.
class CarefulSearchOfTwo : public ::testing::TestWithParam<std::array<View, 2>> {};

TEST_P(CarefulSearchOfTwo, FindsBoth) {
  const CameraRig rig = bebop_rig();
  const auto& [near, far] = GetParam();
  Canvas canvas(315, 160);
  canvas.draw_gate(near, rig), canvas.draw_gate(far, rig);
  const auto gates = careful_gates_in(canvas);
  ASSERT_EQ(gates.size(), 2u);
  for (const View& view : {near, far}) {
    const Quad truth = corners_of(1.0, view, rig).value();
    EXPECT_LT(std::min(worst_corner(gates[0].corners_px, truth),
                       worst_corner(gates[1].corners_px, truth)),
              2.5);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Places, CarefulSearchOfTwo,
    ::testing::Values(std::array{View{{-3.0, 0.9, 0}, {}}, View{{-4.5, -1.6, 0}, {}}},
                      std::array{View{{-2.0, 0, 0}, {}}, View{{-6.0, 0.1, 0.1}, {}}}));

TEST(CarefulSearch, AGateCutByTheBorderIsNotCalledWhole) {
  const CameraRig rig = bebop_rig();
  int whole = 0, cut = 0;
  for (double sideways = 0.6; sideways < 2.3; sideways += 0.02) {
    const View view{{-2.0, sideways, 0.2}, {}};
    const Quad truth = corners_of(1.0, view, rig).value();
    const bool is_whole = inside_picture(truth, 315, 160, 1.0);
    if (!is_whole && inside_picture(truth, 315, 160, -1.0)) continue;  // a pixel is not told
    Canvas canvas(315, 160);
    canvas.draw_gate(view, rig);
    for (const auto& gate : careful_gates_in(canvas)) {
      ++(is_whole ? whole : cut);
      EXPECT_EQ(gate.whole, is_whole) << sideways;
    }
  }
  EXPECT_GE(whole, 3);
  EXPECT_GE(cut, 5) << "some are found all the same";
}

TEST(CarefulSearch, ALargePictureOfTheSameSceneShowsTheSameGate) {
  CameraRig rig = bebop_rig();
  rig.lens.model = DhaneFisheye{{672, 672}, {628, 496}, 1.08};
  const View view{{-3.5, 0.3, 0.2}, {0.1, -0.05, 0.1}};
  Canvas canvas(1260, 640);
  canvas.draw_gate(view, rig);
  const auto gates = careful_gates_in(canvas);
  ASSERT_EQ(gates.size(), 1u);
  EXPECT_LT(worst_corner(gates[0].corners_px, corners_of(1.0, view, rig).value()), 4.0);
}

TEST(CarefulSearch, TheSamePictureTwiceIsTheSameAnswer) {
  const CameraRig rig = bebop_rig();
  Canvas canvas(315, 160);
  Rng rng{3};
  canvas.draw_gate({{-3.0, 0.2, 0}, {}}, rig), canvas.add_noise(rng);
  const auto first = careful_gates_in(canvas);
  Canvas other(315, 160);
  (void)careful_gates_in(other);  // what was looked at before leaves no trace
  const auto second = careful_gates_in(canvas);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_EQ(worst_corner(first[i].corners_px, second[i].corners_px), 0.0);
}

TEST(CarefulSearch, NastyPicturesHaveNoGateAndDoNoHarm) {
  CarefulSearch search;
  EXPECT_TRUE(search.detect(Image{}, kOrange).empty());
  for (const auto& [width, height] : {std::pair{1, 1},
                                      {2, 2},
                                      {1, 3000},
                                      {3000, 1},
                                      {15, 9},
                                      {16, 16},
                                      {17, 4000},
                                      {4000, 17},
                                      {2000, 1500}}) {
    const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::vector<std::uint8_t> plain(3 * count), checkered(3 * count);
    for (std::size_t i = 0; i < count; ++i) {
      const bool odd =
          (i % static_cast<std::size_t>(width) + i / static_cast<std::size_t>(width)) % 2 != 0;
      const Yuv orange = yuv_of_rgb(255, 102, 0);
      plain[3 * i] = orange.y, plain[3 * i + 1] = orange.u, plain[3 * i + 2] = orange.v;
      checkered[3 * i] = odd ? orange.y : 16, checkered[3 * i + 1] = odd ? orange.u : 128,
                    checkered[3 * i + 2] = odd ? orange.v : 128;
    }
    EXPECT_TRUE(search.detect({plain.data(), PixelFormat::kYuv444, width, height}, kOrange).empty())
        << width << " x " << height;
    EXPECT_TRUE(
        search.detect({checkered.data(), PixelFormat::kYuv444, width, height}, kOrange).empty())
        << width << " x " << height;
  }
}

}  // namespace
}  // namespace gatefly
