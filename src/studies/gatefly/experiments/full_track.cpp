// SPDX-License-Identifier: Apache-2.0
// The showroom: three flights of 15 gates each at -5 and at -7 degrees, and ours beside them. Li18
// §5, Fig. "basement 3D".
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/causes.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/experiments/simulated_laps.hpp"
#include "gatefly/experiments/track_view.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

using simulated_race::RaceResult;
using simulated_race::Vision;

constexpr std::uint64_t kTrackReported = 2401,
                        kTrackLookedAt = 1401;       // first seeds: in full, quick
constexpr int kWanted = 3;                           // flights shown, as in the paper
constexpr std::size_t kTries = 24, kQuickTries = 4;  // seeds that are tried for them
constexpr double kPeriod = 0.05;                     // between samples of a flight [s]
// The stretch before G2, the longest straight: there the speed is nearest to a steady one.
constexpr int kLongestTo = 1;
constexpr double kLastMetres = 2.0;
constexpr int kFirstLapFrom = 1, kLastLapTo = 11;  // gates passed: two laps, without the start

/// Pilot of a comparison, and the paper's figures for it.
struct Contender {
  std::string name;
  std::vector<std::string> configs, settings;
  double pitch;  ///< θ_0 [rad]; 0: none.
  std::string paper_speed;
};

std::vector<Contender> contenders() {
  return {{"paper, -5°", {"li18"}, {"control.pitch_deg=-5"}, -5.0 * kDegree, "1.5 m/s"},
          {"paper, -7°", {"li18"}, {"control.pitch_deg=-7"}, -7.0 * kDegree, "1.8 m/s"},
          {"ours", {}, {}, 0.0, ""}};
}

/// A seed's flight.
struct Race {
  std::uint64_t seed = 0;
  RaceResult result;
  std::vector<double> t;                         ///< [s]
  std::vector<Eigen::Vector3d> truth, estimate;  ///< Earth frame [m].
  double lap_length = 0.0;      ///< Mean of the laps from gate 1 to gate 11 [m]; less was flown: 0.
  double straight_speed = 0.0;  ///< At the end of the longest straight [m/s].
};

Race flown(const Contender& who, std::uint64_t seed, const Options& options) {
  std::vector<std::string> settings = who.settings;
  settings.emplace_back("randomize.level=none");
  const auto race = race_on("showroom-li18", 0, Vision::kIdeal, seed, false, who.configs, settings);
  Race flight{.seed = seed, .result = {}, .t = {}, .truth = {}, .estimate = {}};
  double next = 0.0, sum = 0.0, way = 0.0;
  int count = 0;
  bool last_lap = false;
  flight.result = simulated_race::fly(race, [&](const flight_log::Tick& tick) {
    const double t = std::chrono::duration<double>(tick.sensors.time).count();
    if (t < next || tick.pilot.finished()) return !options.stopped();
    next = t + kPeriod;
    const int passed = tick.pilot.estimate().gates_passed;
    if (passed >= kFirstLapFrom && passed < kLastLapTo && !flight.truth.empty())
      way += (tick.truth.p_EB - flight.truth.back()).norm();
    last_lap = last_lap || passed >= kLastLapTo;
    flight.t.push_back(t);
    flight.truth.push_back(tick.truth.p_EB);
    flight.estimate.push_back(tick.pilot.estimate().p_EB);
    const double x = tick.pilot.estimate().p_GB.x();
    if (tick.pilot.target_gate() == kLongestTo && x < 0.0 && x > -kLastMetres)
      sum += tick.truth.v_E.head<2>().norm(), ++count;
    return true;
  });
  flight.straight_speed = count > 0 ? sum / count : std::nan("");
  if (last_lap) flight.lap_length = 0.5 * way;
  return flight;
}

