// SPDX-License-Identifier: Apache-2.0
// The whole original beside the whole of ours on the same seeds, and which box makes the
// difference: one at a time is swapped. Nothing in Li18 to compare with but its own three flights.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/experiments/causes.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/experiments/simulated_laps.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"
#include "gatefly/simulated_race/results/campaign_statistics.hpp"

namespace gatefly::experiments {
namespace {

using simulated_race::RaceResult;
using simulated_race::Vision;

constexpr std::uint64_t kComparedReported = 2801,
                        kComparedLookedAt = 1801;  // first seeds: in full, quick
constexpr std::size_t kIdeal = 40, kRendered = 10, kQuickIdeal = 4;
// A section of configs/li18.toml each.
const std::array<std::string, 4> kBoxes{"detector", "pose", "filter", "control"};

/// Which boxes are the paper's; the others are ours.
struct Mixture {
  std::string name;
  std::array<bool, 4> paper{};
};

std::vector<Mixture> mixtures() {
  std::vector<Mixture> list{{"all ours", {}}};
  for (std::size_t i = 0; i < kBoxes.size(); ++i) {
    Mixture one{"ours, the paper's " + kBoxes[i], {}};
    one.paper[i] = true;
    list.push_back(one);
  }
  for (std::size_t i = 0; i < kBoxes.size(); ++i) {
    Mixture one{"paper, our " + kBoxes[i], {true, true, true, true}};
    one.paper[i] = false;
    list.push_back(one);
  }
  list.push_back({"all the paper's (li18)", {true, true, true, true}});
  return list;
}

/// The keys of those sections of configs/li18.toml, as --set has them. Without pictures the
/// detector's box is its statistics.
std::vector<std::string> settings_of(const Mixture& mixture, Vision vision) {
  const files::TomlFile file(config::config_files(std::vector<std::string>{"li18"}).back());
  const nlohmann::json& li18 = file.content();
  std::vector<std::string> settings;
  for (std::size_t i = 0; i < kBoxes.size(); ++i) {
    if (!mixture.paper[i]) continue;
    if (kBoxes[i] == "detector" && vision == Vision::kIdeal) {
      settings.emplace_back("sim.ideal_detector=\"paper\"");
      continue;
    }
    for (const auto& [key, value] : li18.at(kBoxes[i]).items())
      settings.push_back(kBoxes[i] + "." + key + "=" + value.dump());
  }
  return settings;
}

/// One mixture's outcome on all seeds.
struct Campaign {
  std::vector<RaceResult> races;

