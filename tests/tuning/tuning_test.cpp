// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <deque>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/tasks/tuning/describe.hpp"
#include "gatefly/tasks/tuning/tune.hpp"

#include "support/draw_gate.hpp"

namespace gatefly::tuning {
namespace {

using ::testing::HasSubstr;
using Yuv3 = std::array<double, 3>;

constexpr Yuv3 kOrange{140, 80, 180}, kGreen{110, 100, 92}, kReddish{120, 112, 178};
const ColorModel kDescribedOrange = ColorModel::described({1.0, 0.4, 0.0});

/// Rendered pictures with one gate each, and some without.
class Album {
 public:
  Album(const Yuv3& color, int gates, int empty, std::uint64_t seed, double label_error_px = 0.0) {
    Rng rng{seed};
    const CameraRig rig = test::bebop_rig();
    while (static_cast<int>(pictures_.size()) < gates) {
      const test::View view{
          {rng.uniform(-4.0, -2.0), rng.uniform(-0.5, 0.5), rng.uniform(0.0, 0.4)},
          {rng.uniform(-0.3, 0.3), 0.0, rng.uniform(-0.2, 0.2)}};
      auto corners = test::corners_of(1.0, view, rig);
      if (!corners || !test::inside_picture(*corners, 315, 160, 6)) continue;
      test::Canvas canvas(315, 160);
      canvas.draw_gate(view, rig, 1.0, 0.05, color);
      for (auto& p : *corners)
        p += Eigen::Vector2d{rng.uniform(-label_error_px, label_error_px),
                             rng.uniform(-label_error_px, label_error_px)};
      add(canvas, rng, {*corners});
    }
    for (int i = 0; i < empty; ++i) {
      test::Canvas canvas(315, 160);
      add(canvas, rng, {});
    }
  }
  operator Pictures() const { return pictures_; }
  [[nodiscard]] std::size_t size() const { return pictures_.size(); }

