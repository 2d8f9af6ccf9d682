// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/sensors.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"

namespace gatefly::sim {
namespace {

constexpr double kNoiseHz = 512.0;    // the rate at which noise was measured
constexpr double kMostJitter = 9e-4;  // [s]

}  // namespace

double ImuModel::next_interval() {
  const double most = std::min(kMostJitter, 0.5 / truth_.imu_hz);
  return 1.0 / truth_.imu_hz + std::clamp(truth_.imu_jitter * noise_.normal(), -most, most);
}

Eigen::Vector3d ImuModel::rumble(double dt) {
  constexpr double kFast = 2.0 * kPi * 12.0, kSlow = 2.0 * kPi * 3.0;  // corners [rad/s]
  const double part = std::min(1.0, kFast * dt), keep = 1.0 - part;
  const Eigen::Vector3d push{rumbling_.normal(), rumbling_.normal(), rumbling_.normal()};
  rumble_ = keep * rumble_ + std::sqrt(1.0 - keep * keep) * truth_.gyro_rumble.cwiseProduct(push);
  slow_ += std::min(1.0, kSlow * dt) * (rumble_ - slow_);
  return rumble_ - slow_;
}

Imu ImuModel::measure(const BodyState& state, double dt) {
  double mean_speed = 0.0;
  for (const double speed : state.rotor_speed) mean_speed += 0.25 * speed;
  const double strength = std::min(1.5, (mean_speed / 750.0) * (mean_speed / 750.0));
  const bool flying = strength > 0.3;
  // Density of white noise and of the phase's wandering are the same at any rate.
  const double density = std::sqrt(truth_.imu_hz / kNoiseHz);
  time_ += dt;
  const double warm = 1.0 - std::exp(-time_ / truth_.warming_time);

  // Three axes of one shaking body: the same frequencies, different phases.
  Eigen::Vector3d shake{0, 0, 0};
  for (int i = 0; i < 4; ++i) {
    const double speed = state.rotor_speed[static_cast<std::size_t>(i)];
    double& phase = phase_(i);
    phase = wrap_angle(phase + speed * dt + 0.3 / density * noise_.normal());
    shake +=
        std::min(1.5, (speed / 750.0) * (speed / 750.0)) * truth_.imbalance(i) *
        Eigen::Vector3d{gatefly::sin(phase), gatefly::sin(phase + 2.1), gatefly::sin(phase + 4.0)};
  }
  // Four of them with an RMS of 1 together.
  shake *= truth_.noise_scale * std::sqrt(2.0) / 2.0;
  const auto white = [&] {
    return Eigen::Vector3d{noise_.normal(), noise_.normal(), noise_.normal()};
  };
  const double quiet = density * (flying ? 1.0 : 0.15);  // standing still with the motors off

  Imu imu;
  imu.accel_B = truth_.accel_scale.cwiseProduct(state.specific_force_B) + truth_.accel_bias +
                std::min(1.0, strength) * truth_.flight_bias + warm * truth_.accel_warming +
                truth_.accel_vibration.cwiseProduct(shake) +
                quiet * truth_.noise_scale * truth_.accel_noise.cwiseProduct(white());
  imu.gyro_B =
      truth_.gyro_scale.cwiseProduct(state.rate_B) + truth_.gyro_bias + warm * truth_.gyro_warming +
      (flying ? truth_.gyro_drift : Eigen::Vector3d::Zero().eval()) +
      truth_.gyro_vibration.cwiseProduct(shake) + (flying ? truth_.noise_scale : 0.0) * rumble(dt) +
      quiet * truth_.noise_scale * truth_.gyro_noise.cwiseProduct(white());
  // Range and resolution of the MPU-6050 at ±8 g, ±1000 °/s, as logged: 1/1024 m/s², 1/4096 rad/s.
  imu.accel_B = (imu.accel_B.cwiseMax(-78.0).cwiseMin(78.0) * 1024.0).array().round() / 1024.0;
  imu.gyro_B = (imu.gyro_B.cwiseMax(-17.4).cwiseMin(17.4) * 4096.0).array().round() / 4096.0;
  return imu;
}

std::optional<double> SonarModel::measure(const BodyState& state, const Sight* scene) {
  const Eigen::Matrix3d R_EB = R_EB_of(state.q_EB);
  const double jitter = truth_.sonar_noise * noise_.normal(), chance = noise_.uniform();
  if (R_EB(2, 2) < 0.7 || chance < truth_.sonar_loss) return std::nullopt;
  double nearest = truth_.sonar_max + 1.0;
  // A cone of ±15°: rings of 1, 6 and 12 rays.
  for (int ring = 0; ring < 3; ++ring) {
    const int rays = ring == 0 ? 1 : 6 * ring;
    const double tan_ring = 0.134 * ring;
    for (int i = 0; i < rays; ++i) {
      const auto [s, c] = sincos(2 * kPi * i / rays);
      const Eigen::Vector3d ray_E =
          R_EB * Eigen::Vector3d{tan_ring * c, tan_ring * s, 1.0}.normalized();
      if (ray_E.z() <= 0.3) continue;
      double range = -state.p_EB.z() / ray_E.z();  // the floor
      if (scene != nullptr)
        range = std::min(range, scene->range(state.p_EB, ray_E, truth_.sonar_max + 1.0));
      nearest = std::min(nearest, range);
    }
  }
  const bool twice = chance > 1.0 - truth_.sonar_double;  // to the floor, the belly, and again
  const double measured = (twice ? 2.0 : 1.0) * nearest + jitter;
  if (measured > truth_.sonar_max || measured < 0.02) return std::nullopt;
  return std::round(measured * 1000.0) / 1000.0;
}

double BaroModel::measure(const BodyState& state, double dt) {
  drift_ += truth_.baro_drift * std::sqrt(dt / 10.0) * noise_.normal();
  const double head = (state.v_E - state.wind_E).squaredNorm() / (2.0 * kGravity);
  return -state.p_EB.z() + drift_ + truth_.baro_airspeed * head +
         truth_.baro_noise * noise_.normal();
}

}  // namespace gatefly::sim
