// SPDX-License-Identifier: Apache-2.0
// Our detector on pictures that were changed: other cameras, light, motion, what stands beside or
// before a gate.
#include <vector>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/own_sets.hpp"
#include "gatefly/experiments/picture_changes.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kAllowed = 0.05;  // false positives a picture

/// The pictures of a set under one change.
struct ChangedSet {
  std::vector<UprightPicture> pictures;
  std::vector<tuning::LabelledImage> labelled;
};

ChangedSet changed_set(const std::vector<UprightPicture>& originals, const PictureChange& change) {
  std::vector<std::optional<UprightPicture>> changed(originals.size());
  in_parallel(originals.size(), [&](std::size_t i) { changed[i] = change.apply(originals[i]); });
  ChangedSet set;
  for (auto& picture : changed)
    if (picture) set.pictures.push_back(std::move(*picture));
  for (const UprightPicture& picture : set.pictures)
    set.labelled.push_back(
        {.image = picture.view(),
         .truth = {.gates = picture.gates, .ignored = picture.ignored, .detections = {}}});
  return set;
}

std::vector<tuning::Judged> judged(tuning::Pictures pictures, const ColorModel& color,
                                   const tuning::Judging& judging) {
  std::vector<std::vector<tuning::Judged>> by_picture(pictures.size());
  in_parallel(pictures.size(), [&](std::size_t i) {
    by_picture[i] = tuning::judged_in(pictures[i], color, judging);
    for (tuning::Judged& found : by_picture[i]) found.picture = i;
  });
  std::vector<tuning::Judged> all;
  for (const auto& list : by_picture) all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// What a threshold gives.
tuning::Operating at_score(std::span<const tuning::Judged> judged, double min_score,
                           std::size_t pictures, double gates) {
  tuning::Operating point{.min_score = min_score};
  for (const tuning::Judged& found : judged)
    if (found.score >= min_score)
      point.true_positive_rate += found.hit / gates,
          point.false_per_image += found.wrong / static_cast<double>(pictures);
  return point;
}

std::string text_of(const tuning::Operating& point) {
  return fixed(point.true_positive_rate, 3) + " at " + fixed(point.false_per_image, 3);
}

}  // namespace

Result robustness(const Options& options) {
  Result result{.table = {}, .json = {}, .csv = "change\n", .picture = io::Canvas(1, 1)};
  const OwnSet set = own_set("cyberzoo", options);
  std::vector<UprightPicture> originals;
  for (std::size_t i = 0; i < set.size(); i += options.quick ? 6 : 1) {
    const tuning::LabelledImage& picture = set.picture(i);
    originals.push_back(upright_rgb(picture.image, picture.truth.gates, picture.truth.ignored));
  }
  const auto changes = picture_changes();
  for (std::size_t c = 0; c < changes.size(); ++c) {
    if (options.stopped()) throw Stopped{};
    options.progress(static_cast<double>(c) / static_cast<double>(changes.size()),
                     changes[c].words);
    const ChangedSet changed = changed_set(originals, changes[c]);
    tuning::Judging judging = set.judging;
    judging.all = changes[c].every_gate;
    const auto found = judged(changed.labelled, set.config.pilot.gate_color, judging);
    const double gates = tuning::count_gates(changed.labelled, false);
    const std::size_t count = changed.labelled.size();
    const auto shipped = at_score(found, set.config.pilot.detector.min_score, count, gates);
    const auto best = tuning::roc_of(found, count, gates).at(kAllowed);
    result.table.push_back({changes[c].words, "-",
                            "shipped " + text_of(shipped) + ", best " + text_of(best) + " (" +
                                fixed(best.min_score, 2) + "), " + std::to_string(count) + " / " +
                                fixed(gates, 0)});
  }
  return result;
}

}  // namespace gatefly::experiments
