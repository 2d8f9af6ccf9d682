// SPDX-License-Identifier: Apache-2.0
// A camera and a hall that nothing was tuned for: rendered pictures of the exhibition hall through a
// wide lens and through a straight one, colours learnt from the seed's own pictures without labels.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/hall_pictures.hpp"
#include "gatefly/experiments/hall_sheet.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/miss_cause.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/tasks/tuning/tune.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kFalsePerImage = 0.02;  // what `tune` allows when nothing is said
constexpr std::array kSizes{25.0, 35.0, 50.0, 80.0, 150.0, 1e9};  // [px]

struct Condition {
  const char *key, *name;
  HallCamera camera;
  bool names_lens = true;  // else `tune` finds its bend on the gates
};
constexpr std::array<Condition, 5> kConditions{
    {{"wide", "lens of 130-170 degrees", {}},
     {"wide_unnamed", "the wide lens, not named", {}, false},
     {"straight", "straight lens", {.straight = true}},
     {"wide_hard", "the wide lens, level hard", {.level = HallCamera::Level::kHard}},
     {"wide_varied", "the wide lens, level varied", {.level = HallCamera::Level::kVaried}}}};

/// Seeds and pictures. The full run's seeds are for reports: nothing was ever tuned on them.
struct Order {
  std::uint64_t first_seed;
  std::size_t seeds, per_seed, conditions;
};
constexpr Order kFull{3801, 20, 50, kConditions.size()}, kQuick{1001, 2, 10, 2};

/// Two of five pictures are judged, the others are there to learn from; of those a third are the ten.
bool is_judged(std::size_t i) { return i % 5 == 1 || i % 5 == 3; }
bool is_of_the_ten(std::size_t i) { return i % 5 == 0; }

/// One seed's outcome, with colours learnt from so many of its pictures.
struct Judgement {
  std::size_t learnt_from = 0, pictures = 0;
  bool learnt = false;
  double min_score = 0.0;
  tuning::GateLens lens{};  ///< The found one, if not named.
  double lens_off = 0.0;    ///< Angle found less angle named, where it bends; a part of it.
  files::Score score{};
  std::vector<HallGate> gates{};  ///< To be found, and false alarms.
};

/// The side of a gate, by its area [px].
double side_of(const Quad& gate) { return std::sqrt(files::polygon_area(gate)); }

Judgement judged(const HallSeed& hall, bool names_lens, bool ten) {
  std::vector<tuning::LabelledImage> own;
  for (std::size_t i = 0; i < hall.pictures.size(); ++i)
    if (!is_judged(i) && (!ten || is_of_the_ten(i))) own.push_back({hall.pictures[i].view(), {}});
  tuning::Judging judging{.detector = hall.config.pilot.detector};
  if (!names_lens) judging.detector.lens = {};
  const tuning::Tuned tuned =
      tuning::tune_to_description(own, hall.config.pilot.gate_color, judging, kFalsePerImage);
  tuning::Judging used = tuning::as_tuned(judging, tuned);
  used.lowest = used.detector.min_score;
  used.all = true;

  Judgement result{.learnt_from = own.size(),
                   .learnt = tuned.learnt,
                   .min_score = used.lowest,
                   .lens = tuned.lens};
  std::vector<files::PictureToScore> scored;
  for (std::size_t i = 0; i < hall.pictures.size(); ++i) {
    if (!is_judged(i)) continue;
    const HallPicture& picture = hall.pictures[i];
    files::PictureToScore& truth = scored.emplace_back(picture.truth);
    const auto found = tuning::judged_in({picture.view(), picture.truth}, tuned.color, used);
    for (const tuning::Judged& gate : found) {
      truth.detections.push_back(gate.corners_px);
      if (gate.wrong > 0.0)
        result.gates.push_back({hall.seed, i, gate.corners_px, gate.score, false, "false alarm"});
    }
    for (const Quad& gate : picture.truth.gates) {
      const bool hit = std::any_of(found.begin(), found.end(), [&](const tuning::Judged& f) {
        return f.hit > 0.0 && files::matches(f.corners_px, gate, files::Rule::kOverlap70);
      });
      result.gates.push_back(
          {hall.seed, i, gate, 0.0, hit,
           hit ? "" : cause_of_miss(picture.view(), gate, tuned.color, used.detector)});
    }
  }
  const double angle = hall.config.camera.width / hall.config.camera.focal_px.x();
  if (tuned.lens.says == tuning::GateLens::Says::kBent)
    result.lens_off = std::abs(tuned.lens.angle / angle - 1.0);
  result.pictures = scored.size();
  result.score = files::score(scored, files::Rule::kOverlap70);
  return result;
}

