// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/tuning/tune.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "gatefly/detection/quad.hpp"

namespace gatefly::tuning {
namespace {

constexpr int kLeastLabelled = 4;  // gates; two in each half

ColorFitParams params_of(const GateDetectorParams& detector) {
  return {.bar_ratio = detector.bar_ratio, .lens = detector.lens};
}

/// Every picture with what a model finds in it: sure gates as examples, the rest as unsure.
std::vector<ColorPicture> examples_of(Pictures pictures, const ColorModel& color,
                                      const GateDetectorParams& detector,
                                      const SelfTrainingParams& params) {
  GateDetectorParams all = detector;
  all.sure_score = kAlwaysCareful;
  all.min_score = gatefly::score_of(params.unsure);
  GateDetector searching{all};
  std::vector<ColorPicture> examples;
  for (const LabelledImage& picture : pictures) {
    ColorPicture& example = examples.emplace_back(ColorPicture{.image = picture.image});
    for (const GateDetection& found :
         searching.look(picture.image, color, {.gates = LookFor::Gates::kAll}).gates) {
      const Quad bars = scaled(found.corners_px, 1.0 / detector.corner_scale);
      if (found.fitness >= params.confident && found.whole)
        example.gates.push_back({bars, found.fitness});
      else
        example.unsure.push_back(bars);
    }
  }
  return examples;
}

/// One of two kinds of detections by their scores.
struct Kind {
  double part = 0.5;  ///< In any unit: only the two kinds are compared.
  double mean = 0.0, variance = 1.0;

  [[nodiscard]] double density(double x) const {
    return part * std::exp(-0.5 * (x - mean) * (x - mean) / variance) / std::sqrt(variance);
  }
};

/// Usual scores of a kind with learnt colours, and as how many detections that counts: ten
/// pictures say little. [five labelled sets: false ones 1.0-2.0, gates 4.8-5.4, Washington's 3.4]
struct Usual {
  double count, mean, variance;
};
constexpr Usual kUsualGates{6.0, 4.7, 0.8}, kUsualOthers{6.0, 1.5, 0.5};

/// The kind that detections with these weights make up beside what is usual, its mean within
/// [least, most]: where nothing false is found, gates are not split in two.
Kind kind_of(std::span<const Judged> found, const std::function<double(const Judged&)>& weight,
             const Usual& usual, double least, double most, double least_variance) {
  constexpr double kMostVariance = 1.0;
  double sum = usual.count, moment = usual.count * usual.mean,
         square = usual.count * usual.variance;
  for (const Judged& f : found) sum += weight(f), moment += weight(f) * f.score;
  const double mean = std::clamp(moment / sum, least, most);
  for (const Judged& f : found) square += weight(f) * (f.score - mean) * (f.score - mean);
  return {sum, mean, std::min(square / sum + least_variance, kMostVariance)};
}

/// Sets how likely each detection is a gate: scores of gates and of false ones are two normal
/// distributions, fitted by expectation and maximisation from what such scores mostly mean; of few
/// pictures that says more than they do.
void estimate_chances(std::span<Judged> found) {
  const double even = gatefly::score_of(0.5);
  for (Judged& f : found) f.hit = confidence_of(f.score);
  for (int step = 0; step < 200 && !found.empty(); ++step) {
    // washed-out ones reach far down
    const Kind gates = kind_of(
        found, [](const Judged& f) { return f.hit; }, kUsualGates, even, 10.0, 0.25);
    const Kind others = kind_of(
        found, [](const Judged& f) { return 1.0 - f.hit; }, kUsualOthers, -10.0, even, 0.05);
    for (Judged& f : found) {
      const double gate = gates.density(f.score), other = others.density(f.score);
      // Above and below both means there is no doubt, whichever distribution is the wider one.
      f.hit = f.score >= gates.mean    ? 1.0
              : f.score <= others.mean ? 0.0
                                       : gate / std::max(1e-300, gate + other);
    }
  }
  for (Judged& f : found) f.wrong = 1.0 - f.hit;
}

/// Detections do not fix the threshold inside a gap between two of them: takes the value nearest to the
/// usual one within the middle half of the gap.
double in_its_gap(double threshold, std::span<const Judged> found, double lowest) {
  // [.02 false a picture with colours learnt from own detections, five labelled sets: 2.3-3.2]
  constexpr double kUsual = 2.7;
  double above = 100.0, below = lowest;
  for (const Judged& f : found)
    if (f.score >= threshold)
      above = std::min(above, f.score);
    else
      below = std::max(below, f.score);
  if (above > 99.0) return threshold;
  const double quarter = 0.25 * (above - below);
  return std::clamp(kUsual, below + quarter, above - quarter);
}

/// The gates to measure a lens by, picture by picture: their bars' middle lines.
std::vector<std::vector<Quad>> gates_to_measure(Pictures pictures, const ColorModel& color,
                                                const GateDetectorParams& detector) {
  constexpr double kConfident = 0.75;  // as colours are learnt from
  const bool labelled = count_gates(pictures, false) > 0;
  GateDetectorParams all = detector;
  all.sure_score = kAlwaysCareful;
  const Judging judging{.detector = all, .lowest = detector.min_score, .all = true};
  std::vector<std::vector<Quad>> gates;
  for (const LabelledImage& picture : pictures) {
    std::vector<Quad>& here = gates.emplace_back();
    for (const Judged& found : judged_in(picture, color, judging)) {
      if (labelled ? found.hit > 0.0 : confidence_of(found.score) >= kConfident)
        here.push_back(scaled(found.corners_px, 1.0 / detector.corner_scale));
    }
  }
  return gates;
}

}  // namespace

GateLens lens_of(Pictures pictures, const ColorModel& color, const GateDetectorParams& detector) {
  constexpr int kRounds = 3;
  GateDetectorParams looking = detector;
  GateLens lens;
  PixelEvidence evidence;
  for (int round = 0; round < kRounds; ++round) {
    const auto gates = gates_to_measure(pictures, color, looking);
    std::vector<BowedSide> sides;
    std::size_t number = 0;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      if (gates[i].empty()) continue;
      evidence.read(pictures[i].image, color);
      if (evidence.empty()) continue;
      for (const Quad& gate : gates[i]) {
        for (BowedSide side : bowed_sides(pictures[i].image, evidence, gate, detector.bar())) {
          side.gate = number;
          sides.push_back(side);
        }
        ++number;
      }
    }
    const double before = lens.angle;
    lens = fit_lens(sides);
    // Searching with the bend finds gates nearer to the picture's corners, and these show more of it.
    if (lens.says != GateLens::Says::kBent || std::abs(lens.angle - before) < lens.angle_sigma)
      break;
    looking.lens = lens.picture_lens();
  }
  return lens;
}

