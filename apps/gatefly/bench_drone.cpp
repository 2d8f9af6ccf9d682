// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "gatefly/files/json.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/live/ardu_bench.hpp"
#include "gatefly/live/bench.hpp"
#include "gatefly/live/drone_answers.hpp"
#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/hand_over_bench.hpp"
#include "gatefly/live/hand_over_mark.hpp"
#include "gatefly/live/uri.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

using namespace std::chrono_literals;

struct BenchDroneOptions {
  CommonOptions common;
  std::string link, camera, hand_over, out = "drone.toml";
  live::Told told;
  double turn_s = 60.0, step_s = 60.0;
  bool propellers_off = false, json = false;
};

/// Prints findings as they come, and remembers whether all were well.
class Protocol {
 public:
  Protocol(bool quiet, bool json) : quiet_{quiet}, json_{json} {}
  bool add(const live::Findings& findings) {
    for (const live::Finding& finding : findings) add(finding);
    return live::all_well(findings);
  }
  void add(const live::Finding& finding) {
    if (json_)
      told_.push_back({{"well", finding.well}, {"line", finding.line}});
    else if (!finding.well || !quiet_)
      std::cout << coloured(finding.well, finding.well ? "well   " : "WRONG  ") << finding.line
                << std::endl;
    well_ = well_ && finding.well;
  }
  [[nodiscard]] bool well() const { return well_; }
  /// @param file  that was written; "": none. @param what_for  of a line about it. @return the exit code.
  int end(const std::string& file = "", const std::string& what_for = "") {
    if (json_)
      std::cout << files::json_text(
          nlohmann::ordered_json{{"well", well_}, {"findings", told_}, {"file", file}});
    else if (!file.empty() && !quiet_)
      std::cout << file << ": written; " << what_for << '\n';
    return file.empty() ? kAnswerIsNo : kDone;
  }

 private:
  bool quiet_, json_, well_ = true;
  nlohmann::json told_ = nlohmann::json::array();
};

bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= 40 &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '-' || c == '_' || c == ' ';
         });
}

/// Asks whoever is at the drone for something, on stderr.
void ask_for(const std::string& what) { std::cerr << live::kBenchSays << what << '\n'; }

/// Writes the file with another mark, or none.
void set_mark(const live::DroneFile& drone, const std::string& mark) {
  files::write_file(drone.path,
                    live::with_hand_over_mark(drone, files::read_file(drone.path), mark));
}

/// With --hand-over. Exit 0: passed, and drone.toml says so; 1: it does not any more.
int hand_over(const BenchDroneOptions& options, const live::LinkUri& link) {
  if (options.camera.empty())
    throw std::runtime_error("--camera is required: what happens without it is part of the test");
  const live::CameraUri camera = live::camera_uri(options.camera);
  if (camera.kind == live::CameraUri::Kind::kFolder)
    throw std::runtime_error("--camera " + options.camera + ": a recording is no camera");
  const config::Config config = load(options.common);
  const live::DroneFile drone = live::read_drone(options.hand_over);
  if (drone.ts002)
    throw std::runtime_error(options.hand_over +
                             ": a TS-002 simulator needs no hand-over test: gatefly run flies it");
  if (drone.px4)
    throw std::runtime_error(options.hand_over +
                             ": a PX4 does not tell by which rates it flies, so there is no "
                             "hand-over test for it yet; look on with gatefly run --shadow");
  (void)live::with_hand_over_mark(drone, files::read_file(drone.path),
                                  "");  // that it can be written
  live::Introduced met = live::introduced(link, drone, false, config.pilot.filter_imu_hz);
  // From now on it has not passed, however this ends.
  if (!drone.tested.empty()) set_mark(drone, "");
  catch_interrupt();
  Protocol protocol{options.common.quiet, options.json};
  live::HandOverTest test;
  test.plan.camera = camera;
  test.plan.size = {config.camera.stored_width(), config.camera.stored_height()};
  test.step = std::chrono::milliseconds{static_cast<int>(1e3 * options.step_s)};
  test.say = ask_for;
  test.found = [&](const live::Finding& finding) { protocol.add(finding); };
  test.told_to_end = interrupted;
  test.plan.limits.least_battery_v = drone.least_battery_v;
  test.plan.limits.flight = 1h;  // whoever is at the radio takes the time that it takes
  ask_for("the motors will turn, and may turn up: propellers off, and the drone held fast");
  const bool passed = test.run(std::move(met), drone);
  if (interrupted()) {
    (void)protocol.end();
    return kInterrupted;
  }
  if (!passed) return protocol.end();
  set_mark(drone, live::hand_over_mark(drone, live::program_mark()));
  return protocol.end(options.hand_over,
                      "the hand-over test has passed: `gatefly run` flies this "
                      "drone, until the file or the program changes");
}

