// SPDX-License-Identifier: Apache-2.0
#include <iomanip>
#include <iostream>
#include <memory>
#include <stdexcept>

#include "gatefly/files/output.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/tasks/recorded_flight.hpp"
#include "gatefly/tasks/replay_report.hpp"

#include "commands.hpp"
#include "render_again.hpp"

namespace gatefly::cli {
namespace {

struct ReplayOptions {
  CommonOptions common;
  tasks::ReplayArguments replay;
  std::string csv;
  bool json = false;
};

int replay(const ReplayOptions& options) {
  const bool rows_on_stdout = io::is_stdout(options.csv);
  if (options.json && rows_on_stdout)
    throw std::runtime_error("--json and --csv " + options.csv + ": both want stdout; name a file");
  check_outputs(
      {{"--csv", options.csv, {"table of estimates", "t_s,x_m,y_m,z_m,vx_mps,"}}},
      {io::find_data(options.replay.directory, options.replay.data), options.replay.track},
      options.common);
  const tasks::ReplayArguments& given = options.replay;
  const tasks::RecordedFlight flight = tasks::read_flight(given);
  say_notes(flight.notes);
  const flight_log::ReplayResult result = tasks::replayed(flight, given, {}, render_again());
  if (!options.csv.empty()) io::write_file(options.csv, tasks::estimates_csv(result));

  const tasks::ReplayReport report = tasks::report_of(flight, given, result);
  if (!report.why_no_fix.empty()) std::cerr << "gatefly replay: " << report.why_no_fix << '\n';
  if (!report.other_pictures.empty())
    std::cerr << "gatefly replay: " << report.other_pictures << '\n';
  if (options.json) {
    std::cout << tasks::as_json(report, given, result).dump(2) << '\n';
  } else if (!rows_on_stdout) {
    std::cout << std::fixed << std::setprecision(2) << given.directory << ": "
              << result.estimates.size() << " samples, " << result.pictures.size()
              << " pictures, all numbers " << (result.finite ? "finite" : "NOT finite") << '\n';
    if (report.visible)
      std::cout
          << "  gate found      in " << report.visible->found << " of " << report.visible->shown
          << " pictures in flight that show a gate of the map whole, the next one or another\n";
    if (report.labelled)
      std::cout << "  labelled        in " << report.labelled->found << " of "
                << report.labelled->shown << " (overlap70)\n";
    std::cout << "  fixes           " << report.fixes << " pictures corrected the filter, "
              << result.gates_passed << " gates passed\n";
    if (result.rmse_samples > 0)
      std::cout << "  position error  rms x " << result.rmse.x() << ", y " << result.rmse.y()
                << ", z " << result.rmse.z() << " m, from the first fix to the last gate\n";
    if (report.comparison)
      std::cout << "  recorded flight " << tasks::text_of(*report.comparison, flight) << '\n';
  }
  const bool came_out =
      !report.comparison || !report.comparison->first_other || report.comparison->told;
  return result.finite && came_out ? kDone : kAnswerIsNo;
}

}  // namespace

void declare_replay(Command& command) {
  auto options = std::make_shared<ReplayOptions>();
  command.footer(
      "Example:\n  gatefly replay out/showroom-1 --csv estimates.csv\n"
      "  gatefly replay tudelft_bebop_flights/flight_11 --json\n\n"
      "Folders of gatefly fly carry their track and configuration; others use tracks/flights.toml "
      "and\n"
      "configs/flights.toml. Exit code 0: done; 1: a number was not finite, or a flight of gatefly "
      "fly came out "
      "otherwise; 2: unusable input.");
  command
      .option("DIR", options->replay.directory,
              "flight folder: log_si.csv or log_si.csv.gz, images.csv, pictures")
      .required()
      .path();
  command.option("--track", options->replay.track,
                 "instead of the folder's own: a name in tracks/ or a file");
  command
      .option("--estimator", options->replay.estimator,
              "drag: the 7-state filter; imu15: the classic inertial one beside it, for comparison")
      .one_of({"drag", "imu15"})
      .show_default();
  command
      .option("--heading-offset-deg", options->replay.heading_offset_deg,
              "real logs: motion capture's heading minus the log's own (differs by flight)")
      .show_default();
  command
      .option("--data", options->replay.data,
              "where a DIR is looked for that is not here [$GATEFLY_DATA]")
      .path("DIR");
  command.option("--csv", options->csv, "write estimates.csv (- for stdout)").path("FILE");
  command.flag("--json", options->json, "print JSON");
  add_force(command, options->common);
  add_common(command, options->common);
  command.runs([options] {
    options->replay.config = options->common;
    return replay(*options);
  });
}

}  // namespace gatefly::cli
