// SPDX-License-Identifier: Apache-2.0
// Laps through two gates: the filter beside the truth, and how its errors are spread. Li18 §3.3,
// Fig. "EKF result", "EKF error".
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/experiments/simulated_laps.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/inertial_follower.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

constexpr int kLaps = 3;
constexpr double kPeriod = 0.05;            // between samples of the error [s]
constexpr double kBin = 0.02, kMost = 0.5;  // of the histograms [m]
constexpr std::array kAxes{'x', 'y', 'z'};

/// Values of the paper's histograms, read off its figure [m].
struct PaperAxis {
  double mean, std;
};
constexpr std::array<PaperAxis, 2> kPaper{{{-0.040, 0.104}, {-0.011, 0.069}}};

struct Instant {
  double t = 0.0;
  Eigen::Vector3d truth, drag, imu15;
  bool blind = false;  ///< No gate corrected the filter in the last 0.3 s.
};

struct Followed {
  std::vector<Instant> moments;  ///< From the first fix to the last gate.
  std::vector<std::pair<double, Eigen::Vector3d>> fixes;
  bool finished = false;
};

Followed flown(std::uint64_t seed, simulated_race::Vision vision, const Options& options) {
  constexpr double kBlind = 0.3;
  // As the paper flies: the nose along the way.
  auto race = race_on("oval", kLaps, vision, seed, true, {},
                      {"control.speed_mps=1.7", "control.look_aside_deg=0"});
  race.while_baking = [&options] {
    if (options.stopped()) throw Stopped{};
  };
  flight_log::InertialFollower inertial;
  Followed flight;
  double next = 0.0, last_fix = -1.0;
  const auto result = simulated_race::fly(race, [&](const flight_log::Tick& tick) {
    const double t = 1e-9 * static_cast<double>(tick.sensors.time.count());
    inertial.update(tick.sensors, tick.pilot);
    if ((tick.sensors.image || tick.sensors.seen) && tick.pilot.sighting().fix)
      last_fix = t, flight.fixes.emplace_back(t, tick.pilot.sighting().fix->p_EB);
    if (last_fix < 0.0 || t < next || tick.pilot.finished()) return !options.stopped();
    next = t + kPeriod;
    flight.moments.push_back({t, tick.truth.p_EB, tick.pilot.estimate().p_EB,
                              inertial.estimate(tick.pilot).p_EB, t - last_fix > kBlind});
    return true;
  });
  flight.finished = result.finished;
  return flight;
}

/// Errors of one axis.
struct Spread {
  std::vector<double> errors;

  [[nodiscard]] double mean() const {
    double sum = 0.0;
    for (const double e : errors) sum += e;
    return sum / static_cast<double>(errors.size());
  }
  [[nodiscard]] double deviation() const {
    double sum = 0.0;
    for (const double e : errors) sum += std::pow(e - mean(), 2);
    return std::sqrt(sum / static_cast<double>(errors.size()));
  }
  [[nodiscard]] double quantile(double part) const { return files::nearest_rank(errors, part); }
  [[nodiscard]] double beyond(double limit) const {
    return static_cast<double>(std::count_if(errors.begin(), errors.end(),
                                             [&](double e) { return std::abs(e) > limit; })) /
           static_cast<double>(errors.size());
  }
};
using Spreads = std::array<Spread, 3>;

void add(Spreads& spreads, const Eigen::Vector3d& error) {
  for (int axis = 0; axis < 3; ++axis)
    spreads[static_cast<std::size_t>(axis)].errors.push_back(error[axis]);
}

drawing::PlotSeries histogram(const std::string& name, const Spread& spread,
                              const drawing::Color& color) {
  std::vector<double> counts(static_cast<std::size_t>(std::lround(2.0 * kMost / kBin)));
  for (const double e : spread.errors) {
    const double bin = std::floor((e + kMost) / kBin);
    if (bin >= 0.0 && bin < static_cast<double>(counts.size()))
      ++counts[static_cast<std::size_t>(bin)];
  }
  drawing::PlotSeries series{.name = name, .points = {}, .color = color};
  for (std::size_t i = 0; i < counts.size(); ++i)
    series.points.emplace_back(-kMost + (static_cast<double>(i) + 0.5) * kBin,
                               100.0 * counts[i] / static_cast<double>(spread.errors.size()));
  return series;
}

drawing::PlotSeries as_normal(const PaperAxis& paper) {
  drawing::PlotSeries series{.name = "paper (normal distribution)",
                             .points = {},
                             .color = drawing::kLight.ink,
                             .marks = false,
                             .dash = 6.0};
  for (double e = -kMost + 0.5 * kBin; e < kMost; e += kBin)
    series.points.emplace_back(e, 100.0 * kBin / (paper.std * std::sqrt(2.0 * kPi)) *
                                      std::exp(-0.5 * std::pow((e - paper.mean) / paper.std, 2)));
  return series;
}