std::string next_step(const std::string& drone) {
  return "for --shadow; to fly, next: gatefly bench-drone --hand-over " + drone +
         " --propellers-off --link URI --camera URI";
}

/// The same of an ArduCopter or a PX4 with those answers, of which `read` makes its drone.
template <class Introduction, class Read>
int bench_mavlink(const BenchDroneOptions& options, live::Port port, const Introduction& answers,
                  Read&& read) {
  Protocol protocol{options.common.quiet, options.json};
  if (!protocol.add(live::of_introduction(answers))) return protocol.end();
  live::DroneFile drone;
  const auto& constants = read(drone);
  live::LinkCommands link = live::commands_on(std::move(port), drone, {});
  if (!options.common.quiet) ask_for("leave it level and still for three seconds");
  if (!protocol.add(live::of_rest(link, 3s))) return protocol.end();
  const auto say = [&](const std::string& what) {
    if (!options.common.quiet) ask_for(what);
  };
  const auto limit = std::chrono::milliseconds{static_cast<int>(1e3 * options.turn_s)};
  protocol.add(live::of_turns(link, limit, say));
  protocol.add(live::of_link(link, 3s));
  if (!protocol.well()) return protocol.end();
  files::write_file(options.out, live::drone_toml(constants, options.told));
  return protocol.end(options.out, drone.px4 ? "for --shadow" : next_step(options.out));
}

int bench_mavlink(const BenchDroneOptions& options, const live::LinkUri& uri, live::Port port) {
  if (live::is_px4(port, uri.system)) {
    const live::Px4Introduction said = live::px4_introduction_of(port, uri.system);
    const auto read = [&](live::DroneFile& drone) -> const live::Px4Drone& {
      drone.px4 = live::px4_drone_of(said.facts);
      drone.px4->system = uri.system;
      return *drone.px4;
    };
    return bench_mavlink(options, std::move(port), said, read);
  }
  const live::ArduIntroduction said = live::ardu_introduction_of(port, uri.system);
  const auto read = [&](live::DroneFile& drone) -> const live::ArduDrone& {
    drone.ardu = live::ardu_drone_of(said.facts);
    drone.ardu->system = uri.system;
    return *drone.ardu;
  };
  return bench_mavlink(options, std::move(port), said, read);
}

/// gatefly bench-drone: exit 0 all is well and the file written, 1 something is wrong with the drone, 2 unusable input.
int bench_drone(const BenchDroneOptions& options) {
  const live::LinkUri uri = live::link_uri(options.link);
  if (uri.kind == live::LinkUri::Kind::kReplay)
    throw std::runtime_error("--link " + options.link + ": a recording is no drone");
  if (!options.propellers_off)
    throw std::runtime_error("--propellers-off is missing: take them off, then say so");
  if (!options.hand_over.empty()) return hand_over(options, uri);
  if (!options.camera.empty()) throw std::runtime_error("--camera: is for --hand-over");
  if (uri.mavlink && options.told.hover_stick_us != 0)
    throw std::runtime_error(
        "--hover-stick-us: an ArduCopter tells itself: MOT_THST_HOVER, a PX4 MPC_THR_HOVER");
  const bool no_hover = !uri.mavlink && options.told.hover_stick_us == 0;
  for (const auto& [flag, missing] : {std::pair{"--name", options.told.name.empty()},
                                      {"--hover-stick-us", no_hover},
                                      {"--exponent", options.told.exponent == 0.0},
                                      {"--least-v", options.told.least_v < 0.0}})
    if (missing) throw std::runtime_error(std::string{flag} + " is required");
  if (!is_name(options.told.name))
    throw std::runtime_error("--name: must be 1 to 40 letters, digits, '-', '_' and spaces");
  check_outputs({{"--out", options.out, {"file of a drone", live::kDroneFileMark}}}, {},
                options.common);
  live::Port port = live::opened(uri);
  if (uri.mavlink) return bench_mavlink(options, uri, std::move(port));
  const live::Introduction said = live::introduction_of(port);
  Protocol protocol{options.common.quiet, options.json};
  // The checks below need a controller that is known. The link is timed even when a sensor is wrong.
  if (!protocol.add(live::of_introduction(said))) return protocol.end();
  msp::ImuScale scale;
  if (!options.common.quiet) ask_for("leave it level and still for three seconds");
  if (!protocol.add(live::of_rest(port, 3s, scale))) return protocol.end();
  const auto say = [&](const std::string& what) {
    if (!options.common.quiet) ask_for(what);
  };
  const auto limit = std::chrono::milliseconds{static_cast<int>(1e3 * options.turn_s)};
  protocol.add(live::of_turns(port, scale, limit, say));
  protocol.add(live::of_link(port, *said.facts.order(), 3s));
  if (!protocol.well()) return protocol.end();
  files::write_file(options.out, live::drone_toml(said, scale, options.told));
  return protocol.end(options.out, next_step(options.out));
}

}  // namespace

