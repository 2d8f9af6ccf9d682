// SPDX-License-Identifier: Apache-2.0
// Where blind half circles end: the paper's, those in recorded takes, and simulated ones. Li18 §4,
// Fig. "feed forward control", Table "accuracy distribution".
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "gatefly/experiments/arc_ablation.hpp"
#include "gatefly/experiments/arc_picture.hpp"
#include "gatefly/experiments/arc_table.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/recorded_arcs.hpp"
#include "gatefly/experiments/simulated_arcs.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

constexpr PlannedArc kPlanned;
const Eigen::Vector2d kPlannedEnd{0.0, 2.0 * kPlanned.radius};
constexpr int kFlights = 10, kAblationFlights = 4, kLaps = 5, kQuickLaps = 3;  // 9 and 5 arcs
constexpr std::uint64_t kFirstSeed = 2201;

/// Facts about the paper's arcs: read off its figure, checked against its table
/// (docs/paper/deviations.md#table-2) [m].
struct PaperArcs {
  std::size_t count = 17;
  Eigen::Vector2d mean{-0.33, 3.67}, variance{0.0251, 0.0657};
  Eigen::Vector2d entry_deviation{0.123, 0.078}, exit_deviation{0.201, 0.299};
  Eigen::Vector2d printed_variance{0.0296, 0.8087};  ///< Its table's "position error variance".

  [[nodiscard]] Eigen::Vector2d from_plan() const {
    return ((mean - kPlannedEnd).array().square() + variance.array()).sqrt();
  }
};

/// Root mean square along each axis; NaN of none [m].
Eigen::Vector2d rms_of(const std::vector<Eigen::Vector2d>& offs) {
  Eigen::Array2d squares = Eigen::Array2d::Zero();
  for (const Eigen::Vector2d& off : offs) squares += off.array().square();
  return (squares / static_cast<double>(offs.size())).sqrt();
}

/// How far arcs end from where they are planned to, RMS [m].
Eigen::Vector2d from_plan(const std::vector<BlindArc>& arcs) {
  std::vector<Eigen::Vector2d> offs;
  for (const BlindArc& arc : arcs) offs.emplace_back(arc.displacement() - kPlannedEnd);
  return rms_of(offs);
}

void report_paper(const PaperArcs& paper, Result& result) {
  Eigen::Vector2d with;
  for (int axis = 0; axis < 2; ++axis)
    with[axis] = variance_with_zero_row(paper.count, paper.mean[axis], paper.variance[axis]);
  result.table.push_back(
      {"variance of y, with a row of zeros left in [m²]", fixed(paper.printed_variance.y(), 4),
       fixed(with.y(), 4) + " from the paper's 17 arcs (x: " +
           fixed(paper.printed_variance.x(), 4) + ", " + fixed(with.x(), 4) + ")"});
  result.table.push_back({"  and without it", "",
                          fixed(paper.variance.y(), 4) + " m²: std " +
                              fixed(std::sqrt(paper.variance.y()), 2) + " m about " +
                              fixed(paper.mean.y(), 2) + " m"});
  result.json["paper"] = {{"arcs", paper.count},
                          {"displacement_m", json_of(paper.mean)},
                          {"variance_m2", json_of(paper.variance)},
                          {"printed_variance_m2", json_of(paper.printed_variance)},
                          {"variance_with_zero_row_m2", json_of(with)},
                          {"entry_std_m", json_of(paper.entry_deviation)},
                          {"exit_std_m", json_of(paper.exit_deviation)}};
}

/// A line for each quantity, all sources beside each other.
void report_quantities(const std::vector<ArcSource>& sources, const PaperArcs& paper,
                       Result& result) {
  const auto line_of = [&](const auto& text) {
    std::string line;
    for (const ArcSource& source : sources)
      if (!source.arcs.empty())
        line += (line.empty() ? "" : "; ") + source.name + " " + text(source);
    return line;
  };
  result.table.push_back(
      {"arcs", "17", line_of([](const ArcSource& s) { return std::to_string(s.arcs.size()); })});
  for (const ArcQuantity& quantity : arc_quantities())
    if (*quantity.name != '\0')
      result.table.push_back({quantity.name, quantity.paper, line_of([&](const ArcSource& s) {
                                return text_of(spread_of(s.arcs, quantity.of));
                              })});
  result.table.push_back({"from the planned end, RMS, x, y [m]", text_of(paper.from_plan()),
                          line_of([](const ArcSource& s) { return text_of(from_plan(s.arcs)); })});
  for (const int axis : {0, 1})
    result.table.push_back({axis == 0 ? "x beyond 0: by 3° left, late nose, speed, slip [m]"
                                      : "y beyond 3: by 3° left, late nose, speed, slip [m]",
                            "-",
                            line_of([&](const ArcSource& s) { return parts_text(s.arcs, axis); })});
  result.json["sources"] = nlohmann::ordered_json::object();
  for (const ArcSource& source : sources) {
    auto& told = result.json["sources"][source.name];
    told["arcs"] = source.arcs.size();
    told["from_plan_rms_m"] = json_of(from_plan(source.arcs));
    for (const ArcQuantity& quantity : arc_quantities())
      told[quantity.key] = json_of(spread_of(source.arcs, quantity.of));
  }
}

