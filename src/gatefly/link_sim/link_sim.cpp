// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link_sim/link_sim.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <thread>

#include "gatefly/link_sim/controller.hpp"
#include "gatefly/link_sim/drone_in_world.hpp"
#include "gatefly/link_sim/paced_line.hpp"
#include "gatefly/live/clock.hpp"

namespace gatefly::link_sim {
namespace {

using namespace std::chrono_literals;

constexpr auto kStep = 1ms;
constexpr auto kMostBehind = 50ms;  ///< More is not made up for: the flight lasts longer then.
constexpr int kRadioEvery = 20, kLookEvery = 20;  ///< Steps.
constexpr double kCalibrates = 4.0;  ///< A controller looks at a gyro at rest first [s].
constexpr double kFalls = 2.0;       ///< From taking it back to the end [s].
constexpr double kPatience = 20.0;   ///< For a controller to say something to its motors [s].

std::string why_taken_back(const DroneInWorld& drone, const SafetyPilot& radio, double limit) {
  if (drone.hit()) return "hit " + *drone.hit();
  return drone.time() - radio.handed_over_at() >= limit ? "time limit" : "landed";
}

}  // namespace

Outcome fly(const sim::SimConfig& day, int laps, const LinkSimParams& params,
            const std::function<void(const std::string&)>& say,
            const std::function<void(const TrueMoment&)>& look, const std::function<bool()>& stop,
            const std::function<void()>& while_baking) {
  const Ports& ports = params.ports;
  const std::unique_ptr<Controller> controller = controller_of(params);
  DroneInWorld drone{day, laps};
  PictureFeed pictures{day, Datagrams::to(ports.pictures), params.network, while_baking};
  SafetyPilot radio{params.radio};
  std::optional<PacedLine> line;
  Outcome outcome;
  outcome.gates_total = drone.gates_total();
  std::optional<double> taken_back;
  live::Moment start = live::Clock::now();
  for (long step = 0; !taken_back || drone.time() < *taken_back + kFalls; ++step) {
    const live::Moment due = start + step * kStep;
    std::this_thread::sleep_until(due);
    const auto behind = live::Clock::now() - due;
    outcome.longest_stall =
        std::max(outcome.longest_stall, std::chrono::duration<double>(behind).count());
    if (behind > kMostBehind) start += behind;
    if (stop()) {
      outcome.reason = "stopped";
      break;
    }

    controller->listen(drone.time());
    drone.step(controller->motors(), std::chrono::duration<double>(kStep).count());
    controller->feel(drone);
    pictures.remember({drone.time(), drone.state().p_EB, drone.state().q_EB}, start);

    const SafetyPilot::State before = radio.state();
    radio.step({.time = drone.time(),
                .client = line && line->connected(),
                .motors = controller->turn(),
                .on_floor = drone.rests(),
                .airborne = drone.airborne(),
                .hit = drone.hit().has_value()});
    if (step % kRadioEvery == 0 || radio.state() != before) controller->hear_radio(drone, radio);
    if (step % kLookEvery == 0)
      look({.time = drone.time(),
            .armed = radio.armed(),
            .overridden = radio.override_on(),
            .state = drone.state(),
            .motors = controller->motors(),
            .gates_passed = static_cast<int>(drone.passes().size())});
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
    if (!line && controller->ever() && drone.time() > kCalibrates) {
      line.emplace(ports.msp, ports.controller, params.baud);
      say("ready");
    }
    if (!line && drone.time() > kPatience) {
      outcome.reason = "no controller";
      break;
    }
  }
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

}  // namespace gatefly::link_sim
