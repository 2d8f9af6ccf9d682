// SPDX-License-Identifier: Apache-2.0
// Li18's figure "TPR vs distance": how near a gate must be to be seen.
#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/detection_examples.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/tasks/tuning/roc.hpp"

namespace gatefly::experiments {
namespace {

struct Bin {
  const char* name;
  double from, to;   ///< [m]
  double paper_tpr;  ///< [recomputed from the authors' stored results]
  int paper_gates;
  int gates = 0, hits = 0;  ///< Over all repeats.

  [[nodiscard]] double tpr() const {
    return gates > 0 ? static_cast<double>(hits) / gates : std::numeric_limits<double>::quiet_NaN();
  }
};

using Bins = std::array<Bin, 5>;

Bins empty_bins() {
  return {{{"below 2 m", 0, 2, .70, 57},
           {"2-3 m", 2, 3, .57, 74},
           {"3-4 m", 3, 4, .29, 48},
           {"4-5 m", 4, 5, .10, 20},
           {"5-6 m", 5, 6, .0, 12}}};
}

constexpr files::Rule kRule = files::Rule::kOverlap70Authors;

void count(Bins& bins, const std::vector<files::PictureToScore>& pictures) {
  for (const files::PictureToScore& picture : pictures) {
    if (picture.gates.empty()) continue;
    const double distance = distance_from_area(files::polygon_area(picture.gates.front()));
    const files::Score score = files::score({&picture, 1}, kRule);
    for (Bin& bin : bins)
      if (distance >= bin.from && distance < bin.to) ++bin.gates, bin.hits += score.hits;
  }
}

/// Our detector as `gatefly detect --config basement` runs it: the best gate of each picture.
Found by_own_detector(const LabelledSet& set) {
  const std::vector<std::string> configs{"basement"};
  const config::Config config = config::load_config(config::config_files(configs));
  const tuning::Judging judging{.detector = config.pilot.detector,
                                .lowest = config.pilot.detector.min_score};
  Found found(set.size());
  in_parallel(set.size(), [&](std::size_t i) {
    for (const tuning::Judged& gate :
         tuning::found_in(set.picture(i), config.pilot.gate_color, judging))
      found[i].push_back({.corners_px = gate.corners_px});
  });
  return found;
}

drawing::Canvas plotted(const Bins& paper_mode, const Bins& own) {
  drawing::PlotSeries paper{.name = "paper (its stored run)",
                            .points = {},
                            .color = drawing::kLight.gate_solid,
                            .line = true,
                            .rings = true};
  drawing::PlotSeries rebuilt{
      .name = "the paper's detector, rebuilt", .points = {}, .color = drawing::kLight.found};
  drawing::PlotSeries ours{.name = "our detector", .points = {}, .color = drawing::kLight.flown};
  for (std::size_t i = 0; i < own.size(); ++i) {
    const double middle = 0.5 * (std::max(own[i].from, 1.0) + own[i].to);
    paper.points.emplace_back(middle, own[i].paper_tpr);
    rebuilt.points.emplace_back(middle, paper_mode[i].tpr());
    ours.points.emplace_back(middle, own[i].tpr());
  }
  return drawing::draw({.title = "True positive rate by distance, the authors' 580 pictures",
                        .x_label = "distance to the gate [m]",
                        .y_label = "true positive rate",
                        .series = {paper, rebuilt, ours}});
}

/// Distances with more hits than nearer ones: the authors' curve has none.
std::string rises(const Bins& bins) {
  std::string text;
  for (std::size_t i = 1; i < bins.size(); ++i)
    if (bins[i].tpr() > bins[i - 1].tpr())
      text += (text.empty() ? "" : "; ") + std::string{bins[i - 1].name} + " " +
              fixed(bins[i - 1].tpr(), 2) + ", " + bins[i].name + " " + fixed(bins[i].tpr(), 2);
  return text;
}

}  // namespace

Result tpr_distance(const Options& options) {
  const auto folder = data_folder("tudelft_bebop_gates", options) / "basement580";
  const LabelledSet set(folder);
  const auto unlabelled = unlabelled_gates(set, folder / "unlabelled_gates.csv");
  Bins bins = empty_bins(), own = empty_bins();
  const int repeats = options.quick ? 2 : 10;
  std::vector<Found> runs;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    if (options.stopped()) throw Stopped{};
    options.progress(static_cast<double>(repeat) / repeats, "run " + std::to_string(repeat + 1));
    runs.push_back(run(set, as_paper(), repeat));
    count(bins, to_score(set, runs.back()));
  }
  options.progress(1.0, "our detector");
  auto by_own = to_score(set, by_own_detector(set));
  count(own, by_own);
  const files::Score own_score = files::score(by_own, kRule);
  for (std::size_t i = 0; i < set.size(); ++i) by_own[i].ignored = unlabelled[i];
  const double on_no_gate = files::score(by_own, kRule).false_positives_per_image();