/// Seeds in order until three flights have finished.
struct Seeds {
  std::vector<Race> all;
  [[nodiscard]] std::vector<const Race*> shown() const {
    std::vector<const Race*> good;
    for (const Race& flight : all)
      if (flight.result.finished && good.size() < kWanted) good.push_back(&flight);
    return good;
  }
  [[nodiscard]] std::vector<RaceResult> results() const {
    std::vector<RaceResult> list;
    for (const Race& flight : all) list.push_back(flight.result);
    return list;
  }
  [[nodiscard]] int finished() const {
    return static_cast<int>(
        std::count_if(all.begin(), all.end(), [](const Race& f) { return f.result.finished; }));
  }
};

template <class Value>
double mean_of(const std::vector<const Race*>& flights, const Value& value) {
  double sum = 0.0;
  for (const Race* flight : flights) sum += value(*flight);
  return flights.empty() ? std::nan("") : sum / static_cast<double>(flights.size());
}

std::string each_of(const std::vector<const Race*>& flights, int digits, const auto& value) {
  std::string text;
  for (const Race* flight : flights)
    text += (text.empty() ? "" : ", ") + fixed(value(*flight), digits);
  return text.empty() ? "none" : text;
}

constexpr std::array kColors{drawing::kLight.found, drawing::kLight.gate_solid,
                             drawing::kLight.estimate};

/// Height over time of the flights shown.
drawing::Plot height_plot(const std::string& name, const std::vector<const Race*>& flights) {
  drawing::Plot plot{
      .title = name + (flights.empty() ? ": no flight to show" : ": height (pale: estimated)"),
      .x_label = "t [s]",
      .y_label = "height [m]"};
  for (std::size_t i = 0; i < flights.size(); ++i) {
    drawing::PlotSeries truth{
        .name = "seed " + std::to_string(flights[i]->seed), .color = kColors[i], .marks = false},
        estimate{.color = kColors[i].faded(0.35), .marks = false};
    for (std::size_t k = 0; k < flights[i]->t.size(); k += 4) {
      truth.points.emplace_back(flights[i]->t[k], -flights[i]->truth[k].z());
      estimate.points.emplace_back(flights[i]->t[k], -flights[i]->estimate[k].z());
    }
    plot.series.push_back(estimate), plot.series.push_back(truth);
  }
  return plot;
}

drawing::Canvas picture_of(const std::vector<Contender>& who, const std::vector<Seeds>& seeds,
                           const Track& track) {
  constexpr int kView = 600;  // wide; the plot of heights beside it
  drawing::Canvas canvas(drawing::kPlotWidth, drawing::kRowHeight * static_cast<int>(who.size()));
  for (std::size_t i = 0; i < who.size(); ++i) {
    const double y = static_cast<double>(i) * drawing::kRowHeight;
    const auto shown = seeds[i].shown();
    std::vector<Trajectory> ways;
    for (std::size_t k = 0; k < shown.size(); ++k) ways.push_back({shown[k]->estimate, kColors[k]});
    canvas.text(
        {16, y + 31},
        who[i].name + ": as estimated, " + std::to_string(shown.size()) + " flights of 15 gates",
        {.size = 18, .bold = true});
    draw_track_3d(canvas, {16, y + 44, kView - 32.0, drawing::kRowHeight - 52.0}, track, ways);
    canvas.paste(drawing::draw(height_plot(who[i].name, shown), drawing::kPlotWidth - kView,
                               drawing::kRowHeight),
                 {kView, y});
  }
  return canvas;
}

}  // namespace

