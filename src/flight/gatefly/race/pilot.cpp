// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/pilot.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/control/attitude_rates.hpp"
#include "gatefly/control/indi.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/race/chosen.hpp"
#include "gatefly/race/intake.hpp"
#include "gatefly/race/part_params.hpp"

namespace gatefly {
namespace {

// By way of an autopilot thrust comes as late as everything else.
VehicleParams rotors_as_felt(const PilotConfig& config) {
  VehicleParams vehicle = config.vehicle;
  if (config.output != Output::kMotors) vehicle.rotor_time_constant = config.rates.response;
  return vehicle;
}

// An autopilot that holds angles tilts in the axes of the heading that it has, not of the one to come.
AttitudeCommand as_heading_is(AttitudeCommand command, double yaw) {
  const auto [sine, cosine] = sincos(command.yaw - yaw);
  const double pitch = command.pitch, roll = command.roll;
  command.pitch = cosine * pitch + sine * roll;
  command.roll = cosine * roll - sine * pitch;
  return command;
}

bool is_resting(const Phase& phase) {
  return std::holds_alternative<OnGround>(phase) || std::holds_alternative<Landed>(phase);
}

}  // namespace

struct Pilot::Parts {
  explicit Parts(const PilotConfig& config)
      : intake{config.imu_hz},
        lookout{config},
        course{course_of(config)},
        guidance{config},
        output{config.output},
        vehicle{config.vehicle},
        indi{indi_params(config), config.vehicle},
        rates{config.rates, config.indi.max_yaw_rate} {}