drawing::Canvas picture_of(const Followed& flight, const Spreads& drag, const Spreads& imu15) {
  const auto series = [](const char* name, const drawing::Color& color, bool line) {
    return drawing::PlotSeries{
        .name = name, .points = {}, .color = color, .line = line, .rings = !line};
  };
  const std::vector<drawing::PlotSeries> empty{
      series("truth", drawing::kLight.ink, true), series("fixes", drawing::kLight.muted, false),
      series("15 states", drawing::kLight.gate_solid, true),
      series("drag filter", drawing::kLight.found, true)};
  std::array<drawing::Plot, 3> plots{drawing::Plot{.title = "Two gates, from above",
                                                   .x_label = "x [m]",
                                                   .y_label = "y [m]",
                                                   .series = empty,
                                                   .y_from_0 = false},
                                     drawing::Plot{.title = "Along x",
                                                   .x_label = "t [s]",
                                                   .y_label = "x [m]",
                                                   .series = empty,
                                                   .y_from_0 = false},
                                     drawing::Plot{.title = "Along y",
                                                   .x_label = "t [s]",
                                                   .y_label = "y [m]",
                                                   .series = empty,
                                                   .y_from_0 = false}};
  const auto point = [&](std::size_t which, double t, const Eigen::Vector3d& p) {
    plots[0].series[which].points.emplace_back(p.x(), p.y()),
        plots[1].series[which].points.emplace_back(t, p.x()),
        plots[2].series[which].points.emplace_back(t, p.y());
  };
  for (std::size_t i = 0; i < flight.moments.size(); i += 3) {
    const Instant& m = flight.moments[i];
    point(0, m.t, m.truth), point(2, m.t, m.imu15), point(3, m.t, m.drag);
  }
  for (std::size_t i = 0; i < flight.fixes.size(); i += 3)
    point(1, flight.fixes[i].first, flight.fixes[i].second);
  std::array<drawing::Plot, 6> all;  // a row for each axis
  for (std::size_t i = 0; i < 3; ++i) {
    drawing::Plot errors{.title = std::string{"Error of "} + kAxes[i],
                         .x_label = "estimate - truth [m]",
                         .y_label = "samples [%]"};
    if (i < kPaper.size()) errors.series.push_back(as_normal(kPaper[i]));
    errors.series.push_back(histogram("15 states", imu15[i], drawing::kLight.gate_solid)),
        errors.series.push_back(histogram("drag filter", drag[i], drawing::kLight.found));
    all[2 * i] = plots[i], all[2 * i + 1] = errors;
  }
  return drawing::draw_sheet(all, 2);
}

std::string text_of(const Spread& s) {
  return "mean " + fixed(s.mean(), 3) + ", std " + fixed(s.deviation(), 3) + " m";
}

nlohmann::ordered_json json_of(const Spreads& spreads) {
  auto json = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < 3; ++i) {
    const Spread& s = spreads[i];
    json[std::string{kAxes[i]}] = {{"mean_m", number(s.mean())},
                                   {"std_m", number(s.deviation())},
                                   {"p1_m", number(s.quantile(0.01))},
                                   {"p99_m", number(s.quantile(0.99))},
                                   {"beyond_0.2_m", number(s.beyond(0.2))},
                                   {"samples", s.errors.size()}};
  }
  return json;
}

}  // namespace

Result ekf_track(const Options& options) {
  const auto vision =
      options.quick ? simulated_race::Vision::kIdeal : simulated_race::Vision::kRendered;
  std::vector<Followed> flights(options.quick ? 4 : 10);
  if (!options.quick) flights[0] = flown(1, vision, options);  // the hall's light is computed once
  in_pieces(flights.size(), options, [&](std::size_t i) {
    if (flights[i].moments.empty()) flights[i] = flown(i + 1, vision, options);
  });

  Result result{
      .table = {},
      .json = {},
      .csv = "seed,t_s,true_x_m,true_y_m,true_z_m,x_m,y_m,z_m,imu15_x_m,imu15_y_m,imu15_z_m\n",
      .picture = drawing::Canvas(1, 1)};
  Spreads drag, imu15, drag_blind, imu15_blind;
  int finished = 0;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    finished += flights[i].finished;
    for (const Instant& m : flights[i].moments) {
      add(drag, m.drag - m.truth), add(imu15, m.imu15 - m.truth);
      if (m.blind) add(drag_blind, m.drag - m.truth), add(imu15_blind, m.imu15 - m.truth);
      result.csv += std::to_string(i + 1) + "," + files::text_of(m.t, 6);
      for (const Eigen::Vector3d& p : {m.truth, m.drag, m.imu15})
        for (const double v : p) result.csv += "," + files::text_of(v, 5);
      result.csv += "\n";
    }
  }
  result.table.push_back(
      {std::to_string(flights.size()) + " flights of " + std::to_string(kLaps) + " laps, finished",
       "", std::to_string(finished)});
  const std::array<std::string, 3> paper{"mean -0.040, std 0.104 m", "mean -0.011, std 0.069 m",
                                         "within 0.05 m"};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string axis{kAxes[i]};
    result.table.push_back(
        {"Error of " + axis, paper[i], text_of(drag[i]) + " (imu15 " + text_of(imu15[i]) + ")"});
    result.table.push_back(
        {"  1 and 99 %",
         i == 0   ? "-0.39, 0.17 m"
         : i == 1 ? "-0.28, ? m"
                  : "",
         fixed(drag[i].quantile(0.01), 2) + ", " + fixed(drag[i].quantile(0.99), 2) + " m (imu15 " +
             fixed(imu15[i].quantile(0.01), 2) + ", " + fixed(imu15[i].quantile(0.99), 2) + " m)"});
    result.table.push_back({"  more than 0.2 m", i < 2 ? "a few" : "",
                            fixed(100.0 * drag[i].beyond(0.2), 1) + " % (imu15 " +
                                fixed(100.0 * imu15[i].beyond(0.2), 1) + " %)"});
    if (i < 2)
      result.table.push_back({"  without a gate for 0.3 s", "",
                              text_of(drag_blind[i]) + " (imu15 " + text_of(imu15_blind[i]) + ")"});
  }
  result.json = {{"flights", flights.size()},
                 {"finished", finished},
                 {"vision", options.quick ? "ideal" : "rendered"},
                 {"drag", json_of(drag)},
                 {"imu15", json_of(imu15)},
                 {"drag_blind", json_of(drag_blind)},
                 {"imu15_blind", json_of(imu15_blind)}};
  result.picture = picture_of(flights[0], drag, imu15);
  return result;
}

}  // namespace gatefly::experiments
