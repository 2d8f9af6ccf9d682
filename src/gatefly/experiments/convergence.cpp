// SPDX-License-Identifier: Apache-2.0
// Li18's conclusion says in words only that its filter "converges faster than a traditional
// 15-states Kalman filter": when, how much, and where it is not so.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/filter_race.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::experiments {
namespace {

constexpr std::uint64_t kFirstSeed = 2101;  // 1-60 are ekf-vs-15's, 1001 on are tuned on
constexpr std::size_t kRuns = 60, kQuickRuns = 6;
constexpr double kPerSecond = 10.0;                             // points of the curves
constexpr std::size_t kFirstFix = 10, kPoints = 211;            // of them: from -1 s to 20 s
constexpr double kHold = 2.0;                                   // a crossover lasts [s]
constexpr std::array kThresholds{0.10, 0.05};                   // of the bias's error [m/s²]
constexpr std::array kMoments{0.5, 1.0, 2.0, 5.0, 10.0, 20.0};  // that are told [s]

/// Seconds since the first fix.
constexpr double time_of(std::size_t point) {
  return (static_cast<double>(point) - kFirstFix) / kPerSecond;
}
constexpr std::size_t point_at(double t) {
  return static_cast<std::size_t>(t * kPerSecond + kFirstFix + 0.5);
}
constexpr double kTo = time_of(kPoints - 1);

enum What : std::size_t { kBias, kPosition, kVelocity, kTilt, kWhats };
struct WhatIs {
  const char *key, *name;
};
constexpr std::array<WhatIs, kWhats> kNames{{{"bias_mps2", "bias x, y"},
                                             {"position_m", "position x, y"},
                                             {"velocity_mps", "velocity x, y"},
                                             {"tilt_deg", "tilt"}}};

/// Errors of one filter over one flight; empty curves when it was over before kTo.
using Trace = std::array<std::vector<double>, kWhats>;

struct Condition {
  std::string key, name;
  FilterConditions given = {};