Judging as_tuned(const Judging& judging, const Tuned& tuned) {
  Judging used = tuned.learnt ? with_fitted_colors(judging) : judging;
  if (!used.detector.lens.model) used.detector.lens = tuned.lens.picture_lens();
  if (tuned.learnt) used.detector.min_score = tuned.chosen.min_score;
  return used;
}

ColorModel fit_to_labels(Pictures pictures, const ColorModel& prior,
                         const GateDetectorParams& detector) {
  std::vector<ColorPicture> examples;
  for (const LabelledImage& picture : pictures) {
    ColorPicture& example = examples.emplace_back(ColorPicture{.image = picture.image});
    const auto bars = [&](const Quad& label) {
      return scaled(files::polygon(label), 1.0 / detector.corner_scale);
    };
    for (const Quad& gate : picture.truth.gates) example.gates.push_back({bars(gate)});
    for (const Quad& gate : picture.truth.ignored) example.unsure.push_back(bars(gate));
  }
  return fit_colors(examples, prior, params_of(detector));
}

SelfTraining train_on_own(Pictures pictures, const ColorModel& described,
                          const GateDetectorParams& detector, const SelfTrainingParams& params) {
  SelfTraining result{.color = described};
  for (int round = 0; round < params.rounds; ++round) {
    const auto examples = examples_of(pictures, result.color, detector, params);
    result.confident = 0;
    for (const ColorPicture& picture : examples)
      result.confident += static_cast<int>(picture.gates.size());
    if (result.confident < params.least_gates)
      return {.color = described, .confident = result.confident};
    result.color = fit_colors(examples, described, params_of(detector));
    result.learnt = true;
  }
  return result;
}

Tuned tune_to_labels(Pictures pictures, const ColorModel& prior, const Judging& given,
                     double false_per_image) {
  Tuned tuned{.color = prior, .gates = count_gates(pictures, false)};
  tuned.learnt = tuned.gates >= kLeastLabelled;
  if (!tuned.learnt) return tuned;
  Judging judging = given;
  if (!judging.detector.lens.model) {
    tuned.lens = lens_of(pictures, fit_to_labels(pictures, prior, judging.detector),
                         with_fitted_colors(judging).detector);
    judging.detector.lens = tuned.lens.picture_lens();
  }
  const auto fit = [&](Pictures half) { return fit_to_labels(half, prior, judging.detector); };
  tuned.gates_to_hit = count_gates(pictures, judging.nearest);
  tuned.roc = roc_of(judged_by_halves(pictures, fit, with_fitted_colors(judging)), pictures.size(),
                     tuned.gates_to_hit);
  tuned.chosen = tuned.roc.at(false_per_image);
  tuned.color = fit(pictures);
  return tuned;
}

Tuned tune_to_description(Pictures pictures, const ColorModel& described, const Judging& given,
                          double false_per_image) {
  Judging judging = given;
  SelfTrainingParams params;
  SelfTraining training;
  for (const double confident : {params.confident, 0.6, 0.5}) {
    params.confident = confident;
    training = train_on_own(pictures, described, judging.detector, params);
    if (training.learnt) break;
  }
  Tuned tuned{.color = training.color,
              .learnt = training.learnt,
              .gates = training.confident,
              .confident = params.confident};
  if (!tuned.learnt) return tuned;
  if (!judging.detector.lens.model) {
    tuned.lens = lens_of(pictures, training.color, with_fitted_colors(judging).detector);
    judging.detector.lens = tuned.lens.picture_lens();
    if (tuned.lens.says == GateLens::Says::kBent) {
      training = train_on_own(pictures, described, judging.detector, params);
      if (training.learnt) tuned.color = training.color, tuned.gates = training.confident;
    }
  }
  const auto fit = [&](Pictures half) {
    return train_on_own(half, described, judging.detector, params).color;
  };
  std::vector<Judged> judged = judged_by_halves(pictures, fit, with_fitted_colors(judging));
  estimate_chances(judged);
  for (const Judged& found : judged) tuned.gates_to_hit += found.hit;
  tuned.roc = roc_of(judged, pictures.size(), tuned.gates_to_hit);
  tuned.chosen = tuned.roc.at(false_per_image);
  tuned.chosen.min_score = in_its_gap(tuned.chosen.min_score, judged, judging.lowest);
  return tuned;
}

}  // namespace gatefly::tuning
