// SPDX-License-Identifier: Apache-2.0
// How fast each course can be flown: wanted speed up, rung by rung, and how many races still finish. Beside Li18 §5 (1.5 to 1.8 m/s in the showroom).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/causes.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/simulated_laps.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::experiments {
namespace {

using simulated_race::RaceResult;

constexpr std::uint64_t kLadderReported = 5001,
                        kLadderLookedAt = 1101;      // first seeds: in full, quick
constexpr std::size_t kRaces = 40, kQuickRaces = 4;  // a rung
constexpr double kMostFinish = 0.95;  // part of the races that finish on a rung that counts

/// A course, who flies it, and the speeds that are asked for.
struct Ladder {
  std::string track;
  std::vector<std::string> configs;
  std::string lateral;        ///< v²/r that an arc may ask for [m/s²].
  std::vector<double> rungs;  ///< control.speed_mps [m/s].
  std::string paper;
};

std::vector<Ladder> ladders() {
  return {
      {"showroom", {}, "4.5", {1.7, 2.0, 2.3, 2.6, 3.0, 3.5}, "1.5 to 1.8 m/s"},
      {"aigp-pq", {"archer-b2", "imx477", "betaflight"}, "5", {1.7, 2.5, 3.2, 4.0, 5.0, 6.0}, ""},
      {"wide", {"racer", "grandprix"}, "7", {2.0, 4.0, 5.0, 6.0, 7.0, 8.0}, ""}};
}

struct Rung {
  double wanted = 0.0;
  std::vector<RaceResult> races;

  [[nodiscard]] std::size_t finished() const {
    return static_cast<std::size_t>(
        std::count_if(races.begin(), races.end(), [](const RaceResult& r) { return r.finished; }));
  }
  [[nodiscard]] double part() const {
    return static_cast<double>(finished()) / static_cast<double>(races.size());
  }
  /// Of the races that finished [m/s]; none: no number.
  [[nodiscard]] double mean_speed() const {
    double sum = 0.0;
    for (const RaceResult& r : races) sum += r.finished ? r.mean_speed : 0.0;
    return finished() > 0 ? sum / static_cast<double>(finished()) : std::nan("");
  }
};

RaceResult flown(const Ladder& ladder, double speed, std::uint64_t seed, const Options& options) {
  const auto race =
      race_on(ladder.track, 0, simulated_race::Vision::kIdeal, seed, false, ladder.configs,
              {"control.speed_mps=" + files::text_of(speed, 4),
               "control.max_lateral_mps2=" + ladder.lateral});
  return simulated_race::fly(race, [&](const flight_log::Tick&) { return !options.stopped(); });
}

/// The fastest of the rungs on which enough races finish; nullptr: none.
const Rung* top_of(const std::vector<Rung>& rungs) {
  const Rung* top = nullptr;
  for (const Rung& rung : rungs)
    if (rung.part() >= kMostFinish && (top == nullptr || rung.mean_speed() > top->mean_speed()))
      top = &rung;
  return top;
}

drawing::Canvas picture_of(const std::vector<Ladder>& who,
                           const std::vector<std::vector<Rung>>& all) {
  constexpr std::array kColors{drawing::kLight.found, drawing::kLight.gate_solid,
                               drawing::kLight.estimate};
  drawing::Plot speeds{.title = "mean speed of the races that finish",
                       .x_label = "wanted [m/s]",
                       .y_label = "flown [m/s]"},
      parts{.title = "races that finish", .x_label = "wanted [m/s]", .y_label = "part"};
  for (std::size_t i = 0; i < who.size(); ++i) {
    drawing::PlotSeries speed{.name = who[i].track, .color = kColors[i]}, part = speed;
    for (const Rung& rung : all[i]) {
      if (rung.finished() > 0) speed.points.emplace_back(rung.wanted, rung.mean_speed());
      part.points.emplace_back(rung.wanted, rung.part());
    }
    speeds.series.push_back(speed), parts.series.push_back(part);
  }
  return drawing::draw_sheet(std::array{speeds, parts}, 2);
}

}  // namespace

Result speed_ladder(const Options& options) {
  const std::vector<Ladder> who = ladders();
  const std::size_t count = options.quick ? kQuickRaces : kRaces;
  struct Job {
    std::size_t ladder, rung, race;
  };
  std::vector<std::vector<Rung>> all(who.size());
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < who.size(); ++i)
    for (std::size_t k = 0; k < who[i].rungs.size(); ++k) {
      all[i].push_back({.wanted = who[i].rungs[k], .races = std::vector<RaceResult>(count)});
      for (std::size_t n = 0; n < count; ++n) jobs.push_back({i, k, n});
    }
  const std::uint64_t first = first_seed(options, kLadderReported, kLadderLookedAt);
  in_pieces(jobs.size(), options, [&](std::size_t j) {
    const Job& job = jobs[j];
    Rung& rung = all[job.ladder][job.rung];
    rung.races[job.race] = flown(who[job.ladder], rung.wanted, first + job.race, options);
  });

  Result result{.table = {},
                .json = nlohmann::ordered_json::object(),
                .csv = "track,wanted_mps,seed,finished,gates,cause,time_s,mean_speed_mps\n",
                .picture = picture_of(who, all)};
  for (std::size_t i = 0; i < who.size(); ++i) {
    auto list = nlohmann::ordered_json::array();
    for (const Rung& rung : all[i]) {
      const std::string causes = causes_of(rung.races);
      result.table.push_back({who[i].track + ", " + fixed(rung.wanted, 1) + " m/s wanted", "",
                              fixed(rung.mean_speed(), 2) + " m/s, " +
                                  std::to_string(rung.finished()) + " of " + std::to_string(count) +
                                  (causes.empty() ? "" : "; " + causes)});
      list.push_back({{"wanted_mps", rung.wanted},
                      {"races", count},
                      {"finished", rung.finished()},
                      {"mean_speed_mps", number(rung.mean_speed())}});
      for (std::size_t n = 0; n < count; ++n) {
        const RaceResult& r = rung.races[n];
        result.csv += who[i].track + "," + files::text_of(rung.wanted, 4) + "," +
                      std::to_string(first + n) + "," + (r.finished ? "1" : "0") + "," +
                      std::to_string(r.gates_passed) + "," + cause_of(r) + "," +
                      files::text_of(r.race_time, 4) + "," + files::text_of(r.mean_speed, 4) + "\n";
      }
    }
    const Rung* top = top_of(all[i]);
    result.table.push_back({"  " + who[i].track + ": fastest with 95 % finishing", who[i].paper,
                            top != nullptr ? fixed(top->mean_speed(), 2) + " m/s" : "none"});
    result.json[who[i].track] = {
        {"rungs", list},
        {"top_mean_speed_mps", number(top != nullptr ? top->mean_speed() : std::nan(""))}};
  }
  return result;
}

}  // namespace gatefly::experiments
