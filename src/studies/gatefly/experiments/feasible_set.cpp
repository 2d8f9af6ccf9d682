// SPDX-License-Identifier: Apache-2.0
// Li18's figure "sim different initial point": from where a gate can still be flown through. True
// position and speed are known to all laws, as in the paper.
#include "gatefly/experiments/feasible_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "gatefly/control/indi.hpp"
#include "gatefly/control/lateral_pd.hpp"
#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/race/path.hpp"
#include "gatefly/race/track.hpp"

namespace gatefly::experiments {
namespace {

using LateralState = Eigen::Vector4d;  // y, v_y, roll, its rate

LateralState derivative(const LateralLoop& loop, const LateralState& x) {
  const double command = loop.roll_command(x[0], x[1]);
  const auto [omega, zeta] = loop.lag;
  const double roll = omega > 0.0 ? x[2] : command;
  // Eq. (30) without its cos²: v̇_y = g tan φ + k_y v_y
  const double v_y_dot = kGravity * gatefly::tan(roll) + loop.k_y * x[1];
  return {x[1], v_y_dot, x[3], omega * omega * (command - roll) - 2.0 * zeta * omega * x[3]};
}

constexpr double kStartStep = 0.02;  // between the starts of the courses [m]

// ---------------------------------------------------------------- the study

constexpr double kFarthest = 5.0, kWidest = 3.0;  // of the starts [m] [Li18 §4]
constexpr std::size_t kAcross = 100;              // starts along and across: 10,000 [Li18 §4]
constexpr std::array kSpeeds{1.5, 2.0};           // [m/s] [Li18 §4]
constexpr double kPaperOpening = 0.5;             // half the gate: what the paper seems to ask [m]
constexpr double kCurveStep = 0.02;               // of x0, in the curves [m]

/// Half of what is open to the drone's middle [m].
double half_opening() {
  const MapGate gate;
  return 0.5 * gate.side - gate.bar - PlanParams{}.body_radius;
}

LateralLoop lateral_loop(const LateralParams& params, const RollLag& lag) {
  return {.roll_command = [params](double y, double v_y) { return lateral_roll(y, v_y, params); },
          .lag = lag};
}

/// ω_n² and 2 ζ ω_n as INDI's gains have them.
RollLag lag_of(double attitude_gain, double rate_gain) {
  const double omega = std::sqrt(attitude_gain);
  return {.omega = omega, .zeta = 0.5 * rate_gain / omega};
}

double printed_roll(double y, double v_y) {
  constexpr double kP = 1.0, kV = 2.0;  // [Li18 §4]
  return gatefly::atan(kV * (kP * (0.0 - y) - v_y) / kGravity);
}

/// How far ahead of the gate the starts with one lateral error must be [m].
double distance_needed(const FeasibleSet& set, double error, double speed, double opening) {
  return speed * set.time_needed(error, opening);
}

/// Part of the 10,000 starts that come through.
double share(const FeasibleSet& set, double speed, double opening) {
  std::size_t passed = 0;
  const auto place = [](std::size_t i) { return static_cast<double>(i) / (kAcross - 1.0); };
  for (std::size_t i = 0; i < kAcross; ++i)
    for (std::size_t j = 0; j < kAcross; ++j) {
      const double distance = kFarthest * place(i), y0 = kWidest * (2.0 * place(j) - 1.0);
      passed += std::abs(set.offset(distance / speed, y0)) <= opening;
    }
  return static_cast<double>(passed) / static_cast<double>(kAcross * kAcross);
}

/// The nearest start that overshoots the opening, from whatever distance [m]; NaN: none does.
double least_overshot(const FeasibleSet& set, double opening) {
  double least = std::numeric_limits<double>::quiet_NaN();
  for (double time = 0.0; time <= kFarthest / kSpeeds[0]; time += 0.01)
    for (const FeasibleSet::Edge& edge : set.edges(time, opening))
      if (edge.overshot) least = std::fmin(least, edge.y0);
  return least;
}

/// The edges of the set over x0.
struct Outline {
  std::vector<Eigen::Vector2d> inner;     ///< Up to where everything passes.
  std::vector<Eigen::Vector2d> late;      ///< Beyond: met the bar of this side.
  std::vector<Eigen::Vector2d> overshot;  ///< Around those that met the other side's.
};

Outline outline(const FeasibleSet& set, double speed, double opening) {
  Outline outline;
  std::vector<Eigen::Vector2d> again;
  const int count = static_cast<int>(std::lround(kFarthest / kCurveStep));
  for (int i = 0; i <= count; ++i) {
    const double distance = kCurveStep * i, time = distance / speed;
    outline.inner.emplace_back(-distance, set.boundary(time, opening));
    std::size_t of_overshoot = 0;
    for (const FeasibleSet::Edge& edge : set.edges(time, opening))
      (!edge.overshot        ? outline.late
       : of_overshoot++ == 0 ? outline.overshot
                             : again)
          .emplace_back(-distance, edge.y0);
  }
  // once round: along its lower edge, back along its upper one
  std::reverse(outline.overshot.begin(), outline.overshot.end());
  outline.overshot.insert(outline.overshot.end(), again.begin(), again.end());
  return outline;
}

// ---------------------------------------------------------------- report

drawing::Color color_of(const LateralLaw& law) {
  return law.key == "printed" ? drawing::kLight.gate_solid
         : law.key == "ours"  ? drawing::kLight.flown
                              : drawing::kLight.found;
}

std::vector<Eigen::Vector2d> mirrored(std::vector<Eigen::Vector2d> points) {
  for (Eigen::Vector2d& p : points) p.y() = -p.y();
  return points;
}

drawing::Plot panel(const std::vector<LateralLaw>& laws, const std::vector<FeasibleSet>& sets,
                    double speed) {
  drawing::Plot plot{.title = "From where a gate is passed, " + fixed(speed, 1) + " m/s",
                     .x_label = "x₀ [m], gate at 0",
                     .y_label = "y₀ [m]"};
  std::vector<Eigen::Vector2d> area = outline(sets.back(), speed, half_opening()).inner;
  const std::vector<Eigen::Vector2d> below = mirrored(area);
  area.insert(area.end(), below.rbegin(), below.rend());
  plot.series.push_back({.name = "ours passes",
                         .points = area,
                         .color = drawing::kLight.flown.faded(0.15),
                         .area = true});
  for (const double opening : {half_opening(), kPaperOpening})
    for (std::size_t i = 0; i < laws.size(); ++i) {
      if (laws[i].key == "flown_no_lag") continue;  // in the CSV
      const bool is_paper = opening == kPaperOpening;
      const auto add = [&](const std::string& name, std::vector<Eigen::Vector2d> points) {
        plot.series.push_back({.name = is_paper ? "" : name,
                               .points = std::move(points),
                               .color = color_of(laws[i]),
                               .marks = false,
                               .dash = is_paper ? 4.0 : 0.0});
      };
      const Outline edges = outline(sets[i], speed, opening);
      if (!is_paper && !edges.overshot.empty())
        for (const bool right : {true, false})
          plot.series.push_back({.name = right ? laws[i].key + " overshoots" : "",
                                 .points = right ? edges.overshot : mirrored(edges.overshot),
                                 .color = color_of(laws[i]).faded(0.2),
                                 .area = true});
      add(laws[i].name, edges.late), add("", mirrored(edges.late));
      add("", edges.overshot), add("", mirrored(edges.overshot));
    }
  plot.series.push_back({.name = "if |y| < 0.5 m will do",
                         .color = drawing::kLight.muted,
                         .marks = false,
                         .dash = 4.0});
  if (speed == kSpeeds[0])
    plot.series.push_back({.name = "paper: 2 m for 0.8 m",
                           .points = {{-2.0, 0.8}, {-2.0, -0.8}},
                           .color = drawing::kLight.ink,
                           .line = false,
                           .rings = true});
  const MapGate gate;
  const double middle = 0.5 * (gate.side - gate.bar);
  plot.series.push_back({.name = "bars",
                         .points = {{0.0, middle}, {0.0, -middle}},
                         .color = drawing::kLight.ink,
                         .line = false});
  return plot;
}

drawing::Canvas picture_of(const std::vector<LateralLaw>& laws,
                           const std::vector<FeasibleSet>& sets) {
  std::vector<drawing::Plot> panels;
  for (const double speed : kSpeeds) panels.push_back(panel(laws, sets, speed));
  return drawing::draw_sheet(panels, 2, drawing::kPlotHeight);
}

std::string csv_of(const LateralLaw& law, const FeasibleSet& set, double speed, double opening) {
  std::string csv;
  for (const Eigen::Vector2d& p : outline(set, speed, opening).inner) {
    std::string late, overshot;  // where there are such edges
    for (const FeasibleSet::Edge& edge : set.edges(-p.x() / speed, opening))
      (edge.overshot ? overshot : late) +=
          (edge.overshot && !overshot.empty() ? "," : "") + files::text_of(edge.y0, 5);
    const std::string lacking = overshot.find(',') == std::string::npos ? "," : "";
    csv += law.key + "," + files::text_of(speed) + "," + files::text_of(opening) + "," +
           files::text_of(p.x() + 0.0, 6) + "," + files::text_of(p.y(), 5) + "," + late + "," +
           overshot + lacking + "\n";
  }
  return csv;
}

/// A lateral error, where it comes from.
struct Error {
  double metres;
  const char* name;
};
// Li18 Table 2 by its erratum (docs/paper/deviations.md#table-2).
constexpr std::array<Error, 5> kErrors{{{0.256, "scatter of an arc"},
                                        {0.30, "scatter of its end"},
                                        {0.60, "twice that"},
                                        {0.67, "mean overshoot"},
                                        {0.80, "paper's table"}}};

}  // namespace

std::vector<LateralLaw> lateral_laws() {
  const LateralParams flown{.kp = 0.50, .kd = 0.20};  // [Li18 flight code, March 2018]
  const RollLag flown_lag = lag_of(200.0, 28.0);      // 14.1 rad/s, ζ 0.99 [Li18 flight code]
  const IndiParams indi;
  return {{"printed", "printed, no lag", {.roll_command = printed_roll}},
          {"flown", "flown, with lag", lateral_loop(flown, flown_lag)},
          {"flown_no_lag", "flown, no lag", lateral_loop(flown, {})},
          {"ours", "ours, with lag", lateral_loop({}, lag_of(indi.attitude_gain, indi.rate_gain))}};
}

std::vector<double> lateral_course(const LateralLoop& loop, double y0, double duration) {
  const auto samples = static_cast<std::size_t>(std::ceil(duration / kLateralStep)) + 1;
  std::vector<double> course;
  course.reserve(samples);
  LateralState x{y0, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < samples; ++i) {
    course.push_back(x[0]);
    // Runge and Kutta's classic step
    constexpr double h = kLateralStep;
    const LateralState k1 = derivative(loop, x), k2 = derivative(loop, x + 0.5 * h * k1),
                       k3 = derivative(loop, x + 0.5 * h * k2), k4 = derivative(loop, x + h * k3);
    x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return course;
}

FeasibleSet::FeasibleSet(const LateralLoop& loop, double widest, double duration)
    : widest_{widest} {
  const int count = static_cast<int>(std::ceil(widest / kStartStep));
  for (int i = 0; i <= count; ++i)
    courses_.push_back(lateral_course(loop, widest * i / count, duration));
}

double FeasibleSet::at(std::size_t course, double time) const {
  const std::vector<double>& y = courses_[course];
  const double place = std::clamp(time / kLateralStep, 0.0, static_cast<double>(y.size() - 1));
  const std::size_t i = std::min(static_cast<std::size_t>(place), y.size() - 2);
  return y[i] + (place - static_cast<double>(i)) * (y[i + 1] - y[i]);
}

double FeasibleSet::offset(double time, double y0) const {
  const double last = static_cast<double>(courses_.size() - 1);
  const double place = std::min(std::abs(y0) / widest_, 1.0) * last;
  const std::size_t i = std::min(static_cast<std::size_t>(place), courses_.size() - 2);
  const double part = place - static_cast<double>(i);
  return std::copysign(1.0, y0) * ((1.0 - part) * at(i, time) + part * at(i + 1, time));
}

std::vector<FeasibleSet::Edge> FeasibleSet::edges(double time, double half_opening) const {
  std::vector<Edge> edges;
  const double last = static_cast<double>(courses_.size() - 1);
  double before = at(0, time);
  for (std::size_t i = 1; i < courses_.size(); ++i) {
    const double here = at(i, time);
    for (const double bar : {-half_opening, half_opening})
      if ((before > bar) != (here > bar)) {
        const double place = static_cast<double>(i - 1) + (bar - before) / (here - before);
        edges.push_back({.y0 = widest_ * place / last, .overshot = bar < 0.0});
      }
    before = here;
  }
  return edges;
}

double FeasibleSet::boundary(double time, double half_opening) const {
  const std::vector<Edge> all = edges(time, half_opening);
  return all.empty() ? widest_ : all.front().y0;
}

double FeasibleSet::time_needed(double y0, double half_opening) const {
  const auto outside = [&](std::size_t i) {
    return std::abs(offset(kLateralStep * static_cast<double>(i), y0)) > half_opening;
  };
  const std::size_t samples = courses_[0].size();
  if (outside(samples - 1)) return std::numeric_limits<double>::quiet_NaN();
  std::size_t i = samples - 1;
  while (i > 0 && !outside(i - 1)) --i;
  return kLateralStep * static_cast<double>(i);
}

Result feasible_set(const Options& options) {
  const std::vector<LateralLaw> laws = lateral_laws();
  std::vector<FeasibleSet> sets;
  for (const LateralLaw& law : laws) {
    if (options.stopped()) throw Stopped{};
    options.progress(static_cast<double>(sets.size()) / static_cast<double>(laws.size()), law.name);
    sets.emplace_back(law.loop, kWidest, kFarthest / kSpeeds[0]);
  }
  const double ours = half_opening();
  Result result{.table = {{"laws", "k_p 1, k_v 2 (printed), PD (flown)",
                           "printed; flown, with lag (without); ours, with lag"}},
                .json = {{"half_opening_m", ours},
                         {"paper_half_opening_m", kPaperOpening},
                         {"k_y_1ps", LateralLoop{}.k_y},
                         {"starts", kAcross * kAcross}},
                .csv =
                    "law,speed_mps,half_opening_m,x0_m,max_y0_m,late_from_m,overshoot_from_m,"
                    "overshoot_to_m\n",
                .picture = picture_of(laws, sets)};
  result.table.push_back(
      {"printed law as an angle, at 0.8 m", "φ = 1.6 rad", "92°: beyond 90° tan φ pushes away"});
  const auto joined = [&](const auto& value, const std::string& unit) {
    return value(0) + ", " + value(1) + " (" + value(2) + "), " + value(3) + " " + unit;
  };
  constexpr double kPaperError = 0.80, kPaperMargin = 2.0;  // [m] [Li18 §4]
  result.table.push_back(
      {"0.8 m beside, 2 m ahead at 1.5 m/s: |y| in the gate", "passes safely",
       joined(
           [&](std::size_t i) {
             return fixed(std::abs(sets[i].offset(kPaperMargin / kSpeeds[0], kPaperError)), 2);
           },
           "m; open: " + fixed(ours, 2) + " m")});
  const FeasibleSet no_drag({.roll_command = printed_roll, .k_y = 0.0}, kWidest,
                            kFarthest / kSpeeds[0]);
  const double without_drag = distance_needed(no_drag, kPaperError, kSpeeds[0], ours);
  result.table.push_back({"distance for 0.8 m, 1.5 m/s, printed law without drag", "2 m",
                          fixed(without_drag, 2) + " m"});
  result.json["printed_without_drag_m"] = without_drag;
  const auto overshoot = [&](std::size_t i) {
    const double widest = least_overshot(sets[i], ours);
    return std::isfinite(widest) ? fixed(widest, 2) : std::string{"none"};
  };
  result.table.push_back(
      {"least y0 that meets the bar on the other side, any speed", "-", joined(overshoot, "m")});
  auto needed = nlohmann::ordered_json::array(), shares = nlohmann::ordered_json::array();
  for (const double opening : {ours, kPaperOpening})
    for (const double speed : kSpeeds) {
      const std::string where = fixed(speed, 1) + " m/s, |y| < " + fixed(opening, 2) + " m";
      for (const Error& error : kErrors) {
        auto json = nlohmann::ordered_json::object();
        for (std::size_t i = 0; i < laws.size(); ++i)
          json[laws[i].key] = number(distance_needed(sets[i], error.metres, speed, opening));
        needed.push_back({{"error_m", error.metres},
                          {"is", error.name},
                          {"speed_mps", speed},
                          {"half_opening_m", opening},
                          {"distance_m", json}});
        if (error.metres <= opening) continue;
        result.table.push_back(
            {"distance for " + files::text_of(error.metres) + " m (" + error.name + "), " + where,
             error.metres == 0.80 && speed == kSpeeds[0] ? "2 m" : "-",
             joined(
                 [&](std::size_t i) {
                   return fixed(distance_needed(sets[i], error.metres, speed, opening), 2);
                 },
                 "m")});
      }
      auto json = nlohmann::ordered_json::object();
      for (std::size_t i = 0; i < laws.size(); ++i)
        json[laws[i].key] = share(sets[i], speed, opening);
      shares.push_back({{"speed_mps", speed}, {"half_opening_m", opening}, {"share", json}});
      result.table.push_back(
          {"part of 10,000 starts that pass, " + where,
           speed == kSpeeds[0] ? "-" : "fewer than at 1.5 m/s",
           joined([&](std::size_t i) { return fixed(100.0 * share(sets[i], speed, opening), 1); },
                  "%")});
      for (std::size_t i = 0; i < laws.size(); ++i)
        result.csv += csv_of(laws[i], sets[i], speed, opening);
    }
  result.json["distance_needed"] = needed, result.json["passing"] = shares;
  for (std::size_t i = 0; i < laws.size(); ++i)
    result.json["laws"].push_back({{"key", laws[i].key},
                                   {"name", laws[i].name},
                                   {"lag_omega_radps", laws[i].loop.lag.omega},
                                   {"lag_zeta", laws[i].loop.lag.zeta},
                                   {"least_overshot_m", number(least_overshot(sets[i], ours))}});
  return result;
}

}  // namespace gatefly::experiments
