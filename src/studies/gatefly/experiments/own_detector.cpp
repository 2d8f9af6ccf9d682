// SPDX-License-Identifier: Apache-2.0
// Our detector on real pictures: colours described, learnt from its own detections, fitted to
// labels; the last two on one half of the pictures and scored on the other.
#include <algorithm>
#include <array>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/own_sets.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::experiments {
namespace {

constexpr std::array kAllowed{0.01, 0.02, 0.03, 0.05, 0.1};

struct Model {
  Colors colors;
  const char *key, *name;
  bool fast = false;
};
constexpr std::array<Model, 5> kModels{
    {{Colors::kLabels, "labels", "labels"},
     {Colors::kOwnDetections, "own_detections", "no labels"},
     {Colors::kDescribed, "described", "described"},
     {Colors::kLabels, "fast_labels", "fast, labels", true},
     {Colors::kDescribed, "fast_described", "fast, described", true}}};

/// Corner errors of the hits above a threshold, in the best cyclic order [px], sorted.
std::vector<double> corner_errors_of(const OwnSet& set, const std::vector<tuning::Judged>& judged,
                                     double min_score) {
  std::vector<double> errors;
  for (const tuning::Judged& found : judged) {
    if (found.hit < 1.0 || found.score < min_score) continue;
    const auto& gates = set.picture(found.picture).truth.gates;
    const auto of = [&](const Quad& gate) {
      return files::corner_errors(found.corners_px, gate).best_order;
    };
    const auto sum = [&](const Quad& gate) {
      double all = 0.0;
      for (const double e : of(gate)) all += e;
      return all;
    };
    const auto nearest = std::min_element(
        gates.begin(), gates.end(), [&](const Quad& a, const Quad& b) { return sum(a) < sum(b); });
    for (const double error : of(*nearest)) errors.push_back(error);
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

/// Li18's own detector where the paper's authors scored it.
std::string paper_text(const std::string& set) {
  return set == "basement580" ? "0.46 at 0.064" : "-";
}

nlohmann::ordered_json json_of(const OwnSet& set, const std::vector<tuning::Judged>& judged,
                               const tuning::Roc& roc) {
  auto at = nlohmann::ordered_json::array();
  for (const double allowed : kAllowed) {
    const tuning::Operating point = roc.at(allowed);
    at.push_back({{"allowed_fp_per_image", allowed},
                  {"tpr", point.true_positive_rate},
                  {"fp_per_image", point.false_per_image},
                  {"min_score", point.min_score}});
  }
  const std::vector<double> errors = corner_errors_of(set, judged, roc.at(0.05).min_score);
  nlohmann::ordered_json corners = nullptr;
  if (!errors.empty())
    corners = {{"median", files::quantile(errors, 0.5)}, {"p90", files::quantile(errors, 0.9)}};
  return {{"at", at}, {"corner_error_px", corners}};
}

std::string row_text(const tuning::Roc& roc) {
  std::string text;
  for (const double allowed : {0.01, 0.02, 0.03, 0.05})
    text += (text.empty() ? "" : ", ") + fixed(roc.at(allowed).true_positive_rate, 3) + " at " +
            fixed(roc.at(allowed).false_per_image, 3);
  return text;
}

drawing::PlotSeries curve(const std::string& name, const tuning::Roc& roc,
                          const drawing::Color& color) {
  drawing::PlotSeries series{.name = name, .points = {}, .color = color};
  for (const tuning::Operating& point : roc.points)
    if (point.false_per_image >= 0.004 && point.false_per_image <= 0.2)
      series.points.emplace_back(point.false_per_image, point.true_positive_rate);
  return series;
}

}  // namespace

Result own_detector(const Options& options) {
  constexpr std::array kColors{drawing::kLight.gate_solid, drawing::kLight.found,
                               drawing::kLight.flown, drawing::kLight.estimate,
                               drawing::kLight.ink};
  Result result{.table = {},
                .json = {{"rule", "overlap70; washington_obrace: iou50, nearest gate"}},
                .csv = "set,colours,min_score,tpr,fp_per_image\n",
                .picture = drawing::Canvas(1, 1)};
  drawing::Plot plot{.title = "Our detector, colours fitted to labels of the other half",
                     .x_label = "false positives per picture",
                     .y_label = "true positive rate",
                     .log_x = true};
  auto sets = nlohmann::ordered_json::array();
  const std::size_t count = options.quick ? 2 : own_set_names().size();
  for (std::size_t s = 0; s < count; ++s) {
    const OwnSet set = own_set(own_set_names()[s], options);
    auto models = nlohmann::ordered_json::object();
    for (const Model& model : kModels) {
      if (options.stopped()) throw Stopped{};
      options.progress(
          (static_cast<double>(s) + 0.2 * static_cast<double>(&model - kModels.data())) /
              static_cast<double>(count),
          set.name + ", " + model.name);
      const std::vector<tuning::Judged> judged = judged_by_halves(set, model.colors, model.fast);
      const tuning::Roc roc = tuning::roc_of(judged, set.size(), set.gates());
      result.table.push_back({set.name + ", " + model.name, paper_text(set.name), row_text(roc)});
      models[model.key] = json_of(set, judged, roc);
      for (const tuning::Operating& point : roc.points)
        result.csv += set.name + "," + model.key + "," + files::text_of(point.min_score, 6) + "," +
                      files::text_of(point.true_positive_rate, 6) + "," +
                      files::text_of(point.false_per_image, 6) + "\n";
      if (model.colors == Colors::kLabels && !model.fast)
        plot.series.push_back(curve(set.name, roc, kColors[s]));
    }
    const auto& corners = models["labels"]["corner_error_px"];
    if (!corners.is_null())
      result.table.push_back({"  corner error", "-",
                              "median " + fixed(corners["median"], 1) + " px, p90 " +
                                  fixed(corners["p90"], 1) + " px"});
    sets.push_back(
        {{"set", set.name}, {"pictures", set.size()}, {"gates", set.gates()}, {"colours", models}});
  }
  result.json["sets"] = sets;
  plot.series.push_back({.name = "paper (basement580)",
                         .points = {{0.064, 0.46}},
                         .color = drawing::kLight.ink,
                         .line = false,
                         .rings = true});
  result.picture = drawing::draw(plot);
  return result;
}

}  // namespace gatefly::experiments