 private:
  void add(test::Canvas& canvas, Rng& rng, std::vector<Quad> gates) {
    canvas.add_noise(rng);
    bytes_.push_back(canvas.yuv444());
    pictures_.push_back({Image(bytes_.back().data(), PixelFormat::kYuv444, 315, 160),
                         {.gates = std::move(gates), .ignored = {}, .detections = {}}});
  }
  std::deque<std::vector<std::uint8_t>> bytes_;
  std::vector<LabelledImage> pictures_;
};

const Judging kDefault{.lowest = GateDetectorParams{}.min_score};

/// Part of an album's gates that a model finds.
double found_part(const Album& album, const ColorModel& color) {
  double hits = 0.0;
  for (const LabelledImage& picture : Pictures{album})
    for (const Judged& found : judged_in(picture, color, kDefault)) hits += found.hit;
  return hits / std::max(1, count_gates(album, false));
}

TEST(FitToLabels, FindsGatesOfAColourUnlikeTheDescription) {
  const Album learnt{kGreen, 20, 5, 1}, seen{kGreen, 15, 0, 2};
  EXPECT_LT(found_part(seen, kDescribedOrange), 0.2);
  EXPECT_GT(found_part(seen, fit_to_labels(learnt, kDescribedOrange, {})), 0.9);
}

TEST(FitToLabels, LabelsMayBeSomePixelsOff) {
  const Album learnt{kGreen, 20, 5, 3, 3.0}, seen{kGreen, 15, 0, 4};
  EXPECT_GT(found_part(seen, fit_to_labels(learnt, kDescribedOrange, {})), 0.9);
}

TEST(FitToLabels, FewGatesDoNotSpoilWhatTheDescriptionFinds) {
  const Album one{kOrange, 1, 2, 5}, seen{kOrange, 15, 0, 6};
  EXPECT_GT(found_part(seen, fit_to_labels(one, kDescribedOrange, {})), 0.9);
}

TEST(FitToLabels, OfEmptyPicturesOrNoneAtAllTheDescriptionsOrderOfColoursIsLeft) {
  const std::vector<LabelledImage> nothing(3);
  const ColorModel fit = fit_to_labels({}, kDescribedOrange, {});
  EXPECT_EQ(fit_to_labels(nothing, kDescribedOrange, {}).absolute, fit.absolute);
  const std::size_t orange = ColorModel::bin({150, 90, 170}),
                    grey = ColorModel::bin({150, 128, 128}), blue = ColorModel::bin({150, 170, 90});
  EXPECT_GT(fit.absolute[orange], fit.absolute[grey]);
  EXPECT_GE(fit.absolute[grey], fit.absolute[blue]);
}

TEST(TrainOnOwn, LearnsAHueThatTheDescriptionOnlyComesNear) {
  const Album pictures{kReddish, 25, 5, 7};
  const SelfTraining training = train_on_own(pictures, kDescribedOrange, {});
  ASSERT_TRUE(training.learnt);
  const Yuv bar{120, 112, 178};
  EXPECT_GT(training.color.absolute[ColorModel::bin(bar)],
            kDescribedOrange.absolute[ColorModel::bin(bar)]);
  EXPECT_GT(found_part(Album{kReddish, 15, 0, 8}, training.color), 0.9);
}

TEST(TrainOnOwn, KeepsTheDescriptionWhenItFindsNothing) {
  const SelfTraining training = train_on_own(Album{kGreen, 10, 5, 9}, kDescribedOrange, {});
  EXPECT_FALSE(training.learnt);
  EXPECT_LT(training.confident, 6);
  EXPECT_EQ(training.color.absolute, kDescribedOrange.absolute);
  EXPECT_EQ(training.color.relative, kDescribedOrange.relative);
}

TEST(Tune, KeepsToTheFalsePositivesThatAreAllowed) {
  const Album pictures{kOrange, 20, 20, 10};
  for (const double allowed : {0.0, 0.05}) {
    const Tuned tuned = tune_to_labels(pictures, kDescribedOrange, {}, allowed);
    ASSERT_TRUE(tuned.learnt);
    EXPECT_LE(tuned.chosen.false_per_image, allowed);
    EXPECT_GT(tuned.chosen.true_positive_rate, 0.9);
  }
}

TEST(Tune, WithoutLabelsTheThresholdLiesBetweenGatesAndTheRest) {
  const Album pictures{kOrange, 30, 30, 11};
  const Tuned tuned = tune_to_description(pictures, kDescribedOrange, {}, 0.02);
  ASSERT_TRUE(tuned.learnt);
  Judging chosen;
  chosen.lowest = tuned.chosen.min_score;
  double hits = 0.0, wrong = 0.0;
  for (const LabelledImage& picture : Pictures{pictures})
    for (const Judged& found : judged_in(picture, tuned.color, chosen))
      hits += found.hit, wrong += found.wrong;
  EXPECT_GE(hits, 27);
  EXPECT_LE(wrong, 2);
}

TEST(Tune, TooFewLabelledGatesAreNotFitted) {
  const Tuned tuned = tune_to_labels(Album{kOrange, 3, 10, 12}, kDescribedOrange, {}, 0.02);
  EXPECT_FALSE(tuned.learnt);
  EXPECT_EQ(tuned.gates, 3);
  EXPECT_EQ(tuned.color.absolute, kDescribedOrange.absolute);
}

TEST(JudgedByHalves, NoPictureIsSearchedWithColoursOfItsOwnHalf) {
  const Album pictures{kOrange, 5, 0, 13};  // halves of 2 and 3
  std::vector<std::pair<const LabelledImage*, std::size_t>> learnt;
  const auto fit = [&](Pictures half) {
    learnt.emplace_back(half.data(), half.size());
    return kDescribedOrange;
  };
  const auto judged = judged_by_halves(pictures, fit, kDefault);
  const LabelledImage* all = Pictures{pictures}.data();
  EXPECT_EQ(learnt,
            (std::vector{std::pair{all + 2, std::size_t{3}}, std::pair{all, std::size_t{2}}}));
  std::vector<std::size_t> numbers;
  for (const Judged& found : judged) numbers.push_back(found.picture);
  EXPECT_EQ(numbers, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

TEST(JudgedIn, ASecondDetectionOfAGateAndOneOnAnIgnoredQuad) {
  const Album pictures{kOrange, 1, 0, 14};
  LabelledImage picture = Pictures{pictures}[0];
  ASSERT_EQ(judged_in(picture, kDescribedOrange, kDefault).at(0).hit, 1.0);
  std::swap(picture.truth.gates, picture.truth.ignored);
  const Judged ignored = judged_in(picture, kDescribedOrange, kDefault).at(0);
  EXPECT_EQ(ignored.hit + ignored.wrong, 0.0);
  picture.truth.ignored.clear();
  EXPECT_EQ(judged_in(picture, kDescribedOrange, kDefault).at(0).wrong, 1.0);
}

Judged judged_as(double score, double hit) {
  Judged judged{.corners_px = {}, .score = score, .hit = hit, .wrong = 1.0 - hit};
  judged.corners_px.fill(Eigen::Vector2d::Zero());
  return judged;
}

TEST(Roc, CountsFromTheHighestScoreDown) {
  const std::vector<Judged> judged{judged_as(1.0, 0), judged_as(4.0, 1), judged_as(3.0, 0),
                                   judged_as(2.0, 1)};
  const Roc roc = roc_of(judged, 10, 4);
  EXPECT_DOUBLE_EQ(roc.at(0.0).true_positive_rate, 0.25);
  EXPECT_DOUBLE_EQ(roc.at(0.0).min_score, 3.5);
  EXPECT_DOUBLE_EQ(roc.at(0.1).true_positive_rate, 0.5);
  EXPECT_DOUBLE_EQ(roc.at(0.1).min_score, 1.5);
  EXPECT_DOUBLE_EQ(roc.at(1.0).false_per_image, 0.2);
}

TEST(Roc, OfNothingIsNothing) {
  const Roc roc = roc_of({}, 0, 0);
  EXPECT_TRUE(roc.points.empty());
  EXPECT_EQ(roc.at(0.1).true_positive_rate, 0.0);
}

TEST(DescribedColor, KnowsNamesHexAndNumbers) {
  EXPECT_EQ(described_color("orange"), described_color(" ORANGE"));
  EXPECT_EQ(described_color("dark blue"), described_color("blue"));
  EXPECT_EQ(described_color("#ff6600"), (std::array{1.0, 0.4, 0.0}));
  EXPECT_EQ(described_color("255,102,0"), described_color("#FF6600"));
  EXPECT_EQ(described_color("1, 0.4, 0"), described_color("#ff6600"));
}

std::string complaint(const std::string& text) {
  try {
    (void)described_color(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(DescribedColor, RefusesWhatHasNoHueAndWhatIsNoColour) {
  for (const char* text : {"white", "Grey", "black", "#808080", "200,200,200", "0,0,0"})
    EXPECT_THAT(complaint(text), HasSubstr("no hue")) << text;
  for (const char* text : {"", "oragne", "#12", "#gggggg", "1,2", "1,2,3,4", "300,0,0", "-1,0,0",
                           "nan,0,0", "blue red", "dark"})
    EXPECT_THAT(complaint(text), HasSubstr("is no colour")) << text;
  EXPECT_THAT(complaint("oragne"), HasSubstr("did you mean 'orange'"));
}

}  // namespace
}  // namespace gatefly::tuning
