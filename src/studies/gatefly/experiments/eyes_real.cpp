// SPDX-License-Identifier: Apache-2.0
// Real flights through the pilot: IMU, pictures and a height in, position out, beside motion
// capture. Li18 §3.3, Fig. "EKF result".
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

#include "gatefly/config/config.hpp"
#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/located_flights.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/recording.hpp"
#include "gatefly/flight_log/replay.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

namespace fs = std::filesystem;
using flight_log::Estimator;
using flight_log::FrameErrors;
using flight_log::ReplayResult;

constexpr double kInTheAir = 0.5;  // [m]

struct Replayed {
  FrameErrors errors;
  std::vector<double> t;
  std::vector<Eigen::Vector3d> truth, estimate, fixes;  ///< In the gate's frame.
  int pictures = 0;                                     ///< That corrected the filter.
  double next_nees = 0.0;                               ///< [s]
};

void add(Replayed& out, const flight_log::EstimateRow& row, const Eigen::Vector3d& estimate,
         const Eigen::Vector3d& truth, bool knows) {
  constexpr double kPeriod = 0.05;  // of NEES, as campaigns count [s]
  const Eigen::Vector3d error = estimate - truth;
  out.errors.add(error);
  if (knows && row.t >= out.next_nees) {
    out.next_nees = row.t + kPeriod;
    out.errors.nees.add(error.dot(row.estimate.covariance_GB.ldlt().solve(error)), 3);
  }
  out.t.push_back(row.t), out.truth.push_back(truth), out.estimate.push_back(estimate);
}

/// From the first picture in the air that corrected the filter until the drone is in the gate's
/// plane. The filter of kOurs from the gate as it has found it, the others from where the map has it.
Replayed replayed(const Flight& flight, const std::vector<flight_log::RecordedTick>& ticks,
                  const PilotConfig& pilot, const Airframe& airframe, const config::Config& config,
                  Estimator estimator) {
  const auto load =
      flight_log::upright(flight_log::pictures_in_files(flight.folder, config.camera.stored_width(),
                                                        config.camera.stored_height()),
                          config.camera.stored_rotation_deg);
  const ReplayResult result = flight_log::replay(pilot, ticks, load, estimator);
  if (!result.finite)
    throw std::runtime_error(flight.folder.directory.string() +
                             ": an estimate is not a finite number");
  const MapGate& gate = pilot.track.gates.front();
  const auto in_gate = [&](const Eigen::Vector3d& p_E) {
    return Eigen::Vector3d{rotation_z(-gate.yaw_EG) * (p_E - gate.p_EG)};
  };
  Replayed out;
  double end = 1e9, begin = 1e9;
  for (const auto& row : result.pictures) {
    const Eigen::Vector3d truth = flight.motion.position(row.t + airframe.mocap_delay);
    if (!row.sighting.fix || truth.z() > -kInTheAir || in_gate(truth).x() > 0.0) continue;
    begin = std::min(begin, row.t), ++out.pictures;
    out.fixes.push_back(in_gate(row.sighting.fix->p_EB));
  }
  for (const auto& row : result.estimates) {
    if (row.t < begin || row.t > end) continue;
    const Eigen::Vector3d truth = in_gate(flight.motion.position(row.t + airframe.mocap_delay));
    if (truth.x() > 0.0) end = row.t;
    const bool ours = estimator == Estimator::kEskf;
    add(out, row, ours ? row.estimate.p_GB : in_gate(row.estimate.p_EB), truth, ours);
  }
  return out;
}

std::string x_and_y(const Eigen::Vector3d& v) { return fixed(v.x(), 3) + ", " + fixed(v.y(), 3); }

nlohmann::ordered_json json_of(const FrameErrors& e) {
  const Eigen::Vector3d rms = e.rms(), std = e.deviation();
  return {{"x_rms_m", number(rms.x())}, {"y_rms_m", number(rms.y())}, {"z_rms_m", number(rms.z())},
          {"x_std_m", number(std.x())}, {"y_std_m", number(std.y())}, {"samples", e.samples}};
}

drawing::PlotSeries top_down(const std::string& name, const std::vector<Eigen::Vector3d>& points,
                             const drawing::Color& color, bool line) {
  drawing::PlotSeries series{
      .name = name, .points = {}, .color = color, .line = line, .rings = !line, .marks = !line};
  for (std::size_t i = 0; i < points.size(); i += line ? 60 : 1)
    series.points.emplace_back(points[i].x(), points[i].y());
  return series;
}

struct Shown {
  std::string name;
  Replayed drag, imu15, unfitted;
};

/// "0.97, 95 %": NEES/3 and how many are inside their 95 % bounds.
std::string consistent(const FrameErrors& e) {
  if (e.nees.samples == 0) return "-";
  return fixed(e.nees.sum_per_dof / e.nees.samples, 2) + ", " +
         fixed(100.0 * e.nees.inside / e.nees.samples, 0) + " %";
}

