// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/gate_detector.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "support/allocation_counter.hpp"
#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/orange.hpp"
#include "support/worst_corner.hpp"

namespace gatefly {
namespace {

using namespace test;
using Gates = LookFor::Gates;
using Part = LookFor::Part;

constexpr LookFor kEverything{.gates = Gates::kAll, .part = Part::kToo};
constexpr std::array kModes{DetectorMode::kOurs, DetectorMode::kFast, DetectorMode::kCareful,
                            DetectorMode::kPaper, DetectorMode::kFlown};
const View kAhead{{-3.0, 0.2, 0.1}, {}}, kAside{{-3.0, -1.6, 0.1}, {}};
const View kTooNear{{-0.6, 0, 0}, {}};  // no more of it than its side bars
// A colour that speaks for a gate in each mode: the paper's have colours of their own.
constexpr std::array<double, 3> kColor{120, 90, 158};

/// A picture that can be looked at.
struct ViewPicture {
  int width, height;
  std::vector<std::uint8_t> bytes;

  explicit ViewPicture(const Canvas& canvas)
      : width{canvas.width()}, height{canvas.height()}, bytes{canvas.yuv444()} {}
  [[nodiscard]] Image image() const { return {bytes.data(), PixelFormat::kYuv444, width, height}; }
};

Canvas canvas_of(std::initializer_list<View> views) {
  Canvas canvas(315, 160);
  for (const View& view : views) canvas.draw_gate(view, bebop_rig(), 1.0, 0.05, kColor);
  return canvas;
}

ViewPicture picture_of(std::initializer_list<View> views) { return ViewPicture{canvas_of(views)}; }

ViewPicture noisy_picture_of(std::initializer_list<View> views, Rng& rng) {
  Canvas canvas = canvas_of(views);
  canvas.add_noise(rng, 8.0, 2.0);
  return ViewPicture{canvas};
}

Quad truth_of(const View& view) { return corners_of(1.0, view, bebop_rig()).value(); }

TEST(GateDetector, EveryModeFindsAGateThatStandsOut) {
  const ViewPicture picture = picture_of({kAhead});
  for (const DetectorMode mode : kModes) {
    GateDetector detector{{}, mode};
    const GatesInView view = detector.look(picture.image(), kOrange, {.gates = Gates::kBest});
    ASSERT_EQ(view.gates.size(), 1u) << static_cast<int>(mode);
    EXPECT_LT(worst_corner(view.gates[0].corners_px, truth_of(kAhead)), 4.0)
        << static_cast<int>(mode);
    EXPECT_TRUE(view.gates[0].whole);
    EXPECT_FALSE(view.part);
  }
}

TEST(GateDetector, AGateThatTheBorderCutsIsAPart) {
  const ViewPicture picture = picture_of({kTooNear});
  GateDetector detector;
  const GatesInView view =
      detector.look(picture.image(), kOrange, {.gates = Gates::kBest, .part = Part::kWithoutGate});
  EXPECT_TRUE(view.gates.empty());
  ASSERT_TRUE(view.part);
  EXPECT_FALSE(view.part->gate.whole);
  EXPECT_LT(view.part->bars.left_px.x(), 100.0);
  EXPECT_GT(view.part->bars.right_px.x(), 200.0);
}

// Side bars by histogram: two columns, no corner.
TEST(GateDetector, OfAGateTooNearThePapersDetectorsKnowTheSideBarsOnly) {
  const ViewPicture picture = picture_of({kTooNear});
  for (const DetectorMode mode : {DetectorMode::kPaper, DetectorMode::kFlown}) {
    GateDetector detector{{}, mode};
    const auto part = detector.look(picture.image(), kOrange, kEverything).part;
    ASSERT_TRUE(part);
    EXPECT_FALSE(part->lower_corners());
    EXPECT_LT(part->bars.left_px.x(), part->bars.right_px.x());
  }
}

TEST(GateDetector, WhatIsNotAskedForIsNotAnswered) {
  const ViewPicture two = picture_of({kAhead, kAside}), near = picture_of({kTooNear});
  GateDetector detector;
  const auto gates = [&](Gates wanted) {
    return detector.look(two.image(), kOrange, {.gates = wanted}).gates.size();
  };
  EXPECT_EQ(gates(Gates::kNone), 0u);
  EXPECT_EQ(gates(Gates::kBest), 1u);
  EXPECT_EQ(gates(Gates::kStandingOut), 2u);
  EXPECT_EQ(gates(Gates::kAll), 2u);
  EXPECT_FALSE(detector.look(near.image(), kOrange, {.part = Part::kNo}).part);
  EXPECT_TRUE(
      detector.look(near.image(), kOrange, {.gates = Gates::kNone, .part = Part::kToo}).part);
}

TEST(GateDetector, AWholeGateIsNoPartOfItself) {
  const ViewPicture picture = picture_of({kAhead});
  GateDetector detector;
  const GatesInView view = detector.look(picture.image(), kOrange, kEverything);
  EXPECT_EQ(view.gates.size(), 1u);
  EXPECT_FALSE(view.part);
}

TEST(GateDetector, APartBesideAGateIsAnsweredOnlyWhereItIsAskedForToo) {
  const View far{{-4.0, -1.2, 0.0}, {}}, cut_above{{-1.5, 0.6, 0.5}, {}};
  const ViewPicture picture = picture_of({far, cut_above});
  GateDetector detector;
  EXPECT_FALSE(
      detector.look(picture.image(), kOrange, {.gates = Gates::kAll, .part = Part::kWithoutGate})
          .part);
  const GatesInView both = detector.look(picture.image(), kOrange, kEverything);
  ASSERT_EQ(both.gates.size(), 1u);
  EXPECT_LT(worst_corner(both.gates[0].corners_px, truth_of(far)), 3.0);
  ASSERT_TRUE(both.part);
  EXPECT_TRUE(both.part->lower_corners());
}

TEST(GateDetector, AnEmptyPictureShowsNothing) {
  for (const DetectorMode mode : kModes) {
    GateDetector detector{{}, mode};
    const GatesInView view = detector.look(Image{}, kOrange, kEverything);
    EXPECT_TRUE(view.gates.empty());
    EXPECT_FALSE(view.part);
  }
}

TEST(GateDetector, KeepsNothingFromPictureToPicture) {
  const ViewPicture one = picture_of({kAhead}), other = picture_of({kTooNear});
  for (const DetectorMode mode : kModes) {
    GateDetector detector{{}, mode};
    const auto first = detector.look(one.image(), kOrange, kEverything).gates;
    ASSERT_FALSE(first.empty());
    const Quad before = first[0].corners_px;
    (void)detector.look(other.image(), kOrange, kEverything);
    const auto second = detector.look(one.image(), kOrange, kEverything).gates;
    ASSERT_FALSE(second.empty());
    EXPECT_EQ(worst_corner(before, second[0].corners_px), 0.0);
  }
}

TEST(GateDetector, LookingAllocatesNothing) {
  expect_that_allocations_are_counted();
  Rng rng{1};
  const std::array pictures{noisy_picture_of({kAhead, kAside}, rng), picture_of({kTooNear}),
                            noisy_picture_of({}, rng)};
  for (const DetectorMode mode : kModes) {
    GateDetector detector{{}, mode};
    const long before = allocations;
    for (const ViewPicture& picture : pictures)
      for (const Gates wanted : {Gates::kNone, Gates::kStandingOut, Gates::kBest, Gates::kAll})
        (void)detector.look(picture.image(), kOrange, {.gates = wanted, .part = Part::kToo});
    EXPECT_EQ(allocations, before) << static_cast<int>(mode);
  }
}

// Two thirds of a bar washed out: its two corners are less sure, the other two are as sure as ever.
TEST(GateDetector, CornersOfABrokenBarHaveLowFitness) {
  GateDetector detector{{.min_score = 0.5}};
  const View view{{-2.5, 0, 0.1}, {}};
  const Quad truth = truth_of(view);
  Canvas canvas(315, 160);
  canvas.draw_gate(view, bebop_rig());
  const int right = static_cast<int>(truth[1].x()),
            middle = static_cast<int>(0.5 * (truth[1].y() + truth[2].y()));
  canvas.blank(right - 6, right + 6, middle - 18, middle + 18);
  const ViewPicture picture{canvas};
  const auto gates = detector.look(picture.image(), kOrange).gates;
  const auto gate = std::find_if(gates.begin(), gates.end(), [&](const auto& g) {
    return worst_corner(g.corners_px, truth) < 8.0;
  });
  ASSERT_NE(gate, gates.end());
  const auto& fitness = gate->corner_fitness;  // TL, TR, BR, BL
  EXPECT_GT(std::min(fitness[0], fitness[3]), 0.9);
  EXPECT_LT(std::max(fitness[1], fitness[2]), 0.8);
}

TEST(GateDetector, ACornerOutsideThePictureHasNoFitness) {
  GateDetector detector;
  int outside = 0;
  for (double sideways = 1.4; sideways < 2.3; sideways += 0.02) {  // more and more is cut off
    const ViewPicture picture = picture_of({{{-2.0, sideways, 0.2}, {}}});
    for (const auto& gate : detector.look(picture.image(), kOrange).gates)
      for (std::size_t i = 0; i < 4; ++i) {
        const Eigen::Vector2d& p = gate.corners_px[i];
        if (p.x() >= 0 && p.y() >= 0 && p.x() <= 314 && p.y() <= 159) continue;
        ++outside;
        EXPECT_EQ(gate.corner_fitness[i], 0.0);
        EXPECT_FALSE(gate.whole);
      }
  }
  EXPECT_GE(outside, 10) << "of gates that are found all the same";
}

// Two gates beyond doubt: noise must not choose between them.
TEST(GateDetector, OfEquallySureGatesTheMostCentralOneIsTheAnswer) {
  GateDetector detector;
  for_all(10, [&](Rng& rng) {
    const ViewPicture picture = noisy_picture_of({kAhead, kAside}, rng);
    for (const Gates wanted : {Gates::kStandingOut, Gates::kBest, Gates::kAll}) {
      const auto gates = detector.look(picture.image(), kOrange, {.gates = wanted}).gates;
      ASSERT_EQ(gates.size(), wanted == Gates::kBest ? 1u : 2u);
      EXPECT_LT(worst_corner(gates[0].corners_px, truth_of(kAhead)), 3.0);
    }
  });
}

TEST(GateDetector, AGateThatStandsOutNeedsNoCarefulSearchAndAFaintFarOneMay) {
  const CameraRig rig = bebop_rig();
  int carefully = 0;
  GateDetector detector;
  for_all(10, [&](Rng& rng) {
    for (const bool faint : {false, true}) {
      const View view{{faint ? -4.5 : -3.0, rng.uniform(-0.3, 0.3), 0.1}, {}};
      Canvas canvas(315, 160);
      if (faint)
        canvas.draw_gate(view, rig, 1.0, 0.05, {124, 124, 132});
      else
        canvas.draw_gate(view, rig);
      canvas.add_noise(rng, 8.0, 2.0);
      const ViewPicture picture{canvas};
      const auto gates = detector.look(picture.image(), kOrange).gates;
      ASSERT_FALSE(gates.empty()) << faint;
      EXPECT_LT(worst_corner(gates[0].corners_px, truth_of(view)), 6.0);
      const bool careful = gates[0].method == DetectionMethod::kFrames;
      EXPECT_TRUE(faint || !careful);
      carefully += careful;
    }
  });
  EXPECT_GT(carefully, 0);
}

// A little off, as a filter's estimate is.
Quad expected_bars_of(const View& view, Rng& rng) {
  Quad bars = scaled(truth_of(view), 0.95);
  const Eigen::Vector2d off{rng.uniform(-4.0, 4.0), rng.uniform(-4.0, 4.0)};
  for (Eigen::Vector2d& corner : bars) corner += off;
  return bars;
}

TEST(GateDetector, WhereAGateIsExpectedLessWillDo) {
  GateDetector detector;
  int found_anyway = 0, found_expected = 0;
  for_all(20, [&](Rng& rng) {
    const View view{{-4.5, rng.uniform(-0.3, 0.3), 0.1}, {}};
    Canvas canvas(315, 160);
    canvas.draw_gate(view, bebop_rig(), 1.0, 0.05, {124, 124, 132});
    canvas.add_noise(rng, 8.0, 2.0);
    const ViewPicture picture{canvas};
    const Quad expected = expected_bars_of(view, rng);
    const auto finds = [&](const LookFor& look_for) {
      const auto gates = detector.look(picture.image(), kOrange, look_for).gates;
      return !gates.empty() && worst_corner(gates[0].corners_px, truth_of(view)) < 6.0;
    };
    found_anyway += finds({.quick = true});
    found_expected += finds({.expected_bars = &expected, .quick = true});
  });
  EXPECT_GT(found_expected, found_anyway);
  EXPECT_GE(found_expected, 17);
}

TEST(GateDetector, WhereAGateIsExpectedAndNoneIsNoneIsFound) {
  GateDetector detector;
  for_all(50, [&](Rng& rng) {
    const View view{{rng.uniform(-6.0, -1.5), rng.uniform(-0.5, 0.5), 0.1}, {}};
    const ViewPicture picture = noisy_picture_of({}, rng);
    const Quad expected = expected_bars_of(view, rng);
    EXPECT_TRUE(
        detector.look(picture.image(), kOrange, {.expected_bars = &expected}).gates.empty());
  });
}

// Two gates that the fast search seldom sees; the window is around one of them.
TEST(GateDetector, OnlyTheWindowIsSearchedCarefully) {
  GateDetector detector;
  const View here{{-3.0, -0.8, 0.1}, {}}, elsewhere{{-3.0, 1.0, 0.1}, {}};
  const Quad corners = truth_of(here);
  const SearchWindow window{corners[0].x() - 20.0,
                            corners[0].y() - 20.0,
                            corners[2].x() + 20.0,
                            corners[2].y() + 20.0,
                            20.0,
                            90.0};
  int all_here = 0, all_elsewhere = 0, window_here = 0, window_elsewhere = 0;
  for_all(80, [&](Rng& rng) {
    Canvas canvas(315, 160);
    for (const View& view : {here, elsewhere})
      canvas.draw_gate(view, bebop_rig(), 1.0, 0.05, {124, 124, 132});
    canvas.add_noise(rng, 8.0, 2.0);
    const ViewPicture picture{canvas};
    const auto shows = [&](const LookFor& look_for, const View& view) {
      const auto gates = detector.look(picture.image(), kOrange, look_for).gates;
      return std::any_of(gates.begin(), gates.end(), [&](const GateDetection& gate) {
        return worst_corner(gate.corners_px, truth_of(view)) < 6.0;
      });
    };
    const LookFor quick{.quick = true}, everywhere{.gates = Gates::kAll},
        in_window{.within = &window};
    if (shows(quick, elsewhere)) return;
    all_here += shows(everywhere, here), all_elsewhere += shows(everywhere, elsewhere);
    window_here += shows(in_window, here), window_elsewhere += shows(in_window, elsewhere);
  });
  EXPECT_GE(all_elsewhere, 5);
  EXPECT_GE(all_here, 5);
  EXPECT_GE(window_here, all_here);
  EXPECT_EQ(window_elsewhere, 0);
}

TEST(GateDetector, WhereTheExpectedGateStandsOutTheWindowNeedNotBeSearched) {
  GateDetector detector;
  const ViewPicture picture = picture_of({kAhead});
  const Quad bars = scaled(truth_of(kAhead), 0.95);
  const SearchWindow window{0.0, 0.0, 315.0, 160.0, 20.0, 90.0};
  const LookFor expected{.expected_bars = &bars, .within = &window};
  EXPECT_FALSE(detector.look(picture.image(), kOrange, expected).careful);
  const LookFor others_too{.gates = Gates::kAll, .expected_bars = &bars, .within = &window};
  EXPECT_TRUE(detector.look(picture.image(), kOrange, others_too).careful);
}

// A gate that stands out is answered wherever the window is.
TEST(GateDetector, AWindowLosesNoGateThatTheFastSearchFinds) {
  GateDetector detector;
  const ViewPicture picture = picture_of({kAhead});
  const SearchWindow elsewhere{0.0, 100.0, 60.0, 160.0, 0.0, 1e3};
  const auto gates = detector.look(picture.image(), kOrange, {.within = &elsewhere}).gates;
  ASSERT_EQ(gates.size(), 1u);
  EXPECT_LT(worst_corner(gates[0].corners_px, truth_of(kAhead)), 4.0);
}

TEST(GateDetector, SaysWhetherItLookedCarefully) {
  GateDetector detector;
  const ViewPicture near = picture_of({kAhead}), empty = picture_of({});
  EXPECT_FALSE(detector.look(near.image(), kOrange).careful);
  EXPECT_TRUE(detector.look(empty.image(), kOrange).careful);
  EXPECT_FALSE(detector.look(empty.image(), kOrange, {.quick = true}).careful);
}

}  // namespace
}  // namespace gatefly