/// Quantities of an arc that a simulator tells and a recording cannot.
struct Inside {
  FlightSpread displacement, entry, exit;
  Spread1 speed_error;    ///< Predicted at the entry - true [m/s].
  Spread1 blind;          ///< From the arc's end to the next gate's first sighting [s].
  Spread2 before, after;  ///< The estimate's error then, and half a second later.
};

Inside inside_of(const std::vector<BlindArc>& arcs) {
  std::vector<double> speeds, blind;
  std::vector<FlightPoint> displacements, entries, exits;
  std::vector<Eigen::Vector2d> before, after;
  for (const BlindArc& arc : arcs) {
    displacements.push_back({arc.flight, arc.displacement()});
    if (!arc.detail) continue;
    const SimulatedDetail& d = *arc.detail;
    speeds.push_back(d.predicted_speed - arc.entry_speed());
    entries.push_back({arc.flight, d.entry_at_gate});
    exits.push_back({arc.flight, d.exit_at_gate});
    if (!d.error_before.allFinite() || !d.error_after.allFinite()) continue;
    blind.push_back(d.blind), before.push_back(d.error_before), after.push_back(d.error_after);
  }
  return {flight_spread(displacements),
          flight_spread(entries),
          flight_spread(exits),
          spread_of(speeds),
          spread_of(blind),
          spread_of(before),
          spread_of(after)};
}

void report_inside(const std::string& name, const SimulatedArcs& flown, const PaperArcs& paper,
                   Result& result) {
  std::string ends;
  auto reasons = nlohmann::ordered_json::object();
  for (const auto& [reason, count] : flown.ends) {
    ends += (ends.empty() ? "" : ", ") + std::to_string(count) + " " + reason;
    reasons[reason] = count;
  }
  const Inside in = inside_of(flown.arcs);
  const Eigen::Vector2d by_pilot = ends_of(flown.by_pilot).mean - ends_of(flown.arcs).mean;
  const auto row = [&](const char* what, const std::string& theirs, const std::string& ours) {
    result.table.push_back({what, theirs, ours});
  };
  const auto cloud = [](const Spread2& s) {
    return text_of(s.mean) + " ± " + text_of(s.deviation());
  };
  result.table.push_back({name + ": flights", "",
                          ends + "; " + std::to_string(flown.left_out.size()) + " other turns"});
  // The paper's 17 arcs are one flight's.
  row("  σ of the displacement within a flight, x, y [m]", text_of(paper.variance.cwiseSqrt()),
      text_of(in.displacement.within));
  row("    of the flights' means", "", text_of(in.displacement.between));
  row("  σ of the entry points within a flight [m]", text_of(paper.entry_deviation),
      text_of(in.entry.within));
  row("  σ of the exit points [m]", text_of(paper.exit_deviation), text_of(in.exit.within));
  row("  predicted speed at the entry - true [m/s]", "", text_of(in.speed_error));
  row("  estimate - truth when a gate is seen again [m]", "",
      cloud(in.before) + ", " + text_of(in.blind) + " s after the arc");
  row("    0.5 s later", "", cloud(in.after));
  row("  from switch to switch of the pilot, not by the nose", "",
      "mean moves by " + text_of(by_pilot) + " m");
  result.json["simulated"][name] = {{"flights", reasons},
                                    {"left_out", flown.left_out.size()},
                                    {"std_within_flights_m", json_of(in.displacement.within)},
                                    {"std_between_flights_m", json_of(in.displacement.between)},
                                    {"entry_std_within_flights_m", json_of(in.entry.within)},
                                    {"exit_std_within_flights_m", json_of(in.exit.within)},
                                    {"predicted_minus_true_speed_mps", json_of(in.speed_error)},
                                    {"error_before_m", json_of(in.before.mean)},
                                    {"error_before_std_m", json_of(in.before.deviation())},
                                    {"error_after_m", json_of(in.after.mean)},
                                    {"error_after_std_m", json_of(in.after.deviation())},
                                    {"blind_after_arc_s", json_of(in.blind)},
                                    {"by_pilot_moves_m", json_of(by_pilot)}};
}

