// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>

#include <sys/resource.h>

#include "gatefly/files/json.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/flight_recorder.hpp"
#include "gatefly/flight_log/sensor_health_json.hpp"
#include "gatefly/report/flight_page.hpp"
#include "gatefly/report/page.hpp"
#include "gatefly/simulated_race/results/flight_mcap.hpp"
#include "gatefly/simulated_race/results/flight_video.hpp"
#include "gatefly/simulated_race/results/loss_report.hpp"
#include "gatefly/simulated_race/results/summary.hpp"

#include "commands.hpp"
#include "race_options.hpp"
#include "track_list.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;
using files::fixed;

struct FlyOptions {
  RaceOptions race;
  std::string out;
  std::uint64_t seed = 1;
  bool json = false, video = false, frames = false, list = false;
};

std::string place(const Eigen::Vector3d& p) {
  return "(" + fixed(p.x(), 2) + ", " + fixed(p.y(), 2) + ", " + fixed(p.z(), 2) + ")";
}

/// "finished", or why not: what, where, when.
std::string outcome(const simulated_race::RaceResult& result, const Eigen::Vector3d& last_p_EB) {
  if (result.finished) return "finished";
  const std::string where = " at " + place(last_p_EB) + " m";
  if (result.crash_time)
    return "crashed into " + result.crash_object + where + ", " + fixed(*result.crash_time, 1) +
           " s after the start";
  if (result.stop_reason == "timeout")
    return "timed out after " + fixed(result.flight_time, 0) + " s" + where;
  if (result.stop_reason == "abort") return "given up: " + result.abort_reason + where;
  return "not finished: " + result.stop_reason + where;
}

/// "finished, 5 of 5 gates in 24.8 s".
std::string verdict(const simulated_race::RaceResult& r, const Eigen::Vector3d& last_p_EB) {
  return outcome(r, last_p_EB) + ", " + std::to_string(r.gates_passed) + " of " +
         files::amount(r.gates_total, "gate") +
         (r.finished ? " in " + fixed(r.race_time, 1) + " s" : "");
}

/// The most memory that this program has taken so far [MB]; ffmpeg's is its own.
double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1.024e-3 * static_cast<double>(usage.ru_maxrss);
}

/// "0.23 s of CPU a second of flight; 6.5 s of CPU, 7.1 s by the clock; 34 MB at most".
std::string cost(const simulated_race::RaceResult& r) {
  constexpr int kDigits = 2;
  const double per_second = r.flight_time > 0 ? r.cpu_seconds / r.flight_time : 0.0;
  return files::text_of(per_second, kDigits) + " s of CPU a second of flight; in all " +
         fixed(r.cpu_seconds, 1) + " s of CPU, " + fixed(r.wall_seconds, 1) + " s by the clock" +
         (r.bake_seconds > 0
              ? ", and before " + fixed(r.bake_seconds, 1) + " s by the clock for the light map"
              : "") +
         "; " + fixed(peak_memory(), 0) + " MB of memory at most";
}

void print_screen(const simulated_race::Race& race, const simulated_race::RaceResult& r,
                  const Eigen::Vector3d& last_p_EB, const fs::path& out, bool quiet) {
  std::cout << race.identity.track << ", seed " << race.identity.seed << ": "
            << coloured(r.finished, verdict(r, last_p_EB)) << '\n';
  if (quiet) return;
  if (const std::string why = simulated_race::loss_line(r); !why.empty())
    std::cout << "  " << why << '\n';

  const auto line = [](const char* name, const std::string& text) {
    std::cout << "  " << std::left << std::setw(16) << name << text << '\n';
  };
  std::string laps;
  for (const double lap : r.lap_times) laps += (laps.empty() ? "" : ", ") + fixed(lap, 1) + " s";
  line("laps", laps.empty() ? "none" : laps);
  // From the first gate on: before it there is nothing to say.
  const auto known = [](bool is, double value) { return is ? fixed(value, 2) : "–"; };
  const bool one = r.gates_passed > 0;
  line("speed", known(r.gates_passed > 1, r.mean_speed) + " m/s mean, " + known(one, r.max_speed) +
                    " m/s max");
  const Eigen::Vector3d& rmse = r.estimation_rmse;
  line("estimate", "rmse x " + known(one, rmse.x()) + ", y " + known(one, rmse.y()) + ", z " +
                       known(one, rmse.z()) + " m");
  line("detection", files::amount(r.frames, "picture") + ", " + std::to_string(r.frames_with_gate) +
                        " show the next gate whole: in " + std::to_string(r.true_positives) +
                        " found, " + std::to_string(r.false_positives) + " false detections");
  if (const std::string refused = flight_log::in_words(r.sensor_health); !refused.empty())
    line("sensors", refused);
  line("searches", std::to_string(r.searches));
  line("cost", cost(r));
  line("files", (out / "").string());
}