  Intake intake;
  ChosenLookout lookout;
  Course course;
  ChosenGuidance guidance;
  Output output;
  VehicleParams vehicle;
  Indi indi;            ///< One of these two turns
  AttitudeRates rates;  ///< the attitude into a command.
};

Pilot::Pilot(const PilotConfig& config)
    : map_uncertainty_{map_uncertainty(config)},
      navigator_{navigator_params(config)},
      parts_{std::make_unique<Parts>(config)},
      phase_params_{phase_params(config)},
      thrust_{rotors_as_felt(config)},
      uses_sonar_{config.uses_sonar},
      uses_baro_{config.uses_baro} {
  check_latency(config);
  const Track& track = config.track;
  navigator_.start({track.start.x(), track.start.y(), 0.0}, track.start_heading,
                   frame_of(parts_->course.gate()), map_uncertainty_);
  now_ = navigator_.state();
}
Pilot::Pilot(Pilot&&) noexcept = default;
Pilot& Pilot::operator=(Pilot&&) noexcept = default;
Pilot::~Pilot() = default;

/// One tick of the system diagram, Li18 Fig. "system structure", left to right.
Command Pilot::step(const Sensors& arrived) {
  // sense: what is no reading goes no further
  const Sensors& sensors = parts_->intake.take(arrived, !is_resting(phase_));
  // estimate: attitude from gyro and gravity; drag carries the position between sightings ...
  navigate(sensors);
  // detect -> pose: ... and a gate in view pulls it back
  look(sensors);
  // race: how far along the course, and what that asks for
  follow_course();
  change_phase(sensors);
  // control: attitude, then rotor speeds, or what an autopilot takes
  const Command next = command(guide());
  motors_ = next.motors;
  return next;
}

void Pilot::navigate(const Sensors& sensors) {
  const double time = std::chrono::duration<double>(sensors.time).count();
  const bool knows_motors = !sensors.looks_on || sensors.motors;
  const double thrust =
      knows_motors ? thrust_.update(sensors.looks_on ? *sensors.motors : motors_, time) : 0.0;
  if (std::holds_alternative<OnGround>(phase_)) {
    navigator_.rest(sensors.imu, time, sensors.navigation_imu);
  } else {
    navigator_.predict(sensors.imu, time, sensors.navigation_imu, thrust);
    navigator_.measure_heights(uses_sonar_ ? sensors.sonar : std::nullopt,
                               uses_baro_ ? sensors.baro : std::nullopt);
  }
}

void Pilot::look(const Sensors& sensors) {
  const bool looking = parts_->guidance.uses_pictures(phase_);
  parts_->lookout.look(sensors, looking, parts_->course, navigator_);
  now_ = navigator_.state();
}

const SensorHealth& Pilot::health() const { return parts_->intake.health(); }

bool Pilot::finished() const { return parts_->course.finished(); }
int Pilot::target_gate() const { return parts_->course.target(); }
const RacePlan& Pilot::plan() const { return parts_->course.plan(); }

std::optional<eskf::Monitor::Verdict> Pilot::divergence() const {
  const eskf::Monitor* monitor = parts_->lookout.monitor();
  return monitor != nullptr ? monitor->verdict() : std::nullopt;
}

const Sighting& Pilot::sighting() const { return parts_->lookout.sighting(); }

AttitudeCommand Pilot::guide() { return parts_->guidance.command(phase_, now_, parts_->course); }

void Pilot::follow_course() {
  if (!parts_->course.follow(now_, phase_)) return;
  navigator_.change_gate(frame_of(parts_->course.gate()), map_uncertainty_);
  now_ = navigator_.state();
  passed_at_ = now_.time;
  // The gate that was searched for is passed, and the waiting place before it is of no use.
  if (std::holds_alternative<Search>(phase_)) phase_ = Straight{};
}

void Pilot::change_phase(const Sensors& sensors) {
  Situation now = situation();
  now.lifted = sensors.lifted;
  // Another pilot may not need pictures, nor wait for a gate.
  if (!sensors.looks_on) {
    now.since_picture = parts_->intake.since_picture();
    now.gate_expected = parts_->lookout.sighting().expected;
  }
  now.picture_interval = parts_->intake.picture_interval();
  const Transition next = next_phase(phase_, now, phase_params_);
  const auto* search = std::get_if<Search>(&phase_);
  const bool found_again = search != nullptr && std::holds_alternative<Straight>(next.phase);
  if (found_again && !search->stand_at) parts_->course.approach_straight(now_);
  if (parts_->course.before_approach() && std::holds_alternative<Straight>(next.phase)) {
    navigator_.begin_leg(parts_->course.turn_end());  // the plan's place, for the paper's filter
    now_ = navigator_.state();
    parts_->course.begin_approach();
  }
  phase_ = next.phase;
  if (next.reason != AbortReason::kNone) abort_reason_ = next.reason;
}

Situation Pilot::situation() {
  const NavigationState& now = now_;
  Situation s;
  s.time = now.time;
  s.rest_samples = now.rest_samples;
  s.height = -now.p_EB.z();
  const bool on_its_way =
      std::holds_alternative<Straight>(phase_) || std::holds_alternative<Turn>(phase_);
  s.course_done = on_its_way ? parts_->course.ran_out() : parts_->course.finished();
  s.to_go = parts_->course.to_go();
  if (const Stop* stop = parts_->course.stop()) s.to_stop = stop->s - parts_->course.progress();
  s.room_before = parts_->course.room_before();
  s.since_gate = now.time - passed_at_;
  s.turn_ahead = parts_->guidance.turn_ahead(now, parts_->course);
  s.gate_y_ahead = parts_->guidance.lateral_at_gate(now, parts_->course);
  s.forward_speed = parts_->guidance.entry_speed(now);
  s.gate_x = now.p_GB.x();
  s.gate_y = now.p_GB.y();
  s.lateral_sigma = now.lateral_sigma;
  s.p_EB = now.p_EB.head<2>(), s.v_E = now.v_E.head<2>();
  s.drift_sigma = drift_sigma(now);
  s.since_doubt = now.since_doubt;
  s.speed = now.v_B.head<2>().norm();
  s.room_beside = parts_->course.room_beside(0.5 * s.speed * s.speed / Braking{}.on_the_way + 0.5);
  s.yaw = now.attitude.yaw;
  s.since_fix = now.since_fix;
  s.since_imu = now.since_imu;
  s.imu_stuck = parts_->intake.imu_stuck();
  if (std::holds_alternative<Search>(phase_))
    s.shows_whole = parts_->lookout.would_show_whole(parts_->course.gate(), now.p_GB);
  s.tilt = acos(now.R_EB.matrix(2, 2));
  return s;
}

// A doubt adds no drift: the gates in view contradict the place, and the next ones will settle it. While
// the drone stands and looks round it is lost until it knows its place as well as before.
double Pilot::drift_sigma(const NavigationState& now) {
  const auto* search = std::get_if<Search>(&phase_);
  const bool stands = search != nullptr && search->stand_at;
  if (std::min(now.since_gate, now.since_doubt) <= now.dt && !stands)
    known_sigma_ = now.place_sigma;
  const double grown = now.place_sigma * now.place_sigma - known_sigma_ * known_sigma_;
  return std::sqrt(std::max(0.0, grown));
}

Command Pilot::command(const AttitudeCommand& attitude) {
  if (is_resting(phase_)) {
    parts_->indi.reset(), parts_->rates.reset();
    parts_->guidance.reset();
    return {.attitude = attitude};
  }
  const NavigationState& now = now_;
  if (parts_->output == Output::kMotors)
    return {attitude, parts_->indi.step(attitude, now.R_EB, now.rate_B, now.dt)};
  const bool by_angles = parts_->output == Output::kAttitudeThrust;
  return {by_angles ? as_heading_is(attitude, now.attitude.yaw) : attitude,
          speeds_for(attitude.thrust, parts_->vehicle),
          parts_->rates.step(attitude, now.R_EB, now.dt)};
}

Estimate Pilot::estimate() const {
  const NavigationState& now = now_;
  Estimate e;
  e.p_EB = now.p_EB;
  e.v_E = now.v_E;
  e.attitude = now.attitude;
  e.accel_bias = navigator_.accel_bias();
  e.gyro_bias = navigator_.gyro_bias();
  e.p_GB = now.p_GB;
  e.covariance_GB = navigator_.covariance_GB();
  e.gates_passed = parts_->course.passed();
  return e;
}

}  // namespace gatefly
