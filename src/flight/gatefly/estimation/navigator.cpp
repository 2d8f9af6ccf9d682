// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/navigator.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sensing/sensor_watch.hpp"

namespace gatefly {
namespace {

constexpr double kLongestStep = 0.1;  // a gap in the samples counts as no more than this [s]
constexpr double kLongLeg = 2.5;      // shorter ones say nothing about heading [m]

bool is_usable(const Imu& imu) { return fault_of(imu) == SensorFault::kNone; }

// Between the gate's own frame, near it, and the map's, far from it. [ours: docs/paper/deviations.md]
constexpr double kOwnFrame = 1.0, kMapFrame = 4.0;  // [m]

eskf::Setup at_rate(eskf::Setup setup, const NavigatorParams& params) {
  setup.imu_hz = params.imu_hz, setup.slow_imu_hz = params.slow_imu_hz;
  setup.memory = params.filter_memory;
  return setup;
}

// The rate of the samples that it is taught by: see Navigator::rest.
AhrsParams ahrs_params(const NavigatorParams& navigator) {
  AhrsParams params = navigator.ahrs;
  const bool slow = navigator.ours && navigator.slow_imu_hz > 0.0;
  params.imu_hz = slow ? navigator.slow_imu_hz : navigator.imu_hz;
  return params;
}

}  // namespace

Navigator::Navigator(const NavigatorParams& params)
    : params_{params},
      ahrs_{ahrs_params(params)},
      accel_filter_{params.accel_cutoff_hz, params.imu_hz},
      filter_{params.filter, moments_for(params.filter_memory, params.imu_hz)},
      velocity_{params.velocity},
      altimeter_{params.altimeter} {
  if (params.ours && !params.ours->map.empty()) ours_.emplace(at_rate(*params.ours, params));
}

void Navigator::start(const Eigen::Vector3d& p_EB, double yaw, const GateFrame& gate,
                      const MapUncertainty& uncertainty) {
  start_p_EB_ = p_EB;
  gate_ = gate;
  uncertainty_ = params_.use.knows_lasting_errors ? uncertainty : MapUncertainty{};
  ahrs_.start(yaw);
  if (ours_) ours_->set_target(gate.p_EG, gate.yaw_EG);
  restart_filter(Eigen::Vector3d::Zero());
}

// False when the sample says nothing new.
bool Navigator::advance(const Imu& imu, double time) {
  const double dt = started_ ? time - time_ : 1.0 / params_.imu_hz;
  if (!started_) last_imu_ = last_slow_ = time;
  started_ = true;
  dt_ = dt > 0.0 ? std::min(dt, kLongestStep) : 0.0;
  if (dt_ > 0.0) time_ = time;
  if (!is_usable(imu)) return false;
  last_imu_ = time_;
  return dt_ > 0.0;
}

void Navigator::rest(const Imu& imu, double time, const std::optional<Imu>& slow) {
  const bool fresh = advance(imu, time), taken = is_slow() && take_slow(slow);
  if (is_slow() ? !taken : !fresh) return;
  const Imu& sample = taken ? *slow : imu;
  ahrs_.update_at_rest(sample);
  accel_filter_.update(sample.accel_B);
  restart_filter(params_.use.takes_rest_bias ? ahrs_.accel_bias() : Eigen::Vector3d::Zero());
}

void Navigator::restart_filter(const Eigen::Vector3d& accel_bias) {
  // On the pad the first gate's place is in start_sigma.
  filter_.start(relative(start_p_EB_), accel_bias, {0.0, uncertainty_.height, uncertainty_.yaw},
                time_);
}

// The first sample of the flight ends the rest: what rest has taught is where the filter starts.
void Navigator::start_ours() {
  eskf::Start start{.p_EB = start_p_EB_,
                    .R_EB = ahrs_.R_EB().matrix,
                    .gyro_bias = ahrs_.gyro_bias(),
                    .rest_accel_B = {}};
  if (ahrs_.rest_samples() > 0)
    start.rest_accel_B = ahrs_.accel_bias() + Eigen::Vector3d{0, 0, -params_.ours->params.gravity};
  ours_->start(start, time_ - dt_);
}

// False when none has come, or it is not usable: as if none had.
bool Navigator::take_slow(const std::optional<Imu>& slow) {
  if (!slow || !is_usable(*slow) || dt_ <= 0.0) return false;
  ours_->predict_slow(*slow, time_, mean_thrust_);
  last_slow_ = time_, thrust_time_ = 0.0;
  return true;
}

void Navigator::predict_ours(const Imu& imu, bool usable, const std::optional<Imu>& slow,
                             double thrust) {
  if (usable) last_imu_sample_ = imu;
  if (dt_ <= 0.0) return;
  if (!ours_->has_started()) start_ours();
  if (is_slow()) {
    thrust_time_ += dt_;
    mean_thrust_ += std::min(1.0, dt_ / thrust_time_) * (thrust - mean_thrust_);
    (void)take_slow(slow);
    ours_->look_ahead(last_imu_sample_.gyro_B, time_);
  } else {
    ours_->predict(last_imu_sample_, dt_, time_, thrust);
  }
  altimeter_.climb(-dt_ * ours_->now().v_E.z());
}

void Navigator::predict(const Imu& imu, double time, const std::optional<Imu>& slow,
                        double thrust) {
  const bool new_sample = advance(imu, time);
  if (ours_) return predict_ours(imu, new_sample, slow, thrust);
  if (new_sample) {
    input_.accel_B = accel_filter_.update(imu.accel_B);
    ahrs_.update(imu, velocity_.v_B(), dt_);
    const Attitude attitude = ahrs_.attitude();
    input_.roll = attitude.roll;
    input_.pitch = attitude.pitch;
    input_.yaw = wrap_angle(attitude.yaw - gate_.yaw_EG);
    input_.yaw_sigma = params_.use.knows_lasting_errors ? ahrs_.heading_sigma() : 0.0;
    input_.gyro_B = ahrs_.rate_B();
  }
  if (dt_ <= 0.0) return;
  filter_.predict(input_, dt_, time_);
  velocity_.update(filter().state(), input_, params_.filter.model, dt_);
  altimeter_.climb(-dt_ * (ahrs_.R_EB() * velocity_.v_B()).z());
}

void Navigator::predict_attitude(const Imu& imu, double time) {
  if (advance(imu, time)) ahrs_.update(imu, Eigen::Vector3d::Zero(), dt_);
}

void Navigator::measure_heights(const std::optional<double>& sonar,
                                const std::optional<double>& baro) {
  const auto fuse = [&](const std::optional<Height>& height, Trust& trust) {
    if (height) take_height(*height, trust);
  };
  if (baro && fault_of_baro(*baro) == SensorFault::kNone)
    fuse(altimeter_.baro(*baro, time_), baro_);
  const double upright = flies_ours() ? ours_->now().R_EB(2, 2) : ahrs_.R_EB().matrix(2, 2);
  if (sonar && fault_of_sonar(*sonar) == SensorFault::kNone && upright > 0.85)
    fuse(altimeter_.sonar(*sonar * upright, -p_EB().z(), time_), sonar_);
}

// A sensor that is metres off while gates are seen is no height sensor (a sonar that hears its rotors).
void Navigator::take_height(const Height& height, Trust& trust) {
  constexpr int kLeaveAfter = 40;       // 2 s at 20 Hz. [estimate]
  constexpr double kGatesWithin = 1.0;  // [s]
  if (!ours_) return correct_height(height.value, height.sigma);
  if (trust.left) return;
  trust.refused = ours_->correct_height(height.value, height.sigma) ? 0 : trust.refused + 1;
  trust.left = trust.refused >= kLeaveAfter && time_ - last_gate_ < kGatesWithin;
}

void Navigator::correct_height(double height, double sigma) {
  if (ours_) return static_cast<void>(ours_->correct_height(height, sigma));
  const double floor_z = -gate_.p_EG.z();  // the floor, in the gate's frame
  (void)filter_.correct_altitude(floor_z - height, sigma, uncertainty_.height);
}

Fix Navigator::as_fused(const Fix& seen) const {
  Fix fix = seen;
  if (!params_.use.fix_sigma) return fix;
  fix.covariance = params_.use.fix_sigma->cwiseAbs2().asDiagonal();
  fix.systematic.setZero();
  fix.has_height = false;  // z is the altimeter's
  return fix;
}

Fusion Navigator::correct(const Fix& fix, double time, bool may_restart) {
  const Fusion fusion = filter_.correct(as_fused(fix), counted_at(time),
                                        may_restart && params_.use.knows_lasting_errors);
  if (fusion == Fusion::kAccepted || fusion == Fusion::kRestarted) last_fix_ = time_;
  return fusion;
}

bool Navigator::correct(std::span<const eskf::GateSight> sights, bool of_target) {
  if (!ours_ || !ours_->correct(sights)) return false;
  last_gate_ = time_;
  if (of_target) last_fix_ = time_;
  return true;
}

void Navigator::replace_target(const GateFrame& place, double sigma, double yaw_sigma) {
  if (ours_) ours_->replace_target(place.p_EG, place.yaw_EG, sigma, yaw_sigma);
}

void Navigator::doubt() {
  if (!ours_) return;
  ours_->doubt();
  last_doubt_ = time_;
}

void Navigator::correct_heading(double error, double variance) {
  const double before = ahrs_.attitude().yaw;
  ahrs_.correct_heading(error, variance);
  filter_.turn_past(wrap_angle(ahrs_.attitude().yaw - before));
}

// A leg flown blind on a heading that is off by δ ends δ ẑ × p₀ beside where it should, p₀ being
// where it began, seen from the next gate. The filter's uncertainty knows that; the difference to
// the first fix tells δ.
void Navigator::learn_heading(const Fix& fix, const Past& then) {
  if (!params_.use.knows_lasting_errors) return;
  const double sigma = ahrs_.heading_sigma();
  const Eigen::Vector2d n = then.filter.heading_sensitivity(fix) / sigma;
  if (n.norm() < kLongLeg) return;
  const Eigen::Vector2d difference = (fix.p_GB - then.filter.position()).head<2>();
  const Eigen::Matrix2d S = then.filter.innovation_covariance(fix).topLeftCorner<2, 2>() -
                            sigma * sigma * n * n.transpose();
  if (!(S(0, 0) > 0.0) || !(S.determinant() > 0.0)) return;
  const Eigen::Vector2d w = S.inverse() * n;
  const double information = w.dot(n);
  correct_heading(-w.dot(difference) / information, 1.0 / information);
}

void Navigator::change_gate(const GateFrame& gate, const MapUncertainty& uncertainty) {
  // p_G' = R_G'E (p_EG + R_EG p_G - p_EG')
  const double turn = gate_.yaw_EG - gate.yaw_EG;
  const Eigen::Vector3d offset = rotation_z(-gate.yaw_EG) * (gate_.p_EG - gate.p_EG);
  uncertainty_ = params_.use.knows_lasting_errors ? uncertainty : MapUncertainty{};
  filter_.change_frame(rotation_z(turn), offset, turn, uncertainty_);
  gate_ = gate;
  if (params_.use.leg_sigma)
    filter_.reset_position(filter().position().head<2>(), *params_.use.leg_sigma);
  input_.yaw = wrap_angle(ahrs_.attitude().yaw - gate.yaw_EG);
  if (ours_) ours_->set_target(gate.p_EG, gate.yaw_EG);
}

void Navigator::begin_leg(const Eigen::Vector2d& p_EB) {
  if (!params_.use.leg_sigma) return;
  const Eigen::Vector3d p_GB = relative({p_EB.x(), p_EB.y(), this->p_EB().z()});
  filter_.reset_position(p_GB.head<2>(), *params_.use.leg_sigma);
}

void Navigator::set_attitude(const Attitude& attitude) { ahrs_.set(attitude); }

void Navigator::set_accel_bias(const Eigen::Vector3d& bias) { restart_filter(bias); }

Eigen::Vector3d Navigator::relative(const Eigen::Vector3d& p_EB) const {
  return rotation_z(-gate_.yaw_EG) * (p_EB - gate_.p_EG);
}

// 1 in the gate, 0 far from it.
double Navigator::nearness() const {
  const double distance = (ours_->now().p_EB - ours_->target().p_EG).head<2>().norm();
  return std::clamp((kMapFrame - distance) / (kMapFrame - kOwnFrame), 0.0, 1.0);
}

// The position in the plan's frame. Near a gate it is relative to that gate, which may stand off the
// map; far from it, it is the position in earth axes; between the two it is blended.
Eigen::Vector3d Navigator::p_EB() const {
  const Eigen::Matrix3d R_EG = rotation_z(gate_.yaw_EG);
  if (!flies_ours())
    return gate_.p_EG + R_EG * (ours_ ? relative(start_p_EB_) : filter().position());
  const Eigen::Vector3d by_gate = gate_.p_EG + R_EG * ours_->p_GB();
  const double near = nearness();
  Eigen::Vector3d p_EB = near * by_gate + (1.0 - near) * ours_->now().p_EB;
  p_EB.z() = by_gate.z();
  return p_EB;
}

// Eq. (14) as it is has the vibration, and no model's lag.
Eigen::Vector3d Navigator::v_B() const {
  if (params_.use.observes_velocity) return velocity_.v_B();
  return drag_model::velocity_B(filter().state(), input_, params_.filter.model);
}

NavigationState Navigator::state() const {
  NavigationState now;
  now.time = time_, now.dt = dt_;
  now.since_fix = since_fix();
  now.since_imu = time_ - (is_slow() ? std::min(last_imu_, last_slow_) : last_imu_);
  now.rest_samples = ahrs_.rest_samples();
  now.p_EB = p_EB();
  if (flies_ours()) {
    describe_ours(now);
    return now;
  }
  now.R_EB = ahrs_.R_EB();
  now.attitude = attitude_of(now.R_EB);
  now.rate_B = ahrs_.rate_B();
  now.v_B = v_B();
  now.v_E = now.R_EB * now.v_B;
  now.p_GB = ours_ ? relative(start_p_EB_) : filter().position();
  const Eigen::Matrix3d R_GB = rotation_z(-gate_.yaw_EG) * now.R_EB.matrix;
  now.v_GB = R_GB * now.v_B;
  now.lateral_sigma = filter().lateral_sigma();
  return now;
}

// In the map's axes, which near the gate are turned as the gate is.
void Navigator::describe_ours(NavigationState& now) const {
  const eskf::Nominal& x = ours_->now();
  const double turned = wrap_angle(gate_.yaw_EG - ours_->target_yaw());
  const Eigen::Matrix3d R_ME = rotation_z(nearness() * turned);
  now.R_EB.matrix = R_ME * x.R_EB;
  now.attitude = attitude_of(now.R_EB);
  now.rate_B = x.rate_B;
  now.v_E = R_ME * x.v_E;
  now.v_B = x.R_EB.transpose() * x.v_E;
  now.p_GB = ours_->p_GB();
  now.v_GB = rotation_z(-ours_->target_yaw()) * x.v_E;
  now.lateral_sigma = std::sqrt(std::max(0.0, ours_->covariance_GB(false)(1, 1)));
  now.since_gate = time_ - last_gate_, now.since_doubt = time_ - last_doubt_;
  now.place_sigma = std::max(ours_->sigma(eskf::kP), ours_->sigma(eskf::kP + 1));
  now.wind_E = (R_ME.topLeftCorner<2, 2>() * (x.wind + x.gust)).eval();
  now.wind_variance = ours_->variance_of_air(0) + ours_->variance_of_air(1);
  now.thrust_found = x.thrust;
}

Eigen::Matrix3d Navigator::covariance_GB() const {
  if (flies_ours()) return ours_->covariance_GB();
  return filter().covariance().topLeftCorner<3, 3>();
}

Eigen::Vector3d Navigator::accel_bias() const {
  if (flies_ours()) return ours_->now().accel_bias;
  return filter().state().segment<3>(drag_model::kBiasX);
}

Eigen::Vector3d Navigator::gyro_bias() const {
  return flies_ours() ? ours_->now().gyro_bias : ahrs_.gyro_bias();
}

Eigen::Vector3d Navigator::velocity_sigma() const {
  if (flies_ours()) {
    const Eigen::Matrix3d& R = ours_->now().R_EB;
    const Eigen::Matrix3d C =
        R.transpose() * ours_->covariance().block<3, 3>(eskf::kV, eskf::kV) * R;
    return C.diagonal().cwiseMax(0.0).cwiseSqrt();
  }
  // Eq. (14): what the bias does to drag's velocity
  const Eigen::Vector3d bias = accel_bias_sigma();
  const Eigen::Vector2d drag = filter().params().model.drag.cwiseAbs();
  const double vertical = filter().covariance()(drag_model::kVz, drag_model::kVz);
  return {bias.x() / drag.x(), bias.y() / drag.y(), std::sqrt(vertical)};
}

Eigen::Vector3d Navigator::accel_bias_sigma() const {
  const auto sigma = [&](int i) {
    return flies_ours()
               ? ours_->sigma(eskf::kAccelBias + i)
               : std::sqrt(filter().covariance()(drag_model::kBiasX + i, drag_model::kBiasX + i));
  };
  return {sigma(0), sigma(1), sigma(2)};
}

double Navigator::tilt_sigma() const {
  if (!flies_ours()) return ahrs_.tilt_sigma();
  return std::sqrt(0.5 * (ours_->covariance()(eskf::kTheta, eskf::kTheta) +
                          ours_->covariance()(eskf::kTheta + 1, eskf::kTheta + 1)));
}

double Navigator::heading_sigma() const {
  return flies_ours() ? ours_->sigma(eskf::kTheta + 2) : ahrs_.heading_sigma();
}

}  // namespace gatefly