  /// The classic filter is told no drag.
  [[nodiscard]] bool changes_imu15() const { return given.told_drag == 1.0; }
};

std::vector<Condition> conditions(bool quick) {
  std::vector<Condition> list{{"as_flown", "15 Hz, 0.10 m, shipped drag"}};
  for (const int percent : {-20, -10, 10, 20})
    if (!quick || std::abs(percent) == 20)
      list.push_back(
          {"drag_" + std::to_string(percent),
           "told drag " + std::string(percent > 0 ? "+" : "") + std::to_string(percent) + " %",
           {.told_drag = 1.0 + percent / 100.0}});
  for (const int rate : {5, 2})
    list.push_back({"rate_" + std::to_string(rate),
                    "fixes at " + std::to_string(rate) + " Hz",
                    {.fix_period = 1.0 / rate}});
  for (const double sigma : {0.05, 0.3})
    list.push_back({"sigma_" + io::text_of(sigma),
                    "fixes of " + io::text_of(sigma) + " m",
                    {.fix_sigma = sigma}});
  list.push_back({"start_1", "start known to 1 m", {.start_sigma = 1.0}});
  return list;
}

template <class Filter>
Trace trace_of(const FilterRace& race, Filter filter, const FilterConditions& given,
               std::size_t points = kPoints) {
  Trace trace;
  const auto fixes = race.fixes(given);
  if (fixes.empty()) return trace;
  const double first = race.laps().moments[fixes.front().moment].t;
  race.feed(filter, given,
            [&](const LapMoment& m, const FilterTick&, const Filter& now, const FixTime*) {
              if (m.t - first < time_of(trace[kBias].size())) return true;
              const auto add = [&](What what, const Eigen::Vector3d& error) {
                trace[what].push_back(error.head<2>().norm());
              };
              add(kBias, now.accel_bias() - race.laps().accel_bias);
              add(kPosition, now.position() - m.p_EB);
              add(kVelocity, now.velocity() - m.v_E);
              const Attitude attitude = now.attitude();
              trace[kTilt].push_back(std::hypot(wrap_angle(attitude.roll - m.attitude.roll),
                                                attitude.pitch - m.attitude.pitch) /
                                     kDegree);
              return trace[kBias].size() < points;
            });
  return trace;
}

/// Those noises of the classic filter that find the bias soonest, on flights that are not shown.
baseline::Imu15Params tuned(const Options& options) {
  constexpr std::size_t kFirst = point_at(0.5), kLast = point_at(5.0);
  const std::vector<FilterRace> races = tuning_races(options);
  return tuned_imu15(options, [&](const baseline::Imu15Params& params) {
    std::vector<std::vector<double>> biases(races.size());
    in_parallel(races.size(), [&](std::size_t i) {
      biases[i] = trace_of(races[i], races[i].imu15(params), {}, kLast + 1)[kBias];
    });
    std::vector<double> all;
    for (const std::vector<double>& bias : biases)
      for (std::size_t k = kFirst; k < bias.size(); ++k) all.push_back(bias[k]);
    return rms(all);
  });
}

/// Both filters' errors under one condition; run i is the same flight in both.
struct Pair {
  std::array<Samples, kWhats> drag, imu15;
};

double median_ratio(const Pair& pair, What what, double t) {
  const std::size_t point = point_at(t);
  return io::nearest_rank(pair.imu15[what][point], 0.5) /
         io::nearest_rank(pair.drag[what][point], 0.5);
}

/// When that part of the flights is below a threshold for the first time [s]; NaN: not by kTo.
double time_below(const Samples& samples, double part, double threshold) {
  for (std::size_t i = kFirstFix; i < samples.size(); ++i)
    if (io::nearest_rank(samples[i], part) <= threshold) return time_of(i);
  return std::numeric_limits<double>::quiet_NaN();
}

/// From when on the classic filter's median error of the bias is the smaller one, for kHold at
/// least [s]; infinite: not by kTo. @param runs  of which flights, repeats allowed.
double crossover_of(const Pair& pair, const std::vector<std::size_t>& runs) {
  std::vector<double> drawn(runs.size());
  const auto median = [&](const std::vector<double>& values) {
    for (std::size_t i = 0; i < runs.size(); ++i) drawn[i] = values[runs[i]];
    const auto middle = drawn.begin() + static_cast<std::ptrdiff_t>(drawn.size() / 2);
    std::nth_element(drawn.begin(), middle, drawn.end());
    return *middle;
  };
  std::size_t better_since = kPoints;
  for (std::size_t i = kFirstFix; i < kPoints; ++i) {
    if (median(pair.imu15[kBias][i]) >= median(pair.drag[kBias][i]))
      better_since = kPoints;
    else if (better_since == kPoints)
      better_since = i;
    if (better_since < kPoints && time_of(i) - time_of(better_since) >= kHold)
      return time_of(better_since);
  }
  return std::numeric_limits<double>::infinity();
}

struct Crossover {
  double t = 0.0, low = 0.0, high = 0.0;  ///< With the 90 % band of flights drawn anew [s].
};

Crossover crossover(const Pair& pair) {
  constexpr std::size_t kDraws = 200;
  std::vector<std::size_t> runs(pair.drag[kBias][0].size());
  for (std::size_t i = 0; i < runs.size(); ++i) runs[i] = i;
  Crossover found{.t = crossover_of(pair, runs)};
  sim::Stream random{1, "convergence/bootstrap"};
  std::vector<double> all;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    for (std::size_t& run : runs)
      run =
          std::min(runs.size() - 1,
                   static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(runs.size()))));
    all.push_back(crossover_of(pair, runs));
  }
  std::sort(all.begin(), all.end());
  found.low = all[kDraws / 20], found.high = all[kDraws - 1 - kDraws / 20];
  return found;
}

// ---------------------------------------------------------------- report

std::string seconds(double t) { return std::isfinite(t) ? fixed(t, 1) + " s" : "not in 20 s"; }

std::string text_of(const Crossover& c) {
  return seconds(c.t) + " (" + seconds(c.low) + " to " + seconds(c.high) + ")";
}

void add_area(io::Plot& plot, const std::string& name, const Samples& samples,
              const io::Color& color) {
  io::PlotSeries band{.color = color.faded(0.2), .area = true},
      median{.name = name, .color = color, .marks = false};
  std::vector<Eigen::Vector2d> upper;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = time_of(i);
    band.points.emplace_back(t, io::nearest_rank(samples[i], 0.05));
    upper.emplace_back(t, io::nearest_rank(samples[i], 0.95));
    median.points.emplace_back(t, io::nearest_rank(samples[i], 0.5));
  }
  band.points.insert(band.points.end(), upper.rbegin(), upper.rend());
  plot.series.push_back(band), plot.series.push_back(median);
}

io::Plot curves(const Pair& pair, const Crossover& cross) {
  io::Plot plot{.title = "Accelerometer bias found: error of x and y",
                .x_label = "time since the first fix [s]",
                .y_label = "error [m/s²], median, 90 % band"};
  add_area(plot, "15 states", pair.imu15[kBias], io::kLight.gate_solid);
  add_area(plot, "drag filter, 7 states", pair.drag[kBias], io::kLight.found);
  if (std::isfinite(cross.t))
    plot.series.push_back({.name = "crossover at " + seconds(cross.t),
                           .points = {{cross.t, 0.0}, {cross.t, 0.5}},
                           .color = io::kLight.ink,
                           .marks = false,
                           .dash = 5.0});
  return plot;
}

