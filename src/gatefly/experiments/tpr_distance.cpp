// SPDX-License-Identifier: Apache-2.0
// Li18's figure "TPR vs distance": how near a gate must be to be seen.
#include <array>
#include <limits>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/files/text.hpp"

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

void count(Bins& bins, const std::vector<io::PictureToScore>& pictures) {
  for (const io::PictureToScore& picture : pictures) {
    if (picture.gates.empty()) continue;
    const double distance = distance_from_area(io::polygon_area(picture.gates.front()));
    const io::Score score = io::score({&picture, 1}, io::Rule::kOverlap70Authors);
    for (Bin& bin : bins)
      if (distance >= bin.from && distance < bin.to) ++bin.gates, bin.hits += score.hits;
  }
}

io::Canvas plotted(const Bins& bins) {
  io::PlotSeries paper{.name = "authors' stored run",
                       .points = {},
                       .color = io::look::kGate,
                       .line = true,
                       .rings = true};
  io::PlotSeries ours{.name = "ours", .points = {}, .color = io::look::kDetection};
  for (const Bin& bin : bins) {
    const double middle = 0.5 * (std::max(bin.from, 1.0) + bin.to);
    paper.points.emplace_back(middle, bin.paper_tpr);
    ours.points.emplace_back(middle, bin.tpr());
  }
  return io::draw({.title = "True positive rate by distance (σ_L 25 px, σ_cf 0.7)",
                   .x_label = "distance to the gate [m]",
                   .y_label = "true positive rate",
                   .series = {paper, ours}});
}

}  // namespace

Result tpr_distance(const Options& options) {
  const LabelledSet set(data_folder("tudelft_bebop_gates", options) / "basement580");
  Bins bins{{{"below 2 m", 0, 2, .70, 57},
             {"2-3 m", 2, 3, .57, 74},
             {"3-4 m", 3, 4, .29, 48},
             {"4-5 m", 4, 5, .10, 20},
             {"5-6 m", 5, 6, .0, 12}}};
  const int repeats = options.quick ? 2 : 10;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    if (options.stopped()) throw Stopped{};
    options.progress(static_cast<double>(repeat) / repeats, "run " + std::to_string(repeat + 1));
    count(bins, run_paper(set, {}, repeat));
  }

  Result result{.table = {},
                .json = {},
                .csv = "from_m,to_m,gates,tpr,paper_gates,paper_tpr\n",
                .picture = plotted(bins)};
  auto list = nlohmann::ordered_json::array();
  for (const Bin& bin : bins) {
    const int gates = bin.gates / repeats;
    result.table.push_back({bin.name,
                            fixed(bin.paper_tpr, 2) + " of " + std::to_string(bin.paper_gates),
                            fixed(bin.tpr(), 2) + " of " + std::to_string(gates)});
    result.csv += io::text_of(bin.from) + "," + io::text_of(bin.to) + "," + std::to_string(gates) +
                  "," + (bin.gates > 0 ? io::text_of(bin.tpr(), 6) : "") + "," +
                  std::to_string(bin.paper_gates) + "," + io::text_of(bin.paper_tpr) + "\n";
    list.push_back({{"from_m", bin.from},
                    {"to_m", bin.to},
                    {"gates", gates},
                    {"hits", bin.hits},
                    {"paper", {{"gates", bin.paper_gates}, {"tpr", bin.paper_tpr}}}});
  }
  result.json = {{"rule", "overlap70-authors"},
                 {"sigma_l_px", PaperDetectorParams{}.min_side_px},
                 {"sigma_cf", PaperDetectorParams{}.min_color_fitness},
                 {"repeats", repeats},
                 {"bins", list}};
  return result;
}

}  // namespace gatefly::experiments
