// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/replay.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "gatefly/files/text.hpp"
#include "gatefly/tasks/recorded_flight.hpp"
#include "gatefly/tasks/replay_report.hpp"

#include "arguments.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "json.hpp"
#include "render_again.hpp"

namespace gatefly::python {
namespace {

using Column = py::array_t<double>;

/// gatefly.Replay: a recorded flight and what the pilot made of it.
struct Replay {
  tasks::ReplayArguments arguments;
  tasks::RecordedFlight flight;
  flight_log::ReplayResult result;
  tasks::ReplayReport report;
};

Replay replay(const py::object& folder, const py::object& config, const py::object& settings,
              const py::object& track, const std::string& estimator, double heading_offset_deg,
              bool true_height) {
  const auto& names = tasks::estimator_names();
  if (!estimator.empty() && std::find(names.begin(), names.end(), estimator) == names.end())
    throw std::runtime_error("estimator = '" + files::one_line(estimator) +
                             "', must be 'drag', 'eskf' or 'imu15'");
  tasks::ReplayArguments arguments{.config = config_arguments(config, settings),
                                   .directory = path_of(folder, "folder"),
                                   .track = track.is_none() ? "" : path_of(track, "track"),
                                   .data = "",
                                   .estimator = estimator,
                                   .heading_offset_deg = heading_offset_deg,
                                   .true_height = true_height};
  Replay replay{
      .arguments = arguments, .flight = tasks::read_flight(arguments), .result = {}, .report = {}};
  warn(replay.flight.notes);
  {
    const py::gil_scoped_release others_may_run;
    replay.result = tasks::replayed(replay.flight, arguments, check_signals, render_again());
    replay.report = tasks::report_of(replay.flight, arguments, replay.result);
  }
  if (!replay.report.why_no_fix.empty()) warn({replay.report.why_no_fix});
  if (!replay.report.other_pictures.empty()) warn({replay.report.other_pictures});
  return replay;
}

/// One number a row.
template <class Value>
Column column(const Replay& replay, Value value) {
  const auto& rows = replay.result.estimates;
  Column column(static_cast<py::ssize_t>(rows.size()));
  double* to = column.mutable_data();
  for (const auto& row : rows) *to++ = value(row);
  return column;
}

/// The columns of estimates.csv by their names.
py::dict estimates(const Replay& replay) {
  using Row = flight_log::EstimateRow;
  py::dict columns;
  const auto add = [&](const char* name, auto value) { columns[name] = column(replay, value); };
  const auto add_vector = [&](std::initializer_list<const char*> names, auto vector) {
    Eigen::Index axis = 0;
    for (const char* name : names) {
      add(name, [&](const Row& row) { return vector(row.estimate)[axis]; });
      ++axis;
    }
  };
  add("t_s", [](const Row& row) { return row.t; });
  add_vector({"x_m", "y_m", "z_m"}, [](const Estimate& e) { return e.p_EB; });
  add_vector({"vx_mps", "vy_mps", "vz_mps"}, [](const Estimate& e) { return e.v_E; });
  add("roll_rad", [](const Row& row) { return row.estimate.attitude.roll; });
  add("pitch_rad", [](const Row& row) { return row.estimate.attitude.pitch; });
  add("yaw_rad", [](const Row& row) { return row.estimate.attitude.yaw; });
  add_vector({"bax_mps2", "bay_mps2", "baz_mps2"}, [](const Estimate& e) { return e.accel_bias; });
  py::list sources;
  for (const Row& row : replay.result.estimates) sources.append(tasks::name_of(row.source));
  columns["source"] = py::module_::import("numpy").attr("array")(sources);
  return columns;
}

/// (rows, 3); NaN where the log does not know.
py::array_t<double> truth(const Replay& replay) {
  const auto& ticks = replay.flight.ticks;
  py::array_t<double> array({static_cast<py::ssize_t>(ticks.size()), py::ssize_t{3}});
  double* to = array.mutable_data();
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  for (const auto& tick : ticks)
    for (Eigen::Index axis = 0; axis < 3; ++axis) *to++ = tick.p_EB ? (*tick.p_EB)[axis] : kUnknown;
  return array;
}

}  // namespace

void bind_replay(py::module_& m) {
  py::class_<Replay>(m, "Replay", "A recorded flight, flown again from its sensors.")
      .def_property_readonly("estimates", estimates,
                             "The columns of estimates.csv: {'t_s': array, 'x_m': array, ... "
                             "'source': array of str}, a\nrow an IMU sample.")
      .def_property_readonly(
          "true_p_EB", truth,
          "Where the drone really was in each row (rows, 3) [m]; NaN where the log "
          "does not know.")
      .def_property_readonly(
          "rmse",
          [](const Replay& r) -> py::object {
            if (r.result.rmse_samples == 0) return py::none();
            return array_of(r.result.rmse);
          },
          "Position error x, y, z, from the first fix to the last gate [m]; None where the log has "
          "no "
          "truth.")
      .def_property_readonly(
          "summary",
          [](const Replay& r) {
            return python_of(tasks::as_json(r.report, r.arguments, r.result));
          },
          "What `gatefly replay --json` prints: samples, pictures, fixes, gates_passed, rmse_m, "
          "same_as_recorded ...");
  m.def(
      "replay", replay,
      "Feeds the flight in a folder (log_si.csv, images.csv, pictures) to the very pilot that "
      "flies.\n\n"
      "Folders of `gatefly fly` carry their track and configuration; others use the track and the "
      "configuration\n'flights'. estimator: 'eskf', 'drag', or 'imu15', the classic "
      "inertial filter beside it; '': what the flight is configured with.\nheading_offset_deg: of "
      "real logs, the map's heading "
      "minus "
      "the log's own.\ntrue_height: a log without sonar and barometer gets its height from its "
      "true "
      "positions.",
      py::arg("folder"), py::arg("config") = py::none(), py::arg("settings") = py::none(),
      py::arg("track") = py::none(), py::arg("estimator") = "",
      py::arg("heading_offset_deg") = tasks::ReplayArguments{}.heading_offset_deg,
      py::arg("true_height") = false);
}

}  // namespace gatefly::python
