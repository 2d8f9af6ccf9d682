// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/pilot.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

constexpr double kImuHz = 512.0;
constexpr double kAccelCutoffHz = 20.0;  // [Li18 flight code]

// Beyond any MEMS range a number is as broken as NaN, and would become one inside.
bool is_usable(const Imu& imu) {
  return imu.gyro_B.allFinite() && imu.accel_B.allFinite() &&
         imu.gyro_B.cwiseAbs().maxCoeff() < 100.0 && imu.accel_B.cwiseAbs().maxCoeff() < 400.0;
}

}  // namespace

Pilot::Pilot(const PilotConfig& config)
    : config_{config},
      plan_{plan_race(config.track, config.plan)},
      ahrs_{config.ahrs},
      accel_filter_{kAccelCutoffHz, kImuHz},
      memory_{config.filter},
      velocity_{config.velocity},
      altimeter_{config.altimeter},
      indi_{config.indi, config.vehicle},
      detector_{config.detector} {
  ahrs_.start(config_.track.start_heading);
}

/// One tick of the system diagram, Li18 Fig. "system structure", left to right.
Command Pilot::step(const Sensors& sensors) {
  const double dt = advance_clock(sensors.time);

  // sense: attitude from gyro and gravity
  sense(sensors.imu, dt);

  // estimate: the drag model carries the position between sightings ...
  estimate_motion(dt);
  measure_height(sensors);

  // detect -> pose: ... and a gate in view pulls it back
  sighting_.seen = false;
  if (sensors.image || sensors.seen) look(sensors);

  // race: how far along the course, and what that asks for
  follow_course();
  Transition next = next_phase(phase_, situation(), config_.phase);
  if (std::holds_alternative<Turn>(next.phase) && !std::holds_alternative<Turn>(phase_))
    std::get<Turn>(next.phase).arc = {.yaw = ahrs_.attitude().yaw, .v_F = {forward_speed(), 0, 0}};
  if (std::holds_alternative<Land>(next.phase) && !std::holds_alternative<Land>(phase_))
    std::get<Land>(next.phase).z = p_EB().z();
  if (std::holds_alternative<Search>(next.phase) && !std::holds_alternative<Search>(phase_)) {
    hold_x_ = std::min(-2.2, filter().position().x() - 0.5);
    hold_integral_.setZero();
  }
  if (std::holds_alternative<Search>(phase_) && std::holds_alternative<Straight>(next.phase))
    approach_from_here();
  phase_ = next.phase;
  if (next.reason != AbortReason::kNone) abort_reason_ = next.reason;

  // control: attitude, then rotor speeds
  Command out;
  out.attitude = command(dt);
  if (std::holds_alternative<OnGround>(phase_) || std::holds_alternative<Landed>(phase_)) {
    indi_.reset();
    altitude_.reset();
  } else {
    out.motors = indi_.step(out.attitude, ahrs_.R_EB(), ahrs_.rate_B(), dt);
  }
  return out;
}

double Pilot::advance_clock(std::chrono::nanoseconds time) {
  const double now = std::chrono::duration<double>(time).count();
  const double dt = started_ ? now - time_ : 1.0 / kImuHz;
  if (!started_) last_imu_ = now;
  started_ = true;
  if (!(dt > 0.0)) return 0.0;  // a repeated or older stamp: no time has passed
  time_ = now;
  return std::min(dt, 0.1);
}

void Pilot::sense(const Imu& imu, double dt) {
  if (!is_usable(imu)) return;  // the last input goes on; next_phase() sees how long
  last_imu_ = time_;
  if (dt <= 0.0) return;
  if (std::holds_alternative<OnGround>(phase_)) {
    ahrs_.update_at_rest(imu);
    accel_filter_.update(imu.accel_B);
    const Eigen::Vector3d p_G =
        rotation_z(-gate().yaw_EG) *
        (Eigen::Vector3d{config_.track.start.x(), config_.track.start.y(), 0.0} - gate().p_EG);
    memory_.start(p_G, ahrs_.accel_bias(), {0.0, config_.gate_height_sigma, config_.gate_yaw_sigma},
                  time_);
    return;
  }
  input_.accel_B = accel_filter_.update(imu.accel_B);
  ahrs_.update(imu, velocity_.v_B(), dt);
  const Attitude attitude = ahrs_.attitude();
  input_.roll = attitude.roll;
  input_.pitch = attitude.pitch;
  input_.yaw = wrap_angle(attitude.yaw - gate().yaw_EG);
  input_.yaw_sigma = ahrs_.heading_sigma();
  input_.gyro_B = ahrs_.rate_B();
}

void Pilot::estimate_motion(double dt) {
  if (std::holds_alternative<OnGround>(phase_) || dt <= 0.0) return;
  memory_.predict(input_, dt, time_);
  velocity_.update(filter().state(), input_, config_.filter.model, dt);
  altimeter_.climb(-dt * (ahrs_.R_EB() * velocity_.v_B()).z());
}

void Pilot::measure_height(const Sensors& sensors) {
  if (std::holds_alternative<OnGround>(phase_)) return;
  const double floor_z = -gate().p_EG.z();  // the floor, in the gate's frame
  const auto fuse = [&](const std::optional<Height>& height) {
    if (height)
      (void)memory_.correct_altitude(floor_z - height->value, height->sigma,
                                     config_.gate_height_sigma);
  };
  if (sensors.baro && std::abs(*sensors.baro) < 1000.0) fuse(altimeter_.baro(*sensors.baro, time_));
  const double upright = ahrs_.R_EB().matrix(2, 2);
  if (sensors.sonar && *sensors.sonar > 0.0 && *sensors.sonar < 100.0 && upright > 0.85)
    fuse(altimeter_.sonar(*sensors.sonar * upright, -p_EB().z(), time_));
}