/// Where turns end beside where the pilot's plan has it: also of a pilot whose nose does not follow the way.
void report_off_plan(const std::string& name, const SimulatedArcs& flown, Result& result) {
  const Eigen::Vector2d rms = rms_of(flown.off_plan);
  int finished = 0, flights = 0;
  for (const auto& [reason, count] : flown.ends)
    flights += count, finished += reason == "finished" ? count : 0;
  const std::string turns = std::to_string(flown.off_plan.size());
  result.table.push_back({name + ": turns, seconds since the gate", "",
                          turns + ", " + text_of(spread_of(flown.blind)) + "; " +
                              std::to_string(finished) + " of " + std::to_string(flights) +
                              " flights finish"});
  result.table.push_back({"  off the plan where they end, RMS, ahead, right, one axis [m]", "",
                          text_of(rms) + ", " + fixed(std::sqrt(0.5 * rms.squaredNorm()), 2)});
  result.json["off_plan"][name] = {{"turns", flown.off_plan.size()},
                                   {"flights", flights},
                                   {"finished", finished},
                                   {"rms_m", json_of(rms)}};
}

/// The columns that only simulated arcs have.
std::string detail_of(const BlindArc& arc) {
  if (!arc.detail) return ",,,,,,,,,,";
  const SimulatedDetail& d = *arc.detail;
  std::string cells = "," + files::text_of(d.predicted_speed, 5);
  for (const Eigen::Vector2d& p : {d.entry_at_gate, d.exit_at_gate, d.error_before, d.error_after})
    for (const double v : p) cells += std::isfinite(v) ? "," + files::text_of(v, 5) : ",";
  return cells + (std::isfinite(d.blind) ? "," + files::text_of(d.blind, 4) : ",");
}

std::string csv_of(const std::vector<ArcSource>& sources) {
  std::string csv = "source,flight,turn,heading_deg,begin_s,entry_slip_deg,mean_climb_m";
  for (const ArcQuantity& quantity : arc_quantities()) csv += std::string{","} + quantity.key;
  csv +=
      ",predicted_speed_mps,entry_x_m,entry_y_m,exit_x_m,exit_y_m,error_before_x_m,error_before_y_"
      "m,"
      "error_after_x_m,error_after_y_m,blind_after_arc_s\n";
  for (const ArcSource& source : sources)
    for (const BlindArc& arc : source.arcs) {
      csv += source.name + "," + arc.flight + "," + (arc.right ? "right" : "left");
      for (const double v : {wrap_angle(arc.heading) / kDegree, arc.begin,
                             arc.entry_slip() / kDegree, arc.mean_climb})
        csv += "," + files::text_of(v, 6);
      for (const ArcQuantity& quantity : arc_quantities())
        csv += "," + files::text_of(quantity.of(arc), 5);
      csv += detail_of(arc) + "\n";
    }
  return csv;
}

}  // namespace

Result arc_accuracy(const Options& options) {
  if (options.stopped()) throw Stopped{};
  const PaperArcs paper;
  const RecordedArcs takes = recorded_arcs(options);
  const std::uint64_t first = first_seed(options, kFirstSeed, kFirstSeed);
  const auto flown = [&](const char* level, const char* config = "li18") {
    return simulated_arcs({.level = level,
                           .config = config,
                           .flights = options.quick ? 1 : kFlights,
                           .laps = options.quick ? kQuickLaps : kLaps,
                           .first_seed = first},
                          options);
  };
  const SimulatedArcs none = flown("none"), race = flown("race");
  const SimulatedArcs ours = flown("race", "default");
  const std::vector<ArcSource> sources{
      {.name = "recorded", .color = drawing::kLight.found, .arcs = takes.arcs(), .told = {}},
      {.name = "simulated none", .color = drawing::kLight.flown, .arcs = none.arcs, .told = {}},
      {.name = "simulated race", .color = drawing::kLight.estimate, .arcs = race.arcs, .told = {}}};
  std::vector<ArcSource> drawn{sources.rbegin(), sources.rend()};  // the few above the many
  drawn.push_back(
      {.name = "paper (17 arcs: mean and σ)",
       .color = drawing::kLight.gate_solid,
       .arcs = {},
       .told = Spread2{
           .count = paper.count, .mean = paper.mean, .covariance = paper.variance.asDiagonal()}});

  Result result{.table = {},
                .json = {},
                .csv = csv_of(sources),
                .picture = picture_of(drawn, sources.front(), kPlanned)};
  report_quantities(sources, paper, result);
  report_paper(paper, result);
  report_inside("simulated none", none, paper, result);
  report_inside("simulated race", race, paper, result);
  report_off_plan("simulated race", race, result);
  report_off_plan("ours race, shown no gate until the turn ends", ours, result);
  const ArcFlightCount again{.flights = options.quick ? 1 : kAblationFlights,
                             .laps = options.quick ? kQuickLaps : kLaps,
                             .first_seed = first};
  report_ablation(none.arcs, again, options, result);
  report_takes(takes, result);
  report_rules(takes, result);
  return result;
}

}  // namespace gatefly::experiments