nlohmann::ordered_json with_nees(nlohmann::ordered_json json, const FrameErrors& e) {
  if (e.nees.samples == 0) return json;
  json["nees_per_dof"] = e.nees.sum_per_dof / e.nees.samples;
  json["nees_inside"] = static_cast<double>(e.nees.inside) / e.nees.samples;
  return json;
}

drawing::Canvas panels_of(const std::vector<Shown>& shown) {
  std::vector<drawing::Plot> plots;
  drawing::Plot errors_x{.title = "Error of x, through the gate; each flight",
                         .x_label = "time before the gate [s]",
                         .y_label = "error [m]",
                         .y_from_0 = false};
  drawing::Plot errors_y = errors_x;
  errors_y.title = "Error of y, to the right; each flight";
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const Replayed& r = shown[i].drag;
    plots.push_back(drawing::Plot{
        .title = shown[i].name + ": RMS " + x_and_y(r.errors.rms()) + " m",
        .x_label = "x before the gate [m]",
        .y_label = "y to the right [m]",
        .series = {top_down("truth", r.truth, drawing::kLight.ink, true),
                   top_down("fixes", r.fixes, drawing::kLight.muted, false),
                   top_down("15 states", shown[i].imu15.estimate, drawing::kLight.gate_solid, true),
                   top_down("ours", r.estimate, drawing::kLight.found, true)},
        .y_from_0 = false});
    for (const auto& [replay, color] : {std::pair{&shown[i].imu15, drawing::kLight.gate_solid},
                                        std::pair{&shown[i].drag, drawing::kLight.found}}) {
      drawing::PlotSeries x{.name = i > 0          ? ""
                                    : replay == &r ? "ours"
                                                   : "15 states",
                            .color = color},
          y = x;
      for (std::size_t k = 0; k < replay->t.size(); k += 100) {
        const Eigen::Vector3d error = replay->estimate[k] - replay->truth[k];
        x.points.emplace_back(replay->t[k] - replay->t.back(), error.x()),
            y.points.emplace_back(replay->t[k] - replay->t.back(), error.y());
      }
      errors_x.series.push_back(x), errors_y.series.push_back(y);
    }
  }
  // The errors in rows of their own, below.
  const drawing::Canvas flights = drawing::draw_sheet(plots, 2, 320),
                        errors = drawing::draw_sheet(std::array{errors_x, errors_y}, 1);
  drawing::Canvas canvas(drawing::kPlotWidth, flights.height() + errors.height());
  canvas.paste(flights, {0.0, 0.0});
  canvas.paste(errors, {0.0, 1.0 * flights.height()});
  return canvas;
}

nlohmann::ordered_json fitted_json(const Located& found, const Survey& s, std::size_t i,
                                   const Flight& flight) {
  const SurveyedGate& g = s.gates[found.gate_of[i]];
  return {{"gate_m", {g.p_EG.x(), g.p_EG.y(), g.p_EG.z()}},
          {"gate_yaw_deg", g.yaw / kDegree},
          {"heading_offset_deg", wrap_angle(s.flights[i].heading - log_yaw(flight)) / kDegree},
          {"tilt_deg", s.flights[i].tilt / kDegree},
          {"camera_roll_deg", s.airframe.camera_roll / kDegree},
          {"exposure_delay_ms", 1e3 * s.airframe.exposure_delay},
          {"mocap_delay_ms", 1e3 * s.airframe.mocap_delay},
          {"gate_from", found.shared(i) ? "other flights" : "this flight"}};
}

void add_rows(const Shown& one, std::string& csv) {
  for (std::size_t k = 0; k < one.drag.t.size(); k += 26) {
    csv += one.name + "," + files::text_of(one.drag.t[k], 6);
    for (const Eigen::Vector3d& p :
         {one.drag.truth[k], one.drag.estimate[k], one.imu15.estimate[k]})
      csv += "," + files::text_of(p.x(), 5) + "," + files::text_of(p.y(), 5);
    csv += "\n";
  }
}

std::string of_unfitted(const Replayed& one) {
  if (one.t.empty()) return "no picture corrected the filter";
  return x_and_y(one.errors.rms()) + " m, NEES/3 " + consistent(one.errors);
}

/// Pooled over flights, and each.
struct Pool {
  FrameErrors all;
  nlohmann::ordered_json per_flight = nlohmann::ordered_json::object();

  void add(const std::string& flight, const Replayed& one) {
    all.add(one.errors);
    per_flight[flight] = with_nees(json_of(one.errors), one.errors);
    per_flight[flight]["pictures"] = one.pictures, per_flight[flight]["from_s"] = one.t.front(),
    per_flight[flight]["to_s"] = one.t.back();
  }
  [[nodiscard]] nlohmann::ordered_json json() const {
    auto json = with_nees(json_of(all), all);
    json["per_flight"] = per_flight;
    return json;
  }
};

}  // namespace