/// gatefly fly: one closed-loop race. Exit 0 finished, 1 not, 2 unusable input, 130 Ctrl-C.
int fly(const FlyOptions& options) {
  const simulated_race::RaceMaker maker = race_maker(options.race);
  simulated_race::Race race = maker.race(options.seed);
  race.config.while_baking = stop_if_interrupted;
  const fs::path out = options.out.empty()
                           ? fs::path{"out"} / (fs::path{options.race.track}.stem().string() + "-" +
                                                std::to_string(options.seed))
                           : fs::path{options.out};
  const bool quiet = options.race.common.quiet;
  if (options.video) files::require_ffmpeg();
  const bool pictures = options.race.vision != "ideal";
  if (options.frames && !pictures)
    throw std::runtime_error("--frames: a flight with --vision ideal has none");
  if (options.frames) files::require_ffmpeg_for("--frames");
  std::string empty_page = report::shipped_page();
  catch_interrupt();
  flight_log::FlightRecorder recorder(
      out, {.packed_log = pictures,
            .frames = options.frames,
            .stored_width = race.config.sim.camera.stored_width,
            .stored_height = race.config.sim.camera.stored_height,
            .frames_per_second = race.config.sim.sensors.camera_hz,
            .navigation_imu = race.config.sim.sensors.autopilot_imu_hz > 0});
  report::FlightPage page(
      std::move(empty_page), report::page_course(race.config.pilot, race.config.sim, pictures),
      pictures && report::OnboardFilm::possible() ? recorder.place_for("onboard.webm")
                                                  : fs::path{});
  simulated_race::FlightMcap mcap(recorder.place_for("flight.mcap"), race.config);
  for (const auto& [name, content] : maker.inputs()) recorder.add_file(name, content);
  std::optional<simulated_race::FlightVideo> video;
  if (options.video)
    video.emplace(recorder.place_for("flight.mp4"), race.config,
                  race.identity.track + ", seed " + std::to_string(options.seed), pictures);

  Progress progress(quiet, 10.0);
  const double total = static_cast<double>(race.config.pilot.track.laps) *
                       static_cast<double>(race.config.pilot.track.gates.size());
  Eigen::Vector3d last_p_EB = Eigen::Vector3d::Zero();
  const auto on_tick = [&](const flight_log::Tick& tick) {
    stop_if_interrupted();
    recorder.record(tick);
    page.record(tick);
    mcap.record(tick);
    if (video) video->record(tick);
    last_p_EB = tick.truth.p_EB;
    const double now = 1e-9 * static_cast<double>(tick.sensors.time.count());
    if (progress.due(now)) {
      const int passed = tick.pilot.estimate().gates_passed;
      progress.update(passed / total, fixed(now, 0) + " s flown, " + std::to_string(passed) +
                                          " of " + fixed(total, 0) + " gates, " +
                                          name_of(tick.pilot.phase()));
    }
  };
  simulated_race::Flight flight{race.config};
  while (flight.step()) on_tick(flight.tick());
  const simulated_race::RaceResult result = flight.result();
  page.end(flight.tick());
  while (video && flight.fall()) {
    stop_if_interrupted();
    video->record_fall(flight.tick(), result);
  }
  progress.clear();

  mcap.finish();
  if (video) video->finish(result, verdict(result, last_p_EB));
  nlohmann::ordered_json told = simulated_race::summary(result, race.identity);
  told["timings"]["whole_flight"]["peak_memory_mb"] = peak_memory();
  const std::string summary = files::json_text(told);
  recorder.add_file("report.html", page.html(told, verdict(result, last_p_EB)));
  const std::string replaced = recorder.finish(summary);
  if (!replaced.empty() && !quiet)
    std::cerr << "gatefly fly: " << (out / "").string() << ": " << replaced << '\n';
  if (options.json) {
    std::cout << summary;
  } else {
    print_screen(race, result, last_p_EB, out, quiet);
  }
  return result.finished ? kDone : kAnswerIsNo;
}

}  // namespace

void declare_fly(Command& command) {
  auto options = std::make_shared<FlyOptions>();
  command.footer(
      "Example:\n  gatefly fly showroom --seed 7 --laps 1 --set control.speed_mps=1.5\n"
      "  gatefly fly oval --vision ideal\n\n"
      "An ideal flight has no pictures: replay needs a rendered one.\n"
      "Exit code 0: finished; 1: not finished; 2: unusable arguments or track; 130: Ctrl-C.");
  command.option("TRACK", options->race.track, "a name in tracks/ or a file").show_default();
  command.flag("--list", options->list,
               "instead of flying: the tracks there are, with gates, laps, room and camera");
  command.option("--seed", options->seed, "random seed: from it [randomize] draws the world")
      .show_default();
  command.option("--out", options->out, "folder for the flight [out/TRACK-SEED]").path("DIR");
  command.flag("--video", options->video,
               "also draw the flight: flight.mp4 in its folder (needs ffmpeg)");
  command.flag("--frames", options->frames,
               "also keep every picture without loss: frames.mkv (needs ffmpeg)");
  command.flag("--json", options->json, "print summary.json instead of a screen");
  add_race_options(command, options->race);
  command.runs([options] {
    take_drone(options->race.drone, options->race.common);
    return options->list ? list_tracks(options->race.common, options->json) : fly(*options);
  });
}

}  // namespace gatefly::cli
