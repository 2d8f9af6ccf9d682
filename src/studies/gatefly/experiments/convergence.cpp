// SPDX-License-Identifier: Apache-2.0
// Li18's conclusion says in words only that its filter "converges faster than a traditional
// 15-states Kalman filter": when, how much, and where it is not so.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/convergence_trial.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/files/quantile.hpp"

namespace gatefly::experiments {
namespace {

constexpr std::uint64_t kFirstSeed = 2101;  // 1-60 are ekf-vs-15's, 1001 on are tuned on
constexpr std::size_t kRuns = 60, kQuickRuns = 6;
constexpr std::array kThresholds{0.10, 0.05};                   // of the bias's error [m/s²]
constexpr std::array kMoments{0.5, 1.0, 2.0, 5.0, 10.0, 20.0};  // that are told [s]

struct WhatIs {
  const char *key, *name;
};
constexpr std::array<WhatIs, kWhats> kNames{{{"bias_mps2", "bias x, y"},
                                             {"position_m", "position x, y"},
                                             {"velocity_mps", "velocity x, y"},
                                             {"tilt_deg", "tilt"}}};

std::string seconds(double t) { return std::isfinite(t) ? fixed(t, 1) + " s" : "not in 20 s"; }

std::string text_of(const Crossover& c) {
  return seconds(c.t) + " (" + seconds(c.low) + " to " + seconds(c.high) + ")";
}

void add_area(drawing::Plot& plot, const std::string& name, const Samples& samples,
              const drawing::Color& color) {
  drawing::PlotSeries band{.color = color.faded(0.2), .area = true},
      median{.name = name, .color = color, .marks = false};
  std::vector<Eigen::Vector2d> upper;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = time_of(i);
    band.points.emplace_back(t, files::nearest_rank(samples[i], 0.05));
    upper.emplace_back(t, files::nearest_rank(samples[i], 0.95));
    median.points.emplace_back(t, files::nearest_rank(samples[i], 0.5));
  }
  band.points.insert(band.points.end(), upper.rbegin(), upper.rend());
  plot.series.push_back(band), plot.series.push_back(median);
}

drawing::Plot curves(const BothFilters& pair, const Crossover& cross) {
  drawing::Plot plot{.title = "Accelerometer bias found: error of x and y",
                     .x_label = "time since the first fix [s]",
                     .y_label = "error [m/s²], median, 90 % band"};
  add_area(plot, "15 states", pair.imu15[kBias], drawing::kLight.gate_solid);
  add_area(plot, "drag filter, 7 states", pair.drag[kBias], drawing::kLight.found);
  if (std::isfinite(cross.t))
    plot.series.push_back({.name = "crossover at " + seconds(cross.t),
                           .points = {{cross.t, 0.0}, {cross.t, 0.5}},
                           .color = drawing::kLight.ink,
                           .marks = false,
                           .dash = 5.0});
  return plot;
}

/// A line for each condition: its crossover with its band.
drawing::Canvas crossovers(const std::vector<Condition>& list, const std::vector<Crossover>& found,
                           int width, int height) {
  constexpr double kLeft = 330.0, kTop = 76.0, kRight = 150.0, kBottom = 66.0;  // [px]
  constexpr double kLetters = 15.0;
  drawing::Canvas canvas(width, height);
  const drawing::Box area{kLeft, kTop, width - kLeft - kRight, height - kTop - kBottom};
  const auto place = [&](double t) { return area.x + area.width * std::min(t, kTo) / kTo; };
  canvas.text({67.0, 34.0}, "From when on 15 states know the bias better",
              {.size = 18.5, .bold = true});
  canvas.text({67.0, 60.0}, "crossover of the medians, 90 % band",
              {.color = drawing::kLight.muted, .size = kLetters});
  for (const double t : drawing::ticks(0.0, kTo, 5)) {
    canvas.line({place(t), area.y}, {place(t), area.bottom()},
                {.color = drawing::kLight.grid, .width = 1.0});
    canvas.text(
        {place(t), area.bottom() + 20.0}, files::text_of(t),
        {.color = drawing::kLight.muted, .size = kLetters, .align = drawing::Align::kCenter});
  }
  canvas.text({area.x + 0.5 * area.width, area.bottom() + 44.0}, "time since the first fix [s]",
              {.size = kLetters, .align = drawing::Align::kCenter});
  for (std::size_t i = 0; i < list.size(); ++i) {
    const double v =
        area.y + area.height * (static_cast<double>(i) + 0.5) / static_cast<double>(list.size());
    const Crossover& c = found[i];
    canvas.text({area.x - 12.0, v + 4.5}, list[i].name,
                {.size = kLetters, .align = drawing::Align::kRight});
    canvas.line({place(c.low), v}, {place(c.high), v},
                {.color = drawing::kLight.found.faded(0.5), .width = 5.0});
    if (std::isfinite(c.t)) canvas.disc({place(c.t), v}, 5.0, drawing::kLight.found);
    canvas.text({area.right() + 8.0, v + 4.5}, seconds(c.t), {.size = kLetters});
  }
  return canvas;
}

std::string csv_of(const Condition& condition, const BothFilters& pair) {
  std::string csv;
  for (std::size_t what = 0; what < kWhats; ++what)
    for (std::size_t i = 0; i < kPoints; ++i) {
      csv += condition.key + "," + kNames[what].key + "," + files::text_of(time_of(i), 4);
      for (const auto* samples : {&pair.drag[what][i], &pair.imu15[what][i]})
        for (const double part : {0.5, 0.05, 0.95})
          csv += "," + files::text_of(files::nearest_rank(*samples, part), 4);
      csv += "\n";
    }
  return csv;
}

nlohmann::ordered_json json_of(const Condition& condition, const BothFilters& pair,
                               const Crossover& cross) {
  auto ratios = nlohmann::ordered_json::object();
  for (std::size_t what = 0; what < kWhats; ++what)
    for (const double t : kMoments)
      ratios[kNames[what].key].push_back(
          {{"t_s", t},
           {"ratio", number(median_ratio(pair, static_cast<ErrorOf>(what), t))},
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

void tell_when(const BothFilters& flown, Result& result) {
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

void tell_how_much(const BothFilters& flown, Result& result) {
  for (const double t : {0.0, 1.0, 5.0, 20.0})
    result.table.push_back(
        {"bias x, y after " + fixed(t, 0) + " s", kWords,
         against(flown.drag[kBias][point_at(t)], flown.imu15[kBias][point_at(t)], "m/s²")});
  for (std::size_t what = 0; what < kWhats; ++what) {
    std::string ratios;
    for (const double t : kMoments)
      ratios += (ratios.empty() ? "" : ", ") +
                fixed(median_ratio(flown, static_cast<ErrorOf>(what), t), 1);
    result.table.push_back(
        {"imu15 / drag filter, " + std::string{kNames[what].name} + ", at 0.5, 1, 2, 5, 10, 20 s",
         what == kTilt ? "-" : kWords, ratios});
  }
}

void tell_where_not(const Condition& condition, const BothFilters& pair, const Crossover& cross,
                    Result& result) {
  result.table.push_back({"  " + condition.name, "-",
                          text_of(cross) + "; " + fixed(median_ratio(pair, kBias, 1.0), 1) + ", " +
                              fixed(median_ratio(pair, kPosition, 5.0), 1)});
  result.json["conditions"].push_back(json_of(condition, pair, cross));
  result.csv += csv_of(condition, pair);
}

}  // namespace

Result convergence(const Options& options) {
  const std::vector<Condition> list = conditions(options.quick);
  options.progress(0.0, "the classic filter's noises");
  const baseline::Imu15Params classic = tuned_for_bias(options);
  const std::size_t count = options.quick ? kQuickRuns : kRuns;
  const std::uint64_t first = first_seed(options, kFirstSeed, kFirstSeed);
  std::vector<FlightCurves> flights(count);
  in_pieces(count, options,
            [&](std::size_t i) { flights[i] = curves_of(first + i, list, classic); });
  std::erase_if(flights, [](const FlightCurves& flight) { return !is_whole(flight); });
  if (flights.empty()) throw std::runtime_error("convergence: no flight lasts 20 s");
  std::vector<BothFilters> pairs(list.size());
  std::vector<Crossover> cross(list.size());
  in_parallel(list.size(), [&](std::size_t c) {
    pairs[c] = gathered(flights, c);
    cross[c] = crossover(pairs[c]);
  });

  Result result{.table = {{std::to_string(count) + " flights, 20 s long after the first fix", "-",
                           std::to_string(flights.size())}},
                .json = {{"runs", count},
                         {"first_seed", first},
                         {"lasting_20_s", flights.size()},
                         {"imu15",
                          {{"accel_noise", classic.accel_noise},
                           {"gyro_noise", classic.gyro_noise},
                           {"start_tilt_sigma_rad", classic.start_tilt_sigma}}}},
                .csv =
                    "condition,what,t_s,drag_median,drag_p5,drag_p95,imu15_median,imu15_p5,"
                    "imu15_p95\n",
                .picture = drawing::Canvas(1, 1)};
  tell_when(pairs.front(), result);
  tell_how_much(pairs.front(), result);
  for (std::size_t c = 0; c < list.size(); ++c) tell_where_not(list[c], pairs[c], cross[c], result);
  result.picture = drawing::Canvas(drawing::kPlotWidth, drawing::kPlotHeight);
  result.picture.paste(
      drawing::draw(curves(pairs.front(), cross.front()), drawing::kPlotWidth, drawing::kRowHeight),
      {0.0, 0.0});
  result.picture.paste(crossovers(list, cross, drawing::kPlotWidth, drawing::kRowHeight),
                       {0.0, drawing::kRowHeight});
  return result;
}

}  // namespace gatefly::experiments
