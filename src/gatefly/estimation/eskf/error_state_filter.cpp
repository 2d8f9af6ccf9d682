// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/error_state_filter.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/estimation/eskf/correction.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::eskf {
namespace {

constexpr double kTickHz = 128.0;  // covariance and drag: 4 samples of 512 Hz. [ours]

std::size_t samples_per_tick(double imu_hz) {
  const double samples = std::clamp(imu_hz / kTickHz, 1.0, static_cast<double>(kMaxSamples));
  return static_cast<std::size_t>(std::lround(samples));
}

std::size_t ticks_for(const Setup& setup) {
  const double tick_hz = setup.imu_hz / static_cast<double>(samples_per_tick(setup.imu_hz));
  return static_cast<std::size_t>(std::ceil(setup.memory * tick_hz)) + 4;
}

void set_variances(Covariance& P, const Params& params, double radians_per_px) {
  const Priors& p = params.priors;
  const auto put3 = [&P](int i, const Eigen::Vector3d& sigma) {
    P.diagonal().segment<3>(i) = sigma.cwiseAbs2();
  };
  const auto put = [&P](int i, double sigma) { P(i, i) = sigma * sigma; };
  put3(kP, p.position);
  put3(kV, Eigen::Vector3d::Constant(p.speed));
  put3(kTheta, {p.tilt, p.tilt, p.heading});
  put3(kGyroBias, Eigen::Vector3d::Constant(p.gyro_bias));
  put3(kAccelBias, p.accel_bias);
  put3(kMount, p.mount);
  for (int i = 0; i < 2; ++i)
    put(kGust + i, p.gust), put(kWind + i, p.wind), put(kDrag + i, p.drag);
  put(kFocal, p.focal), put(kBend, p.bend), put(kDelay, p.delay);
  const double lasting = radians_per_px * params.sight.lasting;
  put3(kCorner, {lasting, lasting, radians_per_px * params.sight.lasting_size});
}

void widen(Covariance& P) {
  constexpr double kPlace = 0.25, kSpeed = 0.04, kHeading = 9e-4;  // [m²] [m²/s²] [rad²]
  for (int i = 0; i < 2; ++i) P(kP + i, kP + i) += kPlace, P(kV + i, kV + i) += kSpeed;
  P(kTheta + 2, kTheta + 2) += kHeading;
}

}  // namespace

ErrorStateFilter::ErrorStateFilter(const Setup& setup)
    : setup_{setup},
      landmarks_{setup.map, setup.params.priors},
      ring_{ticks_for(setup)},
      vibration_{setup.params.noise},
      per_tick_{samples_per_tick(setup.imu_hz)} {
  const int n = gate_at(landmarks_.slots());
  P_.setIdentity(n, n);
}

void ErrorStateFilter::start(const Start& start, double time) {
  const Params& params = setup_.params;
  now_ = {};
  now_.p_EB = start.p_EB, now_.R_EB = start.R_EB, now_.R_BC = setup_.R_BC;
  now_.gyro_bias = start.gyro_bias;
  now_.gust_sigma = params.priors.gust;
  P_.setZero();
  set_variances(P_, params, setup_.camera.radians_per_px);
  landmarks_.reset(now_, P_);
  (void)landmarks_.bring_in(target_.landmark, now_, P_);
  if (start.rest_accel_B) correct_by_rest(now_, P_, *start.rest_accel_B, params);
  Tick tick;
  tick.time = time, tick.x = now_;
  ring_.restart(tick, P_);
  pending_.clear();
  vibration_ = Vibration{params.noise};
  started_ = true;
}

void ErrorStateFilter::predict(const Imu& imu, double dt, double time) {
  if (!started_ || !(dt > 0.0)) return;
  const Sample sample{imu, dt};
  vibration_.add(sample);
  propagate(now_, sample, setup_.params.gravity);
  (void)pending_.push_back(sample);
  if (pending_.size() < per_tick_) return;
  Tick& tick = ring_.push();
  tick.time = time;
  tick.samples = pending_;
  tick.accel_shaking = vibration_.accel(), tick.gyro_shaking = vibration_.gyro();
  pending_.clear();
  take_in(tick);
  ring_.keep(ring_.newest(), P_);
  now_ = tick.x;
}

// All of a tick, from the belief before it (in tick.x and P_).
void ErrorStateFilter::take_in(Tick& tick) {
  const Params& params = setup_.params;
  const std::span<const Sample> samples{tick.samples.begin(), tick.samples.size()};
  tick.x.accel_shaking = tick.accel_shaking, tick.x.gyro_shaking = tick.gyro_shaking;
  eskf::predict(tick.x, P_, samples, params, setup_.camera.radians_per_px);
  correct_by_drag(tick.x, P_, mean_of(samples), params);
  for (const HeightSeen& seen : tick.heights)
    (void)correct_by_height(tick.x, P_, seen.height, seen.sigma);
  for (const PositionSeen& seen : tick.positions)
    correct_by_position(tick.x, P_, seen.p_EB, seen.sigma);
  for (const GateSight& sight : tick.sights)
    (void)correct_by_gate(tick.x, P_, sight, landmarks_.shape(sight.slot), sight.time - tick.time,
                          setup_.camera, params.sight);
  if (tick.doubted) widen(P_);
}