  [[nodiscard]] int finished() const {
    return static_cast<int>(
        std::count_if(races.begin(), races.end(), [](const auto& r) { return r.finished; }));
  }
  [[nodiscard]] double gates() const {
    double sum = 0.0;
    for (const RaceResult& r : races) sum += r.gates_passed;
    return sum / static_cast<double>(races.size());
  }
  /// Median over those that came past the first gate.
  template <class Value>
  [[nodiscard]] double median(const Value& value) const {
    std::vector<double> values;
    for (const RaceResult& r : races)
      if (r.gates_passed > 1) values.push_back(value(r));
    return values.empty() ? std::nan("") : files::nearest_rank(values, 0.5);
  }
  [[nodiscard]] double speed() const {
    return median([](const RaceResult& r) { return r.mean_speed; });
  }
  [[nodiscard]] double error() const {
    return median([](const RaceResult& r) { return r.estimation_rmse.head<2>().norm(); });
  }
  [[nodiscard]] std::string causes() const { return causes_of(races); }
};

Campaign campaign_of(const Mixture& mixture, Vision vision, std::size_t seeds,
                     const Options& options) {
  Campaign campaign;
  campaign.races.resize(seeds);
  const auto settings = settings_of(mixture, vision);
  in_pieces(seeds, options, [&](std::size_t i) {
    auto race =
        race_on("showroom-li18", 0, vision,
                first_seed(options, kComparedReported, kComparedLookedAt) + i, false, {}, settings);
    race.while_baking = [&options] {
      if (options.stopped()) throw Stopped{};
    };
    campaign.races[i] =
        simulated_race::fly(race, [&](const flight_log::Tick&) { return !options.stopped(); });
  });
  return campaign;
}

struct Row {
  Mixture mixture;
  std::string vision;
  Campaign campaign;
};

/// One line a mixture: part finished with its 95 % interval, gates, speed, error, causes.
drawing::Canvas picture_of(const std::vector<Row>& rows) {
  constexpr int kWidth = drawing::kPlotWidth, kLine = 32, kTop = 112;
  constexpr double kBar = 250.0, kBarWidth = 220.0, kColumns = 490.0;
  drawing::Canvas canvas(kWidth, kTop + kLine * (static_cast<int>(rows.size()) + 3));
  canvas.text({24, 40}, "Paper and ours on the same seeds: showroom, 15 gates, level race",
              {.size = 22, .bold = true});
  const drawing::Lettering head{.color = drawing::kLight.muted, .size = 14};
  canvas.text({kBar, 84}, "races finished, 95 % interval", head);
  const std::array<std::pair<double, const char*>, 5> titles{{{kColumns, "finished"},
                                                              {kColumns + 85, "gates"},
                                                              {kColumns + 140, "m/s"},
                                                              {kColumns + 190, "error [m]"},
                                                              {kColumns + 270, "the others"}}};
  for (const auto& [x, title] : titles) canvas.text({x, 84}, title, head);
  double y = kTop;
  std::string vision;
  for (const Row& row : rows) {
    if (row.vision != vision) {
      vision = row.vision;
      canvas.text({24, y + 8}, vision, {.color = drawing::kLight.ink, .size = 16, .bold = true});
      y += kLine;
    }
    const Campaign& c = row.campaign;
    const int n = static_cast<int>(c.races.size());
    const double part = static_cast<double>(c.finished()) / n;
    const auto interval = simulated_race::wilson95(c.finished(), n);
    const bool pure = row.mixture.name.rfind("all", 0) == 0;
    const drawing::Color color =
        row.mixture.paper[3] ? drawing::kLight.gate_solid : drawing::kLight.found;
    canvas.text({24, y + 8}, row.mixture.name, {.size = 15, .bold = pure});
    canvas.fill({kBar, y - 6, kBarWidth, 16}, drawing::kLight.well, 3);
    canvas.fill({kBar, y - 6, std::max(1.0, kBarWidth * part), 16}, color.faded(pure ? 1.0 : 0.6),
                3);
    canvas.line({kBar + kBarWidth * interval.low, y + 2}, {kBar + kBarWidth * interval.high, y + 2},
                {.color = drawing::kLight.ink, .width = 2});
    const drawing::Lettering small{.size = 14};
    canvas.text({kColumns, y + 8}, std::to_string(c.finished()) + " of " + std::to_string(n),
                small);
    canvas.text({kColumns + 85, y + 8}, fixed(c.gates(), 1), small);
    canvas.text({kColumns + 140, y + 8}, fixed(c.speed(), 2), small);
    canvas.text({kColumns + 190, y + 8}, fixed(c.error(), 2), small);
    drawing::Lettering causes{.color = drawing::kLight.muted, .size = 14};
    const double wide = canvas.text_width(c.causes(), causes), most = kWidth - kColumns - 290;
    if (wide > most) causes.size *= most / wide;
    canvas.text({kColumns + 270, y + 8}, c.causes(), causes);
    y += kLine;
  }
  return canvas;
}

}  // namespace

Result paper_vs_ours(const Options& options) {
  std::vector<Row> rows;
  const auto all = mixtures();
  for (std::size_t i = 0; i < all.size(); ++i) {
    options.progress(0.3 * static_cast<double>(i) / static_cast<double>(all.size()), all[i].name);
    rows.push_back(
        {all[i], "ideal vision",
         campaign_of(all[i], Vision::kIdeal, options.quick ? kQuickIdeal : kIdeal, options)});
  }
  if (!options.quick)
    for (const Mixture& mixture : {all.front(), all[1], all[5], all.back()}) {
      options.progress(0.3 + 0.7 * 0.25 * static_cast<double>(rows.size() - all.size()),
                       mixture.name);
      rows.push_back({mixture, "rendered pictures",
                      campaign_of(mixture, Vision::kRendered, kRendered, options)});
    }

  Result result{.table = {},
                .json = nlohmann::ordered_json::array(),
                .csv = "vision,who,seed,finished,gates,cause,mean_speed_mps,rmse_x_m,rmse_y_m\n",
                .picture = picture_of(rows)};
  auto list = nlohmann::ordered_json::array();
  for (const Row& row : rows) {
    const Campaign& c = row.campaign;
    const int n = static_cast<int>(c.races.size());
    const auto interval = simulated_race::wilson95(c.finished(), n);
    result.table.push_back({row.vision + ": " + row.mixture.name, "",
                            std::to_string(c.finished()) + " of " + std::to_string(n) + " (" +
                                fixed(interval.low, 2) + "-" + fixed(interval.high, 2) + "), " +
                                fixed(c.gates(), 1) + " gates, " + fixed(c.speed(), 2) +
                                " m/s, error " + fixed(c.error(), 2) + " m" +
                                (c.causes().empty() ? "" : "; " + c.causes())});
    for (std::size_t i = 0; i < c.races.size(); ++i) {
      const RaceResult& r = c.races[i];
      result.csv += row.vision + "," + "\"" + row.mixture.name + "\"," +
                    std::to_string(first_seed(options, kComparedReported, kComparedLookedAt) + i) +
                    "," + (r.finished ? "1" : "0") + "," + std::to_string(r.gates_passed) + "," +
                    cause_of(r);
      for (const double v : {r.mean_speed, r.estimation_rmse.x(), r.estimation_rmse.y()})
        result.csv += "," + files::text_of(v, 4);
      result.csv += "\n";
    }
    list.push_back({{"vision", row.vision},
                    {"who", row.mixture.name},
                    {"races", n},
                    {"finished", c.finished()},
                    {"finished_95", {number(interval.low), number(interval.high)}},
                    {"gates", number(c.gates())},
                    {"mean_speed_mps", number(c.speed())},
                    {"error_m", number(c.error())},
                    {"causes", c.causes()}});
  }
  result.json = {{"track", "showroom-li18"},
                 {"first_seed", first_seed(options, kComparedReported, kComparedLookedAt)},
                 {"campaigns", list}};
  return result;
}

}  // namespace gatefly::experiments