Result eyes_real(const Options& options) {
  const fs::path folder = data_folder("tudelft_bebop_flights", options);
  const std::vector<std::string> name{"flights"};
  const config::Config config = config::load_config(config::config_files(name));
  const PilotConfig pilot = pilot_for_recordings(config);
  std::vector<Flight> flights = flights_in(folder, config, pilot, options);
  const Located found = located(flights, pilot);

  Result result{.table = {},
                .json = {},
                .csv = "flight,t_s,true_x_m,true_y_m,x_m,y_m,imu15_x_m,imu15_y_m\n",
                .picture = drawing::Canvas(1, 1)};
  auto without = nlohmann::ordered_json::object(), fits = without;
  const auto leave_out = [&](const std::string& flight, const std::string& why) {
    without[flight] = why;
    result.table.push_back({flight, "", "left out: " + why});
  };
  for (const Flight& flight : flights)
    leave_out(flight.name,
              "a whole gate in " + std::to_string(flight.seen.size()) + " pictures that agree");

  Pool drag, imu15, gate_from_all, unfitted;
  std::vector<Shown> shown;
  for (std::size_t i = 0; i < found.flights.size(); ++i) {
    const Flight& flight = found.flights[i];
    if (options.stopped()) throw Stopped{};
    options.progress(0.4 + 0.6 * static_cast<double>(i) / static_cast<double>(found.flights.size()),
                     flight.name);
    const auto fly = [&](const Survey& survey, Estimator estimator) {
      return replayed(flight, flight.ticks, told(pilot, survey, found.gate_of[i], i),
                      survey.airframe, config, estimator);
    };
    const Survey others = by_the_others(found, i, pilot);
    // Nothing of this flight is told but what its own sensors say.
    const Replayed own_sensors =
        replayed(flight, flight_log::ticks_of(flight.folder),
                 told_the_gate(pilot, others.gates[found.gate_of[i]], flight), others.airframe,
                 config, Estimator::kEskf);
    Shown s{flight.name, fly(others, Estimator::kDrag), fly(others, Estimator::kImu15),
            own_sensors};
    const Replayed all = fly(found.survey, Estimator::kDrag);
    if (s.drag.t.empty() || all.t.empty()) {
      leave_out(flight.name, "no picture in the air corrected the filter");
      continue;
    }
    if (!s.unfitted.t.empty()) unfitted.add(s.name, s.unfitted);
    drag.add(s.name, s.drag), imu15.add(s.name, s.imu15), gate_from_all.add(s.name, all);
    fits[s.name] = fitted_json(found, others, i, flight);
    result.table.push_back({s.name + (found.shared(i) ? "" : ", gate from itself") + ", " +
                                fixed(s.drag.t.back() - s.drag.t.front(), 1) + " s, " +
                                std::to_string(s.drag.pictures) + " pictures",
                            "",
                            x_and_y(s.drag.errors.rms()) + " m (imu15 " +
                                x_and_y(s.imu15.errors.rms()) +
                                "); nothing fitted: " + of_unfitted(s.unfitted)});
    add_rows(s, result.csv);
    shown.push_back(std::move(s));
  }
  if (shown.empty())
    throw std::runtime_error(folder.string() + ": no flight whose gate can be located");
  result.table.push_back({"all, RMS of x, y", "",
                          x_and_y(drag.all.rms()) + " m (imu15 " + x_and_y(imu15.all.rms()) + ")"});
  result.table.push_back(
      {"all, std of x, y", "0.104, 0.069 m",
       x_and_y(drag.all.deviation()) + " m (imu15 " + x_and_y(imu15.all.deviation()) + ")"});
  if (unfitted.all.samples > 0)
    result.table.push_back({"all, RMS, nothing fitted on the scored flight; NEES/3", "",
                            x_and_y(unfitted.all.rms()) + " m; " + consistent(unfitted.all)});
  result.table.push_back(
      {"all, RMS, gate from all flights", "", x_and_y(gate_from_all.all.rms()) + " m"});
  const double misfit = misfit_px(found, pilot),
               misfit_of_log = misfit_px(with_logged_attitudes(found, pilot), pilot);
  result.table.push_back(
      {"misfit of all corners, RMS", "",
       fixed(misfit, 2) + " px (attitudes of the log's AHRS: " + fixed(misfit_of_log, 2) + " px)"});
  result.json = {{"drag", drag.json()},
                 {"imu15", imu15.json()},
                 {"unfitted", unfitted.all.samples > 0 ? unfitted.json() : nullptr},
                 {"drag_gate_from_all", gate_from_all.json()},
                 {"misfit_px", {{"our_ahrs", misfit}, {"logs_ahrs", misfit_of_log}}},
                 {"fitted", fits},
                 {"without_window", without}};
  result.picture = panels_of(shown);
  return result;
}

}  // namespace gatefly::experiments
