// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/link_sim.hpp"

#include <cstdint>
#include <iomanip>
#include <iostream>
#include <memory>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "gatefly/files/json.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"

#include "commands.hpp"
#include "race_options.hpp"

namespace gatefly::cli {
namespace {

using files::fixed;

struct LinkSimOptions {
  RaceOptions race;
  link_sim::LinkSimParams params;
  std::uint64_t seed = 1;
  std::string log, bench, controller = "betaflight-4.5";
  /// Options that were not given follow the controller.
  std::optional<int> servos, state, radio, controller_port, mavlink, baud;
  bool json = false, second_round = false;
};

constexpr const char* kLogHeader =
    "t_s,armed,override,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,roll_rad,pitch_rad,yaw_rad,"
    "motor_lf,motor_rf,motor_rb,motor_lb,gates_passed,sticks_held_ms\n";

/// A line of the log.
std::string row_of(const link_sim::TrueMoment& now) {
  const sim::BodyState& s = now.state;
  const Attitude attitude = attitude_of({sim::R_EB_of(s.q_EB)});
  std::string row = fixed(now.time, 3) + (now.armed ? ",1" : ",0") + (now.overridden ? ",1" : ",0");
  const auto add = [&](auto... values) { ((row += "," + fixed(values, 4)), ...); };
  add(s.p_EB.x(), s.p_EB.y(), s.p_EB.z(), s.v_E.x(), s.v_E.y(), s.v_E.z());
  add(attitude.roll, attitude.pitch, attitude.yaw);
  add(now.motors[0], now.motors[1], now.motors[2], now.motors[3]);
  return row + "," + std::to_string(now.gates_passed) + "," + fixed(1e3 * now.sticks_held, 1) +
         "\n";
}

std::string outcome_of(const link_sim::Outcome& r) {
  return (r.finished ? std::string{"finished"} : "not finished: " + r.reason) + ", " +
         std::to_string(r.gates_passed) + " of " +
         files::amount(static_cast<std::size_t>(r.gates_total), "gate") +
         (r.finished ? " in " + fixed(r.race_time, 1) + " s" : "");
}

void print_outcome(const std::string& track, std::uint64_t seed, const link_sim::Outcome& r,
                   bool quiet) {
  std::cout << track << ", seed " << seed << ": " << coloured(r.finished, outcome_of(r)) << '\n';
  if (quiet) return;
  const auto line = [](const char* name, const std::string& text) {
    std::cout << "  " << std::left << std::setw(16) << name << text << '\n';
  };
  line("taken back", r.reason + " after " + fixed(r.flight_time, 1) + " s at (" +
                         fixed(r.last_p_EB.x(), 2) + ", " + fixed(r.last_p_EB.y(), 2) + ", " +
                         fixed(r.last_p_EB.z(), 2) + ") m");
  line("speed", (r.gates_passed > 1 ? fixed(r.mean_speed, 2) : "–") + " m/s mean");
  line("pictures", std::to_string(r.pictures) + ", " + std::to_string(r.pictures_late) + " late, " +
                       std::to_string(r.pictures_left_out) + " left out");
  line("longest stall", fixed(1e3 * r.longest_stall, 0) + " ms");
}

nlohmann::ordered_json told(const std::string& track, std::uint64_t seed,
                            const link_sim::Outcome& r) {
  nlohmann::ordered_json offsets = nlohmann::ordered_json::array();
  for (const Eigen::Vector2d& offset : r.gate_offsets) offsets.push_back({offset.x(), offset.y()});
  return {{"kind", "link-sim"},
          {"track", track},
          {"seed", seed},
          {"finished", r.finished},
          {"landed", r.landed},
          {"stop_reason", r.reason},
          {"gates_passed", r.gates_passed},
          {"gates_total", r.gates_total},
          {"race_time_s", r.race_time},
          {"flight_time_s", r.flight_time},
          {"mean_speed_mps", r.mean_speed},
          {"gate_offsets_m", offsets},
          {"pictures", r.pictures},
          {"pictures_late", r.pictures_late},
          {"pictures_left_out", r.pictures_left_out},
          {"longest_stall_ms", 1e3 * r.longest_stall}};
}

/// gatefly link-sim: exit 0 finished and landed, 1 not, 2 unusable input, 130 Ctrl-C.
int simulate_link(const LinkSimOptions& options) {
  check_outputs({{"--log", options.log, {"log of link-sim", kLogHeader}}}, {}, options.race.common);
  const simulated_race::RaceMaker maker = race_maker(options.race);
  const simulated_race::Race race = maker.race(options.seed);
  catch_interrupt();
  link_sim::LinkSimParams params = options.params;
  if (options.controller == "arducopter") {
    params.autopilot = link_sim::Autopilot::kArduCopter;
    const int msp = params.ports.msp, pictures = params.ports.pictures;
    params.ports = link_sim::kArduCopterPorts;
    params.ports.msp = msp, params.ports.pictures = pictures;
    params.baud = 921600;
    // Its motors stand for two seconds after arming.
    params.radio.hand_over = 3.0;
  }
  if (options.controller == "px4") {
    params.autopilot = link_sim::Autopilot::kPx4;
    const int pictures = params.ports.pictures;
    params.ports = link_sim::kPx4Ports;
    params.ports.pictures = pictures;
    // Its motors stand for a second after arming.
    params.radio.hand_over = 2.0;
  }
  if (options.controller == "ts-002") {
    if (!options.bench.empty())
      throw std::runtime_error("--bench: TS-002 has no bench; nobody hands its drone over");
    params.autopilot = link_sim::Autopilot::kTs002;
    params.tells_attitude = !options.second_round;
    // Nobody but the program flies it: armed is handed over.
    params.radio.hand_over = 0.0;
  } else if (options.second_round) {
    throw std::runtime_error("--second-round: is for --autopilot ts-002");
  }
  params.baud = options.baud.value_or(params.baud);
  params.ports.servos = options.servos.value_or(params.ports.servos);
  params.ports.state = options.state.value_or(params.ports.state);
  params.ports.radio = options.radio.value_or(params.ports.radio);
  params.ports.controller = options.controller_port.value_or(params.ports.controller);
  params.ports.mavlink = options.mavlink.value_or(params.ports.mavlink);
  params.release = options.controller == "betaflight-4.5" ? betaflight_sitl::Release::k4_5
                                                          : betaflight_sitl::Release::k2026;
  const auto say = [&](const std::string& what) {
    if (!options.race.common.quiet) std::cerr << "gatefly link-sim: " << what << std::endl;
  };
  const auto no_controller = [&] {
    const bool px4 = params.autopilot == link_sim::Autopilot::kPx4;
    return std::runtime_error(
        std::string{"no flight controller tells motors at "} + (px4 ? "tcp" : "udp") +
        " 127.0.0.1:" + std::to_string(px4 ? params.ports.state : params.ports.servos));
  };
  if (!options.bench.empty()) {
    if (!link_sim::hold(
            race.config.sim, options.bench, params, say, [] { return interrupted(); },
            stop_if_interrupted))
      throw no_controller();
    return kInterrupted;
  }
  std::string log = kLogHeader;
  const auto look = [&](const link_sim::TrueMoment& now) {
    if (!options.log.empty()) log += row_of(now);
  };
  const link_sim::Outcome outcome = link_sim::fly(
      race.config.sim, race.config.pilot.track.laps, params, say, look,
      [] { return interrupted(); }, stop_if_interrupted);
  if (interrupted()) return kInterrupted;
  if (outcome.reason == "no controller") throw no_controller();
  if (!options.log.empty()) files::write_file(options.log, log);
  if (options.json)
    std::cout << files::json_text(told(race.identity.track, options.seed, outcome));
  else
    print_outcome(race.identity.track, options.seed, outcome, options.race.common.quiet);
  return outcome.finished && outcome.landed ? kDone : kAnswerIsNo;
}

}  // namespace

void declare_link_sim(Command& command) {
  auto options = std::make_shared<LinkSimOptions>();
  link_sim::Ports& ports = options->params.ports;
  constexpr int kMostPort = 65535;
  command.footer(
      "Example, with Betaflight's simulator running beside it:\n"
      "  gatefly link-sim oval --vehicle archer-b2 --config betaflight --seed 7\n"
      "with ArduCopter's (arducopter --model json:127.0.0.1 --serial0 tcp:5760):\n"
      "  gatefly link-sim oval --vehicle archer-b2 --config arducopter --autopilot arducopter\n"
      "with PX4's, set up as docs/real_drone.md says:\n"
      "  gatefly link-sim oval --vehicle archer-b2 --config arducopter --autopilot px4\n"
      "or as a simulator of TS-002, the AI Grand Prix's virtual qualifier, without any other "
      "program:\n"
      "  gatefly link-sim oval --vehicle archer-b2 --camera grandprix --config ts002 --autopilot "
      "ts-002\n\n"
      "It waits for the controller, then says \"ready\"; once a program has called it "
      "arms, "
      "hands over, and takes the\ndrone back when it has landed, hit something, or the time is "
      "over. Everything is on 127.0.0.1.\n"
      "With --bench FILE the drone is in somebody's hand, without propellers, who turns it and "
      "switches at the radio as new "
      "lines of\nFILE ask: what `gatefly bench-drone` says (2> FILE), or one of the words turn, "
      "arm, override on, override off, "
      "disarm.\nCtrl-C ends it.\n"
      "Exit code 0: all gates passed, and landed; 1: not; 2: unusable arguments, or no controller; "
      "130: Ctrl-C.");
  command.option("TRACK", options->race.track, "a name in tracks/ or a file").required();
  command.option("--seed", options->seed, "random seed, as of fly").show_default();
  command.option("--laps", options->race.laps, "instead of the track's own number").between(1, 100);
  command
      .option("--autopilot", options->controller,
              "the controller's simulator: its releases differ in a sign; ts-002: our own")
      .one_of({"betaflight-4.5", "betaflight-2026", "arducopter", "px4", "ts-002"})
      .show_default();
  command.option("--baud", options->baud, "speed of the serial line: 115200; ArduCopter's 921600")
      .between(9600, 10'000'000);
  command
      .option("--loss", options->params.network.loss,
              "part of the pictures' slices that is lost; of TS-002 and PX4 all datagrams'")
      .between(0.0, 0.9);
  command
      .option("--reorder", options->params.network.reorder,
              "part of them that comes after the next one")
      .between(0.0, 0.9);
  command.option("--time-limit", options->params.radio.time_limit, "of the flight [s]")
      .between(1.0, 3600.0)
      .show_default();
  command
      .option("--link-out-s", options->params.link_out,
              "so long after the hand-over the cable is pulled [s]")
      .between(0.0, 3600.0);
  command
      .option("--camera-out-s", options->params.camera_out,
              "so long after the hand-over the camera hangs [s]")
      .between(0.0, 3600.0);
  const auto port = [&](const char* name, auto& value, const char* what) {
    return command.option(name, value, what).between(1, kMostPort);
  };
  port("--servos", options->servos,
       "UDP port at which the controller tells its motors: 9001; ArduCopter's 9002");
  port("--state", options->state,
       "UDP port at which it hears its sensors: 9003; ArduCopter hears them at its own; PX4 calls "
       "at TCP 4560 for them and for its motors");
  port("--radio", options->radio,
       "UDP port of its receiver: 9004; ArduCopter's 5501; PX4's for a ground station 18570");
  port("--controller", options->controller_port,
       "TCP port of its serial line: 5761; ArduCopter's 5760; PX4 tells a computer aboard at UDP "
       "14540");
  port("--msp", ports.msp, "TCP port of that line, paced, for the program that flies")
      .show_default();
  port("--pictures", ports.pictures, "UDP port of that program's camera").show_default();
  port("--mavlink", options->mavlink,
       "UDP port of that program's end of TS-002, 14550, or of PX4, 14551");
  command.flag("--second-round", options->second_round,
               "TS-002 as in its second round: no ATTITUDE");
  Flag log =
      command.option("--log", options->log, "where the drone truly was, 50 times a second: a CSV");
  log.path("FILE");
  Flag json = command.flag("--json", options->json, "print the outcome as JSON");
  command
      .option("--bench", options->bench,
              "do not fly: hold the drone at a bench, and do what new lines of this file ask for")
      .excludes(log)
      .excludes(json)
      .path("FILE");
  add_force(command, options->race.common);
  add_drone(command, options->race.drone);
  add_common(command, options->race.common);
  command.runs([options] {
    take_drone(options->race.drone, options->race.common);
    return simulate_link(*options);
  });
}

}  // namespace gatefly::cli
