// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/autopilot/autopilot.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly::sim {
namespace {

constexpr double kIdle = 0.055;  // of the highest speed, with the throttle at its least [a default]
constexpr double kGyroHz = 100.0;         // low-pass before the PID [docs/simulation.md: 100-250]
constexpr double kLevelling = 0.25;       // what gravity corrects the angles by [1/s; a default]
constexpr double kFullThrottle = 1000.0;  // of the throttle
constexpr int kMiddle = 1500, kHalfTravel = 500;  // of a stick [µs]

msp::RateCurve curve_of(const world::AutopilotTruth& truth, int axis) {
  return {.type = msp::RateCurve::Type::kBetaflight,
          .rc_rate = truth.rc_rate[axis],
          .super_rate = truth.super_rate[axis],
          .expo = truth.rc_expo[axis]};
}

msp::ThrottleCurve throttle_of(const world::AutopilotTruth& truth) {
  msp::RcTuning tuning;
  tuning.throttle_mid = static_cast<std::uint8_t>(truth.throttle_mid);
  tuning.throttle_expo = static_cast<std::uint8_t>(truth.throttle_expo);
  tuning.throttle_hover = msp::RcTuning::kNoHover;
  msp::RxConfig receiver;
  receiver.min_check = 1050;
  return *msp::ThrottleCurve::from(tuning, receiver);
}

}  // namespace

StickCurves::StickCurves(const world::AutopilotTruth& truth)
    : rates{curve_of(truth, 0), curve_of(truth, 1), curve_of(truth, 2)},
      throttle{throttle_of(truth)},
      most_angle{truth.most_angle} {}

double StickCurves::angle(int stick) const {
  return most_angle * std::clamp((stick - kMiddle) / double(kHalfTravel), -1.0, 1.0);
}

int StickCurves::angle_stick(double angle) const {
  if (!std::isfinite(angle)) return kMiddle;
  return kMiddle +
         static_cast<int>(std::lround(kHalfTravel * std::clamp(angle / most_angle, -1.0, 1.0)));
}

int throttle_of(double speed, double highest) {
  const double part = (speed / highest - kIdle) / (1.0 - kIdle);
  return static_cast<int>(std::lround(kFullThrottle * std::clamp(part, 0.0, 1.0)));
}

Autopilot::Autopilot(const world::AutopilotTruth& truth, const world::VehicleTruth& vehicle)
    : truth_{truth},
      vehicle_{vehicle},
      curves_{truth},
      sticks_{truth.smoothing_hz},
      gyro_{kGyroHz},
      derivative_{kGyroHz} {
  // With the rotors' lag τ a rate obeys τ s² + (1 + k_d) s + k_p = 0: ω² = k_p / τ, 2 ζ ω τ = 1 + k_d.
  const double tau = vehicle.rotor_time_constant;
  kp_ = truth.gain / tau * Eigen::Vector3d{2.0, 2.0, 0.5};
  kd_ = truth.gain * Eigen::Vector3d{1.0, 1.0, 0.0};
  ki_ = kp_ / (10.0 * tau);
  // At hover; more throttle makes it livelier, as it does real ones.
  const double hover = std::sqrt(vehicle.mass * kGravity / 4.0 / vehicle.thrust_coefficient);
  const double thrust_per_throttle =
      2.0 * vehicle.thrust_coefficient * hover * (1.0 - kIdle) * vehicle.max_speed;
  turn_per_throttle_ =
      4.0 * thrust_per_throttle *
      Eigen::Vector3d{vehicle.arm_y, vehicle.arm_x, vehicle.torque_coefficient}.cwiseQuotient(
          vehicle.inertia);
}

Eigen::Vector2d Autopilot::angles() const {
  return {atan2(-up_B_.y(), -up_B_.z()), asin(std::clamp(up_B_.x(), -1.0, 1.0))};
}

void Autopilot::level(const Imu& imu, double dt) {
  const double size = imu.accel_B.norm();
  Eigen::Vector3d turn = imu.gyro_B - bias_;
  if (size > 0.5 * kGravity) turn += kLevelling * (imu.accel_B / size).cross(up_B_);
  up_B_ = rotation_of(-dt * turn) * up_B_;
  up_B_.normalize();
}

