// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "gatefly/files/json.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/partial_folder.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/findings_json.hpp"
#include "gatefly/report/flight_page.hpp"
#include "gatefly/report/page.hpp"
#include "gatefly/tasks/recorded_flight.hpp"
#include "gatefly/tasks/replay_report.hpp"
#include "gatefly/tasks/tum_file.hpp"

#include "commands.hpp"
#include "drone_options.hpp"
#include "render_again.hpp"
#include "smoothing.hpp"

namespace gatefly::cli {
namespace {

struct ReplayOptions {
  CommonOptions common;
  DroneOptions drone;
  tasks::ReplayArguments replay;
  std::string csv, tum, out;
  bool json = false, smooth = false;
};

namespace fs = std::filesystem;

constexpr files::OutputKind kTum{"trajectory", "timestamp tx ty tz qx qy qz qw"};

/// The page of a flight that is flown again: report.html and summary.json in a folder of its own.
class ReplayPage {
 public:
  ReplayPage(const fs::path& out, const tasks::RecordedFlight& flight)
      : folder_{out, files::PartialFolder::Grows::kInside, is_ours},
        flight_{flight},
        page_{report::shipped_page(), course(flight),
              report::OnboardFilm::possible() ? folder_.path() / "onboard.webm" : fs::path{}} {}

  void record(const flight_log::ReplayedTick& tick, bool other_filter) {
    const flight_log::FlightSample& truth = flight_.folder.samples[tick.index];
    const report::PageTick shown{.sensors = tick.sensors,
                                 .command = tick.command,
                                 .pilot = tick.pilot,
                                 .estimate = other_filter ? &tick.estimate : nullptr,
                                 .p_EB = truth.true_p_EB,
                                 .v_E = truth.true_v_E,
                                 .attitude = truth.true_attitude,
                                 .battery_v = truth.battery_v};
    page_.record(shown);
    if (tick.index + 1 == flight_.folder.samples.size()) page_.end(shown);
  }

  void write(const tasks::ReplayReport& report, const tasks::ReplayArguments& given,
             const flight_log::ReplayResult& result) {
    const Track& track = flight_.pilot.track;
    const std::string name = fs::weakly_canonical(flight_.folder.directory).filename().string();
    nlohmann::ordered_json told{{"kind", "replay"},
                                {"flight", name},
                                {"estimator", tasks::estimator_of(given, flight_.pilot)},
                                {"track", track.name},
                                {"version", GATEFLY_VERSION},
                                {"gates_passed", result.gates_passed},
                                {"gates_total", track.laps * static_cast<int>(track.gates.size())},
                                {"fixes", report.fixes},
                                {"detection", {{"frames", result.pictures.size()}}},
                                {"timings", nlohmann::json::object()},
                                {"replay", tasks::as_json(report, given, result)},
                                {"config", config::as_json(flight_.config)}};
    if (result.rmse_samples > 0)
      told["position_rmse_m"] = {result.rmse.x(), result.rmse.y(), result.rmse.z()};
    if (report.comparison) told["recorded"] = tasks::text_of(*report.comparison, flight_);
    const std::string verdict = name + ", flown again by its sensors";
    folder_.write("summary.json", files::json_text(told));
    folder_.write("report.html", page_.html(told, verdict));
    stop_if_interrupted();
    folder_.pour();
  }

 private:
  static report::PageCourse course(const tasks::RecordedFlight& flight) {
    report::PageCourse course = report::page_course(flight.pilot);
    const auto& samples = flight.folder.samples;
    const double seconds =
        1e-9 * static_cast<double>((samples.back().time - samples.front().time).count());
    course.pictures = flight.folder.images.size();
    course.pictures_per_second = static_cast<double>(course.pictures) / std::max(1.0, seconds);
    return course;
  }

  static bool is_ours(const std::string& name) {
    return name == "summary.json" || name == "report.html" || name.starts_with("onboard.webm");
  }