/// A line for each condition: its crossover with its band.
io::Canvas crossovers(const std::vector<Condition>& list, const std::vector<Crossover>& found,
                      int width, int height) {
  constexpr double kLeft = 330.0, kTop = 76.0, kRight = 150.0, kBottom = 66.0;  // [px]
  constexpr double kLetters = 15.0;
  io::Canvas canvas(width, height);
  const io::Box area{kLeft, kTop, width - kLeft - kRight, height - kTop - kBottom};
  const auto place = [&](double t) { return area.x + area.width * std::min(t, kTo) / kTo; };
  canvas.text({67.0, 34.0}, "From when on 15 states know the bias better",
              {.size = 18.5, .bold = true});
  canvas.text({67.0, 60.0}, "crossover of the medians, 90 % band",
              {.color = io::kLight.muted, .size = kLetters});
  for (const double t : io::ticks(0.0, kTo, 5)) {
    canvas.line({place(t), area.y}, {place(t), area.bottom()},
                {.color = io::kLight.grid, .width = 1.0});
    canvas.text({place(t), area.bottom() + 20.0}, io::text_of(t),
                {.color = io::kLight.muted, .size = kLetters, .align = io::Align::kCenter});
  }
  canvas.text({area.x + 0.5 * area.width, area.bottom() + 44.0}, "time since the first fix [s]",
              {.size = kLetters, .align = io::Align::kCenter});
  for (std::size_t i = 0; i < list.size(); ++i) {
    const double v =
        area.y + area.height * (static_cast<double>(i) + 0.5) / static_cast<double>(list.size());
    const Crossover& c = found[i];
    canvas.text({area.x - 12.0, v + 4.5}, list[i].name,
                {.size = kLetters, .align = io::Align::kRight});
    canvas.line({place(c.low), v}, {place(c.high), v},
                {.color = io::kLight.found.faded(0.5), .width = 5.0});
    if (std::isfinite(c.t)) canvas.disc({place(c.t), v}, 5.0, io::kLight.found);
    canvas.text({area.right() + 8.0, v + 4.5}, seconds(c.t), {.size = kLetters});
  }
  return canvas;
}

std::string csv_of(const Condition& condition, const Pair& pair) {
  std::string csv;
  for (std::size_t what = 0; what < kWhats; ++what)
    for (std::size_t i = 0; i < kPoints; ++i) {
      csv += condition.key + "," + kNames[what].key + "," + io::text_of(time_of(i), 4);
      for (const auto* samples : {&pair.drag[what][i], &pair.imu15[what][i]})
        for (const double part : {0.5, 0.05, 0.95})
          csv += "," + io::text_of(io::nearest_rank(*samples, part), 4);
      csv += "\n";
    }
  return csv;
}

nlohmann::ordered_json json_of(const Condition& condition, const Pair& pair,
                               const Crossover& cross) {
  auto ratios = nlohmann::ordered_json::object();
  for (std::size_t what = 0; what < kWhats; ++what)
    for (const double t : kMoments)
      ratios[kNames[what].key].push_back(
          {{"t_s", t},
           {"ratio", number(median_ratio(pair, static_cast<What>(what), t))},
           {"drag", band_json(pair.drag[what][point_at(t)])},
           {"imu15", band_json(pair.imu15[what][point_at(t)])}});
  auto below = nlohmann::ordered_json::array();
  for (const double threshold : kThresholds)
    for (const double part : {0.5, 0.9})
      below.push_back({{"threshold_mps2", threshold},
                       {"part", part},
                       {"drag_s", number(time_below(pair.drag[kBias], part, threshold))},
                       {"imu15_s", number(time_below(pair.imu15[kBias], part, threshold))}});
  return {{"condition", condition.key},
          {"fix_hz", 1.0 / condition.given.fix_period},
          {"fix_sigma_m", condition.given.fix_sigma},
          {"told_drag", condition.given.told_drag},
          {"start_sigma_m", condition.given.start_sigma},
          {"crossover_s",
           {{"t", number(cross.t)}, {"p5", number(cross.low)}, {"p95", number(cross.high)}}},
          {"bias_below", below},
          {"errors", ratios}};
}

constexpr const char* kWords = "converges faster (words)";

void tell_when(const Pair& flown, Result& result) {
  for (const double threshold : kThresholds) {
    const auto both = [&](const Samples& samples) {
      return seconds(time_below(samples, 0.5, threshold)) + ", " +
             seconds(time_below(samples, 0.9, threshold));
    };
    result.table.push_back({"bias x, y below " + fixed(threshold, 2) + " m/s²: half, 90 % of them",
                            kWords,
                            both(flown.drag[kBias]) + "; imu15 " + both(flown.imu15[kBias])});
  }
}

