// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Core>

#include "gatefly/estimation/eskf/params.hpp"
#include "gatefly/estimation/eskf/state.hpp"
#include "gatefly/sensing/imu.hpp"

// How errors grow: docs/derivations/error_state_filter.md.
namespace gatefly::eskf {

/// An IMU sample, and for how long it holds.
struct Sample {
  Imu imu;
  double dt = 0.0;  ///< [s]
  /// Specific thrust that was commanded, with the rotors' lag [m/s²]; 0: nobody knows.
  double thrust = 0.0;
};

/// Position, velocity, attitude after one sample: v̇ = R (f − b_a) + g, Ṙ = R [ω − b_g].
void propagate(Nominal& x, const Sample& sample, double gravity);

/// Several samples that count as one, of their mean.
struct Interval {
  Imu mean;
  double dt = 0.0;      ///< [s]
  double thrust = 0.0;  ///< [m/s²]; 0: not known of all of them.
};
[[nodiscard]] Interval mean_of(std::span<const Sample> samples);

/// The part of the transition matrix that is not the identity: of errors kP ... kWind.
inline constexpr int kMoving = kWind;
using Transition = Eigen::Matrix<double, kMoving, kMoving>;

/// ∂(errors after)/∂(errors before) over an interval that began at `x`.
[[nodiscard]] Transition transition(const Nominal& x, const Interval& interval,
                                    const Params& params);

/// The mean by every sample, the covariance by their mean.
void predict(Nominal& x, Covariance& P, std::span<const Sample> samples, const Params& params,
             double radians_per_px);

/// The position is in doubt: place, speed and heading are less certain than they were.
void widen(Covariance& P);

/// How much of a gust is left after the interval. No libm: e^-x by its own series.
[[nodiscard]] double gust_left(const Nominal& x, double dt, const Params& params);

}  // namespace gatefly::eskf
