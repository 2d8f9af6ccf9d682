// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "gatefly/detection/quad.hpp"
#include "gatefly/files/detections_file.hpp"
#include "gatefly/files/labels_file.hpp"

namespace gatefly::files {

/// When a detection is a hit.
enum class Rule {
  /// It covers >= 70 % of both areas; everything that is no hit is a false positive.
  kOverlap70,
  /// The same, but whatever covers a label that much is never a false positive. Li18 §3.1.
  kOverlap70Authors,
  kIou50,  ///< Shared area / area of both together >= 0.5.
  kIou75,
};

/// The rule of a name: overlap70, overlap70-authors, iou50, iou75. @throws std::invalid_argument
/// for others.
[[nodiscard]] Rule rule_of(const std::string& name);

/// The corners as a polygon that does not cross itself, clockwise as seen.
[[nodiscard]] Quad polygon(const Quad& quad);

/// Area of polygon(quad) [px²].
[[nodiscard]] double polygon_area(const Quad& quad);

/// Area that two polygons share; need not be convex [px²].
[[nodiscard]] double polygon_shared_area(const Quad& a, const Quad& b);

/// Whether two quads are the same gate by a rule; the order of their corners does not matter.
[[nodiscard]] bool matches(const Quad& a, const Quad& b, Rule rule);

/// How far four corners are from the four of a label [px].
struct CornerErrors {
  /// In the cyclic order, of either direction, with the least sum of squares.
  std::array<double, 4> best_order;
  std::array<double, 4> as_listed;  ///< First to first, second to second, ...
};
[[nodiscard]] CornerErrors corner_errors(const Quad& detection, const Quad& label);

/// One picture, ready to be scored.
struct PictureToScore {
  std::vector<Quad> gates;    ///< Labelled; the first is the nearest.
  std::vector<Quad> ignored;  ///< A detection here that is no hit is no false positive either.
  std::vector<Quad> detections;
  double true_distance = std::numeric_limits<double>::quiet_NaN();  ///< [m]
};

/// Labelled gates of a kind, and how many of them were hit.
struct HitRate {
  double from = 0.0, to = 0.0;  ///< Range of the sorting quantity; `to` is not included.
  int gates = 0, hits = 0;
};

struct Score {
  int pictures = 0, gates = 0, detections = 0;
  int hits = 0, false_positives = 0;
  /// Detections that count neither way: on ignored quads, second ones by the authors' rule.
  int neither = 0;
  std::vector<double> best_order_px, as_listed_px;  ///< Four corner errors for every hit, sorted.
  std::vector<HitRate> by_size;  ///< By the square root of the label's area [px].
  /// By the true distance, metre by metre [m]; empty when no label has one.
  std::vector<HitRate> by_distance;

  /// Hits / labelled gates; NaN without any.
  [[nodiscard]] double true_positive_rate() const;
  [[nodiscard]] double false_positives_per_image() const;  ///< NaN without pictures.
};

/// @param nearest  only the first gate of a picture is a label; detections on the others count
///     neither way.
[[nodiscard]] Score score(std::span<const PictureToScore> pictures, Rule rule,
                          bool nearest = false);

/// Labels and detections brought together, and what was left out.
struct ScoreInput {
  std::vector<PictureToScore> pictures;
  int bars = 0;        ///< Rows of method "bars".
  int duplicates = 0;  ///< Pictures left out because an identical one is scored.
  int degenerate = 0;  ///< Pictures left out because their label is.
  /// Names of pictures with detections that the labels do not have.
  std::vector<std::string> unknown;
};

/// @param ignored  labels of quads where a detection is neither hit nor false positive.
/// Identical pictures count once, the first; by the authors' rule every time.
[[nodiscard]] ScoreInput brought_together(const Labels& labels,
                                          std::span<const DetectionRow> detections,
                                          const Labels& ignored, Rule rule);

}  // namespace gatefly::files
