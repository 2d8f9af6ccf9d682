// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/error_state_filter.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/estimation/eskf/correction.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::eskf {
namespace {

// Samples that the filter itself takes, in a second.
double rate_of(const Setup& setup) {
  if (!(setup.slow_imu_hz > 0.0)) return setup.imu_hz;
  return setup.slow_imu_hz * SlowImu::pieces_in(1.0 / setup.slow_imu_hz);
}

// So much younger than the last sample a picture may be [s].
double beyond_of(const Setup& setup) {
  return setup.slow_imu_hz > 0.0 ? 2.0 / setup.slow_imu_hz : 0.0;
}

Vibration vibration_of(const Setup& setup) {
  return Vibration{setup.params.noise, setup.slow_imu_hz > 0.0};
}

std::size_t samples_per_tick(double imu_hz) {
  const double samples = std::clamp(imu_hz / kTickHz, 1.0, static_cast<double>(kMaxSamples));
  return static_cast<std::size_t>(std::lround(samples));
}

std::size_t ticks_for(const Setup& setup) {
  const double hz = rate_of(setup), tick_hz = hz / static_cast<double>(samples_per_tick(hz));
  return static_cast<std::size_t>(std::ceil(setup.memory * tick_hz)) + 4;
}

// Ticks in 20 ms: over twice that a rate is a mean; what the rotors shake is less by five then.
std::size_t ticks_nearby(const Setup& setup) {
  constexpr double kHalf = 0.02;  // [s]
  const double hz = rate_of(setup), tick_hz = hz / static_cast<double>(samples_per_tick(hz));
  return static_cast<std::size_t>(std::max(1L, std::lround(kHalf * tick_hz)));
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
  put(kFocal, p.focal), put(kBend, p.bend), put(kDelay, p.delay), put(kThrust, p.thrust);
  const double lasting = radians_per_px * params.sight.lasting;
  put3(kCorner, {lasting, lasting, radians_per_px * params.sight.lasting_size});
}

}  // namespace

ErrorStateFilter::ErrorStateFilter(const Setup& setup)
    : setup_{setup},
      landmarks_{setup.map, setup.params.priors},
      ring_{ticks_for(setup)},
      vibration_{vibration_of(setup)},
      per_tick_{samples_per_tick(rate_of(setup))},
      near_{ticks_nearby(setup)} {
  if (setup.slow_imu_hz > 0.0) slow_.emplace(setup.slow_imu_hz);
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
  tick.time = slow_ && slow_->clock().runs() ? slow_->clock().time() : time, tick.x = now_;
  ring_.restart(tick, P_);
  pending_.clear();
  vibration_ = vibration_of(setup_);
  ahead_.restart({0, 0, -params.gravity}, tick.time);
  started_ = true;
}

void ErrorStateFilter::predict(const Imu& imu, double dt, double time, double thrust) {
  if (!started_ || !(dt > 0.0)) return;
  const Sample sample{imu, dt, std::isfinite(thrust) ? std::max(0.0, thrust) : 0.0};
  vibration_.add(sample);
  advance(sample, time);
}

void ErrorStateFilter::predict_slow(const Imu& imu, double time, double thrust) {
  slow_->add(imu, time);
  if (!started_) return;
  const auto pieces = slow_->pieces();
  if (!pieces.empty()) vibration_.add({imu, slow_->clock().interval()});
  const double end = slow_->clock().time();
  double left = 0.0;
  for (const Sample& piece : pieces) left += piece.dt;
  for (Sample piece : pieces) {
    piece.thrust = std::isfinite(thrust) ? std::max(0.0, thrust) : 0.0;
    left -= piece.dt;
    advance(piece, end - left);
  }
  ahead_.restart(imu.accel_B - ring_[ring_.newest()].x.accel_bias, end);
  catch_up();
}

void ErrorStateFilter::look_ahead(const Eigen::Vector3d& gyro_B, double time) {
  if (!started_) return;
  ahead_.turn(gyro_B - now_.gyro_bias, time);
  catch_up();
}

void ErrorStateFilter::advance(const Sample& sample, double time) {
  propagate(now_, sample, setup_.params.gravity);
  (void)pending_.push_back(sample);
  if (pending_.size() < per_tick_) return;
  Tick& tick = ring_.push();
  tick.time = time;
  tick.samples = pending_;
  tick.accel_shaking = vibration_.accel(), tick.gyro_shaking = vibration_.gyro();
  pending_.clear();
  take_in(ring_.newest());
  ring_.keep(ring_.newest(), P_);
  now_ = tick.x;
}

