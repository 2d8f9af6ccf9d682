// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/twin_rates.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "gatefly/config/config.hpp"
#include "gatefly/files/scoring.hpp"
#include "gatefly/simulated_race/results/campaign_statistics.hpp"
#include "gatefly/tasks/tuning/roc.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kTwoSided = 1.96;  // σ of a 95 % interval

PaperDetector detector_of(TwinMode mode, const std::string& config_name) {
  if (mode == TwinMode::kPaper) return as_paper();
  if (mode == TwinMode::kFlown) return as_flown();
  const std::vector<std::string> names{config_name};
  const config::Config config = config::load_config(config::config_files(names));
  const tuning::Judging judging{.detector = config.pilot.detector,
                                .lowest = config.pilot.detector.min_score};
  return [config, judging](const Image& image, Rng&) {
    std::vector<GateDetection> found;
    for (const tuning::Judged& gate : tuning::found_in(image, config.pilot.gate_color, judging))
      found.push_back({.corners_px = gate.corners_px});
    return found;
  };
}

TwinRate mean_of(const std::vector<double>& values) {
  TwinRate rate{.count = static_cast<int>(values.size())};
  if (values.empty()) return rate;
  const auto n = static_cast<double>(values.size());
  double squares = 0.0;
  for (const double v : values) rate.mean += v / n, squares += v * v / n;
  const double sigma = std::sqrt(std::max(0.0, squares - rate.mean * rate.mean) / n);
  rate.low = std::max(0.0, rate.mean - kTwoSided * sigma),
  rate.high = rate.mean + kTwoSided * sigma;
  return rate;
}

TwinRate rate_of(const std::vector<double>& hits) {
  TwinRate rate = mean_of(hits);
  if (hits.empty()) return rate;
  const auto interval =
      simulated_race::wilson95(static_cast<int>(std::lround(rate.mean * rate.count)), rate.count);
  rate.low = interval.low, rate.high = interval.high;
  return rate;
}

}  // namespace

const char* name_of(TwinMode mode) {
  return mode == TwinMode::kPaper ? "paper" : mode == TwinMode::kFlown ? "flown" : "ours";
}

int bin_of(const Quad& gate) {
  const double distance = distance_from_area(files::polygon_area(gate));
  for (std::size_t i = 0; i < kTwinBinCount; ++i)
    if (distance < kTwinBins[i + 1]) return static_cast<int>(i);
  return -1;
}

std::vector<TwinOutcome> outcomes(std::span<const TwinPicture> pictures, TwinMode mode,
                                  const std::string& config, int repeats) {
  const PaperDetector detector = detector_of(mode, config);
  const files::Rule rule =
      mode == TwinMode::kPaper ? files::Rule::kOverlap70Authors : files::Rule::kOverlap70;
  if (mode == TwinMode::kOurs) repeats = 1;  // it draws nothing
  std::vector<TwinOutcome> all(pictures.size());
  in_parallel(pictures.size(), [&](std::size_t i) {
    for (int repeat = 0; repeat < repeats; ++repeat) {
      Rng rng{1'000'003u * static_cast<std::uint64_t>(repeat) + i};
      files::PictureToScore picture{.gates = {}, .ignored = pictures[i].others, .detections = {}};
      if (pictures[i].gate) picture.gates.push_back(*pictures[i].gate);
      for (const GateDetection& gate : detector(pictures[i].view(), rng))
        picture.detections.push_back(gate.corners_px);
      const files::Score score = files::score({&picture, 1}, rule);
      all[i].hit += static_cast<double>(score.hits) / repeats;
      all[i].false_positives += static_cast<double>(score.false_positives) / repeats;
      if (repeat == 0) all[i].corner_errors = score.best_order_px;
    }
  });
  return all;
}

TwinRates pooled(std::span<const TwinRates> sets) {
  TwinRates all = weighted(sets, sets);
  for (TwinRate& bin : all.bins) {
    const auto interval =
        simulated_race::wilson95(static_cast<int>(std::lround(bin.mean * bin.count)), bin.count);
    bin.low = interval.low, bin.high = interval.high;
  }
  return all;
}

TwinRates weighted(std::span<const TwinRates> rendered, std::span<const TwinRates> real) {
  const auto joined = [&](const auto& part) {
    TwinRate all;
    double weight = 0.0, variance = 0.0;
    for (std::size_t i = 0; i < real.size(); ++i) {
      const TwinRate &of = part(rendered[i]), &by = part(real[i]);
      all.count += of.count;
      if (of.count == 0) continue;
      const double sigma = (of.high - of.mean) / kTwoSided;
      all.mean += by.count * of.mean, weight += by.count;
      variance += by.count * by.count * sigma * sigma;
    }
    if (weight <= 0.0) return all;
    all.mean /= weight;
    const double sigma = std::sqrt(variance) / weight;
    all.low = std::max(0.0, all.mean - kTwoSided * sigma), all.high = all.mean + kTwoSided * sigma;
    return all;
  };
  TwinRates all;
  for (std::size_t i = 0; i < kTwinBinCount; ++i)
    all.bins[i] = joined([i](const TwinRates& r) -> const TwinRate& { return r.bins[i]; });
  all.false_positives_with_gate =
      joined([](const TwinRates& r) -> const TwinRate& { return r.false_positives_with_gate; });
  all.false_positives_without =
      joined([](const TwinRates& r) -> const TwinRate& { return r.false_positives_without; });
  return all;
}

TwinRates rates(std::span<const TwinPicture> pictures, std::span<const TwinOutcome> outcomes) {
  std::array<std::vector<double>, kTwinBinCount> hits;
  std::vector<double> with, without;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    (pictures[i].gate ? with : without).push_back(outcomes[i].false_positives);
    if (!pictures[i].gate) continue;
    const int bin = bin_of(*pictures[i].gate);
    if (bin >= 0) hits[static_cast<std::size_t>(bin)].push_back(outcomes[i].hit);
  }
  TwinRates result{.bins = {},
                   .false_positives_with_gate = mean_of(with),
                   .false_positives_without = mean_of(without)};
  std::transform(hits.begin(), hits.end(), result.bins.begin(), rate_of);
  return result;
}

}  // namespace gatefly::experiments
