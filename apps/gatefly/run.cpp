// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <chrono>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>

#include "gatefly/config/derived.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/files/film_pipe.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/sensor_health_json.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/live/camera.hpp"
#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/flight_deck.hpp"
#include "gatefly/live/hand_over_mark.hpp"
#include "gatefly/live/keeper.hpp"
#include "gatefly/live/linked.hpp"
#include "gatefly/live/run_recorder.hpp"
#include "gatefly/live/session.hpp"
#include "gatefly/race/chosen.hpp"
#include "gatefly/tasks/flight_inputs.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;
using files::fixed;
using namespace std::chrono_literals;

struct RunOptions {
  CommonOptions common;
  std::string track, camera, link, drone, out;
  std::optional<int> laps;
  double time_limit_s = 480.0;
  bool shadow = false, carried = false, json = false;
};

/// A course and the pilot that is to fly it.
struct Course {
  config::Config config;
  fs::path track_file;
  PilotConfig pilot;
};

Course course_of(const RunOptions& options) {
  Course course;
  course.track_file = config::find_track(options.track);
  config::Config config = load(options.common);
  const config::TrackFile track = config::read_track(course.track_file, config.gate);
  course.config = config::on_course(std::move(config), track);
  say_notes(course.config.notes);
  course.pilot = course.config.pilot;
  course.pilot.track = track.track;
  if (options.laps) course.pilot.track.laps = *options.laps;
  return course;
}

/// All that flies a drone; the keeper is a process of its own.
struct Flying {
  Flying(live::Introduced met, const live::DroneFile& drone, const live::FlightDeck::Params& params)
      : link{live::commands_on(std::move(met.port), drone, met.known)},
        deck{params},
        keeper{link.fd(), drone, met.known, params.hand_over.brake} {}
  live::LinkCommands link;
  live::FlightDeck deck;
  live::Keeper keeper;
};

/// A recorded flight in the place of a link.
struct RecordedLink {
  flight_log::FlightFolder folder;
  std::vector<flight_log::RecordedTick> ticks;
};

std::shared_ptr<const RecordedLink> recording_of(const live::LinkUri& uri) {
  auto recording = std::make_shared<RecordedLink>();
  recording->folder = flight_log::read_flight_folder(uri.place);
  recording->ticks = flight_log::ticks_of(recording->folder);
  return recording;
}