// All of a tick, from the belief before it (in tick.x and P_).
void ErrorStateFilter::take_in(std::size_t index) {
  Tick& tick = ring_[index];
  const Params& params = setup_.params;
  const std::span<const Sample> samples{tick.samples.begin(), tick.samples.size()};
  tick.x.accel_shaking = tick.accel_shaking, tick.x.gyro_shaking = tick.gyro_shaking;
  eskf::predict(tick.x, P_, samples, params, setup_.camera.radians_per_px);
  const Interval interval = mean_of(samples);
  correct_by_drag(tick.x, P_, interval, params);
  correct_by_thrust(tick.x, P_, interval, params);
  for (const HeightSeen& seen : tick.heights)
    (void)correct_by_height(tick.x, P_, seen.height, seen.sigma);
  for (const PositionSeen& seen : tick.positions)
    correct_by_position(tick.x, P_, seen.p_EB, seen.sigma);
  if (!tick.sights.empty()) tick.x.rate_B = rate_around(index);
  for (const GateSight& sight : tick.sights)
    (void)correct_by_gate(tick.x, P_, sight, landmarks_.shape(sight.slot), sight.time - tick.time,
                          setup_.camera, params.sight);
  if (!tick.sights.empty()) tick.x.rate_B = samples.back().imu.gyro_B - tick.x.gyro_bias;
  if (tick.doubted) widen(P_);
}

// How the drone turned around the end of a tick, without the rotors' shaking. A picture's delay is told
// from how it moves with this rate: noise in it would make every delay look shorter than it is.
Eigen::Vector3d ErrorStateFilter::rate_around(std::size_t index) const {
  const Nominal& x = ring_[index].x;
  // As many ticks after as before: the mean over them is of the moment between.
  const std::size_t near = std::min({near_, ring_.newest() - index, index - ring_.oldest()});
  Eigen::Vector3d turned = Eigen::Vector3d::Zero();
  double time = 0.0;
  for (std::size_t i = index + 1 - near; i <= index + near; ++i) {
    const Interval interval = mean_of({ring_[i].samples.begin(), ring_[i].samples.size()});
    turned += interval.dt * interval.mean.gyro_B, time += interval.dt;
  }
  return time > 0.0 ? Eigen::Vector3d{turned / time - x.gyro_bias} : x.rate_B;
}

bool ErrorStateFilter::correct_height(double height, double sigma) {
  if (!started_ || !std::isfinite(height) || !(sigma > 0.0)) return false;
  Tick& tick = ring_[ring_.newest()];
  if (slow_) height += now_.p_EB.z() - tick.x.p_EB.z();  // of a slow tick, which may be long ago
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
  if (slow_) ahead_.carry(now_, setup_.params.gravity);
}

// The tick nearest to the exposure as the delay is known by now: with what is left of it the drone has
// turned hardly at all, so that a delay that was told wrongly by tens of milliseconds is found.
std::optional<std::size_t> ErrorStateFilter::tick_of(const GateSight& sight) const {
  const double newest = ring_[ring_.newest()].time;
  const double exposed = std::min(sight.time + now_.delay, std::max(sight.time, newest));
  const auto found = ring_.at(exposed, beyond_of(setup_));
  return found ? found : ring_.at(sight.time, beyond_of(setup_));
}

std::optional<Innovation> ErrorStateFilter::innovation_of(const GateSight& sight) const {
  if (!started_) return std::nullopt;
  const auto i = tick_of(sight);
  if (!i) return std::nullopt;
  const Tick& tick = ring_[*i];
  Nominal x = tick.x;
  x.rate_B = rate_around(*i);
  const bool fresh =
      sight.quality == GateSight::Quality::kWhole && x.corner_of != eskf::face_of(sight);
  return innovation(x, ring_.covariance(ring_.kept_before(*i)), sight, landmarks_.shape(sight.slot),
                    sight.time - tick.time, fresh, setup_.camera, setup_.params.sight);
}

bool ErrorStateFilter::correct(std::span<const GateSight> sights) {
  std::optional<std::size_t> first;
  for (const GateSight& sight : sights) {
    const auto i = started_ ? tick_of(sight) : std::nullopt;
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
    take_in(i);
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

void ErrorStateFilter::replace_target(const Eigen::Vector3d& p_EG, double yaw_EG, double sigma,
                                      double yaw_sigma) {
  if (!started_ || target_slot() < 0) return;
  const int slot = target_slot(), at = gate_at(slot);
  const Priors& priors = setup_.params.priors;
  Tick tick = ring_[ring_.newest()];
  GateBelief& gate = tick.x.gates[static_cast<std::size_t>(slot)];
  gate = {p_EG, wrap_angle(yaw_EG - (target_.behind ? kPi : 0.0)), 0.0};
  P_.middleRows<kPerGate>(at).setZero();
  P_.middleCols<kPerGate>(at).setZero();
  P_.diagonal().segment<kPerGate>(at) << sigma * sigma, sigma * sigma, sigma * sigma,
      yaw_sigma * yaw_sigma, priors.map_size * priors.map_size;
  // Earlier sightings were taken for another place: they are not done again.
  tick.sights.clear(), tick.heights.clear();
  ring_.restart(tick, P_);
  catch_up();
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
