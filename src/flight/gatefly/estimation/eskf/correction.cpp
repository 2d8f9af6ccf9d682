// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/correction.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::eskf {
namespace {

// An expectation-maximisation step of a first-order process: its variance is the mean of g².
void learn_gust(Nominal& x, const Covariance& P, double dt, const Noise& noise) {
  if (!(noise.gust_adaptation > 0.0)) return;
  const double seen = 0.5 * (x.gust.squaredNorm() + P(kGust, kGust) + P(kGust + 1, kGust + 1));
  const double now = x.gust_sigma * x.gust_sigma;
  const double next = now + noise.gust_adaptation * dt * (seen - now);
  x.gust_sigma = std::clamp(std::sqrt(std::max(0.0, next)), noise.least_gust, noise.greatest_gust);
}

}  // namespace

DragMeasurement drag_measurement(const Nominal& x, const Interval& interval, int axis,
                                 const Params& params) {
  Eigen::Vector3d air = x.v_E;
  air.head<2>() -= x.wind + x.gust;
  const Eigen::RowVector3d body = x.R_EB.col(axis).transpose();  // row of Rᵀ
  const double k = params.drag(axis) * (1.0 + x.drag(axis));
  const double speed = body * air;
  const Eigen::RowVector3d by_turn = k * body * skew(air);
  return {.residual = interval.mean.accel_B(axis) - x.accel_bias(axis) - k * speed,
          .states = {kV, kV + 1, kV + 2, kTheta, kTheta + 1, kTheta + 2, kAccelBias + axis, kGust,
                     kGust + 1, kWind, kWind + 1, kDrag + axis},
          .jacobian = {k * body(0), k * body(1), k * body(2), by_turn(0), by_turn(1), by_turn(2),
                       1.0, -k * body(0), -k * body(1), -k * body(0), -k * body(1),
                       params.drag(axis) * speed},
          .variance = x.accel_shaking * params.noise.drag_measurement / interval.dt};
}

void correct_by_drag(Nominal& x, Covariance& P, const Interval& interval, const Params& params) {
  for (const int axis : {0, 1}) correct(x, P, drag_measurement(x, interval, axis, params));
  learn_gust(x, P, interval.dt, params.noise);
}

ThrustMeasurement thrust_measurement(const Nominal& x, const Interval& interval,
                                     const Params& params) {
  const double expected = x.accel_bias.z() - (1.0 + x.thrust) * interval.thrust;
  return {.residual = interval.mean.accel_B.z() - expected,
          .states = {kAccelBias + 2, kThrust},
          .jacobian = {1.0, -interval.thrust},
          .variance = x.accel_shaking * params.noise.thrust_measurement / interval.dt};
}

bool rotors_carry(const Nominal& x, const Interval& interval, const Params& params) {
  constexpr double kLifts = 0.15;  // [m] Below that the floor pushes back.
  constexpr double kLeast = 0.5;   // of gravity: rotors that idle say nothing
  return interval.thrust >= kLeast * params.gravity && -x.p_EB.z() >= kLifts;
}

// Rotors that give less from one moment to the next: what was learnt of them holds no more. Without
// this a drone whose rotors lose a third sinks onto the floor before the random walk has followed.
void forget_broken_thrust(Nominal& x, Covariance& P, double residual, double dt,
                          const Priors& priors) {
  constexpr double kOver = 0.2;     // [s] longer than rotors' lag and a gust's edge. [estimate]
  constexpr double kBroken = 0.15;  // of gravity; a battery sags by less in minutes. [estimate]
  x.thrust_misfit += std::min(1.0, dt / kOver) * (residual - x.thrust_misfit);
  if (std::abs(x.thrust_misfit) < kBroken * kGravity) return;
  P(kThrust, kThrust) += priors.thrust * priors.thrust;
  x.thrust_misfit = 0.0;
}

void correct_by_thrust(Nominal& x, Covariance& P, const Interval& interval, const Params& params) {
  if (!rotors_carry(x, interval, params)) return;
  const ThrustMeasurement measured = thrust_measurement(x, interval, params);
  forget_broken_thrust(x, P, measured.residual, interval.dt, params.priors);
  correct(x, P, measured);
}

bool correct_by_height(Nominal& x, Covariance& P, double height, double sigma) {
  constexpr double kFarthest = 5.0;  // sigmas
  constexpr double kDoubt = 0.003;   // [m²] A floor that keeps disagreeing wins in the end.
  const Scalar<1> m{.residual = -height - x.p_EB.z(),
                    .states = {kP + 2},
                    .jacobian = {1.0},
                    .variance = sigma * sigma};
  const double S = P(kP + 2, kP + 2) + m.variance;
  if (!(m.residual * m.residual < kFarthest * kFarthest * S)) {
    P(kP + 2, kP + 2) += kDoubt;
    return false;
  }
  correct(x, P, m);
  return true;
}

void correct_by_position(Nominal& x, Covariance& P, const Eigen::Vector3d& p_EB,
                         const Eigen::Vector3d& sigma) {
  for (int axis = 0; axis < 3; ++axis)
    correct(x, P,
            Scalar<1>{.residual = p_EB(axis) - x.p_EB(axis),
                      .states = {kP + axis},
                      .jacobian = {1.0},
                      .variance = sigma(axis) * sigma(axis)});
}

void correct_by_rest(Nominal& x, Covariance& P, const Eigen::Vector3d& accel_B,
                     const Params& params) {
  const double variance = params.priors.rest_accel * params.priors.rest_accel;
  const Eigen::Vector3d up{0, 0, -params.gravity};
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::RowVector3d body = x.R_EB.col(axis).transpose();
    const Eigen::RowVector3d by_turn = body * skew(up);
    correct(x, P,
            Scalar<4>{.residual = accel_B(axis) - x.accel_bias(axis) - body * up,
                      .states = {kTheta, kTheta + 1, kTheta + 2, kAccelBias + axis},
                      .jacobian = {by_turn(0), by_turn(1), by_turn(2), 1.0},
                      .variance = variance});
  }
}

}  // namespace gatefly::eskf
