// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/pilot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

constexpr double kImuHz = 512.0;
constexpr double kAccelCutoffHz = 20.0;  // [Li18 flight code]
constexpr double kBlind = 1.0;           // without a fix for this long, a leg was flown blind [s]
constexpr double kOpenGateFrom = 3.5;    // nearer than this the upper bar may be cut off [m]
constexpr double kLongLeg = 2.5;         // shorter ones say nothing about heading [m]

// Beyond any MEMS range a number is as broken as NaN, and would become one inside.
bool is_usable(const Imu& imu) {
  return imu.gyro_B.allFinite() && imu.accel_B.allFinite() && imu.gyro_B.cwiseAbs().maxCoeff() < 100.0 &&
         imu.accel_B.cwiseAbs().maxCoeff() < 400.0;
}

}  // namespace

Pilot::Pilot(const PilotConfig& config)
    : config_{config},
      plan_{plan_race(config.track, config.plan)},
      ahrs_{config.ahrs},
      accel_filter_{kAccelCutoffHz, kImuHz},
      filter_{config.filter},
      velocity_{config.velocity},
      altimeter_{config.altimeter},
      indi_{config.indi, config.vehicle},
      rng_{config.seed} {
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
  if (sensors.image) look(*sensors.image);

  // race: how far along the course, and what that asks for
  follow_course();
  Transition next = next_phase(phase_, situation(), config_.phase);
  if (std::holds_alternative<Turn>(next.phase) && !std::holds_alternative<Turn>(phase_))
    std::get<Turn>(next.phase).arc = {.yaw = ahrs_.attitude().yaw, .v_F = {forward_speed(), 0, 0}};
  if (std::holds_alternative<Land>(next.phase) && !std::holds_alternative<Land>(phase_))
    std::get<Land>(next.phase).z = p_EB().z();
  if (std::holds_alternative<Search>(next.phase) && !std::holds_alternative<Search>(phase_)) {
    hold_x_ = std::min(-2.2, filter_.position().x() - 0.5);
    hold_integral_.setZero();
  }
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
    const Eigen::Vector3d p_G = rotation_z(-gate().yaw_EG) *
        (Eigen::Vector3d{config_.track.start.x(), config_.track.start.y(), 0.0} - gate().p_EG);
    filter_.start(p_G, ahrs_.accel_bias());
    return;
  }
  input_.accel_B = accel_filter_.update(imu.accel_B);
  ahrs_.update(imu, input_.accel_B, velocity_.v_B(), dt);
  const Attitude attitude = ahrs_.attitude();
  input_.roll = attitude.roll;
  input_.pitch = attitude.pitch;
  input_.yaw = wrap_angle(attitude.yaw - gate().yaw_EG);
  input_.gyro_B = ahrs_.rate_B();
}

void Pilot::estimate_motion(double dt) {
  if (std::holds_alternative<OnGround>(phase_) || dt <= 0.0) return;
  filter_.predict(input_, dt);
  velocity_.update(filter_.state(), input_, config_.filter.model, dt);

  // Dead reckoning, never corrected: how far the drone moved between two moments.
  const Eigen::Matrix3d R_EB = ahrs_.R_EB().matrix;
  const Eigen::Vector3d moved_E = dt * (R_EB * velocity_.v_B());
  odometry_E_ += moved_E;
  altimeter_.climb(-moved_E.z());
  history_[history_count_ % history_.size()] = {time_, R_EB, odometry_E_};
  ++history_count_;
}

