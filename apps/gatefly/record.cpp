// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include <nlohmann/json.hpp>

#include "gatefly/config/derived.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/live/recording_session.hpp"
#include "gatefly/tasks/flight_inputs.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using live::RecordingSession;

struct RecordOptions {
  CommonOptions common;
  std::string camera, link, drone, out, track;
  std::optional<int> laps;
  double time_limit_s = 0.0, keep_free_mib = 64.0;
  bool json = false;
};

/// Files that each folder holds beside the recording: the drone's constants, and the course if one is named.
std::map<std::string, std::string> files_of(const RecordOptions& options,
                                            const config::Config& config) {
  std::map<std::string, std::string> files;
  if (!options.track.empty()) {
    const fs::path file = config::find_track(options.track);
    const config::TrackFile track = config::read_track(file, config.gate);
    files = tasks::flight_inputs(options.common, config::on_course(config, track), file,
                                 options.laps.value_or(track.track.laps));
  }
  files["drone.toml"] = files::read_file(options.drone);
  return files;
}

nlohmann::ordered_json summary_of(const RecordOptions& options,
                                  const live::SensorRecorder& recorder, RecordingSession::End end,
                                  const RecordingSession::Counts& counts) {
  return {
      {"kind", "record"},
      {"folder", recorder.folder().string()},
      {"version", GATEFLY_VERSION},
      {"stop_reason", live::text_of(end)},
      {"flight_time_s", seconds(recorder.last_time())},
      {"rows", recorder.rows()},
      {"lifted", recorder.lifted()},
      {"detection", {{"frames", recorder.pictures()}}},
      {"camera",
       {{"uri", options.camera}, {"lost", counts.pictures_lost}, {"error", counts.camera_error}}},
      {"link",
       {{"uri", options.link},
        {"samples", recorder.samples()},
        {"unrecorded", counts.samples_lost},
        {"asked", counts.state.asked},
        {"lost", counts.state.lost},
        {"battery_v", counts.state.battery_v}}}};
}

/// One that records flight after flight.
class Recording {
 public:
  Recording(const RecordOptions& options, const config::Config& config)
      : options_{options},
        link_{live::link_uri(options.link)},
        drone_{live::read_drone(options.drone)},
        plan_{.camera = live::camera_uri(options.camera),
              .size = {config.camera.stored_width(), config.camera.stored_height()},
              .recorder = {.imu_hz = config.rates.imu_hz},
              .files = files_of(options, config),
              .keep_free = static_cast<std::uintmax_t>(options.keep_free_mib * (1 << 20))} {
    if (link_.kind == live::LinkUri::Kind::kReplay)
      throw std::runtime_error("--link " + options.link + ": is recorded already");
  }

  int run() {
    bool any = false;
    while (!over()) {
      std::optional<live::Introduced> controller = meet(!any);
      if (!controller) continue;
      if (live::free_bytes(parent()) < plan_.keep_free) {
        say("less than " + files::text_of(options_.keep_free_mib) + " MiB are free in " +
            parent().string() + ", waiting");
        wait(5s);
        continue;
      }
      any = true;
      RecordingSession session{plan_, drone_, std::move(*controller)};
      try {
        const auto end = session.record(
            options_.out, [this] { return over(); },
            [&](const live::SensorRecorder& recorder, RecordingSession::End why,
                const RecordingSession::Counts& counts) {
              told_ = summary_of(options_, recorder, why, counts);
              return files::json_text(told_);
            });
        tell(session, end);
      } catch (const live::DiskFailed& error) {
        say(error.what());
        failed_ = true;
        wait(5s);
      }
    }
    if (interrupted()) return kInterrupted;
    return any && !failed_ ? kDone : kAnswerIsNo;
  }

