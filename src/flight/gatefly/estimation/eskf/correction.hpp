// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "gatefly/estimation/eskf/process.hpp"

// Measurements of one number each, and the update they share.
namespace gatefly::eskf {

/// One number that was measured: which errors move it, and how much.
template <std::size_t N>
struct Scalar {
  double residual = 0.0;  ///< Measured less predicted.
  std::array<int, N> states{};
  std::array<double, N> jacobian{};
  double variance = 1.0;
};

/// Kalman update by one number, in place; P stays symmetric to the bit.
template <std::size_t N>
void correct(Nominal& x, Covariance& P, const Scalar<N>& m) {
  ErrorVector PH = ErrorVector::Zero(P.rows());
  for (std::size_t i = 0; i < N; ++i) PH += m.jacobian[i] * P.col(m.states[i]);
  double S = m.variance;
  for (std::size_t i = 0; i < N; ++i) S += m.jacobian[i] * PH(m.states[i]);
  if (!(S > 0.0)) return;
  add(x, PH * (m.residual / S));
  PH /= std::sqrt(S);
  for (Eigen::Index j = 0; j < PH.size(); ++j) P.col(j) -= PH(j) * PH;
}

/// Drag along one axis of the body: f_i = k_i (1 + κ_i) [Rᵀ (v − w − g)]_i + b_i.
using DragMeasurement = Scalar<12>;
[[nodiscard]] DragMeasurement drag_measurement(const Nominal& x, const Interval& interval, int axis,
                                               const Params& params);

/// Both axes of it, and what that says about how strong gusts are.
void correct_by_drag(Nominal& x, Covariance& P, const Interval& interval, const Params& params);

/// The accelerometer measures what the rotors were commanded to: f_z = b_z - (1 + τ) u.
///
/// At hover τ and b_z show together; gates tell b_z, and with it the thrust that hovering takes.
using ThrustMeasurement = Scalar<2>;
[[nodiscard]] ThrustMeasurement thrust_measurement(const Nominal& x, const Interval& interval,
                                                   const Params& params);

/// Whether the thrust is known and the rotors carry the drone: on the pad the floor does.
[[nodiscard]] bool rotors_carry(const Nominal& x, const Interval& interval, const Params& params);

/// That measurement, where they do.
void correct_by_thrust(Nominal& x, Covariance& P, const Interval& interval, const Params& params);

/// A height above the floor [m]. False: more than five sigmas off, and left.
bool correct_by_height(Nominal& x, Covariance& P, double height, double sigma);

/// A position in E, each axis by itself, as motion capture or a satellite has it [m].
void correct_by_position(Nominal& x, Covariance& P, const Eigen::Vector3d& p_EB,
                         const Eigen::Vector3d& sigma);

/// The mean specific force of a drone that stands, which is not accelerated: Rᵀ (0, 0, −g) + b.
void correct_by_rest(Nominal& x, Covariance& P, const Eigen::Vector3d& accel_B,
                     const Params& params);

}  // namespace gatefly::eskf