/// All seeds of one condition.
struct Sum {
  std::size_t learnt_from = 0, pictures = 0, seeds = 0, learnt = 0;
  int gates = 0, hits = 0, wrong = 0;
  std::vector<double> errors{};  ///< Errors of corners [px], sorted.
  std::array<files::HitRate, kSizes.size() - 1> by_size{};
  std::map<std::string, int> causes{};
  std::vector<double> thresholds{};  ///< Each seed's, sorted.
  std::vector<double> lens_off{};    ///< For each seed whose gates showed a bend, sorted.

  [[nodiscard]] double tpr() const { return static_cast<double>(hits) / std::max(1, gates); }
  [[nodiscard]] double fp_per_image() const {
    return static_cast<double>(wrong) / static_cast<double>(std::max<std::size_t>(1, pictures));
  }
};

Sum sum_of(const std::vector<Judgement>& judgements) {
  Sum sum{.seeds = judgements.size()};
  for (std::size_t b = 0; b < sum.by_size.size(); ++b)
    sum.by_size[b] = {.from = kSizes[b], .to = kSizes[b + 1]};
  for (const Judgement& judgement : judgements) {
    sum.learnt_from = judgement.learnt_from, sum.pictures += judgement.pictures,
    sum.learnt += judgement.learnt;
    sum.gates += judgement.score.gates, sum.hits += judgement.score.hits;
    sum.wrong += judgement.score.false_positives;
    sum.errors.insert(sum.errors.end(), judgement.score.best_order_px.begin(),
                      judgement.score.best_order_px.end());
    sum.thresholds.push_back(judgement.min_score);
    if (judgement.lens.says == tuning::GateLens::Says::kBent)
      sum.lens_off.push_back(judgement.lens_off);
    for (const HallGate& gate : judgement.gates) {
      if (gate.is_false()) continue;
      for (files::HitRate& bin : sum.by_size)
        if (side_of(gate.corners_px) >= bin.from && side_of(gate.corners_px) < bin.to)
          ++bin.gates, bin.hits += gate.hit;
      if (!gate.hit) ++sum.causes[gate.cause];
    }
  }
  std::sort(sum.errors.begin(), sum.errors.end());
  std::sort(sum.thresholds.begin(), sum.thresholds.end());
  std::sort(sum.lens_off.begin(), sum.lens_off.end());
  return sum;
}

std::string size_name(const files::HitRate& bin) {
  return bin.to > 1e6 ? fixed(bin.from, 0) + " px and more"
                      : fixed(bin.from, 0) + "-" + fixed(bin.to, 0) + " px";
}

void add_rows(const Condition& condition, const Sum& sum, std::vector<Comparison>& table) {
  const std::string name = condition.name;
  table.push_back(
      {name + ", " + std::to_string(sum.learnt_from) + " own pictures", "-",
       fixed(sum.tpr(), 3) + " at " + fixed(sum.fp_per_image(), 3) + " false a picture"});
  if (!sum.errors.empty())
    table.push_back({"  corner error", "-",
                     "median " + fixed(files::quantile(sum.errors, 0.5), 2) + " px, p90 " +
                         fixed(files::quantile(sum.errors, 0.9), 1) + " px"});
  std::string sizes, causes;
  for (const files::HitRate& bin : sum.by_size)
    if (bin.gates > 0)
      sizes += (sizes.empty() ? "" : ", ") + size_name(bin) + " " +
               fixed(static_cast<double>(bin.hits) / bin.gates, 2) + " of " +
               std::to_string(bin.gates);
  for (const auto& [cause, count] : sum.causes)
    causes += (causes.empty() ? "" : ", ") + std::to_string(count) + " " + cause;
  table.push_back({"  by side", "-", sizes});
  if (!causes.empty()) table.push_back({"  missed", "-", causes});
  if (!condition.names_lens)
    table.push_back(
        {"  lens found on the gates", "-",
         "on " + std::to_string(sum.lens_off.size()) + " of " + files::amount(sum.seeds, "seed") +
             (sum.lens_off.empty()
                  ? ""
                  : ", its angle off by " + fixed(100.0 * files::quantile(sum.lens_off, 0.5), 1) +
                        " %, median, " + fixed(100.0 * sum.lens_off.back(), 1) + " % at most")});
  if (sum.learnt < sum.seeds)
    table.push_back(
        {"  too few gates to learn from", "-",
         std::to_string(sum.seeds - sum.learnt) + " of " + files::amount(sum.seeds, "seed")});
}