 private:
  [[nodiscard]] bool over() const {
    const double since = seconds(live::Clock::now() - start_);
    return interrupted() || (options_.time_limit_s > 0.0 && since > options_.time_limit_s);
  }
  /// The folder whose disk needs space: --out, or its nearest existing parent.
  [[nodiscard]] fs::path parent() const {
    fs::path folder = fs::absolute(options_.out);
    std::error_code error;
    while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
    return folder;
  }
  void wait(std::chrono::milliseconds time) const {
    for (const auto until = live::Clock::now() + time; live::Clock::now() < until && !over();)
      std::this_thread::sleep_for(50ms);
  }
  /// Said once, until something else is to be said.
  void say(const std::string& what) {
    if (what == said_) return;
    said_ = what;
    std::cerr << "gatefly record: " << what << std::endl;
  }
  /// The controller, when it answers; nothing while it does not. Another drone than the file's is refused at the start.
  std::optional<live::Introduced> meet(bool at_start) {
    try {
      return live::introduced(link_, drone_, true);
    } catch (const live::AnotherDrone& error) {
      if (at_start) throw;
      say(error.what());
    } catch (const std::runtime_error& error) {
      say(std::string{error.what()} + ", waiting for it");
    }
    wait(1s);
    return std::nullopt;
  }
  void tell(const RecordingSession& session, RecordingSession::End end) {
    const RecordingSession::Counts& counts = session.counts();
    if (!counts.disk_error.empty()) failed_ = true, say(counts.disk_error);
    if (!counts.camera_error.empty()) say("--camera: " + counts.camera_error);
    said_.clear();
    if (options_.json) {
      std::cout << files::json_text(told_) << std::flush;
    } else if (!options_.common.quiet) {
      const auto number = [&](const char* key) { return told_.at(key).dump(); };
      std::cout << session.folder().string() << ": "
                << files::fixed(told_.at("flight_time_s").get<double>(), 1) << " s, "
                << number("rows") << " rows, " << told_.at("detection").at("frames").dump()
                << " pictures (" << counts.pictures_lost << " lost); " << live::text_of(end)
                << std::endl;
    }
    if (end == RecordingSession::End::kDiskFull) wait(5s);
  }

  const RecordOptions& options_;
  live::LinkUri link_;
  live::DroneFile drone_;
  RecordingSession::Plan plan_;
  live::Moment start_ = live::Clock::now();
  nlohmann::ordered_json told_;
  std::string said_;
  bool failed_ = false;
};

/// gatefly record: exit 0 the time is over, 1 nothing could be recorded, or not to the end; 2 unusable input, 130 Ctrl-C, 143 TERM.
int record(const RecordOptions& options) {
  const config::Config config = load(options.common);
  say_notes(config.notes);
  files::check_output_folder("--out", options.out);
  Recording recording{options, config};
  catch_interrupt();
  return recording.run();
}

}  // namespace

void declare_record(Command& command) {
  auto options = std::make_shared<RecordOptions>();
  command.footer(
      "Example:\n  gatefly record --camera v4l2:/dev/video0 --link "
      "'msp:/dev/ttyTHS1?baud=115200' \\\n"
      "    --drone drone.toml --config imx477 --config betaflight --out flights\n\n"
      "Each battery is a folder of its own, flights/flight-0001 and so on, that replay reads, "
      "whole or cut when the\n"
      "power went. Nothing is sent but questions. It waits for a controller that is not there yet, "
      "for a camera, for\n"
      "space on the disk. examples/gatefly-record.service starts it with the computer.\n"
      "Exit code 0: the time is over; 1: nothing was recorded, or not all; 2: unusable arguments, "
      "file or drone; 130, 143: told to end.");
  command
      .option("--camera", options->camera,
              "v4l2:/dev/videoN, gst:PIPELINE, udp-jpeg:PORT, or file:DIR, a recorded flight")
      .required()
      .type_name("URI");
  command
      .option("--link", options->link,
              "msp:/dev/ttyX?baud=115200, msp:tcp:HOST:PORT, betaflight-sitl:, mavlink:…")
      .required()
      .type_name("URI");
  command.option("--drone", options->drone, "drone.toml: every constant of the drone")
      .required()
      .path("FILE");
  command.option("--out", options->out, "folder for the flights' folders").required().path("DIR");
  command
      .option("--track", options->track,
              "kept in each folder with --config and --set, so that replay takes them from there")
      .path("FILE");
  command.option("--laps", options->laps, "instead of the track's own number").between(1, 100);
  command
      .option("--time-limit", options->time_limit_s,
              "ends after so long [s]; 0: when it is told to")
      .between(0.0, 1e6)
      .show_default();
  command
      .option("--keep-free-mib", options->keep_free_mib,
              "of the disk: with less a flight is ended, whole, and no other begun")
      .between(1.0, 1e6)
      .show_default();
  command.flag("--json", options->json, "print each summary.json instead of a line");
  add_common(command, options->common);
  command.runs([options] { return record(*options); });
}

}  // namespace gatefly::cli
