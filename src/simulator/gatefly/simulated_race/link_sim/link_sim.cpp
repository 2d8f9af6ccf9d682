// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/link_sim.hpp"

#include <chrono>
#include <memory>
#include <optional>

#include "gatefly/simulated_race/link_sim/bench_hand.hpp"
#include "gatefly/simulated_race/link_sim/controller.hpp"
#include "gatefly/simulated_race/link_sim/drone_in_world.hpp"
#include "gatefly/simulated_race/link_sim/held_drone.hpp"
#include "gatefly/simulated_race/link_sim/new_lines.hpp"
#include "gatefly/simulated_race/link_sim/pace.hpp"
#include "gatefly/simulated_race/link_sim/paced_line.hpp"

namespace gatefly::link_sim {
namespace {

constexpr int kRadioEvery = 20, kLookEvery = 20, kReadEvery = 20;             ///< Steps.
constexpr double kStep = std::chrono::duration<double>(Pace::kStep).count();  ///< [s]
constexpr double kCalibrates = 4.0;  ///< A controller looks at a gyro at rest first [s].
constexpr double kFalls = 2.0;       ///< From taking it back to the end [s].
constexpr double kPatience = 20.0;   ///< For a controller to say something to its motors [s].

/// Betaflight and ArduCopter are talked to as by a serial line, the others by datagrams.
bool has_serial_line(Autopilot autopilot) {
  return autopilot == Autopilot::kBetaflight || autopilot == Autopilot::kArduCopter;
}

std::string why_taken_back(const DroneInWorld& drone, const SafetyPilot& radio, double limit) {
  if (drone.hit()) return "hit " + *drone.hit();
  return drone.time() - radio.handed_over_at() >= limit ? "time limit" : "landed";
}

}  // namespace

Outcome fly(const world::SimConfig& config, int laps, const LinkSimParams& params,
            const std::function<void(const std::string&)>& say,
            const std::function<void(const TrueMoment&)>& look, const std::function<bool()>& stop,
            const std::function<void()>& while_baking) {
  const Ports& ports = params.ports;
  const std::unique_ptr<Controller> controller = controller_of(params, config);
  DroneInWorld drone{config, laps};
  PictureFeed pictures{config, Datagrams::to(ports.pictures), params.network, while_baking};
  SafetyPilot radio{params.radio};
  std::optional<PacedLine> line;
  bool ready = false;
  Outcome outcome;
  outcome.gates_total = drone.gates_total();
  std::optional<double> taken_back;
  Pace pace;
  while (!taken_back || drone.time() < *taken_back + kFalls) {
    pace.wait();
    if (stop()) {
      outcome.reason = "stopped";
      break;
    }

    controller->listen(drone.time());
    drone.step(controller->motors(), kStep);
    controller->feel(drone.told(), drone.state());
    pictures.remember({drone.time(), drone.state().p_EB, drone.state().q_EB}, pace.start());

    const SafetyPilot::State before = radio.state();
    radio.step({.time = drone.time(),
                .client = line ? line->connected() : ready && controller->called(),
                .motors = controller->turn(),
                .on_floor = drone.rests(),
                .airborne = drone.airborne(),
                .hit = drone.hit().has_value()});
    if (pace.every(kRadioEvery) || radio.state() != before)
      controller->hear_radio(drone.told().time, msp::kNeutral, radio.switches());
    if (pace.every(kLookEvery))
      look({.time = drone.time(),
            .armed = radio.armed(),
            .overridden = radio.override_on(),
            .state = drone.state(),
            .motors = controller->motors(),
            .sticks_held =
                line ? line->stick_gaps().longest(live::Clock::now()) : controller->held_for(),
            .gates_passed = static_cast<int>(drone.passes().size())});
    const auto is_over_for = [&](const std::optional<double>& limit) {
      return limit && radio.override_on() && drone.time() - radio.handed_over_at() >= *limit;
    };
    if (is_over_for(params.link_out)) line ? line->cut() : controller->cut();
    if (is_over_for(params.camera_out)) pictures.freeze();
    const auto enters = [&](SafetyPilot::State state) {
      return radio.state() == state && before != state;
    };
    if (enters(SafetyPilot::State::kHandedOver)) say("armed, and handed over");
    if (enters(SafetyPilot::State::kNotArmed))
      say("the controller does not arm; again in a second");
    if (enters(SafetyPilot::State::kTookBack)) {
      taken_back = drone.time();
      outcome.reason = why_taken_back(drone, radio, params.radio.time_limit);
      outcome.flight_time = *taken_back - radio.handed_over_at();
      outcome.last_p_EB = drone.state().p_EB;
      say("taken back: " + outcome.reason);
    }
    if (!ready && controller->ever() && drone.time() > kCalibrates) {
      if (has_serial_line(params.autopilot)) line.emplace(ports.msp, ports.controller, params.baud);
      ready = true;
      say("ready");
    }
    if (!ready && drone.time() > kPatience) {
      outcome.reason = "no controller";
      break;
    }
  }
  outcome.longest_stall = pace.longest_stall();
  outcome.finished = drone.finished();
  outcome.landed = outcome.reason == "landed";
  outcome.gates_passed = static_cast<int>(drone.passes().size());
  for (const sim::GatePass& pass : drone.passes()) outcome.gate_offsets.push_back(pass.offset);
  if (!drone.passes().empty())
    outcome.race_time = drone.passes().back().time - radio.handed_over_at();
  outcome.mean_speed = drone.mean_speed();
  outcome.pictures = pictures.sent();
  outcome.pictures_left_out = pictures.left_out();
  outcome.pictures_late = pictures.late();
  return outcome;
}

bool hold(const world::SimConfig& config, const std::string& asks, const LinkSimParams& params,
          const std::function<void(const std::string&)>& say, const std::function<bool()>& stop,
          const std::function<void()>& while_baking) {
  const Ports& ports = params.ports;
  NewLines lines{asks};
  const std::unique_ptr<Controller> controller = controller_of(params, config);
  HeldDrone drone{config};
  PictureFeed pictures{config, Datagrams::to(ports.pictures), params.network, while_baking};
  BenchHand hand;
  std::optional<PacedLine> line;
  bool ready = false;
  for (Pace pace; !stop();) {
    pace.wait();
    controller->listen(drone.time());
    drone.step(kStep);
    controller->feel(drone.told(), drone.state());
    pictures.remember({drone.time(), drone.state().p_EB, drone.state().q_EB}, pace.start());
    if (pace.every(kReadEvery))
      for (const std::string& asked : lines.read()) hand.hear(asked, drone.time());
    const auto done = hand.step(drone.time(), controller->turn());
    if (done) say(std::string{text_of(*done)});
    if (done == Deed::kTurnRoll) drone.turn(0);
    if (done == Deed::kTurnPitch) drone.turn(1);
    if (done == Deed::kTurnYaw) drone.turn(2);
    if (pace.every(kRadioEvery) || done)
      controller->hear_radio(drone.told().time, hand.sticks(),
                             switches_of(hand.armed(), hand.override_on()));
    if (!ready && controller->ever() && drone.time() > kCalibrates) {
      if (has_serial_line(params.autopilot)) line.emplace(ports.msp, ports.controller, params.baud);
      ready = true;
      say("ready");
    }
    if (!ready && drone.time() > kPatience) return false;
  }
  return true;
}

}  // namespace gatefly::link_sim