/// For a film without loss; without one each picture is a file.
bool has_ffmpeg() {
  try {
    files::require_ffmpeg();
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

/// Before anything is opened: what does not go together.
void check_options(const RunOptions& options, const live::LinkUri& link,
                   const live::CameraUri& camera) {
  const bool replayed = link.kind == live::LinkUri::Kind::kReplay;
  if (replayed && !options.shadow)
    throw std::runtime_error("--link replay:" + link.place +
                             ": nobody can fly a recording; look on with --shadow");
  if (!options.shadow && options.carried)
    throw std::runtime_error("--carried: a drone that flies is not carried; with --shadow only");
  if (replayed && (camera.kind != live::CameraUri::Kind::kFolder || camera.place != link.place))
    throw std::runtime_error("--link replay:" + link.place + " needs --camera file:" + link.place +
                             ": pictures and sensors of one flight");
  if (replayed && options.carried)
    throw std::runtime_error("--carried: a recorded flight says itself when it took off");
  if (!replayed && options.drone.empty())
    throw std::runtime_error("--drone is required: the file with the drone's constants");
}

std::string quantiles(std::vector<double>& values) {
  const auto ms = [&](double part) { return fixed(1e3 * files::nearest_rank(values, part), 2); };
  return values.empty()
             ? "none"
             : ms(0.5) + " ms median, " + ms(0.999) + " ms p99.9, " + ms(1.0) + " ms at most";
}

/// The content of a run's summary.json.
nlohmann::ordered_json summary_of(const RunOptions& options, const Course& course,
                                  live::Session& session, live::RunRecorder& recorder,
                                  const std::string& reason) {
  live::Wires& wires = session.wires();
  const live::ControllerState& state = wires.state.read();
  const live::DeckNews& deck = wires.deck.read();
  const Track& track = course.pilot.track;
  const auto ms = [](std::vector<double>& values) {
    nlohmann::ordered_json all;
    for (const auto& [name, part] : {std::pair{"p50_ms", 0.5}, {"p999_ms", 0.999}, {"max_ms", 1.0}})
      all[name] = values.empty() ? 0.0 : 1e3 * files::nearest_rank(values, part);
    return all;
  };
  return {{"kind", "run"},
          {"mode", options.shadow ? "shadow" : "flown"},
          {"track", track.name},
          {"version", GATEFLY_VERSION},
          {"gates_passed", recorder.gates_passed()},
          {"gates_total", track.laps * static_cast<int>(track.gates.size())},
          {"finished", recorder.finished()},
          {"stop_reason", reason},
          {"flight_time_s", seconds(recorder.last_time())},
          {"commands", recorder.ticks()},
          {"detection",
           {{"frames", recorder.pictures()}, {"with_gate", recorder.pictures_with_gate()}}},
          {"camera",
           {{"uri", options.camera},
            {"lost", wires.pictures_lost.load()},
            {"stalls", wires.stalls.load()}}},
          {"sensors", flight_log::as_json(session.sensor_health())},
          {"link",
           {{"uri", options.link},
            {"samples", state.samples},
            {"asked", state.asked},
            {"lost", state.lost},
            {"refused", state.refused},
            {"battery_v", state.battery_v}}},
          {"sticks",
           {{"frames", deck.frames},
            {"longest_gap_ms", 1e3 * seconds(deck.longest_gap)},
            {"late",
             {{"p50_ms", 1e3 * seconds(wires.late_frames.quantile(0.5))},
              {"p999_ms", 1e3 * seconds(wires.late_frames.quantile(0.999))},
              {"max_ms", 1e3 * seconds(wires.late_frames.longest())}}}}},
          {"system", {{"goes_first", wires.first.load()}, {"memory_held", wires.held.load()}}},
          {"pilot_loop",
           {{"hz", course.pilot.imu_hz},
            {"missed", wires.ticks_missed.load()},
            {"unrecorded", wires.unrecorded.load()},
            {"unwritten", recorder.unwritten()},
            {"late", ms(recorder.late())},
            {"step", ms(recorder.took())}}},
          {"config", config::as_json(course.config)}};
}

void print_run(const nlohmann::ordered_json& told, const SensorHealth& sensors,
               live::RunRecorder& recorder, const fs::path& out) {
  const auto line = [](const char* name, const std::string& text) {
    std::cout << "  " << std::left << std::setw(16) << name << text << '\n';
  };
  const auto number = [&](const char* part, const char* key) {
    return std::to_string(told.at(part).at(key).get<long>());
  };
  std::cout << told.at("track").get<std::string>() << ", " << told.at("mode").get<std::string>()
            << ": " << told.at("stop_reason").get<std::string>() << ", "
            << files::amount(static_cast<std::size_t>(recorder.gates_passed()), "gate")
            << " passed in " << fixed(seconds(recorder.last_time()), 1) << " s\n";
  line("commands",
       std::to_string(recorder.ticks()) + ", " + number("pilot_loop", "missed") + " ticks missed");
  line("pictures", std::to_string(recorder.pictures()) + ", " +
                       std::to_string(recorder.pictures_with_gate()) + " with a gate, " +
                       number("camera", "lost") + " lost, " + number("camera", "stalls") +
                       " stalls");
  line("link", number("link", "samples") + " samples, " + number("link", "asked") + " requests, " +
                   number("link", "lost") + " without an answer");
  const std::string refused = flight_log::in_words(sensors);
  line("sensors", refused.empty() ? "all well" : refused);
  line("woken late by", quantiles(recorder.late()));
  line("a step takes", quantiles(recorder.took()));
  if (!out.empty()) line("files", (out / "").string());
}

/// Says on stderr what the drone's owner has to know: who flies, and why not.
class Announcer {
 public:
  explicit Announcer(bool quiet) : quiet_{quiet} {}
  void say(const live::DeckNews& news) {
    const bool same = said_ && news.state.phase == phase_ && news.state.reason == reason_;
    if (quiet_ || same || news.frames == 0) return;
    said_ = true, phase_ = news.state.phase, reason_ = news.state.reason;
    constexpr std::array kNames{"starting", "neutral sticks are sent, the drone is yours", "flying",
                                "ending: braking, then down", "over"};
    std::cerr << "gatefly run: " << kNames[static_cast<std::size_t>(phase_)]
              << (reason_ == guard::Reason::kNone ? "" : ": ") << guard::text_of(reason_) << '\n';
  }

 private:
  bool quiet_, said_ = false;
  guard::Phase phase_ = guard::Phase::kStarting;
  guard::Reason reason_ = guard::Reason::kNone;
};

/// Why one that looks on ends now; "" while it does not.
std::string why_over(live::Session& session, double time_limit_s, bool over) {
  const live::Wires& wires = session.wires();
  if (interrupted()) return "told to end";
  if (seconds(session.clock().now()) > time_limit_s) return "time limit";
  if (!over) return "";
  if (!wires.link_error.empty()) return wires.link_error;
  if (wires.camera_over && !wires.camera_error.empty()) return wires.camera_error;
  return "the end";
}

/// The same of one that flies: whatever it is told, it ends when the drone is down.
std::string why_over_flying(live::Wires& wires, Announcer& announcer) {
  if (interrupted()) wires.told_to_end = true;
  const bool over = wires.link_over;
  const live::DeckNews& news = wires.deck.read();
  announcer.say(news);
  if (!over) return "";
  if (!wires.link_error.empty()) return wires.link_error;
  const std::string reason{guard::text_of(news.state.reason)};
  return reason.empty() ? "the end" : reason;
}

/// Lets it fly until something ends it. @return what.
std::string flown(live::Session& session, live::RunRecorder& recorder, const RunOptions& options) {
  live::Wires& wires = session.wires();
  Announcer announcer{options.common.quiet};
  const auto record = [&](const live::FlownTick& tick) { recorder.record(tick); };
  std::string reason;
  session.start();
  while (reason.empty()) {
    const bool over = session.over();
    const bool any = session.drain(record);
    reason = options.shadow ? why_over(session, options.time_limit_s, over)
                            : why_over_flying(wires, announcer);
    if (!any && reason.empty()) std::this_thread::sleep_for(1ms);
  }
  wires.stop = true;
  session.drain(record);
  session.stop();
  session.drain(record);
  return reason;
}

/// Refuses to fly what must not be flown, before anything is opened.
void expect_to_fly(const live::DroneFile& drone, const PilotConfig& pilot) {
  if (pilot.output != Output::kRatesThrust)
    throw std::runtime_error(
        "control.output must be \"rates_thrust\" to fly a drone (--config betaflight, or "
        "arducopter)");
  if (!live::hand_over_tested(drone, live::program_mark()))
    throw std::runtime_error(
        drone.path.string() + ": " + std::string{guard::text_of(guard::Reason::kNotTested)} +
        (drone.px4 ? "; there is none for a PX4 yet" : "; bench-drone --hand-over does it") +
        ", --shadow looks on without");
}

/// The pilot's plan, before anything is opened.
RacePlan plan_of(const Course& course) try {
  return gatefly::course_of(course.pilot).plan();
} catch (const std::invalid_argument& error) {
  throw std::runtime_error(std::string{"the track cannot be flown: "} + error.what());
}

live::FlightDeck::Params deck_params(const RunOptions& options, const Course& course,
                                     const live::DroneFile& drone) {
  constexpr double kAside = 3.0, kAbove = 1.5;  // of the fence [m]
  live::FlightDeck::Params params;
  params.hand_over.least_battery_v = drone.least_battery_v;
  params.hand_over.flight =
      std::chrono::nanoseconds{static_cast<std::int64_t>(1e9 * options.time_limit_s)};
  // A simulator that has gone, or that never disarms, leaves nobody in the air.
  if (drone.ts002) {
    params.hand_over.gone = live::kSimulatorGone;
    params.hand_over.ending = live::kSimulatorEnds;
  }
  params.fence = live::fence_around(course.pilot.track, plan_of(course), kAside, kAbove);
  params.hand_over_tested = true;  // expect_to_fly() has asked
  return params;
}

/// gatefly run: a real drone. Exit 0 done, 1 link or camera failed, 2 unusable input, 130 Ctrl-C.
int run(const RunOptions& options) {
  const live::LinkUri link = live::link_uri(options.link);
  const live::CameraUri camera = live::camera_uri(options.camera);
  check_options(options, link, camera);
  const bool replayed = link.kind == live::LinkUri::Kind::kReplay;
  const Course course = course_of(options);
  const live::StoredSize size{course.config.camera.stored_width(),
                              course.config.camera.stored_height()};
  std::optional<live::DroneFile> drone;
  if (!options.drone.empty()) drone = live::read_drone(options.drone);
  if (!options.shadow) expect_to_fly(*drone, course.pilot);
  live::LinkWork work;
  if (replayed) {
    work = [recording = recording_of(link), pace = link.pace](live::Wires& wires,
                                                              const live::RunClock& clock) {
      live::play(recording->ticks, recording->folder, pace, wires, clock);
    };
  } else if (options.shadow) {
    live::Introduced met = live::introduced(link, *drone, true, course.pilot.filter_imu_hz);
    const auto queries = std::make_shared<live::LinkQueries>(
        live::queries_on(std::move(met.port), *drone, met.known));
    work = [queries](live::Wires& wires, const live::RunClock& clock) {
      live::listen(*queries, wires, clock);
    };
  } else {
    const live::FlightDeck::Params deck = deck_params(options, course, *drone);
    // Its second process before anything else is open: that would be open there, too.
    const auto flying = std::make_shared<Flying>(
        live::introduced(link, *drone, false, course.pilot.filter_imu_hz), *drone, deck);
    work = [flying](live::Wires& wires, const live::RunClock& clock) {
      live::fly(flying->link, flying->deck, flying->keeper, wires, clock, interrupted);
    };
  }
  std::unique_ptr<live::Camera> eye = live::opened(camera, size, !replayed);
  std::unique_ptr<live::Session> session;
  try {
    session = std::make_unique<live::Session>(
        live::SessionPlan{.pilot = course.pilot,
                          .rotation_deg = course.config.camera.stored_rotation_deg,
                          .recorded = replayed,
                          .looks_on = options.shadow,
                          .carried = options.carried},
        std::move(eye), std::move(work));
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(std::string{"the track cannot be flown: "} + error.what());
  }
  catch_interrupt();
  const bool film =
      camera.kind == live::CameraUri::Kind::kStream && !options.out.empty() && has_ffmpeg();
  live::RunRecorder recorder(options.out, {.packed_log = true,
                                           .frames = film,
                                           .stored_width = size.width,
                                           .stored_height = size.height,
                                           .navigation_imu = course.pilot.filter_imu_hz > 0,
                                           .raw_frames = !film,
                                           .lifted = true,
                                           .picture_late = true});
  for (const auto& [name, content] : tasks::flight_inputs(
           options.common, course.config, course.track_file, course.pilot.track.laps))
    recorder.add_file(name, content);
  if (drone) recorder.add_file("drone.toml", files::read_file(options.drone));

  const std::string reason = flown(*session, recorder, options);
  const nlohmann::ordered_json told = summary_of(options, course, *session, recorder, reason);
  const std::string replaced = recorder.finish(files::json_text(told));
  if (!replaced.empty() && !options.common.quiet)
    std::cerr << "gatefly run: " << (fs::path{options.out} / "").string() << ": " << replaced
              << '\n';
  if (!recorder.error().empty())
    std::cerr << "gatefly run: not recorded to the end, the last "
              << files::amount(recorder.unwritten(), "tick") << " missing: " << recorder.error()
              << '\n';
  if (options.json)
    std::cout << files::json_text(told);
  else if (!options.common.quiet)
    print_run(told, session->sensor_health(), recorder, options.out);
  if (interrupted()) return kInterrupted;
  const bool well =
      options.shadow ? reason == "the end" || reason == "time limit" : recorder.finished();
  return well && recorder.error().empty() ? kDone : kAnswerIsNo;
}

}  // namespace

void declare_run(Command& command) {
  auto options = std::make_shared<RunOptions>();
  command.footer(
      "Example:\n  gatefly run aigp-pq --shadow --camera v4l2:/dev/video0 --link "
      "'msp:/dev/ttyTHS1?baud=115200' \\\n"
      "    --drone drone.toml --config imx477 --config archer-b2 --config betaflight --out "
      "out/shadow\n"
      "  gatefly run oval --shadow --camera file:out/oval-1 --link 'replay:out/oval-1?pace=0'\n\n"
      "With --shadow everything runs and nothing is sent but questions. Without it, a drone flies "
      "whose hand-over test\nhas passed with this program (gatefly bench-drone --hand-over), or a "
      "TS-002 simulator's.\n"
      "The folder of --out is one that replay flies again.\n"
      "Exit code 0: done; 1: link, camera or recording failed on the way; 2: unusable arguments, "
      "file or drone; 130: Ctrl-C.");
  command.option("TRACK", options->track, "a name in tracks/ or a file").required();
  command
      .option("--camera", options->camera,
              "v4l2:/dev/videoN, gst:PIPELINE, udp-jpeg:PORT, or file:DIR, a recorded flight")
      .required()
      .type_name("URI");
  command
      .option(
          "--link", options->link,
          "msp:/dev/ttyX?baud=115200, msp:tcp:HOST:PORT, betaflight-sitl:, "
          "mavlink:serial:/dev/ttyX?baud=921600, "
          "mavlink:tcp:HOST:PORT, mavlink:udp:HOST:PORT, or replay:DIR?pace=1, a recorded flight")
      .required()
      .type_name("URI");
  command.option("--drone", options->drone, "drone.toml: every constant of the drone").path("FILE");
  command.flag("--shadow", options->shadow, "everything runs, and the link cannot send sticks");
  command.flag("--carried", options->carried,
               "with --shadow: carried by hand, off the ground once it has rested for 1.5 s");
  command.option("--laps", options->laps, "instead of the track's own number").between(1, 100);
  command
      .option("--time-limit", options->time_limit_s,
              "ends after so long [s]; a flight: counted from when the drone is handed over")
      .between(0.1, 3600.0)
      .show_default();
  command.option("--out", options->out, "folder for the flight; without it nothing is kept")
      .path("DIR");
  command.flag("--json", options->json, "print summary.json instead of a screen");
  add_common(command, options->common);
  command.runs([options] { return run(*options); });
}

}  // namespace gatefly::cli
