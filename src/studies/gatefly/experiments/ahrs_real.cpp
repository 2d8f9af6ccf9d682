// SPDX-License-Identifier: Apache-2.0
// Our AHRS, as flown, beside a plain Mahony filter: hand-held with a true attitude, in turns, on
// real flights.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/experiments/attitude_errors.hpp"
#include "gatefly/experiments/attitude_trial.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/flown_attitude.hpp"
#include "gatefly/experiments/held_attitude.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/baseline/mahony.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/tasks/identification/drag_fit.hpp"

namespace gatefly::experiments {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double kLeastFlight = 3.0;  // to be scored [s]

std::string degrees(double value) { return files::text_of(value, 3) + "°"; }

struct Turns {
  AttitudeErrors ours, mahony;  ///< Errors of roll while turning.
  AttitudeTrace trace{"Coordinated turns, r 1.5 m, 1.6 m/s, seed 1", "roll error [°]"};
};

Turns turns(const TurnCourse& course, int seeds) {
  Turns result;
  for (int seed = 1; seed <= seeds; ++seed) {
    Navigator ours{{}};
    baseline::Mahony mahony;
    double t = 0.0, next = 0.0;
    for (const Moment& moment : coordinated_turns(course, static_cast<std::uint64_t>(seed))) {
      if (t == 0.0) ours.start({0, 0, moment.z}, 0.0);
      t += moment.dt;
      if (moment.rests)
        ours.rest(moment.imu, t);
      else
        ours.predict(moment.imu, t);
      if (t >= next) ours.correct_height(-moment.z, kTrialAltitudeSigma), next = t + kCorrections;
      mahony.update(moment.imu, moment.dt);
      const double e = ours.ahrs().attitude().roll - moment.truth.roll,
                   m = mahony.attitude().roll - moment.truth.roll;
      if (moment.turns) result.ours.add(e, ours.ahrs().tilt_sigma()), result.mahony.add(m, 0.0);
      if (seed == 1) result.trace.add(t, e, m);
    }
  }
  return result;
}

struct Report {
  Result result{.table = {},
                .json = {},
                .csv = "kind,name,ours_rms_deg,mahony_rms_deg,authors_rms_deg,ours_claimed_deg\n",
                .picture = drawing::Canvas(1, 1)};
  std::vector<drawing::Plot> plots;

  void row(const std::string& kind, const std::string& name, double ours, double mahony,
           const std::string& authors, const std::string& claimed) {
    result.csv += kind + "," + name + "," + files::text_of(ours, 4) + "," +
                  files::text_of(mahony, 4) + "," + authors + "," + claimed + "\n";
    result.table.push_back({name, "",
                            degrees(ours) + " (Mahony " + degrees(mahony) +
                                (authors.empty() ? "" : ", autopilot " + authors + "°") + ")"});
  }
};

void add_held(Report& report, const fs::path& folder, const Options& options) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  if (files.empty()) throw std::runtime_error(folder.string() + ": there is no CSV file in it");
  std::sort(files.begin(), files.end());
  auto& json = report.result.json["broad"] = ordered_json::object();
  for (const fs::path& file : files) {
    if (options.stopped()) throw Stopped{};
    options.progress(0.1, file.stem().string());
    const HeldErrors c = held_attitude(file);
    json[file.stem().string()] = {{"inclination_rmse_deg", c.ours.rms_deg()},
                                  {"mahony_rmse_deg", c.mahony.rms_deg()},
                                  {"max_deg", c.ours.most / kDegree},
                                  {"claimed_rms_deg", c.ours.claimed_deg()},
                                  {"within_95", static_cast<double>(c.ours.within) / c.ours.n}};
    report.row("broad", file.stem().string(), c.ours.rms_deg(), c.mahony.rms_deg(), "",
               files::text_of(c.ours.claimed_deg(), 4));
    report.plots.push_back(c.trace.plot);
  }
}

