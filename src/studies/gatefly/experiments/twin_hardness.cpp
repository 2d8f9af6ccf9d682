// SPDX-License-Identifier: Apache-2.0
// Are rendered pictures as hard as real ones? The same detectors on both, through the same
// recording, by apparent size.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/gate_appearance.hpp"
#include "gatefly/experiments/twin_rates.hpp"
#include "gatefly/experiments/twin_sheet.hpp"
#include "gatefly/files/quantile.hpp"

namespace gatefly::experiments {
namespace {

constexpr std::uint64_t kHardReported = 3501, kHardLookedAt = 1001;  // first seeds: in full, quick
constexpr int kEnough = 20;           // real gates that make a bin count
constexpr int kRealRepeats = 4;       // of the paper's detectors on the few real pictures
constexpr double kRayleigh = 1.1774;  // median of a distance / σ of a coordinate

using Pictures = std::vector<TwinPicture>;
using Outcomes = std::vector<TwinOutcome>;

/// A room through the Bebop's calibrated lens (cameras/bebop-brown.toml, within 0.8 px, but it does
/// not fold back at the corners); nobody had put orange boxes into the real ones.
std::vector<std::string> as_real(std::vector<std::string> settings = {}) {
  settings.insert(
      settings.end(),
      {"camera.model=\"kannala-brandt\"", "camera.focal_px=[169.229,169.453]",
       "camera.center_px=[149.328,124.1]", "camera.distortion=[-0.016054,-0.026981,0.0,0.0]",
       "randomize.decoys=0", "randomize.saturation_percent=8", "randomize.hue_deg=3"});
  return settings;
}

/// Rooms whose pictures were kept alike.
struct Group {
  std::string name;
  std::vector<TwinRoom> rooms;
};

std::vector<Group> groups() {
  return {{"basement580",
           {{.set = "basement580",
             .config = "basement",
             .track = "showroom",
             .recording = files::Recording::kMjpegLow,
             .shake_deg = 4.0,
             .settings = as_real({"sim.saturation=1.15"})}}},
          {"basement32_hq and cyberzoo",
           {{.set = "basement32_hq",
             .config = "basement",
             .track = "showroom",
             .recording = files::Recording::kJpeg,
             .shake_deg = 4.0,
             .settings = as_real({"sim.saturation=1.55"})},
            {.set = "cyberzoo",
             .config = "cyberzoo",
             .track = "darkhall",
             .recording = files::Recording::kJpeg,
             .shake_deg = 20.0,
             .settings = as_real(
                 {"faults.hue_deg=10", "sim.saturation=1.9", "randomize.light_percent=20"})}}}};
}

TwinOrder order_of(const Group& group, const Options& options) {
  const std::uint64_t first = first_seed(options, kHardReported, kHardLookedAt);
  if (options.quick) return {.first_seed = first, .seeds = 30, .per_seed = 20};
  return {.first_seed = first, .seeds = 100, .per_seed = group.rooms.size() > 1 ? 20u : 30u};
}

/// Both sides of a room.
struct Sides {
  const TwinRoom* room;
  Pictures real, rendered;
};

/// One detector on both sides of a group.
struct Compared {
  std::string group;
  TwinMode mode{};
  TwinRates real, rendered;
  std::vector<double> real_errors, rendered_errors;  ///< Errors of corners, sorted [px].
};

void take_errors(const Outcomes& outcomes, std::vector<double>& errors) {
  for (const TwinOutcome& outcome : outcomes)
    errors.insert(errors.end(), outcome.corner_errors.begin(), outcome.corner_errors.end());
}

Compared compared(const Group& group, const std::vector<Sides>& rooms, TwinMode mode) {
  Compared c{.group = group.name,
             .mode = mode,
             .real = {},
             .rendered = {},
             .real_errors = {},
             .rendered_errors = {}};
  std::vector<TwinRates> real, rendered;
  for (const Sides& sides : rooms) {
    const Outcomes of_real = outcomes(sides.real, mode, sides.room->config, kRealRepeats);
    const Outcomes of_rendered = outcomes(sides.rendered, mode, sides.room->config, 1);
    real.push_back(rates(sides.real, of_real));
    rendered.push_back(rates(sides.rendered, of_rendered));
    take_errors(of_real, c.real_errors), take_errors(of_rendered, c.rendered_errors);
  }
  c.real = pooled(real), c.rendered = weighted(rendered, real);
  std::sort(c.real_errors.begin(), c.real_errors.end());
  std::sort(c.rendered_errors.begin(), c.rendered_errors.end());
  return c;
}

bool inside(const TwinRate& real, double rendered) {
  return rendered >= real.low - 1e-9 && rendered <= real.high + 1e-9;
}

std::string bin_name(std::size_t i) {
  return i == 0 ? "below " + fixed(kTwinBins[1], 0) + " m"
                : fixed(kTwinBins[i], 0) + "-" + fixed(kTwinBins[i + 1], 0) + " m";
}

std::string with_interval(const TwinRate& rate, int digits) {
  return fixed(rate.mean, digits) + " [" + fixed(rate.low, digits) + ", " +
         fixed(rate.high, digits) + "] of " + std::to_string(rate.count);
}

/// Mean size of the difference over the bins that count, weighted by real gates.
double pooled_deviation(const Compared& c) {
  double sum = 0.0, gates = 0.0;
  for (std::size_t i = 0; i < kTwinBinCount; ++i) {
    const TwinRate &real = c.real.bins[i], &rendered = c.rendered.bins[i];
    if (real.count < kEnough) continue;
    sum += real.count * std::abs(rendered.mean - real.mean), gates += real.count;
  }
  return gates > 0.0 ? sum / gates : std::nan("");
}

nlohmann::ordered_json json_of(const TwinRate& real, const TwinRate& rendered) {
  return {{"real",
           {{"count", real.count},
            {"mean", number(real.mean)},
            {"low", number(real.low)},
            {"high", number(real.high)}}},
          {"rendered", {{"count", rendered.count}, {"mean", number(rendered.mean)}}},
          {"inside", inside(real, rendered.mean)}};
}

nlohmann::ordered_json errors_json(const std::vector<double>& errors) {
  return {{"robust_sigma_px", number(files::quantile(errors, 0.5) / kRayleigh)},
          {"p95_px", number(files::quantile(errors, 0.95))}};
}

std::string errors_text(const std::vector<double>& errors) {
  return "σ " + fixed(files::quantile(errors, 0.5) / kRayleigh, 1) + " px, p95 " +
         fixed(files::quantile(errors, 0.95), 1) + " px";
}

void report(const Compared& c, Result& result) {
  const std::string head = c.group + ", " + name_of(c.mode);
  auto bins = nlohmann::ordered_json::array();
  const auto row = [&](const std::string& what, const TwinRate& real, const TwinRate& rendered,
                       int digits, bool counts) {
    result.table.push_back({what, with_interval(real, digits),
                            fixed(rendered.mean, digits) + " of " + std::to_string(rendered.count) +
                                (!counts                       ? ", too few real ones"
                                 : inside(real, rendered.mean) ? ", inside"
                                                               : ", outside")});
    result.csv += c.group + "," + name_of(c.mode) + "," + what.substr(2) + "," +
                  std::to_string(real.count) + "," + files::text_of(real.mean, 5) + "," +
                  files::text_of(real.low, 5) + "," + files::text_of(real.high, 5) + "," +
                  std::to_string(rendered.count) + "," + files::text_of(rendered.mean, 5) + "\n";
  };
  result.table.push_back(
      {head + ": hits", "", "pooled deviation " + fixed(pooled_deviation(c), 3)});
  for (std::size_t i = 0; i < kTwinBinCount; ++i) {
    row("  " + bin_name(i), c.real.bins[i], c.rendered.bins[i], 2, c.real.bins[i].count >= kEnough);
    bins.push_back({{"from_m", kTwinBins[i]}, {"to_m", kTwinBins[i + 1]}});
    bins.back().update(json_of(c.real.bins[i], c.rendered.bins[i]));
  }
  row("  false ones a picture with a gate", c.real.false_positives_with_gate,
      c.rendered.false_positives_with_gate, 3, true);
  row("  false ones a picture without", c.real.false_positives_without,
      c.rendered.false_positives_without, 3, c.real.false_positives_without.count >= kEnough);
  result.table.push_back({"  corners", errors_text(c.real_errors), errors_text(c.rendered_errors)});
  result.json["compared"].push_back(
      {{"group", c.group},
       {"mode", name_of(c.mode)},
       {"pooled_deviation", number(pooled_deviation(c))},
       {"bins", bins},
       {"false_positives_with_gate",
        json_of(c.real.false_positives_with_gate, c.rendered.false_positives_with_gate)},
       {"false_positives_without",
        json_of(c.real.false_positives_without, c.rendered.false_positives_without)},
       {"corners",
        {{"real", errors_json(c.real_errors)}, {"rendered", errors_json(c.rendered_errors)}}}});
}

drawing::Plot plot_of(const Compared& c) {
  drawing::PlotSeries real{
      .name = "real", .points = {}, .color = drawing::kLight.ink, .line = false, .rings = true},
      low{.points = {}, .color = drawing::kLight.muted, .marks = false, .dash = 4.0},
      high = low, rendered{.name = "rendered", .points = {}, .color = drawing::kLight.found};
  high.name = "real, 95 %";
  for (std::size_t i = 0; i < kTwinBinCount; ++i) {
    const double x = 0.5 * (std::max(kTwinBins[i], 1.0) + kTwinBins[i + 1]);
    if (c.rendered.bins[i].count > 0) rendered.points.emplace_back(x, c.rendered.bins[i].mean);
    if (c.real.bins[i].count == 0) continue;
    real.points.emplace_back(x, c.real.bins[i].mean);
    low.points.emplace_back(x, c.real.bins[i].low),
        high.points.emplace_back(x, c.real.bins[i].high);
  }
  return {.title = c.group + ", " + name_of(c.mode),
          .x_label = "distance by apparent size [m]",
          .y_label = "true positive rate",
          .series = {high, low, real, rendered}};
}

/// Medians of what gates look like on both sides.
void report_looks(const Sides& sides, Result& result) {
  std::array<std::vector<GateAppearance>, 2> looks;
  for (const bool of_rendered : {false, true}) {
    const Pictures& pictures = of_rendered ? sides.rendered : sides.real;
    std::vector<GateAppearance> all(pictures.size());
    in_parallel(pictures.size(), [&](std::size_t i) {
      if (pictures[i].gate && bin_of(*pictures[i].gate) >= 0) all[i] = appearance_of(pictures[i]);
    });
    for (const GateAppearance& a : all)
      if (a.side_px > 0.0) looks[of_rendered ? 1 : 0].push_back(a);
  }
  auto json = nlohmann::ordered_json::object();
  result.table.push_back({sides.room->set + ": looks, quartiles", "", ""});
  for (const Feature& feature : features()) {
    std::array<std::string, 2> text;
    for (const std::size_t side : {0u, 1u}) {
      std::vector<double> values;
      for (const GateAppearance& a : looks[side])
        if (std::isfinite(a.*feature.value)) values.push_back(a.*feature.value);
      std::sort(values.begin(), values.end());
      for (const double part : {0.25, 0.5, 0.75}) {
        const double q = files::quantile(values, part);
        text[side] += (text[side].empty() ? "" : ", ") + fixed(q, std::abs(q) < 5.0 ? 2 : 0);
        json[feature.key][side == 0 ? "real" : "rendered"].push_back(number(q));
      }
    }
    result.table.push_back({std::string{"  "} + feature.name, text[0], text[1]});
  }
  result.json["looks"][sides.room->set] = json;
}

/// One effect taken away, the rest as it is.
struct Effect {
  const char* name;
  std::vector<std::string> settings;
  double shake = 1.0;        ///< Times the room's.
  bool kept_better = false;  ///< Through the careful recording.
};

std::vector<Effect> effects() {
  return {{"everything", {}},
          {"soft luma: 1.6 px a pixel", {"sim.pixel_footprint_px=1.6"}},
          {"no red fringes", {"sim.red_shift_px=0"}},
          {"colours not smoothed", {"sim.chroma_smoothing=0"}},
          {"the same saturation with every seed", {"randomize.saturation_percent=0"}},
          {"bars as wide as the map's", {"sim.paint_width=1"}},
          {"paint not worn", {"sim.paint_wear=0"}},
          {"the same light with every seed",
           {"randomize.light_percent=0", "randomize.exposure_percent=0"}},
          {"camera held straight", {}, 0.0},
          {"careful recording", {}, 1.0, true}};
}

/// Tells each effect's share in the hits below 4 m.
void report_effects(const TwinRoom& room, const Options& options, Result& result) {
  std::array<double, kTwinModes.size()> whole{};
  result.table.push_back(
      {room.set + " rendered, hits below 4 m, one effect taken away", "", "paper, flown, ours"});
  for (const Effect& effect : effects()) {
    if (options.stopped()) throw Stopped{};
    TwinRoom without = room;
    without.settings.insert(without.settings.end(), effect.settings.begin(), effect.settings.end());
    without.shake_deg *= effect.shake;
    if (effect.kept_better) without.recording = files::Recording::kJpeg;
    const Pictures pictures = rendered_pictures(
        without, {.first_seed = kHardLookedAt, .seeds = 30, .per_seed = 20}, options);
    std::string text;
    auto json = nlohmann::ordered_json::object();
    for (std::size_t m = 0; m < kTwinModes.size(); ++m) {
      const TwinRates r = rates(pictures, outcomes(pictures, kTwinModes[m], room.config, 1));
      double hits = 0.0;
      int gates = 0;
      for (const std::size_t i : {0u, 1u, 2u})
        hits += r.bins[i].mean * r.bins[i].count, gates += r.bins[i].count;
      const double rate = gates > 0 ? hits / gates : std::nan("");
      if (effect.settings.empty() && effect.shake > 0.0 && !effect.kept_better) whole[m] = rate;
      text += (m > 0 ? ", " : "") + fixed(rate, 2);
      json[name_of(kTwinModes[m])] = number(rate);
    }
    result.table.push_back({std::string{"  "} + effect.name, "", text});
    result.json["effects"].push_back({{"without", effect.name}, {"tpr", json}});
  }
}

/// How differently the seeds go: spread of the rate between seeds with enough gates.
std::string spread_of_seeds(const Pictures& pictures, const Outcomes& outcomes) {
  std::map<std::uint64_t, std::pair<double, int>> seeds;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    if (pictures[i].gate && bin_of(*pictures[i].gate) >= 0 && bin_of(*pictures[i].gate) < 3)
      seeds[pictures[i].seed].first += outcomes[i].hit, ++seeds[pictures[i].seed].second;
  std::vector<double> rates;
  for (const auto& [seed, sum] : seeds)
    if (sum.second >= 4) rates.push_back(sum.first / sum.second);
  std::sort(rates.begin(), rates.end());
  return fixed(files::quantile(rates, 0.1), 2) + " to " + fixed(files::quantile(rates, 0.9), 2) +
         " in " + std::to_string(rates.size()) + " of them";
}

}  // namespace

Result twin_hardness(const Options& options) {
  Result result{
      .table = {{"", "real, 95 %", "rendered"}},
      .json = {{"rule", "overlap70; mode paper: overlap70-authors"}},
      .csv = "group,mode,what,real_count,real,real_low,real_high,rendered_count,rendered\n",
      .picture = drawing::Canvas(1, 1)};
  std::vector<drawing::Plot> plots;
  const std::vector<Group> all = groups();
  double done = 0.0;
  for (const Group& group : all) {
    std::vector<Sides> rooms;
    for (const TwinRoom& room : group.rooms) {
      options.progress(done, room.set + ": rendering");
      rooms.push_back({&room, real_pictures(room, options),
                       rendered_pictures(room, order_of(group, options), options)});
      done += 0.25;
    }
    for (const TwinMode mode : kTwinModes) {
      if (options.stopped()) throw Stopped{};
      options.progress(done, group.name + ", " + name_of(mode));
      const Compared c = compared(group, rooms, mode);
      report(c, result);
      plots.push_back(plot_of(c));
    }
    for (const Sides& sides : rooms) {
      const auto spread = [&](const Pictures& pictures) {
        return spread_of_seeds(pictures,
                               outcomes(pictures, TwinMode::kPaper, sides.room->config, 1));
      };
      result.table.push_back(
          {sides.room->set +
               ", paper, below 4 m: spread, 10 to 90 %, of 50 pictures in a row; of seeds",
           spread(sides.real), spread(sides.rendered)});
      report_looks(sides, result);
      result.extra.push_back({"sheet-" + sides.room->set, twin_sheet(sides.real, sides.rendered)});
    }
  }
  options.progress(0.8, "one effect at a time");
  if (!options.quick) report_effects(all.front().rooms.front(), options, result);
  result.picture = drawing::draw_sheet(plots, 3);
  return result;
}

}  // namespace gatefly::experiments