  Result result{.table = {{"", "authors", "the same detector, rebuilt; our detector"}},
                .json = {},
                .csv = "from_m,to_m,gates,tpr,paper_gates,paper_tpr,own_tpr\n",
                .picture = plotted(bins, own)};
  auto list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const Bin& bin = bins[i];
    const int gates = bin.gates / repeats;
    result.table.push_back(
        {bin.name, fixed(bin.paper_tpr, 2) + " of " + std::to_string(bin.paper_gates),
         fixed(bin.tpr(), 2) + " of " + std::to_string(gates) + "; " + fixed(own[i].tpr(), 2)});
    result.csv += files::text_of(bin.from) + "," + files::text_of(bin.to) + "," +
                  std::to_string(gates) + "," +
                  (bin.gates > 0 ? files::text_of(bin.tpr(), 6) : "") + "," +
                  std::to_string(bin.paper_gates) + "," + files::text_of(bin.paper_tpr) + "," +
                  (bin.gates > 0 ? files::text_of(own[i].tpr(), 6) : "") + "\n";
    list.push_back({{"from_m", bin.from},
                    {"to_m", bin.to},
                    {"gates", gates},
                    {"hits", bin.hits},
                    {"own_hits", own[i].hits},
                    {"paper", {{"gates", bin.paper_gates}, {"tpr", bin.paper_tpr}}}});
  }
  result.table.push_back({"all, at false positives a picture", "0.46 at 0.064",
                          "our detector " + fixed(own_score.true_positive_rate(), 2) + " at " +
                              fixed(own_score.false_positives_per_image(), 3) + " (" +
                              fixed(on_no_gate, 3) +
                              " without gates that have no label); chosen on these pictures"});
  if (const std::string where = rises(bins); !where.empty())
    result.table.push_back({"differs: hits rise with distance", "never", "rebuilt: " + where});
  result.json = {{"rule", "overlap70-authors"},
                 {"sigma_l_px", PaperDetectorParams{}.min_side_px},
                 {"sigma_cf", PaperDetectorParams{}.min_color_fitness},
                 {"repeats", repeats},
                 {"bins", list},
                 {"own",
                  {{"config", "basement"},
                   {"tpr", own_score.true_positive_rate()},
                   {"fp_per_image", own_score.false_positives_per_image()},
                   {"fp_per_image_on_no_gate", on_no_gate}}},
                 {"differs", rises(bins)}};
  const auto examples = detection_examples(set, runs, unlabelled);
  for (const DetectionExample& example : examples)
    result.json["examples"].push_back(
        {{"kind", example.kind},
         {"rule", example.rule},
         {"image", example.picture
                       ? nlohmann::ordered_json(set.labels.pictures[*example.picture].image)
                       : nullptr}});
  result.extra.push_back(
      {"examples", drawn_examples(set, runs.front(), examples, PaperDetectorParams{}.color)});
  return result;
}

}  // namespace gatefly::experiments
