// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/changed_set.hpp"

#include <utility>

namespace gatefly::experiments {
namespace {

using Judgements = std::vector<tuning::Judged>;

Judgements judged(tuning::Pictures pictures, const ColorModel& color,
                  const tuning::Judging& judging) {
  std::vector<Judgements> by_picture(pictures.size());
  in_parallel(pictures.size(), [&](std::size_t i) {
    by_picture[i] = tuning::judged_in(pictures[i], color, judging);
  });
  Judgements all;
  for (const Judgements& list : by_picture) all.insert(all.end(), list.begin(), list.end());
  return all;
}

double threshold_of(const Judgements& found, const ChangedHalf& half, double allowed) {
  return tuning::roc_of(found, half.labelled.size(), tuning::count_gates(half.labelled, false))
      .at(allowed)
      .min_score;
}

/// Rate of finds at each half's own threshold.
ChangedRate rate_of(const std::array<Judgements, 2>& found, const std::array<double, 2>& min_scores,
                    const ChangedRates& counts) {
  ChangedRate rate{.min_scores = min_scores};
  for (std::size_t half = 0; half < 2; ++half)
    for (const tuning::Judged& gate : found[half])
      if (gate.score >= min_scores[half])
        rate.true_positive_rate += gate.hit, rate.false_per_image += gate.wrong;
  if (counts.gates > 0) rate.true_positive_rate /= counts.gates;
  if (counts.pictures > 0) rate.false_per_image /= static_cast<double>(counts.pictures);
  return rate;
}

/// Colours learnt from what the described ones find in a half, and how to search with them.
struct OwnColors {
  ColorModel color;
  tuning::Judging judging;
};

std::array<OwnColors, 2> own_colors(const ChangedSet& changed, const OwnSet& set,
                                    const tuning::Judging& judging) {
  std::array<OwnColors, 2> of_half;
  in_parallel(2, [&](std::size_t h) {
    const tuning::SelfTraining own =
        tuning::train_on_own(changed[h].labelled, set.config.pilot.gate_color, judging.detector);
    of_half[h] = {own.color, own.learnt ? tuning::with_fitted_colors(judging) : judging};
  });
  return of_half;
}

ChangedRate self_tuned(const ChangedRates& counts, const ChangedSet& changed, const OwnSet& set,
                       const tuning::Judging& judging, double allowed) {
  const std::array<OwnColors, 2> own = own_colors(changed, set, judging);
  std::array<Judgements, 2> found;
  std::array<double, 2> min_scores{};
  for (std::size_t h = 0; h < 2; ++h) {
    const auto& [color, with] = own[1 - h];
    found[h] = judged(changed[h].labelled, color, with);
    min_scores[h] =
        threshold_of(judged(changed[1 - h].labelled, color, with), changed[1 - h], allowed);
  }
  return rate_of(found, min_scores, counts);
}

}  // namespace

UprightHalves upright_halves(const OwnSet& set) {
  UprightHalves halves;
  for (std::size_t h = 0; h < 2; ++h)
    for (const tuning::LabelledImage& picture : h == 0 ? set.first : set.second)
      halves[h].push_back(upright_rgb(picture.image, picture.truth.gates, picture.truth.ignored));
  return halves;
}

ChangedSet changed_set(const UprightHalves& halves, const PictureChange& change) {
  ChangedSet set;
  for (std::size_t h = 0; h < 2; ++h) {
    std::vector<std::optional<UprightPicture>> changed(halves[h].size());
    in_parallel(changed.size(), [&](std::size_t i) { changed[i] = change.apply(halves[h][i]); });
    for (auto& picture : changed)
      if (picture) set[h].pictures.push_back(std::move(*picture));
    for (const UprightPicture& picture : set[h].pictures)
      set[h].labelled.push_back(
          {.image = picture.view(),
           .truth = {.gates = picture.gates, .ignored = picture.ignored, .detections = {}}});
  }
  return set;
}

ChangedRates rates_of(const ChangedSet& changed, const OwnSet& set, bool every_gate, double allowed,
                      bool tune) {
  tuning::Judging judging = set.judging;
  judging.all = every_gate;
  std::array<Judgements, 2> found;
  ChangedRates rates;
  std::array<double, 2> other_half{};
  for (std::size_t h = 0; h < 2; ++h) {
    found[h] = judged(changed[h].labelled, set.config.pilot.gate_color, judging);
    rates.pictures += changed[h].labelled.size();
    rates.gates += tuning::count_gates(changed[h].labelled, false);
    other_half[1 - h] = threshold_of(found[h], changed[h], allowed);
  }
  const double shipped = set.config.pilot.detector.min_score;
  rates.shipped = rate_of(found, {shipped, shipped}, rates);
  rates.other_half = rate_of(found, other_half, rates);
  Judgements all = found[0];
  all.insert(all.end(), found[1].begin(), found[1].end());
  const double best = tuning::roc_of(all, rates.pictures, rates.gates).at(allowed).min_score;
  rates.best = rate_of(found, {best, best}, rates);
  if (tune) rates.self_tuned = self_tuned(rates, changed, set, judging, allowed);
  return rates;
}

}  // namespace gatefly::experiments
