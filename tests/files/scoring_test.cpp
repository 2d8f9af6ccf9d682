// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/scoring.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/rng.hpp"

namespace gatefly::files {
namespace {

using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::SizeIs;

constexpr std::array kRules{Rule::kOverlap70, Rule::kOverlap70Authors, Rule::kIou50, Rule::kIou75};

Quad square(double u, double v, double side) {
  return {{{u, v}, {u + side, v}, {u + side, v + side}, {u, v + side}}};
}

/// A quad as somebody might have clicked it.
Quad some_quad(Rng& rng) {
  Quad quad = square(rng.uniform(0, 200), rng.uniform(0, 100), rng.uniform(25, 80));
  for (auto& corner : quad) corner += Eigen::Vector2d{rng.uniform(-6, 6), rng.uniform(-6, 6)};
  return quad;
}

Quad shuffled(Quad quad, Rng& rng) {
  for (int i = 3; i > 0; --i)
    std::swap(quad[static_cast<std::size_t>(i)],
              quad[static_cast<std::size_t>(rng.uniform_index(i + 1))]);
  return quad;
}

Score score_of(const PictureToScore& picture, Rule rule = Rule::kOverlap70, bool nearest = false) {
  return score(std::array{picture}, rule, nearest);
}

TEST(Scoring, DetectionsThatAreTheLabelsScorePerfectly) {
  Rng rng{1};
  std::vector<PictureToScore> pictures(50);
  for (auto& picture : pictures)
    picture.gates = {some_quad(rng)}, picture.detections = picture.gates;
  pictures.push_back({});  // no gate, nothing detected
  for (const Rule rule : kRules) {
    const Score result = score(pictures, rule);
    EXPECT_EQ(result.true_positive_rate(), 1.0);
    EXPECT_EQ(result.false_positives_per_image(), 0.0);
    EXPECT_EQ(result.pictures, 51);
    EXPECT_THAT(result.best_order_px, AllOf(SizeIs(200), Each(0.0)));
    EXPECT_THAT(result.as_listed_px, Each(0.0));
  }
}

TEST(Scoring, NothingDetectedIsNoHitAndNoFalsePositive) {
  const Score result = score_of({.gates = {square(0, 0, 40)}, .ignored = {}, .detections = {}});
  EXPECT_EQ(result.true_positive_rate(), 0.0);
  EXPECT_EQ(result.false_positives, 0);
  EXPECT_TRUE(std::isnan(score_of({}).true_positive_rate()));
  EXPECT_TRUE(std::isnan(score({}, Rule::kIou50).false_positives_per_image()));
}

TEST(Scoring, TheOrderOfCornersDoesNotMatterToHitsAndBestOrderErrors) {
  Rng rng{2};
  for (int i = 0; i < 200; ++i) {
    const Quad label = some_quad(rng);
    Quad detection = label;
    for (auto& corner : detection)
      corner += Eigen::Vector2d{rng.uniform(-2, 2), rng.uniform(-2, 2)};
    const auto straight = corner_errors(detection, label).best_order;
    const Score result = score_of(
        {.gates = {shuffled(label, rng)}, .ignored = {}, .detections = {shuffled(detection, rng)}});
    ASSERT_EQ(result.hits, 1) << i;
    ASSERT_EQ(result.false_positives, 0) << i;
    auto sorted = straight;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(result.best_order_px[k], sorted[k], 1e-9) << i;
  }
}

TEST(Scoring, ListedErrorsSeeAWrongFirstCorner) {
  const Quad label = square(10, 10, 30);
  const CornerErrors errors = corner_errors({label[1], label[2], label[3], label[0]}, label);
  EXPECT_THAT(errors.as_listed, Each(DoubleNear(30.0, 1e-12)));
  EXPECT_THAT(errors.best_order, Each(0.0));
}

TEST(Scoring, SeventyPercentOfBothAreasIsTheLimit) {
  const Quad label = square(0, 0, 100);
  const auto hits = [&](const Quad& detection, Rule rule) {
    return score_of({.gates = {label}, .ignored = {}, .detections = {detection}}, rule).hits;
  };
  for (const Rule rule : {Rule::kOverlap70, Rule::kOverlap70Authors}) {
    EXPECT_EQ(hits(square(29.9, 0, 100), rule), 1);
    EXPECT_EQ(hits(square(30.1, 0, 100), rule), 0);
    // Wholly covering the label is not enough: 70 % of the detection must be the label, too.
    EXPECT_EQ(hits(square(-10, -10, 119), rule), 1);
    EXPECT_EQ(hits(square(-10, -10, 120), rule), 0);
    EXPECT_EQ(hits(square(5, 5, 84), rule), 1);
    EXPECT_EQ(hits(square(5, 5, 83), rule), 0);
  }
  // Shifted by s: (100 - s) / (100 + s).
  EXPECT_EQ(hits(square(33, 0, 100), Rule::kIou50), 1);
  EXPECT_EQ(hits(square(34, 0, 100), Rule::kIou50), 0);
  EXPECT_EQ(hits(square(14, 0, 100), Rule::kIou75), 1);
  EXPECT_EQ(hits(square(15, 0, 100), Rule::kIou75), 0);
}

TEST(Scoring, ASecondDetectionOfAGateIsAFalsePositiveButNotByTheAuthorsRule) {
  const PictureToScore picture{
      .gates = {square(0, 0, 100)},
      .ignored = {},
      .detections = {square(9, 0, 100), square(3, 0, 100), square(300, 0, 50)}};
  const Score ours = score_of(picture);
  EXPECT_EQ(ours.hits, 1);
  EXPECT_EQ(ours.false_positives, 2);
  EXPECT_THAT(ours.best_order_px, Each(DoubleNear(3.0, 1e-12)));  // the better one is the hit
  const Score authors = score_of(picture, Rule::kOverlap70Authors);
  EXPECT_EQ(authors.hits, 1);
  EXPECT_EQ(authors.false_positives, 1);
  EXPECT_EQ(authors.neither, 1);
}

TEST(Scoring, HitsPlusFalsePlusNeitherAreAllDetectionsInAnyOrder) {
  Rng rng{3};
  for (int i = 0; i < 300; ++i) {
    PictureToScore picture;
    for (int k = rng.uniform_index(4); k > 0; --k) picture.gates.push_back(some_quad(rng));
    for (int k = rng.uniform_index(3); k > 0; --k) picture.ignored.push_back(some_quad(rng));
    for (int k = rng.uniform_index(6); k > 0; --k) picture.detections.push_back(some_quad(rng));
    if (!picture.gates.empty()) picture.detections.push_back(picture.gates[0]);
    PictureToScore backwards = picture;
    std::reverse(backwards.detections.begin(), backwards.detections.end());
    for (const Rule rule : kRules) {
      const Score a = score_of(picture, rule), b = score_of(backwards, rule);
      ASSERT_EQ(a.hits + a.false_positives + a.neither, a.detections);
      ASSERT_LE(a.hits, a.gates);
      ASSERT_EQ(a.hits, b.hits) << i;
      ASSERT_EQ(a.false_positives, b.false_positives) << i;
    }
  }
}

TEST(Scoring, NearestCountsTheFirstGateOnlyAndForgivesTheOthers) {
  const Quad first = square(0, 0, 60), second = square(100, 0, 40);
  const PictureToScore both{
      .gates = {first, second}, .ignored = {}, .detections = {second, first, square(200, 0, 30)}};
  const Score result = score_of(both, Rule::kOverlap70, true);
  EXPECT_EQ(result.gates, 1);
  EXPECT_EQ(result.hits, 1);
  EXPECT_EQ(result.neither, 1);
  EXPECT_EQ(result.false_positives, 1);
  EXPECT_EQ(score_of({.gates = {first, second}, .ignored = {}, .detections = {second}},
                     Rule::kOverlap70, true)
                .hits,
            0);
}

TEST(Scoring, ADetectionOnAnIgnoredQuadIsNeitherUnlessItIsAHit) {
  const Quad gate = square(0, 0, 60), unlabelled = square(100, 0, 40);
  const Quad crossing{unlabelled[0], unlabelled[2], unlabelled[1], unlabelled[3]};
  const Score result =
      score_of({.gates = {gate}, .ignored = {crossing, gate}, .detections = {unlabelled, gate}});
  EXPECT_EQ(result.hits, 1);
  EXPECT_EQ(result.neither, 1);
  EXPECT_EQ(result.false_positives, 0);
}

TEST(Scoring, RatesBySizeAndDistanceAddUpToAll) {
  std::vector<PictureToScore> pictures;
  for (const double side : {10.0, 25.0, 40.0, 60.0, 200.0}) {
    pictures.push_back({.gates = {square(0, 0, side)},
                        .ignored = {},
                        .detections = {},
                        .true_distance = side < 50 ? 6.2 : 2.0});
    if (side > 30) pictures.back().detections = pictures.back().gates;
  }
  const Score result = score(pictures, Rule::kOverlap70);
  EXPECT_THAT(result.by_size, SizeIs(5));
  for (const HitRate& rate : result.by_size) EXPECT_EQ(rate.gates, 1);
  ASSERT_THAT(result.by_distance, SizeIs(2));
  EXPECT_EQ(result.by_distance[0].hits, 2);   // 2 m
  EXPECT_EQ(result.by_distance[1].gates, 3);  // 6 m
  EXPECT_EQ(result.by_distance[1].hits, 1);
}

TEST(Scoring, AreasOfArrowsAndCrossedQuadsAreExact) {
  const Quad arrow{{{0, 0}, {10, 0}, {2, 2}, {0, 10}}};  // concave at (2, 2)
  EXPECT_NEAR(polygon_area(arrow), 20.0, 1e-12);
  EXPECT_NEAR(polygon_shared_area(arrow, arrow), 20.0, 1e-12);
  EXPECT_NEAR(polygon_shared_area(arrow, square(5, 5, 5)), 0.0, 1e-12);
  EXPECT_NEAR(polygon_area({{{0, 0}, {4, 4}, {4, 0}, {0, 4}}}), 16.0, 1e-12);
  EXPECT_EQ(polygon_area({{{1, 1}, {1, 1}, {1, 1}, {1, 1}}}), 0.0);
  const Quad point{{{1, 1}, {1, 1}, {1, 1}, {1, 1}}};
  EXPECT_FALSE(matches(point, point, Rule::kOverlap70));
  EXPECT_FALSE(matches(point, point, Rule::kIou50));
}

TEST(Scoring, IdenticalPicturesCountOnceButEveryTimeByTheAuthorsRule) {
  const Quad gate = square(0, 0, 40);
  Labels labels;
  labels.pictures = {
      {.image = "a.jpg", .gates = {gate}, .first_identical = "a.jpg"},
      {.image = "b.jpg", .gates = {gate}, .first_identical = "a.jpg"},
      {.image = "c.jpg", .gates = {gate}, .first_identical = "gone.jpg"},  // its first is not here:
      {.image = "d.jpg", .gates = {gate}, .first_identical = ""}};         // it counts itself
  labels.degenerate = {"e.jpg"};
  std::vector<DetectionRow> rows;
  for (const char* name : {"a.jpg", "b.jpg", "e.jpg", "z.jpg"})
    rows.push_back({.image = name, .corners_px = gate});
  rows.push_back({.image = "d.jpg", .corners_px = gate, .method = "bars"});

  const ScoreInput ours = brought_together(labels, rows, {}, Rule::kOverlap70);
  EXPECT_EQ(ours.pictures.size(), 3u);
  EXPECT_EQ(ours.duplicates, 1);
  EXPECT_EQ(ours.degenerate, 1);
  EXPECT_EQ(ours.bars, 1);
  EXPECT_THAT(ours.unknown, ElementsAre("z.jpg"));
  EXPECT_EQ(score(ours.pictures, Rule::kOverlap70).hits, 1);

  const ScoreInput authors = brought_together(labels, rows, {}, Rule::kOverlap70Authors);
  EXPECT_EQ(authors.pictures.size(), 4u);
  EXPECT_EQ(score(authors.pictures, Rule::kOverlap70Authors).hits, 2);
}

}  // namespace
}  // namespace gatefly::files