Result full_track(const Options& options) {
  const std::vector<Contender> who = contenders();
  std::vector<Seeds> seeds(who.size());
  const std::size_t tries = options.quick ? kQuickTries : kTries;
  for (auto& each : seeds) each.all.resize(tries);
  in_pieces(who.size() * tries, options, [&](std::size_t i) {
    seeds[i / tries].all[i % tries] = flown(
        who[i / tries], first_seed(options, kTrackReported, kTrackLookedAt) + i % tries, options);
  });
  const Track track = race_on("showroom-li18", 0, Vision::kIdeal, 1).pilot.track;

  Result result{.table = {},
                .json = nlohmann::ordered_json::object(),
                .csv =
                    "who,seed,finished,gates,cause,time_s,mean_speed_mps,straight_speed_mps,"
                    "lap_length_m,rmse_x_m,rmse_y_m,rmse_z_m\n",
                .picture = picture_of(who, seeds, track)};
  const auto speed = [](const Race& f) { return f.result.mean_speed; };
  const auto time = [](const Race& f) { return f.result.race_time; };
  for (std::size_t i = 0; i < who.size(); ++i) {
    const auto shown = seeds[i].shown();
    const std::string& name = who[i].name;
    const bool is_paper = who[i].pitch != 0.0;
    result.table.push_back({name + ": flights of 15 gates",
                            is_paper ? "3 shown; by names 5 of a day's 104 logs" : "",
                            std::to_string(seeds[i].finished()) + " of " + std::to_string(tries) +
                                " seeds, level none, our detector's statistics"});
    result.table.push_back(
        {"  mean speed of the three", who[i].paper_speed, each_of(shown, 2, speed) + " m/s"});
    if (is_paper) {
      // k of the paper's arcs; the steady speed of its straights, were they long
      const double steady = kGravity * std::tan(-who[i].pitch) / 0.53;
      result.table.push_back(
          {"  steady g tan θ / |k|; end of the longest straight", fixed(steady, 2) + " m/s",
           each_of(shown, 2, [](const Race& f) { return f.straight_speed; }) + " m/s"});
    }
    result.table.push_back({"  15 gates in", "", each_of(shown, 1, time) + " s"});
    result.table.push_back({"  a lap", is_paper ? "41 m, nominal" : "",
                            each_of(shown, 0, [](const Race& f) { return f.lap_length; }) + " m"});
    const std::string causes = causes_of(seeds[i].results());
    if (!causes.empty())
      result.table.push_back(
          {"  the others ended", is_paper ? "crashes at gates 2-5" : "", causes});
    auto list = nlohmann::ordered_json::array();
    for (const Race& f : seeds[i].all) {
      const RaceResult& r = f.result;
      const std::string cause = cause_of(r);
      result.csv += "\"" + name + "\"," + std::to_string(f.seed) + "," + (r.finished ? "1" : "0") +
                    "," + std::to_string(r.gates_passed) + "," + cause;
      for (const double v : {r.race_time, r.mean_speed, f.straight_speed, f.lap_length,
                             r.estimation_rmse.x(), r.estimation_rmse.y(), r.estimation_rmse.z()})
        result.csv += "," + files::text_of(v, 4);
      result.csv += "\n";
      list.push_back({{"seed", f.seed},
                      {"finished", r.finished},
                      {"gates", r.gates_passed},
                      {"cause", cause},
                      {"time_s", number(r.race_time)},
                      {"mean_speed_mps", number(r.mean_speed)},
                      {"straight_speed_mps", number(f.straight_speed)},
                      {"lap_length_m", number(f.lap_length)}});
    }
    result.json[name] = {{"days", tries},
                         {"finished", seeds[i].finished()},
                         {"mean_speed_mps", number(mean_of(shown, speed))},
                         {"flights", list}};
  }
  // The introduction's races: gates, metres, seconds.
  const auto winner = [&](const std::string& what, int gates, double metres, double seconds) {
    result.table.push_back({what,
                            std::to_string(gates) + " gates, " + files::text_of(metres, 3) +
                                " m, " + files::text_of(seconds, 3) +
                                " s: " + fixed(metres / seconds, 2) + " m/s",
                            ""});
  };
  winner("IROS 2016, first (KAIST)", 10, 50.0, 86.0);
  winner("IROS 2017, first (INAOE)", 9, 60.0, 194.0);
  return result;
}

}  // namespace gatefly::experiments
