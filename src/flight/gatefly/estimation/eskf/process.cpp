// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/process.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly::eskf {
namespace {

// e^-x of a small x >= 0: what is left of a first-order process; 1e-5 off at x = 0.2.
double left_after(double x) {
  const double h = 0.25 * x;
  const double y = 1.0 / (1.0 + h + 0.5 * h * h + h * h * h / 6.0);
  return y * y * y * y;
}

// C = C Fᵀ, column by column: c_j = Σ_i F_ji c_i. F is upper triangular (p by v, θ, b; v by θ, b; θ by
// b), so that the columns to the right are still as they were.
template <class Columns>
void times_transposed(Columns&& C, const Transition& F) {
  for (int j = 0; j < kMoving; ++j) {
    if (F(j, j) != 1.0) C.col(j) *= F(j, j);
    for (int i = j + 1; i < kMoving; ++i)
      if (F(j, i) != 0.0) C.col(j) += F(j, i) * C.col(i);
  }
}

// P = F P Fᵀ, F being the identity but for its first kMoving rows and columns.
void carry(Covariance& P, const Transition& F) {
  const Eigen::Index rest = P.rows() - kMoving;
  times_transposed(P.leftCols<kMoving>(), F);
  P.block(0, kMoving, kMoving, rest) = P.block(kMoving, 0, rest, kMoving).transpose();
  Transition corner = P.topLeftCorner<kMoving, kMoving>().transpose();
  times_transposed(corner, F);
  P.topLeftCorner<kMoving, kMoving>() = 0.5 * (corner + corner.transpose());
}

void fade_corner(Nominal& x, Covariance& P, double dt, const Params& params,
                 double radians_per_px) {
  const SightNoise& sight = params.sight;
  const double keep = left_after(dt / sight.lasts);
  x.corner *= keep;
  P.middleRows<3>(kCorner) *= keep;
  P.middleCols<3>(kCorner) *= keep;
  for (int i = 0; i < 3; ++i) {
    const double sigma = radians_per_px * (i < 2 ? sight.lasting : sight.lasting_size);
    P(kCorner + i, kCorner + i) += sigma * sigma * (1.0 - keep * keep);
  }
}

void add_noise(const Nominal& x, Covariance& P, const Interval& interval, double keep,
               const Params& params) {
  const Noise& noise = params.noise;
  const double dt = interval.dt;
  const Eigen::Vector3d rate_E = x.R_EB * (interval.mean.gyro_B - x.gyro_bias);
  const auto grow = [&P](int i, double variance) { P(i, i) += variance; };
  for (int i = 0; i < 3; ++i) {
    const double turned = noise.gyro_scale * rate_E(i);
    grow(kV + i, x.accel_shaking * (i < 2 ? noise.accel : noise.accel_z) * dt);
    grow(kTheta + i, (x.gyro_shaking * noise.attitude + turned * turned) * dt);
    grow(kGyroBias + i, noise.gyro_bias * dt);
    grow(kAccelBias + i, noise.accel_bias * dt);
  }
  for (int i = 0; i < 2; ++i) {
    grow(kP + i, noise.position * dt);
    grow(kWind + i, noise.wind * dt);
    grow(kDrag + i, noise.drag * dt);
    grow(kGust + i, x.gust_sigma * x.gust_sigma * (1.0 - keep * keep));
  }
  grow(kThrust, noise.thrust * dt);
}

}  // namespace

void propagate(Nominal& x, const Sample& sample, double gravity) {
  const double dt = sample.dt;
  x.rate_B = sample.imu.gyro_B - x.gyro_bias;
  const Eigen::Matrix3d half = rotation_of(0.5 * dt * x.rate_B);
  const Eigen::Matrix3d R_middle = x.R_EB * half;
  const Eigen::Vector3d a_E =
      R_middle * (sample.imu.accel_B - x.accel_bias) + Eigen::Vector3d{0, 0, gravity};
  x.p_EB += dt * x.v_E + 0.5 * dt * dt * a_E;
  x.v_E += dt * a_E;
  x.R_EB = R_middle * half;
}

Interval mean_of(std::span<const Sample> samples) {
  Interval all;
  bool knows_thrust = true;
  for (const Sample& one : samples) {
    all.mean.gyro_B += one.dt * one.imu.gyro_B;
    all.mean.accel_B += one.dt * one.imu.accel_B;
    all.thrust += one.dt * one.thrust;
    all.dt += one.dt;
    knows_thrust = knows_thrust && one.thrust > 0.0;
  }
  if (all.dt > 0.0) all.mean.gyro_B /= all.dt, all.mean.accel_B /= all.dt, all.thrust /= all.dt;
  if (!knows_thrust) all.thrust = 0.0;
  return all;
}

double gust_left(const Nominal& x, double dt, const Params& params) {
  const double air = (x.v_E.head<2>() - x.wind).norm();
  return left_after(dt * std::max(params.slowest_air, air) / params.noise.gust_length);
}

void widen(Covariance& P) {
  constexpr double kPlace = 0.25, kSpeed = 0.04, kHeading = 9e-4;  // [m²] [m²/s²] [rad²]
  for (int i = 0; i < 2; ++i) P(kP + i, kP + i) += kPlace, P(kV + i, kV + i) += kSpeed;
  P(kTheta + 2, kTheta + 2) += kHeading;
}

Transition transition(const Nominal& x, const Interval& interval, const Params& params) {
  const double dt = interval.dt;
  const Eigen::Vector3d rate = interval.mean.gyro_B - x.gyro_bias;
  const Eigen::Matrix3d R = x.R_EB * rotation_of(0.5 * dt * rate);
  const Eigen::Matrix3d A = -skew(R * (interval.mean.accel_B - x.accel_bias));
  Transition F = Transition::Identity();
  F.block<3, 3>(kP, kV).diagonal().setConstant(dt);
  F.block<3, 3>(kP, kTheta) = 0.5 * dt * dt * A;
  F.block<3, 3>(kP, kAccelBias) = -0.5 * dt * dt * R;
  F.block<3, 3>(kV, kTheta) = dt * A;
  F.block<3, 3>(kV, kGyroBias) = -0.5 * dt * dt * A * R;
  F.block<3, 3>(kV, kAccelBias) = -dt * R;
  F.block<3, 3>(kTheta, kGyroBias) = -dt * R;
  F(kGust, kGust) = F(kGust + 1, kGust + 1) = gust_left(x, dt, params);
  return F;
}

void predict(Nominal& x, Covariance& P, std::span<const Sample> samples, const Params& params,
             double radians_per_px) {
  const Interval interval = mean_of(samples);
  const Transition F = transition(x, interval, params);
  for (const Sample& one : samples) propagate(x, one, params.gravity);
  const double keep = F(kGust, kGust);
  x.gust *= keep;
  carry(P, F);
  fade_corner(x, P, interval.dt, params, radians_per_px);
  add_noise(x, P, interval, keep, params);
}

}  // namespace gatefly::eskf
