// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/files/scoring.hpp"

namespace gatefly::tuning {

/// A picture and what it is known to show.
struct LabelledImage {
  Image image;
  files::PictureToScore truth;  ///< Its detections are not used.
};

/// A gate that was found, and what it is by the labels.
struct Judged {
  std::size_t picture = 0;
  Quad corners_px{};
  double score = 0.0;  ///< FrameScore::total, what detector.min_score is compared with.
  /// 1 or 0, both 0 on an ignored quad; without labels the chance of either.
  double hit = 0.0, wrong = 0.0;
};

/// How pictures are searched and judged.
struct Judging {
  GateDetectorParams detector = {};  ///< Its min_score is not used.
  double lowest = 0.5;               ///< Score down to which gates are looked for.
  /// Every gate of a picture, by the careful search; else the best, as `gatefly detect` gives.
  bool all = false;
  bool fast = false;  ///< By the fast search alone.
  files::Rule rule = files::Rule::kOverlap70;
  bool nearest = false;  ///< Only the first labelled gate counts.
};

/// A sure_score that nothing reaches: the careful search looks at every picture.
inline constexpr double kAlwaysCareful = 100.0;

/// The same for fitted colours: their tables reach 4 nats, described ones 3, and so much higher are
/// all scores.
[[nodiscard]] Judging with_fitted_colors(Judging judging);

/// Detections in a picture, best first; hit and wrong are left 0.
[[nodiscard]] std::vector<Judged> found_in(const Image& image, const ColorModel& color,
                                           const Judging& judging);
/// The same, judged.
[[nodiscard]] std::vector<Judged> judged_in(const LabelledImage& picture, const ColorModel& color,
                                            const Judging& judging);

using Pictures = std::span<const LabelledImage>;

/// Every picture searched with the colours that `fit` learnt from the other half; halves are
/// contiguous.
[[nodiscard]] std::vector<Judged> judged_by_halves(Pictures pictures,
                                                   const std::function<ColorModel(Pictures)>& fit,
                                                   const Judging& judging);

/// How many gates there are to hit.
[[nodiscard]] int count_gates(Pictures pictures, bool nearest);

/// A threshold and what it gives.
struct Operating {
  double min_score = 0.0, true_positive_rate = 0.0, false_per_image = 0.0;
};

/// Hits against false positives over detector.min_score, from the highest score down.
struct Roc {
  std::vector<Operating> points;

  /// The most hits at no more false positives than allowed; before the first detection when there
  /// is none.
  [[nodiscard]] Operating at(double false_per_image) const;
};
[[nodiscard]] Roc roc_of(std::span<const Judged> judged, std::size_t pictures, double gates);

}  // namespace gatefly::tuning