void tell_how_much(const Pair& flown, Result& result) {
  for (const double t : {0.0, 1.0, 5.0, 20.0})
    result.table.push_back(
        {"bias x, y after " + fixed(t, 0) + " s", kWords,
         against(flown.drag[kBias][point_at(t)], flown.imu15[kBias][point_at(t)], "m/s²")});
  for (std::size_t what = 0; what < kWhats; ++what) {
    std::string ratios;
    for (const double t : kMoments)
      ratios +=
          (ratios.empty() ? "" : ", ") + fixed(median_ratio(flown, static_cast<What>(what), t), 1);
    result.table.push_back(
        {"imu15 / drag filter, " + std::string{kNames[what].name} + ", at 0.5, 1, 2, 5, 10, 20 s",
         what == kTilt ? "-" : kWords, ratios});
  }
}

void tell_where_not(const Condition& condition, const Pair& pair, const Crossover& cross,
                    Result& result) {
  result.table.push_back({"  " + condition.name, "-",
                          text_of(cross) + "; " + fixed(median_ratio(pair, kBias, 1.0), 1) + ", " +
                              fixed(median_ratio(pair, kPosition, 5.0), 1)});
  result.json["conditions"].push_back(json_of(condition, pair, cross));
  result.csv += csv_of(condition, pair);
}

/// Both filters' traces over one flight, by condition.
using Flight = std::vector<std::pair<Trace, Trace>>;

Flight flown(std::uint64_t seed, const std::vector<Condition>& list,
             const baseline::Imu15Params& classic) {
  const FilterRace race{seed};
  Flight flight;
  for (const Condition& condition : list)
    flight.emplace_back(trace_of(race, race.drag(condition.given), condition.given),
                        condition.changes_imu15()
                            ? trace_of(race, race.imu15(classic, condition.given), condition.given)
                            : flight.front().second);
  return flight;
}

bool is_whole(const Flight& flight) {
  return std::all_of(flight.begin(), flight.end(), [](const auto& pair) {
    return pair.first[kBias].size() == kPoints && pair.second[kBias].size() == kPoints;
  });
}

Pair gathered(const std::vector<Flight>& flights, std::size_t condition) {
  Pair pair;
  for (std::size_t what = 0; what < kWhats; ++what) {
    pair.drag[what].resize(kPoints), pair.imu15[what].resize(kPoints);
    for (const Flight& flight : flights)
      for (std::size_t i = 0; i < kPoints; ++i)
        pair.drag[what][i].push_back(flight[condition].first[what][i]),
            pair.imu15[what][i].push_back(flight[condition].second[what][i]);
  }
  return pair;
}

}  // namespace

Result convergence(const Options& options) {
  const std::vector<Condition> list = conditions(options.quick);
  options.progress(0.0, "the classic filter's noises");
  const baseline::Imu15Params classic = tuned(options);
  const std::size_t count = options.quick ? kQuickRuns : kRuns;
  std::vector<Flight> flights(count);
  in_pieces(count, options,
            [&](std::size_t i) { flights[i] = flown(kFirstSeed + i, list, classic); });
  std::erase_if(flights, [](const Flight& flight) { return !is_whole(flight); });
  if (flights.empty()) throw std::runtime_error("convergence: no flight lasts 20 s");
  std::vector<Pair> pairs(list.size());
  std::vector<Crossover> cross(list.size());
  in_parallel(list.size(), [&](std::size_t c) {
    pairs[c] = gathered(flights, c);
    cross[c] = crossover(pairs[c]);
  });

  Result result{.table = {{std::to_string(count) + " flights, 20 s long after the first fix", "-",
                           std::to_string(flights.size())}},
                .json = {{"runs", count},
                         {"first_seed", kFirstSeed},
                         {"lasting_20_s", flights.size()},
                         {"imu15",
                          {{"accel_noise", classic.accel_noise},
                           {"gyro_noise", classic.gyro_noise},
                           {"start_tilt_sigma_rad", classic.start_tilt_sigma}}}},
                .csv =
                    "condition,what,t_s,drag_median,drag_p5,drag_p95,imu15_median,imu15_p5,"
                    "imu15_p95\n",
                .picture = io::Canvas(1, 1)};
  tell_when(pairs.front(), result);
  tell_how_much(pairs.front(), result);
  for (std::size_t c = 0; c < list.size(); ++c) tell_where_not(list[c], pairs[c], cross[c], result);
  result.picture = io::Canvas(io::kPlotWidth, io::kPlotHeight);
  result.picture.paste(
      io::draw(curves(pairs.front(), cross.front()), io::kPlotWidth, io::kRowHeight), {0.0, 0.0});
  result.picture.paste(crossovers(list, cross, io::kPlotWidth, io::kRowHeight),
                       {0.0, io::kRowHeight});
  return result;
}

}  // namespace gatefly::experiments