void Pilot::measure_height(const Sensors& sensors) {
  if (std::holds_alternative<OnGround>(phase_)) return;
  const double floor_z = -gate().p_EG.z();  // the floor, in the gate's frame
  const auto fuse = [&](const std::optional<Height>& height) {
    if (height) (void)filter_.correct_altitude(floor_z - height->value, height->sigma);
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

Pilot::Past Pilot::past(double time) const {
  const std::size_t kept = std::min(history_count_, history_.size());
  Past best{time_, ahrs_.R_EB().matrix, odometry_E_};
  for (std::size_t i = 1; i <= kept; ++i) {
    const Past& moment = history_[(history_count_ - i) % history_.size()];
    if (std::abs(moment.time - time) <= std::abs(best.time - time)) best = moment;
    if (moment.time < time) break;
  }
  return best;
}

RotationGB Pilot::R_GB(const Eigen::Matrix3d& R_EB) const { return {rotation_z(-gate().yaw_EG) * R_EB}; }

Eigen::Vector3d Pilot::p_EB() const { return gate().p_EG + rotation_z(gate().yaw_EG) * filter_.position(); }

void Pilot::look(const Image& image) {
  sighting_ = {};
  if (image.empty()) return;
  image_width_ = image.width();
  if (std::holds_alternative<OnGround>(phase_) || std::holds_alternative<Land>(phase_) ||
      std::holds_alternative<Landed>(phase_))
    return;
  sighting_.detections = detect_gates(image, config_.color, config_.snake, rng_);
  if (sighting_.detections.empty() && last_corners_)
    sighting_.detections = detect_gates_near(image, config_.color, config_.snake, *last_corners_);
  sighting_.seen = !sighting_.detections.empty();
  last_corners_.reset();

  doubt_heading_after_blind_leg();

  // The candidate that fits best to where the gate should be.
  int best = -1;
  double best_distance2 = 1e9;
  for (std::size_t i = 0; i < sighting_.detections.size(); ++i) {
    const GateDetection& candidate = sighting_.detections[i];
    const Past then = past(capture_time(center(candidate.corners_px).x()));
    const auto fix = fix_of(candidate, then);
    if (!fix) continue;
    const Eigen::Vector3d moved = rotation_z(-gate().yaw_EG) * (odometry_E_ - then.odometry_E);
    const double distance2 = filter_.distance2(*fix, moved);
    if (distance2 < best_distance2) best = static_cast<int>(i), best_distance2 = distance2;
  }
  if (best >= 0) {
    const GateDetection& chosen = sighting_.detections[static_cast<std::size_t>(best)];
    if (correct_with(chosen)) {
      sighting_.used = best;
      last_corners_ = chosen.corners_px;
    }
  }
  // Near the gate parts of it are enough: the lower corners, then the side bars.
  const double x = filter_.position().x();
  if (sighting_.source == Sighting::Source::kNone && x > -kOpenGateFrom && x < 0.0) {
    sighting_.open = detect_open_gate(image, config_.color, config_.snake, rng_);
    if (sighting_.open) correct_with_lower_corners(*sighting_.open);
  }
  if (sighting_.source == Sighting::Source::kNone && x > -config_.pose.max_bars_distance && x < 0.0) {
    sighting_.bars = detect_bars(image, config_.color, config_.bars, nadir_px());
    if (sighting_.bars) correct_with_bars(*sighting_.bars);
  }
}

void Pilot::accept_fix(Sighting::Source source) {
  last_fix_ = time_;
  heading_doubt_ = 0.0;
  anchor_E_ = p_EB();
  sighting_.source = source;
}

std::optional<Fix> Pilot::fix_of(const GateDetection& seen, const Past& then) const {
  return fix_from_corners(seen.corners_px, R_GB(then.R_EB), gate().side, config_.camera, pose_params());
}

std::optional<Eigen::Vector2d> Pilot::nadir_px() const {
  const Past then = past(capture_time(0.5 * image_width_));
  return vanishing_point_px(config_.camera.lens, config_.camera.R_BC.matrix.transpose() * then.R_EB.row(2).transpose());
}

PoseParams Pilot::pose_params() const {
  PoseParams params = config_.pose;
  const double heading = ahrs_.heading_sigma();
  params.heading_sigma = std::sqrt(heading * heading + config_.gate_yaw_sigma * config_.gate_yaw_sigma);
  return params;
}

void Pilot::correct_heading(double error, double variance) {
  const double before = ahrs_.attitude().yaw;
  ahrs_.correct_heading(error, variance);
  // The past was off by as much.
  const Eigen::Matrix3d turn = rotation_z(wrap_angle(ahrs_.attitude().yaw - before));
  for (auto& moment : history_) moment.R_EB = turn * moment.R_EB;
}

// A leg flown blind on a heading that is off by δ ends δ ẑ × p₀ beside where it should, p₀ being where it
// began, seen from the next gate. Before the gate comes into view that belongs into the covariance ...
void Pilot::doubt_heading_after_blind_leg() {
  if (heading_doubt_ > 0.0 || time_ - last_fix_ < kBlind || last_fix_ < 0.0) return;
  const Eigen::Vector3d p0 = rotation_z(-gate().yaw_EG) * (anchor_E_ - gate().p_EG);
  const Eigen::Vector2d n{-p0.y(), p0.x()};
  heading_doubt_ = ahrs_.heading_sigma() * ahrs_.heading_sigma();
  filter_.doubt(heading_doubt_ * n * n.transpose());
}

// ... and when it does, the difference tells δ: the update of the state the filter does not carry.
void Pilot::learn_heading_from_leg(const Fix& fix, const Eigen::Vector3d& moved) {
  const Eigen::Vector3d p0 = rotation_z(-gate().yaw_EG) * (anchor_E_ - gate().p_EG);
  const Eigen::Vector2d n{-p0.y(), p0.x()};
  if (n.norm() < kLongLeg) return;
  const Eigen::Vector2d difference = (fix.p_GB + moved - filter_.position()).head<2>();
  const Eigen::Matrix2d S = filter_.covariance().topLeftCorner<2, 2>() - heading_doubt_ * n * n.transpose() +
                            fix.covariance.topLeftCorner<2, 2>();
  if (!(S(0, 0) > 0.0) || !(S.determinant() > 0.0)) return;
  const Eigen::Vector2d w = S.inverse() * n;
  const double information = w.dot(n);
  correct_heading(-w.dot(difference) / information, 1.0 / information);
}

bool Pilot::correct_with(const GateDetection& seen) {
  Past then = past(capture_time(center(seen.corners_px).x()));
  auto fix = fix_of(seen, then);
  if (!fix) return false;
  const Eigen::Vector3d moved = rotation_z(-gate().yaw_EG) * (odometry_E_ - then.odometry_E);
  const double limit = config_.filter.gate_sigma * config_.filter.gate_sigma;
  if (heading_doubt_ > 0.0 && filter_.distance2(*fix, moved) < limit) {
    learn_heading_from_leg(*fix, moved);
    then = past(then.time);
    fix = fix_of(seen, then);
    if (!fix) return false;
  }
  if (filter_.correct(*fix, moved) == Fusion::kRefused) {
    // A gate where none is expected: either not this gate, or the estimate is wrong. Doubt grows.
    if (!belongs_to_another_gate(seen)) filter_.doubt(0.01 * Eigen::Matrix2d::Identity());
    return false;
  }
  accept_fix(Sighting::Source::kCorners);
  if (fix->yaw_error) {
    const double gate_yaw = config_.gate_yaw_sigma;
    // Neighbouring pictures share their errors: each counts as a third.
    correct_heading(*fix->yaw_error, 3.0 * (fix->yaw_variance + gate_yaw * gate_yaw));
  }
  return true;
}

bool Pilot::belongs_to_another_gate(const GateDetection& seen) const {
  const Past then = past(capture_time(center(seen.corners_px).x()));
  for (int i = 0; i < static_cast<int>(config_.track.gates.size()); ++i) {
    if (i == target_) continue;
    const MapGate& other = config_.track.gates[static_cast<std::size_t>(i)];
    const auto fix = fix_from_corners(seen.corners_px, {rotation_z(-other.yaw_EG) * then.R_EB}, other.side,
                                      config_.camera, config_.pose);
    if (!fix) continue;
    const Eigen::Vector3d p_E = other.p_EG + rotation_z(other.yaw_EG) * fix->p_GB;
    if ((p_E - p_EB()).head<2>().norm() < 1.0) return true;
  }
  return false;
}

void Pilot::correct_with_lower_corners(const OpenGate& seen) {
  const Past then = past(capture_time(0.5 * (seen.bottom_left_px.x() + seen.bottom_right_px.x())));
  const auto fix = fix_from_lower_corners(seen, R_GB(then.R_EB), gate().side, config_.camera, pose_params());
  if (!fix) return;
  const Eigen::Vector3d moved = rotation_z(-gate().yaw_EG) * (odometry_E_ - then.odometry_E);
  if (filter_.correct(*fix, moved) == Fusion::kAccepted) accept_fix(Sighting::Source::kCorners);
}

void Pilot::correct_with_bars(const GateBars& bars) {
  const Past then = past(capture_time(0.5 * (bars.left_px.x() + bars.right_px.x())));
  const auto fix = fix_from_bars(bars, R_GB(then.R_EB), gate().side - gate().bar, config_.camera, pose_params());
  if (!fix) return;
  const Eigen::Vector3d moved = rotation_z(-gate().yaw_EG) * (odometry_E_ - then.odometry_E);
  if (filter_.correct(*fix, moved) == Fusion::kAccepted) accept_fix(Sighting::Source::kBars);
}

const Path& Pilot::path() const {
  if (passed_ == 0) return plan_.start;
  const std::size_t n = plan_.legs.size();
  if (n == 0) return plan_.start;
  return plan_.legs[static_cast<std::size_t>(passed_ - 1) % n];
}

void Pilot::follow_course() {
  if (finished() || std::holds_alternative<OnGround>(phase_)) return;
  const double total = path().length();
  progress_ = path().nearest(p_EB().head<2>(), std::max(0.0, progress_ - 0.5), std::min(progress_ + 0.8, total + 0.5));
  // While searching, only what went through the opening has passed.
  const bool on_course = std::holds_alternative<Straight>(phase_) || std::holds_alternative<Turn>(phase_);
  const bool through = std::holds_alternative<Search>(phase_) && std::abs(filter_.position().y()) < 0.5 * gate().side;
  if ((on_course || through) && total - progress_ < 1.5 && filter_.position().x() > 0.10) pass_gate();
}

void Pilot::pass_gate() {
  ++passed_;
  progress_ = 0.0;
  heading_doubt_ = 0.0;  // it was about the way to the gate just passed
  last_corners_.reset();
  if (finished()) return;
  const MapGate from = gate();
  target_ = (target_ + 1) % static_cast<int>(config_.track.gates.size());
  const MapGate& to = gate();
  // p_G' = R_G'E (p_EG + R_EG p_G - p_EG')
  const Eigen::Matrix3d R = rotation_z(from.yaw_EG - to.yaw_EG);
  const Eigen::Vector3d offset = rotation_z(-to.yaw_EG) * (from.p_EG - to.p_EG);
  filter_.change_frame(R, offset, config_.map_sigma);
  input_.yaw = wrap_angle(ahrs_.attitude().yaw - to.yaw_EG);
}

// Where the lateral PD will have brought the drone when it reaches the gate: a critically damped decay
// that starts after the roll's lag.
double Pilot::lateral_at_gate() const {
  const double speed = std::max(0.5, forward_speed());
  const double t = std::max(0.0, -filter_.position().x() / speed - 1.5 * config_.speed.roll_lead);
  const double wt = std::sqrt(config_.lateral.kp * config_.filter.model.gravity) * t;
  const double decay = 1.0 / (1.0 + wt + 0.5 * wt * wt + wt * wt * wt / 6.0);  // e^-wt, from its series
  const double v_y = (R_GB(ahrs_.R_EB().matrix) * velocity_.v_B()).y();
  return (1.0 + wt) * decay * filter_.position().y() + t * decay * v_y;
}

Situation Pilot::situation() const {
  Situation now;
  now.time = time_;
  now.rest_samples = ahrs_.rest_samples();
  now.height = -p_EB().z();
  now.course_done = finished();
  now.gate_x = filter_.position().x();
  now.gate_y = filter_.position().y();
  now.lateral_sigma = std::sqrt(filter_.covariance()(drag_model::kY, drag_model::kY));
  now.speed = velocity_.v_B().head<2>().norm();
  now.gate_y_ahead = lateral_at_gate();
  now.turn_ahead = !finished() && path().at(progress_ + config_.speed.roll_lead * std::max(0.0, forward_speed())).curvature != 0.0;
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
  e.accel_bias = filter_.state().segment<3>(drag_model::kBiasX);
  e.sigma = filter_.covariance().diagonal().head<3>().cwiseSqrt();
  e.gates_passed = passed_;
  return e;
}

}  // namespace gatefly
