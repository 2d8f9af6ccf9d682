// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/tuning/roc.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace gatefly::tuning {

Judging with_fitted_colors(Judging judging) {
  // [of 0, .5, 1, 1.5, ever: the least that loses no hit on the labelled sets]
  judging.detector.sure_score += 1.5;
  return judging;
}

std::vector<Judged> found_in(const Image& image, const ColorModel& color, const Judging& judging) {
  GateDetectorParams params = judging.detector;
  params.min_score = judging.lowest;
  if (judging.all) params.sure_score = kAlwaysCareful;
  GateDetector detector{params, judging.fast ? DetectorMode::kFast : DetectorMode::kOurs};
  const auto wanted = judging.all ? LookFor::Gates::kAll : LookFor::Gates::kBest;
  std::vector<Judged> list;
  for (const GateDetection& gate : detector.look(image, color, {.gates = wanted}).gates)
    list.push_back({.corners_px = gate.corners_px, .score = gatefly::score_of(gate.fitness)});
  return list;
}

std::vector<Judged> judged_in(const LabelledImage& picture, const ColorModel& color,
                              const Judging& judging) {
  std::vector<Judged> list = found_in(picture.image, color, judging);
  files::PictureToScore so_far = picture.truth;
  so_far.detections.clear();
  int hits = 0, wrong = 0;
  for (Judged& found : list) {  // what one more detection changes
    so_far.detections.push_back(found.corners_px);
    const files::Score score = files::score({&so_far, 1}, judging.rule, judging.nearest);
    found.hit = score.hits - std::exchange(hits, score.hits);
    found.wrong = score.false_positives - std::exchange(wrong, score.false_positives);
  }
  return list;
}

std::vector<Judged> judged_by_halves(Pictures pictures,
                                     const std::function<ColorModel(Pictures)>& fit,
                                     const Judging& judging) {
  const std::size_t middle = pictures.size() / 2;
  const Pictures first = pictures.first(middle), second = pictures.subspan(middle);
  std::vector<Judged> all;
  for (const auto& [learnt, looked_at, offset] :
       {std::tuple{second, first, std::size_t{0}}, std::tuple{first, second, middle}}) {
    const ColorModel color = fit(learnt);
    for (std::size_t i = 0; i < looked_at.size(); ++i)
      for (Judged found : judged_in(looked_at[i], color, judging)) {
        found.picture = offset + i;
        all.push_back(found);
      }
  }
  return all;
}

int count_gates(Pictures pictures, bool nearest) {
  std::size_t gates = 0;
  for (const LabelledImage& picture : pictures)
    gates +=
        nearest ? std::min<std::size_t>(1, picture.truth.gates.size()) : picture.truth.gates.size();
  return static_cast<int>(gates);
}

Roc roc_of(std::span<const Judged> judged, std::size_t pictures, double gates) {
  std::vector<Judged> sorted(judged.begin(), judged.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Judged& a, const Judged& b) { return a.score > b.score; });
  Roc roc;
  double hits = 0.0, wrong = 0.0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    hits += sorted[i].hit, wrong += sorted[i].wrong;
    // Half-way to the next: a threshold does not hang on one picture.
    const double next = i + 1 < sorted.size() ? sorted[i + 1].score : sorted[i].score;
    roc.points.push_back(
        {.min_score = 0.5 * (sorted[i].score + next),
         .true_positive_rate = gates > 0.0 ? hits / gates : 0.0,
         .false_per_image = pictures > 0 ? wrong / static_cast<double>(pictures) : 0.0});
  }
  return roc;
}

Operating Roc::at(double false_per_image) const {
  Operating best{.min_score = points.empty() ? GateDetectorParams{}.min_score
                                             : points.front().min_score + 0.1};
  for (const Operating& point : points)
    if (point.false_per_image <= false_per_image) best = point;
  return best;
}

}  // namespace gatefly::tuning