nlohmann::ordered_json json_of(const Condition& condition, const Sum& sum) {
  auto by_size = nlohmann::ordered_json::array();
  for (const files::HitRate& bin : sum.by_size)
    by_size.push_back({{"from_px", bin.from}, {"gates", bin.gates}, {"hits", bin.hits}});
  nlohmann::ordered_json corners = nullptr;
  if (!sum.errors.empty())
    corners = {{"median", files::quantile(sum.errors, 0.5)},
               {"p90", files::quantile(sum.errors, 0.9)}};
  return {{"condition", condition.key},
          {"learnt_from", sum.learnt_from},
          {"days", sum.seeds},
          {"days_learnt", sum.learnt},
          {"pictures", sum.pictures},
          {"gates", sum.gates},
          {"tpr", sum.tpr()},
          {"fp_per_image", sum.fp_per_image()},
          {"corner_error_px", corners},
          {"lens",
           {{"named", condition.names_lens},
            {"days_found", sum.lens_off.size()},
            {"angle_off_median",
             sum.lens_off.empty() ? nlohmann::ordered_json(nullptr)
                                  : nlohmann::ordered_json(files::quantile(sum.lens_off, 0.5))}}},
          {"min_score", {{"least", sum.thresholds.front()}, {"most", sum.thresholds.back()}}},
          {"by_size", by_size},
          {"missed", sum.causes}};
}

std::string csv_of(const Condition& condition, const std::vector<Judgement>& judgements) {
  std::string csv;
  for (const Judgement& judgement : judgements)
    for (const HallGate& gate : judgement.gates)
      csv += std::string{condition.key} + "," + std::to_string(judgement.learnt_from) + "," +
             std::to_string(gate.seed) + "," + std::to_string(gate.picture) + "," +
             files::text_of(side_of(gate.corners_px), 4) + "," +
             (gate.is_false() ? "false"
              : gate.hit      ? "hit"
                              : "missed") +
             "," + gate.cause + "\n";
  return csv;
}

drawing::PlotSeries curve_of(const std::string& name, const Sum& sum, const drawing::Color& color) {
  drawing::PlotSeries series{.name = name, .points = {}, .color = color};
  for (const files::HitRate& bin : sum.by_size)
    if (bin.gates > 0)
      series.points.emplace_back(bin.to > 1e6 ? 1.5 * bin.from : 0.5 * (bin.from + bin.to),
                                 static_cast<double>(bin.hits) / bin.gates);
  return series;
}

}  // namespace

Result other_camera(const Options& options) {
  constexpr std::array kColors{drawing::kLight.found, drawing::kLight.focus,
                               drawing::kLight.gate_solid, drawing::kLight.flown,
                               drawing::kLight.estimate};
  Order order = options.quick ? kQuick : kFull;
  order.first_seed = first_seed(options, kFull.first_seed, kQuick.first_seed);
  Result result{.table = {},
                .json = {{"rule", "overlap70, every gate"},
                         {"least_side_px", HallPicture::kLeastSide},
                         {"first_seed", order.first_seed}},
                .csv = "condition,learnt_from,seed,picture,side_px,is,cause\n",
                .picture = drawing::Canvas(1, 1)};
  drawing::Plot plot{
      .title = "Gates found by their side, exhibition hall, colours learnt without labels",
      .x_label = "side of the gate [px]",
      .y_label = "true positive rate",
      .log_x = true};
  auto list = nlohmann::ordered_json::array();
  HallSheet misses{"Missed, " + std::string{kConditions[0].name}},
      alarms{"False alarms, " + std::string{kConditions[0].name}};
  for (std::size_t c = 0; c < order.conditions; ++c) {
    const Condition& condition = kConditions[c];
    std::vector<Judgement> by_all(order.seeds), by_ten(order.seeds);
    std::vector<HallSheet::Tiles> missed(order.seeds), wrong(order.seeds);
    in_parallel(order.seeds, [&](std::size_t s) {
      if (options.stopped()) return;
      const HallSeed hall =
          hall_seed(condition.camera, order.first_seed + s, order.per_seed, options);
      if (options.stopped()) return;
      by_all[s] = judged(hall, condition.names_lens, false);
      by_ten[s] = judged(hall, condition.names_lens, true);
      if (c > 0) return;
      missed[s] = HallSheet::tiles_of(hall, by_all[s].gates, false);
      wrong[s] = HallSheet::tiles_of(hall, by_all[s].gates, true);
    });
    if (options.stopped()) throw Stopped{};
    options.progress(static_cast<double>(c + 1) / static_cast<double>(order.conditions),
                     condition.name);
    for (const auto* judgements : {&by_all, &by_ten}) {
      const Sum sum = sum_of(*judgements);
      add_rows(condition, sum, result.table);
      list.push_back(json_of(condition, sum));
      result.csv += csv_of(condition, *judgements);
    }
    plot.series.push_back(curve_of(condition.name, sum_of(by_all), kColors[c]));
    for (std::size_t s = 0; s < order.seeds; ++s) misses.add(missed[s]), alarms.add(wrong[s]);
  }
  result.json["conditions"] = list;
  result.picture = drawing::draw(plot);
  result.extra.push_back({"missed", misses.drawn()});
  result.extra.push_back({"false-alarms", alarms.drawn()});
  return result;
}

}  // namespace gatefly::experiments