double Pilot::capture_time(double u_px) const {
  const double across = std::clamp(u_px / image_width_ - 0.5, -0.5, 0.5);
  return time_ - config_.camera_timing.latency + across * config_.camera_timing.readout;
}

RotationGB Pilot::R_GB(const Eigen::Matrix3d& R_EB) const {
  return {rotation_z(-gate().yaw_EG) * R_EB};
}

Eigen::Vector3d Pilot::p_EB() const {
  return gate().p_EG + rotation_z(gate().yaw_EG) * filter().position();
}

const Path& Pilot::path() const {
  if (approach_) return *approach_;
  if (passed_ == 0) return plan_.start;
  const std::size_t n = plan_.legs.size();
  if (n == 0) return plan_.start;
  return plan_.legs[static_cast<std::size_t>(passed_ - 1) % n];
}

void Pilot::follow_course() {
  if (finished() || std::holds_alternative<OnGround>(phase_)) return;
  const double total = path().length();
  progress_ = path().nearest(p_EB().head<2>(), std::max(0.0, progress_ - 0.5),
                             std::min(progress_ + 0.8, total + 0.5));
  // While searching, only what went through the opening has passed.
  const bool on_course =
      std::holds_alternative<Straight>(phase_) || std::holds_alternative<Turn>(phase_);
  const bool through = std::holds_alternative<Search>(phase_) &&
                       std::abs(filter().position().y()) < 0.5 * gate().side;
  if ((on_course || through) && total - progress_ < 1.5 && filter().position().x() > 0.10)
    pass_gate();
}

// From where it waited the drone flies straight on along the gate's axis: the leg's own way may end
// in an arc.
void Pilot::approach_from_here() {
  const double before = std::max(1.0, -filter().position().x() + 0.5);
  const Eigen::Vector3d start =
      gate().p_EG + rotation_z(gate().yaw_EG) * Eigen::Vector3d{-before, 0, 0};
  approach_.emplace();
  (void)approach_->segments.push_back(
      {.start = start.head<2>(), .heading = gate().yaw_EG, .curvature = 0.0, .length = before});
  approach_->z_start = approach_->z_end = gate().p_EG.z();
  progress_ = 0.5;
}

void Pilot::pass_gate() {
  ++passed_;
  approach_.reset();
  witness_.reset();
  progress_ = 0.0;
  if (finished()) return;
  const MapGate from = gate();
  target_ = (target_ + 1) % static_cast<int>(config_.track.gates.size());
  const MapGate& to = gate();
  // p_G' = R_G'E (p_EG + R_EG p_G - p_EG')
  const Eigen::Matrix3d R = rotation_z(from.yaw_EG - to.yaw_EG);
  const Eigen::Vector3d offset = rotation_z(-to.yaw_EG) * (from.p_EG - to.p_EG);
  memory_.change_frame(R, offset, from.yaw_EG - to.yaw_EG,
                       {config_.map_sigma, config_.gate_height_sigma, config_.gate_yaw_sigma});
  input_.yaw = wrap_angle(ahrs_.attitude().yaw - to.yaw_EG);
}

// Where the lateral PD will have brought the drone when it reaches the gate: a critically damped
// decay that starts after the roll's lag.
double Pilot::lateral_at_gate() const {
  const double speed = std::max(0.5, forward_speed());
  const double t = std::max(0.0, -filter().position().x() / speed - 1.5 * config_.speed.roll_lead);
  const double wt = std::sqrt(config_.lateral.kp * config_.filter.model.gravity) * t;
  // e^-wt, from its series
  const double decay = 1.0 / (1.0 + wt + 0.5 * wt * wt + wt * wt * wt / 6.0);
  const double v_y = (R_GB(ahrs_.R_EB().matrix) * velocity_.v_B()).y();
  return (1.0 + wt) * decay * filter().position().y() + t * decay * v_y;
}

Situation Pilot::situation() const {
  Situation now;
  now.time = time_;
  now.rest_samples = ahrs_.rest_samples();
  now.height = -p_EB().z();
  now.course_done = finished();
  now.to_go = path().length() - progress_;
  now.gate_x = filter().position().x();
  now.gate_y = filter().position().y();
  now.lateral_sigma = filter().lateral_sigma();
  now.speed = velocity_.v_B().head<2>().norm();
  now.gate_y_ahead = lateral_at_gate();
  now.turn_ahead =
      !finished() &&
      path().at(progress_ + config_.speed.roll_lead * std::max(0.0, forward_speed())).curvature !=
          0.0;
  now.since_fix = time_ - last_fix_;
  now.since_imu = time_ - last_imu_;
  now.tilt = acos(ahrs_.R_EB().matrix(2, 2));
  return now;
}

Estimate Pilot::estimate() const {
  Estimate e;
  e.p_EB = p_EB();
  e.v_E = ahrs_.R_EB() * velocity_.v_B();
  e.attitude = ahrs_.attitude();
  e.accel_bias = filter().state().segment<3>(drag_model::kBiasX);
  e.gyro_bias = ahrs_.gyro_bias();
  e.p_GB = filter().position();
  e.covariance_GB = filter().covariance().topLeftCorner<3, 3>();
  e.gates_passed = passed_;
  return e;
}

}  // namespace gatefly