// The rates that the smoothed sticks ask for [rad/s].
Eigen::Vector3d Autopilot::wanted_rates(const Eigen::Vector4d& smoothed) const {
  Eigen::Vector3d rates = smoothed.head<3>();
  if (truth_.takes == world::AutopilotTruth::Takes::kAngles)
    rates.head<2>() = truth_.angle_gain * (smoothed.head<2>() - angles());
  return rates;
}

// The differences count: where a rotor is at its limit the throttle gives way.
std::array<double, 4> Autopilot::mixed(const Eigen::Vector3d& turn, double throttle) const {
  const Eigen::Vector3d part = turn.cwiseQuotient(turn_per_throttle_);
  constexpr std::array<double, 4> kRoll{1, -1, -1, 1}, kPitch{1, 1, -1, -1}, kYaw{-1, 1, -1, 1};
  Eigen::Vector4d share;
  for (int i = 0; i < 4; ++i) {
    const auto k = static_cast<std::size_t>(i);
    share(i) = kRoll[k] * part.x() + kPitch[k] * part.y() + kYaw[k] * part.z();
  }
  const double range = share.maxCoeff() - share.minCoeff();
  if (range > 1.0) share /= range;
  const double base = std::clamp(throttle, -share.minCoeff(), 1.0 - share.maxCoeff());
  std::array<double, 4> speeds{};
  for (int i = 0; i < 4; ++i)
    speeds[static_cast<std::size_t>(i)] =
        vehicle_.max_speed * (kIdle + (1.0 - kIdle) * std::clamp(base + share(i), 0.0, 1.0));
  return speeds;
}

std::array<double, 4> Autopilot::step(const SetPoint& wanted, const Imu& imu, double dt) {
  Imu sample = imu;
  const bool usable = imu.gyro_B.allFinite() && imu.accel_B.allFinite();
  if (!usable) sample = {last_gyro_, Eigen::Vector3d::Zero()};
  if (!wanted.armed) {  // it stands: that is level enough, and what the gyro says is its bias
    if (usable) {
      bias_ += (sample.gyro_B - bias_) / ++rested_;
      if (sample.accel_B.norm() > 1.0) up_B_ += (sample.accel_B.normalized() - up_B_) / rested_;
      up_B_.normalize();
    }
    sticks_.reset(), integral_.setZero(), started_ = false;
    return {};
  }
  level(sample, dt);
  const msp::Sticks& s = wanted.sticks;
  Eigen::Vector4d asked;
  asked.head<3>() = curves_.rates.rates(s);
  // Stick forward is nose down, for rates and for angles.
  if (truth_.takes == world::AutopilotTruth::Takes::kAngles)
    asked.head<2>() = Eigen::Vector2d{curves_.angle(s.roll), -curves_.angle(s.pitch)};
  asked(3) = curves_.throttle.throttle(s.throttle) / kFullThrottle;
  const Eigen::Vector4d smoothed = sticks_.update(asked, dt);

  const Eigen::Vector3d rate = gyro_.update(sample.gyro_B - bias_, dt);
  const Eigen::Vector3d accel = derivative_.update(
      started_ ? Eigen::Vector3d{(rate - last_gyro_) / dt} : Eigen::Vector3d::Zero(), dt);
  last_gyro_ = rate, started_ = true;
  const Eigen::Vector3d error = wanted_rates(smoothed) - rate;
  constexpr double kMostIntegral = 0.2;  // of a full throttle
  integral_ += dt * ki_.cwiseProduct(error);
  const Eigen::Vector3d most = kMostIntegral * turn_per_throttle_;
  integral_ = integral_.cwiseMax(-most).cwiseMin(most);
  const Eigen::Vector3d turn = kp_.cwiseProduct(error) - kd_.cwiseProduct(accel) + integral_;
  return mixed(turn, smoothed(3));
}

}  // namespace gatefly::sim