  files::PartialFolder folder_;
  const tasks::RecordedFlight& flight_;
  report::FlightPage page_;
};

/// The estimated trajectory, and the true one if the log has it.
void write_tum(const ReplayOptions& options, const fs::path& truth_path,
               const tasks::RecordedFlight& flight, const flight_log::ReplayResult& result) {
  std::vector<files::FileContent> files{{options.tum, tasks::tum_of_estimates(result)}};
  const auto truth = tasks::tum_of_truth(flight.folder);
  if (truth) files.push_back({truth_path, truth->text});
  files::write_files(files);
  if (options.common.quiet || (truth && truth->has_attitude)) return;
  std::cerr << "gatefly replay: " << (truth ? truth_path.string() : flight.folder.log.string())
            << (truth ? ": the log has no true attitude, each is 0 0 0 1\n"
                      : ": has no true position, only the estimate is written\n");
}

/// The smoother goes over the models of one filter, which has to have flown.
std::unique_ptr<FlightSmoother> smoother_for(const ReplayOptions& options,
                                             const tasks::RecordedFlight& flight) {
  if (!options.smooth) return nullptr;
  const std::string estimator = tasks::estimator_of(options.replay, flight.pilot);
  if (estimator != "eskf")
    throw std::runtime_error(
        "--smooth: smooths the estimator eskf, this is " + estimator +
        (options.replay.estimator.empty() ? " (filter.model); add" : "; give") +
        " --estimator eskf");
  return flight_smoother();
}

int replay(const ReplayOptions& options) {
  const bool rows_on_stdout = files::is_stdout(options.csv);
  if (options.json && rows_on_stdout)
    throw std::runtime_error("--json and --csv " + options.csv + ": both want stdout; name a file");
  if (files::is_stdout(options.tum))
    throw std::runtime_error("--tum " + options.tum + ": writes two files; name one");
  const fs::path truth =
      options.tum.empty() ? fs::path{} : tasks::tum_truth_path(fs::path{options.tum});
  const std::vector<files::Output> files{
      {"--csv", options.csv, {"table of estimates", "t_s,x_m,y_m,z_m,vx_mps,"}},
      {"--tum", options.tum, kTum},
      {"--tum", truth, kTum}};
  check_outputs(files,
                {data_at(options.replay.directory, options.replay.data), options.replay.track},
                options.common);
  if (!options.out.empty()) {
    files::check_output_folder("--out", options.out, files);
    files::refuse_foreign_folder(options.out, "summary.json", {"replay", "\"kind\": \"replay\""},
                                 "choose another --out");
  }
  const tasks::ReplayArguments& given = options.replay;
  const tasks::RecordedFlight flight = tasks::read_flight(given);
  say_notes(flight.notes);
  catch_interrupt();
  const auto smoother = smoother_for(options, flight);
  std::optional<ReplayPage> page;
  if (!options.out.empty()) page.emplace(options.out, flight);
  const flight_log::ReplayResult result =
      tasks::replayed(flight, given, stop_if_interrupted, render_again(),
                      [&](const flight_log::ReplayedTick& tick) {
                        stop_if_interrupted();
                        if (page) page->record(tick, given.estimator == "imu15");
                        if (smoother) smoother->follow(tick);
                      });
  SmoothedFlight smoothed;
  flight_log::ReplayResult told;  // what the tables say
  told.estimates = result.estimates;
  if (smoother) {
    smoothed = smoother->smoothed(flight, result, stop_if_interrupted);
    told.estimates = smoothed.estimates;
  }
  if (!options.csv.empty()) files::write_file(options.csv, tasks::estimates_csv(told));
  if (!options.tum.empty()) write_tum(options, truth, flight, told);

  const tasks::ReplayReport report = tasks::report_of(flight, given, result);
  if (page) page->write(report, given, result);
  if (!report.why_no_fix.empty()) std::cerr << "gatefly replay: " << report.why_no_fix << '\n';
  if (!report.other_pictures.empty())
    std::cerr << "gatefly replay: " << report.other_pictures << '\n';
  if (options.json) {
    nlohmann::json answer = tasks::as_json(report, given, result);
    if (smoother) answer["smoothed"] = smoothed.json;
    std::cout << files::json_text(answer);
  } else if (!rows_on_stdout) {
    std::cout << std::fixed << std::setprecision(2) << given.directory << ": "
              << files::amount(result.estimates.size(), "sample") << ", "
              << files::amount(result.pictures.size(), "picture") << ", all numbers "
              << (result.finite ? "finite" : "NOT finite") << '\n';
    if (report.next_gate)  // the same words as fly's
      std::cout << "  detection       " << report.next_gate->shown
                << " show the next gate whole: in " << report.next_gate->found << " found\n";
    else if (report.visible)
      std::cout
          << "  gate found      in " << report.visible->found << " of " << report.visible->shown
          << " pictures in flight that show a gate of the map whole, the next one or another\n";
    if (report.labelled)
      std::cout << "  labelled        in " << report.labelled->found << " of "
                << report.labelled->shown << " (overlap70)\n";
    std::cout << "  fixes           " << files::amount(report.fixes, "picture")
              << " corrected the filter, " << files::amount(result.gates_passed, "gate")
              << " passed\n";
    if (result.rmse_samples > 0)
      std::cout << "  position error  rms x " << result.rmse.x() << ", y " << result.rmse.y()
                << ", z " << result.rmse.z() << " m, from the first fix to the last gate\n";
    std::cout << tasks::text_of(result.score);
    for (const std::string& line : smoothed.lines) std::cout << "  " << line << '\n';
    if (result.findings)
      std::cout << "  found           " << flight_log::text_of(result.findings) << '\n';
    if (result.divergence)
      std::cout << "  diverged        at " << result.divergence->since
                << " s: " << eskf::text_of(result.divergence->why) << '\n';
    if (!report.unknown.empty())
      std::cout << "  position        unknown: " << report.unknown << '\n';
    if (report.comparison)
      std::cout << "  recorded flight " << tasks::text_of(*report.comparison, flight) << '\n';
  }
  const bool came_out =
      !report.comparison || !report.comparison->first_other || report.comparison->told;
  const bool known = !result.divergence && report.unknown.empty();
  return result.finite && came_out && known ? kDone : kAnswerIsNo;
}

}  // namespace

void declare_replay(Command& command) {
  auto options = std::make_shared<ReplayOptions>();
  command.footer(
      "Example:\n  gatefly replay out/showroom-1 --csv estimates.csv\n"
      "  gatefly replay out/showroom-1 --tum est.txt   # then: evo_ape tum est.truth.txt est.txt\n"
      "  gatefly replay tudelft_bebop_flights/flight_11 --json\n"
      "  gatefly replay out/showroom-1 --smooth --csv smoothed.csv\n\n"
      "Folders of gatefly fly carry their track and configuration; others use tracks/flights.toml "
      "and\n"
      "configs/flights.toml. Exit code 0: done; 1: the filter has diverged or knows no position, "
      "by "
      "its own\n"
      "account; a number was not finite; or a flight of gatefly fly came out otherwise; 2: "
      "unusable "
      "input.");
  command
      .option("DIR", options->replay.directory,
              "flight folder: log_si.csv or log_si.csv.gz, images.csv, pictures")
      .required()
      .path();
  command.option("--track", options->replay.track,
                 "instead of the folder's own: a name in tracks/ or a file");
  command
      .option(
          "--estimator", options->replay.estimator,
          "eskf: wind, gates and camera are states; drag: the 7-state filter; imu15: the classic "
          "inertial one beside it, for comparison [the flight's filter.model]")
      .one_of({"drag", "eskf", "imu15"});
  command
      .option("--heading-offset-deg", options->replay.heading_offset_deg,
              "real logs: the map's heading minus the log's own, where somebody knows it")
      .show_default();
  command.flag("--true-height", options->replay.true_height,
               "a log without sonar and barometer: height from its true positions");
  command
      .option("--data", options->replay.data,
              "where a DIR is looked for that is not here [$GATEFLY_DATA]")
      .path("DIR");
  command.option("--csv", options->csv, "write estimates.csv (- for stdout)").path("FILE");
  command
      .option("--tum", options->tum,
              "write the estimated trajectory for evo (timestamp tx ty tz qx qy qz qw); with a "
              "true position in the log also FILE.truth beside it: est.txt, est.truth.txt")
      .path("FILE");
  command
      .option("--out", options->out,
              "folder for report.html, the flight as a page for a browser, and summary.json")
      .path("DIR");
  command.flag(
      "--smooth", options->smooth,
      "afterwards the most probable flight by all that was measured, before each moment and "
      "after: --csv and --tum write that one, a reference where there is no motion capture");
  command.flag("--json", options->json, "print JSON");
  add_drone(command, options->drone);
  add_force(command, options->common);
  add_common(command, options->common);
  command.runs([options] {
    take_drone(options->drone, options->common);
    options->replay.config = options->common;
    return replay(*options);
  });
}

}  // namespace gatefly::cli