void declare_bench_drone(Command& command) {
  auto options = std::make_shared<BenchDroneOptions>();
  options->told.least_v = -1.0;
  command.footer(
      "Example:\n  gatefly bench-drone --propellers-off --link 'msp:/dev/ttyTHS1?baud=115200' "
      "--name archer-1 \\\n"
      "    --hover-stick-us 1425 --exponent 1.6 --least-v 19.8 --out drone.toml\n"
      "  gatefly bench-drone --hand-over drone.toml --propellers-off --link "
      "'msp:/dev/ttyTHS1?baud=115200' \\\n"
      "    --camera v4l2:/dev/video0 --config imx477\n\n"
      "The first writes the file. The second moves the sticks of the drone of that file, while "
      "somebody arms and switches\nas asked; when all is well it marks the file as passed, which "
      "`gatefly run` asks for. The mark is of this file and\nthis program; an older one is struck "
      "out as the test begins.\n"
      "Exit code 0: all is well, the file is written; 1: something is wrong with the drone, a line "
      "each; 2: unusable arguments,\n"
      "or nobody answers.");
  command
      .option(
          "--link", options->link,
          "msp:/dev/ttyX?baud=115200, msp:tcp:HOST:PORT, betaflight-sitl:, or mavlink: as of run")
      .required()
      .type_name("URI");
  command.flag("--propellers-off", options->propellers_off,
               "that they are off: stick frames will be sent");
  Flag hand_over =
      command.option("--hand-over", options->hand_over,
                     "the hand-over test of this drone.toml, with a hand on the radio");
  hand_over.path("FILE");
  command
      .option("--camera", options->camera,
              "of the hand-over test: v4l2:/dev/videoN, gst:PIPELINE or udp-jpeg:PORT")
      .type_name("URI");
  command
      .option("--step-s", options->step_s,
              "so long the hand-over test waits for each switch at the radio [s]")
      .between(1.0, 600.0)
      .show_default();
  command.option("--name", options->told.name, "what the drone is called")
      .excludes(hand_over)
      .type_name("NAME");
  command
      .option("--hover-stick-us", options->told.hover_stick_us,
              "throttle stick at which it hovers [µs]; no controller knows it")
      .excludes(hand_over)
      .between(1000, 2000);
  command.option("--exponent", options->told.exponent, "of thrust over throttle: 0.8 to 3")
      .excludes(hand_over)
      .between(0.8, 3.0);
  command.option("--least-v", options->told.least_v, "battery at which a flight ends [V]")
      .excludes(hand_over)
      .between(0.0, 60.0);
  command.option("--turn-s", options->turn_s, "so long it waits for the three turns by hand [s]")
      .between(1.0, 600.0)
      .show_default();
  command.option("--out", options->out, "the file to write")
      .excludes(hand_over)
      .path("FILE")
      .show_default();
  command.flag("--json", options->json, "print the findings as JSON");
  add_force(command, options->common);
  add_common(command, options->common);
  command.runs([options] { return bench_drone(*options); });
}

}  // namespace gatefly::cli
