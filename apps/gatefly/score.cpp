// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "gatefly/files/json.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/files/scoring.hpp"
#include "gatefly/files/text.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

using files::fixed;
using files::number;
using nlohmann::ordered_json;

struct ScoreOptions {
  CommonOptions common;
  std::string detections, labels, ignore, data, rule = "overlap70";
  bool nearest = false, json = false;
};

ordered_json as_json(std::span<const double> errors) {
  return {{"median", number(files::quantile(errors, 0.5))},
          {"p90", number(files::quantile(errors, 0.9))}};
}

ordered_json as_json(std::span<const files::HitRate> rates, const std::string& unit) {
  ordered_json list = ordered_json::array();
  for (const files::HitRate& rate : rates)
    list.push_back({{"from_" + unit, rate.from},
                    {"to_" + unit, number(rate.to)},
                    {"gates", rate.gates},
                    {"hits", rate.hits}});
  return list;
}

ordered_json as_json(const ScoreOptions& options, const files::ScoreInput& input,
                     const files::Score& score) {
  return {
      {"labels", options.labels},
      {"rule", options.rule},
      {"nearest", options.nearest},
      {"pictures", score.pictures},
      {"labelled_gates", score.gates},
      {"detections", score.detections},
      {"hits", score.hits},
      {"false_positives", score.false_positives},
      {"neither", score.neither},
      {"true_positive_rate", number(score.true_positive_rate())},
      {"false_positives_per_image", number(score.false_positives_per_image())},
      {"corner_error_px",
       {{"best_order", as_json(score.best_order_px)}, {"as_listed", as_json(score.as_listed_px)}}},
      {"by_size", as_json(score.by_size, "px")},
      {"by_distance", as_json(score.by_distance, "m")},
      {"left_out",
       {{"duplicates", input.duplicates},
        {"degenerate", input.degenerate},
        {"bars", input.bars},
        {"not_labelled", input.unknown.size()}}}};
}

std::string medians(std::span<const double> errors) {
  if (errors.empty()) return "no hit";
  return "median " + fixed(files::quantile(errors, 0.5), 1) + " px, p90 " +
         fixed(files::quantile(errors, 0.9), 1) + " px";
}

/// "20-30 px 5/6  30-45 px 12/14": hits of labelled gates.
std::string rates_text(std::span<const files::HitRate> rates, const char* unit, bool middle) {
  std::string text;
  for (const files::HitRate& rate : rates) {
    if (rate.gates == 0) continue;
    std::string range = middle                   ? fixed(0.5 * (rate.from + rate.to), 0)
                        : std::isfinite(rate.to) ? fixed(rate.from, 0) + "-" + fixed(rate.to, 0)
                                                 : fixed(rate.from, 0) + "+";
    text += (text.empty() ? "" : "   ") + range + unit + std::to_string(rate.hits) + "/" +
            std::to_string(rate.gates);
  }
  return text;
}

std::string left_out_text(const files::ScoreInput& input, const files::Score& score) {
  std::string text;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  };
  add(static_cast<std::size_t>(score.neither), "detections neither hit nor false");
  add(static_cast<std::size_t>(input.duplicates), "duplicate pictures");
  add(static_cast<std::size_t>(input.degenerate), "pictures with a degenerate label");
  add(static_cast<std::size_t>(input.bars), "rows of bars");
  add(input.unknown.size(), "detections in pictures without a label");
  return text;
}

void print_screen(const ScoreOptions& options, const files::ScoreInput& input,
                  const files::Score& score) {
  const auto line = [](const char* name, const std::string& text) {
    if (!text.empty()) std::cout << "  " << std::left << std::setw(17) << name << text << '\n';
  };
  std::cout << options.labels << ": " << files::amount(score.pictures, "picture") << ", "
            << files::amount(score.gates, "labelled gate") << ", " << options.rule
            << (options.nearest ? ", nearest" : "") << '\n';
  line("true positives",
       std::to_string(score.hits) + " of " + std::to_string(score.gates) +
           (score.gates > 0 ? " (rate " + fixed(score.true_positive_rate(), 3) + ")" : ""));
  line("false positives",
       std::to_string(score.false_positives) +
           (score.pictures > 0 ? " (" + fixed(score.false_positives_per_image(), 3) + " per image)"
                               : ""));
  if (options.common.quiet) return;
  line("corner error", medians(score.best_order_px) +
                           (score.hits > 0 ? "; as listed " + medians(score.as_listed_px) : ""));
  line("by size", rates_text(score.by_size, " px ", false));
  line("by distance", rates_text(score.by_distance, " m ", true));
  line("left out", left_out_text(input, score));
}

void warn_of_unknown(const files::ScoreInput& input) {
  if (input.unknown.empty()) return;
  std::cerr << "gatefly score: warning: " << input.unknown.size()
            << " detections name pictures that are not in the labels: ";
  for (std::size_t i = 0; i < input.unknown.size() && i < 3; ++i)
    std::cerr << (i > 0 ? ", " : "") << input.unknown[i];
  std::cerr << (input.unknown.size() > 3 ? ", ...\n" : "\n");
}

/// gatefly score: exit 0 scored, 2 unusable input.
int score(const ScoreOptions& options) {
  (void)load(options.common);  // a wrong --config or --set is an error here as everywhere
  const files::Rule rule = files::rule_of(options.rule);
  const auto detections = files::read_detections(data_at(options.detections, options.data));
  const files::Labels labels = files::read_labels(data_at(options.labels, options.data));
  const files::Labels ignored = options.ignore.empty()
                                    ? files::Labels{}
                                    : files::read_labels(data_at(options.ignore, options.data));
  const files::ScoreInput input = files::brought_together(labels, detections, ignored, rule);
  const files::Score result = files::score(input.pictures, rule, options.nearest);
  warn_of_unknown(input);
  if (options.json)
    std::cout << files::json_text(as_json(options, input, result));
  else
    print_screen(options, input, result);
  return kDone;
}

}  // namespace

void declare_score(Command& command) {
  auto options = std::make_shared<ScoreOptions>();
  command.footer(
      "Example:\n  gatefly score --detections found.csv --labels "
      "../shared/data/tudelft_bebop_gates/cyberzoo/labels.csv\n\n"
      "overlap70: a hit covers at least 70 % of both areas, one per labelled gate; everything else "
      "is a false\n"
      "positive. overlap70-authors: whatever covers a label that much is none, and identical "
      "pictures count each\n"
      "time. iou50, iou75: shared area by the area of both. Corner errors are of all four corners "
      "of all hits, in\n"
      "the best cyclic order and as listed. Exit code 0: scored; 2: unusable input.");
  command.option("--detections", options->detections, "what gatefly detect wrote")
      .required()
      .path("FILE");
  command.option("--labels", options->labels, "labels.csv").required().path("FILE");
  command.option("--rule", options->rule, "when a detection is a hit")
      .one_of({"overlap70", "overlap70-authors", "iou50", "iou75"})
      .show_default();
  command.flag("--nearest", options->nearest, "only the first labelled gate of a picture counts");
  command
      .option("--ignore", options->ignore,
              "quads where a detection is neither hit nor false positive")
      .path("FILE");
  command
      .option("--data", options->data,
              "where a FILE is looked for that is not here [$GATEFLY_DATA]")
      .path("DIR");
  command.flag("--json", options->json, "print JSON");
  add_common(command, options->common);
  command.runs([options] { return score(*options); });
}

}  // namespace gatefly::cli