void add_turns(Report& report, const Options& options) {
  const int seeds = options.quick ? 4 : 20;
  auto& json = report.result.json["turns"] = {
      {"radius_m", TurnCourse{}.radius}, {"speed_mps", TurnCourse{}.speed}, {"seeds", seeds}};
  for (const int in_a_row : {1, 4}) {
    if (options.stopped()) throw Stopped{};
    options.progress(0.4, "turns");
    const Turns t = turns({.turns = in_a_row, .level = "race"}, seeds);
    const std::string name = in_a_row == 1 ? "one" : "four";
    const double claimed = t.ours.claimed_deg() / std::sqrt(2.0);
    json[name] = {{"roll_rmse_deg", t.ours.rms_deg()},
                  {"roll_max_deg", t.ours.most / kDegree},
                  {"mahony_rmse_deg", t.mahony.rms_deg()},
                  {"mahony_max_deg", t.mahony.most / kDegree},
                  {"claimed_deg", claimed}};
    report.row("turns", "roll, " + name + " of 180°, " + std::to_string(seeds) + " seeds",
               t.ours.rms_deg(), t.mahony.rms_deg(), "", files::text_of(claimed, 4));
    report.result.table.push_back(
        {"  at most", "",
         degrees(t.ours.most / kDegree) + " (Mahony " + degrees(t.mahony.most / kDegree) + ")"});
    if (in_a_row == 4) report.plots.push_back(t.trace.plot);
  }
}

void add_flights(Report& report, const fs::path& folder, const Options& options) {
  std::vector<fs::path> flights;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && entry.path().filename().string().starts_with("flight_"))
      flights.push_back(entry.path());
  if (flights.empty())
    throw std::runtime_error(folder.string() + ": there is no folder flight_* in it");
  std::sort(flights.begin(), flights.end());
  auto& json = report.result.json["flights"] = ordered_json::object();
  drawing::Plot plot{.title = "Real flights: roll and pitch, RMS",
                     .x_label = "number of the flight",
                     .y_label = "difference to motion capture [°]"};
  plot.series = {{.name = "Mahony, Kp 0.5", .color = drawing::kLight.gate_solid, .line = false},
                 {.name = "ours, as flown", .line = false},
                 {.name = "the Bebop's autopilot",
                  .color = drawing::kLight.flown,
                  .line = false,
                  .rings = true}};
  for (std::size_t i = 0; i < flights.size(); ++i) {
    if (options.stopped()) throw Stopped{};
    const std::string name = flights[i].filename().string();
    options.progress(0.5 + 0.5 * static_cast<double>(i) / static_cast<double>(flights.size()),
                     name);
    const flight_log::FlightFolder flight = flight_log::read_flight_folder(flights[i]);
    const auto fit = identification::fit_drag(flight);
    if (!fit) continue;
    const FlownAttitude f = flown_attitude(name, flight, fit->heading_offset);
    if (static_cast<double>(f.ours.all.size()) < 512.0 * kLeastFlight) continue;
    const auto told = [](const AttitudeDifferences& d) {
      return ordered_json{{"rms_deg", d.rms_deg()},
                          {"offset_deg", {d.offset().x() / kDegree, d.offset().y() / kDegree}}};
    };
    json[name] = {{"ours", told(f.ours)},
                  {"mahony", told(f.mahony)},
                  {"autopilot", told(f.authors)},
                  {"reference_sigma_deg", f.reference_sigma_deg}};
    report.row("flight", name, f.ours.rms_deg(), f.mahony.rms_deg(),
               files::text_of(f.authors.rms_deg(), 3), "");
    const double number = std::stod("0" + name.substr(std::string("flight_").size()));
    plot.series[0].points.emplace_back(number, f.mahony.rms_deg()),
        plot.series[1].points.emplace_back(number, f.ours.rms_deg());
    plot.series[2].points.emplace_back(number, f.authors.rms_deg());
    if (report.plots.size() == 4) report.plots.push_back(f.trace.plot);
  }
  report.plots.push_back(plot);
}

}  // namespace

Result ahrs_real(const Options& options) {
  const fs::path held_folder = data_folder("broad_ahrs", options),
                 flights = data_folder("tudelft_bebop_flights", options);
  Report report;
  add_held(report, held_folder, options);
  add_turns(report, options);
  add_flights(report, flights, options);
  report.result.picture = drawing::draw_sheet(report.plots, 2);
  return std::move(report.result);
}

}  // namespace gatefly::experiments
