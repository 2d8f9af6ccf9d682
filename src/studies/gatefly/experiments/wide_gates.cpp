// SPDX-License-Identifier: Apache-2.0
// Gates of wide boards through a camera that is tilted up: what the pilot's look finds of them, by how
// many of their corners are in the picture and by how many sides they are away.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/wide_gate_looks.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/race/part_params.hpp"
#include "gatefly/race/seen_fix.hpp"
#include "gatefly/simulated_race/labelled_pictures.hpp"

namespace gatefly::experiments {
namespace {

/// Seeds and pictures. The full run's seeds are for reports: nothing was ever tuned on them.
struct WideOrder {
  std::uint64_t first_seed;
  std::size_t seeds, per_seed;
};
constexpr WideOrder kWideFull{4441, 3, 240}, kWideQuick{1441, 1, 12};
constexpr double kCutFrom = 1.5, kCutTo = 6.0;         // of gates that the border cuts [m]
constexpr std::array kSides{0.0, 1.0, 2.0, 3.0, 1e9};  // distances, in sides of the gate

/// As the pilot looks: whole gates and, near its target, a part of one.
std::vector<FoundCorners> found_in(const Image& image, const LookoutParams& params,
                                   GateDetector& detector) {
  std::vector<FoundCorners> found;
  const auto add = [&](const GateDetection& gate) {
    FoundCorners& one = found.emplace_back(FoundCorners{.corners_px = gate.corners_px});
    for (std::size_t i = 0; i < 4; ++i) one.reported[i] = gate.corner_fitness[i] > 0.0;
    if (one.count() < 2) found.pop_back();
  };
  for (const GateDetection& gate :
       detector.look(image, params.gate_color, {.gates = LookFor::Gates::kAll}).gates)
    add(gate);
  const GatesInView near = detector.look(
      image, params.gate_color, {.gates = LookFor::Gates::kNone, .part = LookFor::Part::kToo});
  if (near.part) add(near.part->gate);
  return found;
}

WideLooks looks_of(const simulated_race::RaceMaker& maker,
                   const simulated_race::PictureOrder& order, std::size_t seed,
                   const Options& options) {
  const simulated_race::Race race = maker.race(order.first_seed + seed);
  const world::CameraTruth& camera = race.config.sim.camera;
  const LookoutParams params = lookout_params(race.config.pilot);
  GateDetector detector{params.detector, params.detector_mode};
  WideLooks looks;
  const auto stop = [&options] {
    if (options.stopped()) throw Stopped{};
  };
  const auto take = [&](simulated_race::Picture&& picture) {
    const Image image{picture.uyvy.data(), PixelFormat::kUyvy, camera.stored_width,
                      camera.stored_height, camera.stored_rotation};
    looks.add(picture, race.config.sim.world, found_in(image, params, detector));
    return true;
  };
  simulated_race::render_seed(maker, order, seed, take, stop);
  return looks;
}

/// Part of the looks that found their gate.
struct Share {
  int looks = 0, found = 0;
  [[nodiscard]] double rate() const {
    return looks > 0 ? static_cast<double>(found) / looks : std::nan("");
  }
  [[nodiscard]] std::string text() const {
    return std::to_string(found) + " of " + std::to_string(looks) +
           (looks > 0 ? " (" + fixed(rate(), 2) + ")" : "");
  }
};
template <class Which>
Share share_of(const std::vector<WideLook>& looks, Which which) {
  Share share;
  for (const WideLook& look : looks)
    if (which(look)) ++share.looks, share.found += look.found;
  return share;
}

std::string distance_name(std::size_t bin) {
  return kSides[bin + 1] > 1e6 ? fixed(kSides[bin], 0) + " sides and more"
                               : fixed(kSides[bin], 0) + "-" + fixed(kSides[bin + 1], 0) + " sides";
}

bool is_cut_near(const WideLook& look) {
  return (look.outer == 2 || look.outer == 3) && look.distance >= kCutFrom &&
         look.distance <= kCutTo;
}

nlohmann::ordered_json json_of(const Share& share) {
  return {{"gates", share.looks}, {"found", share.found}, {"rate", number(share.rate())}};
}

void add_table(const WideLooks& all, Result& result) {
  const auto row = [&](const std::string& what, const char* key, const Share& share) {
    result.table.push_back({what, "-", share.text()});
    result.json[key] = json_of(share);
  };
  Share covered{};
  for (const WideLook& look : all.looks)
    if (look.outer == 4) ++covered.looks, covered.found += look.covered;
  row("four corners in view, 70 % covered", "four_corners", covered);
  row("  ... every corner within 5 % of the side", "four_corners_exact",
      share_of(all.looks, [](const WideLook& look) { return look.outer == 4; }));
  row("two or three corners, 1.5 to 6 m", "cut_near", share_of(all.looks, is_cut_near));
  auto list = nlohmann::ordered_json::array();
  for (int outer = 4; outer >= 0; --outer)
    for (int inner = 4; inner >= 0; --inner)
      for (std::size_t bin = 0; bin + 1 < kSides.size(); ++bin) {
        const Share share = share_of(all.looks, [&](const WideLook& look) {
          return look.outer == outer && look.inner == inner && look.sides >= kSides[bin] &&
                 look.sides < kSides[bin + 1];
        });
        if (share.looks == 0) continue;
        result.table.push_back({"  " + std::to_string(outer) + " outer, " + std::to_string(inner) +
                                    " inner, " + distance_name(bin),
                                "-", share.text()});
        auto entry = json_of(share);
        entry["outer"] = outer, entry["inner"] = inner, entry["from_sides"] = kSides[bin];
        list.push_back(entry);
      }
  result.json["by_corners"] = list;
}

void add_errors(const WideLooks& all, Result& result) {
  std::vector<double> whole, cut, scale;
  for (const WideLook& look : all.looks) {
    if (!look.found) continue;
    auto& errors = look.outer == 4 ? whole : cut;
    errors.insert(errors.end(), look.errors_px.begin(), look.errors_px.end());
    scale.push_back(std::abs(look.scale - 1.0));
  }
  const auto median = [&](const std::string& what, const char* key, std::vector<double>& values,
                          double factor, const char* unit) {
    std::sort(values.begin(), values.end());
    const double m = values.empty() ? std::nan("") : factor * files::quantile(values, 0.5);
    result.json[key] = number(m);
    if (!values.empty()) result.table.push_back({what, "-", fixed(m, 2) + unit});
  };
  median("corner error, four corners, median", "corner_error_px", whole, 1.0, " px");
  median("corner error, cut gates, median", "cut_corner_error_px", cut, 1.0, " px");
  median("error of the scale, median", "scale_error_percent", scale, 100.0, " %");
  const double wrong = static_cast<double>(all.wrong.size()) /
                       static_cast<double>(std::max<std::size_t>(1, all.pictures));
  result.table.push_back(
      {"detections that are no gate", "-",
       std::to_string(all.wrong.size()) + " in " + files::amount(all.pictures, "picture")});
  result.json["false"] = all.wrong.size(), result.json["false_per_image"] = wrong;
}

drawing::Canvas plot_of(const WideLooks& all) {
  constexpr std::array kColors{drawing::kLight.found, drawing::kLight.estimate,
                               drawing::kLight.flown};
  drawing::Plot plot{.title = "Wide gates found, by corners in view",
                     .x_label = "distance [sides of the gate]",
                     .y_label = "part of them that is found"};
  for (int outer = 4; outer >= 2; --outer) {
    drawing::PlotSeries series{.name = std::to_string(outer) + " corners",
                               .points = {},
                               .color = kColors[static_cast<std::size_t>(4 - outer)]};
    for (double from = 0.5; from < 6.0; from += 0.5) {
      const Share share = share_of(all.looks, [&](const WideLook& look) {
        return look.outer == outer && look.sides >= from && look.sides < from + 0.5;
      });
      if (share.looks > 0) series.points.emplace_back(from + 0.25, share.rate());
    }
    plot.series.push_back(series);
  }
  return drawing::draw(plot);
}

}  // namespace

Result wide_gates(const Options& options) {
  WideOrder wide = options.quick ? kWideQuick : kWideFull;
  wide.first_seed = first_seed(options, kWideFull.first_seed, kWideQuick.first_seed);
  const simulated_race::RaceMaker maker(
      {.config = {.configs = {"cameras/grandprix.toml"}, .settings = {}},
       .track = "grandprix",
       .vision = "rendered",
       .laps = 1});
  const simulated_race::PictureOrder order{.pictures = wide.seeds * wide.per_seed,
                                           .per_seed = wide.per_seed,
                                           .first_seed = wide.first_seed};
  std::vector<WideLooks> by_seed(wide.seeds);
  in_parallel(wide.seeds, [&](std::size_t i) {
    if (!options.stopped()) by_seed[i] = looks_of(maker, order, i, options);
  });
  if (options.stopped()) throw Stopped{};
  WideLooks all;
  for (const WideLooks& looks : by_seed) all.add(looks);
  Result result{.table = {},
                .json = {{"track", "grandprix"},
                         {"camera", "grandprix"},
                         {"first_seed", wide.first_seed},
                         {"pictures", all.pictures}},
                .csv = all.csv(),
                .picture = plot_of(all)};
  add_table(all, result);
  add_errors(all, result);
  return result;
}

}  // namespace gatefly::experiments