bool ErrorStateFilter::correct_height(double height, double sigma) {
  if (!started_ || !std::isfinite(height) || !(sigma > 0.0)) return false;
  Tick& tick = ring_[ring_.newest()];
  (void)tick.heights.push_back({height, sigma});
  const bool good = correct_by_height(tick.x, P_, height, sigma);
  ring_.keep(ring_.newest(), P_);
  catch_up();
  return good;
}

bool ErrorStateFilter::correct_position(const Eigen::Vector3d& p_EB, const Eigen::Vector3d& sigma) {
  if (!started_ || !p_EB.allFinite() || !(sigma.minCoeff() > 0.0)) return false;
  Tick& tick = ring_[ring_.newest()];
  if (!tick.positions.push_back({p_EB, sigma})) return false;
  correct_by_position(tick.x, P_, p_EB, sigma);
  ring_.keep(ring_.newest(), P_);
  catch_up();
  return true;
}

void ErrorStateFilter::catch_up() {
  now_ = ring_[ring_.newest()].x;
  for (const Sample& sample : pending_) propagate(now_, sample, setup_.params.gravity);
}

std::optional<Innovation> ErrorStateFilter::innovation_of(const GateSight& sight) const {
  if (!started_) return std::nullopt;
  const auto i = ring_.at(sight.time);
  if (!i) return std::nullopt;
  const Tick& tick = ring_[*i];
  const bool fresh =
      sight.quality == GateSight::Quality::kWhole && tick.x.corner_of != eskf::face_of(sight);
  const auto rows = gate_rows(tick.x, sight, landmarks_.shape(sight.slot), sight.time - tick.time,
                              fresh, setup_.camera, setup_.params.sight);
  if (!rows) return std::nullopt;
  return innovation(ring_.covariance(ring_.kept_before(*i)), *rows);
}

bool ErrorStateFilter::correct(std::span<const GateSight> sights) {
  std::optional<std::size_t> first;
  for (const GateSight& sight : sights) {
    const auto i = started_ ? ring_.at(sight.time) : std::nullopt;
    if (!i || !ring_[*i].sights.push_back(sight)) continue;
    first = first ? std::min(*first, *i) : *i;
  }
  if (!first) return false;
  do_again(*first);
  return true;
}

void ErrorStateFilter::do_again(std::size_t from) {
  const std::size_t last = ring_.newest(), kept = ring_.kept_before(from - 1);
  P_ = ring_.covariance(kept);
  for (std::size_t i = kept + 1; i <= last; ++i) {
    ring_[i].x = ring_[i - 1].x;
    take_in(ring_[i]);
    ring_.keep(i, P_);
  }
  catch_up();
}

void ErrorStateFilter::doubt() {
  if (!started_) return;
  ring_[ring_.newest()].doubted = true;
  widen(P_);
  ring_.keep(ring_.newest(), P_);
}

void ErrorStateFilter::set_target(const Eigen::Vector3d& p_EG, double yaw_EG) {
  target_ = landmarks_.face_of(p_EG, yaw_EG);
  if (!started_ || !landmarks_.bring_in(target_.landmark, now_, P_)) return;
  // Slots have changed: what was before was of other gates.
  Tick tick = ring_[ring_.newest()];
  tick.x.gates = now_.gates;
  tick.sights.clear(), tick.heights.clear(), tick.positions.clear();
  ring_.restart(tick, P_);
}

const GateBelief& ErrorStateFilter::target() const {
  return now_.gates[static_cast<std::size_t>(target_slot())];
}

double ErrorStateFilter::target_yaw() const {
  return target().yaw_EG + (target_.behind ? kPi : 0.0);
}

Eigen::Vector3d ErrorStateFilter::p_GB() const {
  return rotation_z(-target_yaw()) * (now_.p_EB - target().p_EG);
}

Eigen::Matrix3d ErrorStateFilter::covariance_GB(bool of_heading) const {
  const Eigen::Matrix3d R_GE = rotation_z(-target_yaw());
  const Eigen::Vector3d p = p_GB();
  const int gate = gate_at(target_slot());
  Eigen::Matrix<double, 3, 7> J;
  J << R_GE, -R_GE, Eigen::Vector3d{p.y(), -p.x(), 0.0};
  if (!of_heading) J.col(6).setZero();
  Eigen::Matrix<double, 7, 7> C;
  C.topLeftCorner<3, 3>() = P_.topLeftCorner<3, 3>();
  C.topRightCorner<3, 4>() = P_.block<3, 4>(kP, gate);
  C.bottomLeftCorner<4, 3>() = P_.block<4, 3>(gate, kP);
  C.bottomRightCorner<4, 4>() = P_.block<4, 4>(gate, gate);
  const Eigen::Matrix3d out = J * C * J.transpose();
  return 0.5 * (out + out.transpose());
}

double ErrorStateFilter::variance_of_air(int axis) const {
  return P_(kGust + axis, kGust + axis) + P_(kWind + axis, kWind + axis) +
         2.0 * P_(kGust + axis, kWind + axis);
}

double ErrorStateFilter::sigma(int state) const {
  return std::sqrt(std::max(0.0, P_(state, state)));
}

}  // namespace gatefly::eskf
