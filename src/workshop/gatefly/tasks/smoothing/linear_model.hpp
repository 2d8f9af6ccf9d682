// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "gatefly/estimation/eskf/correction.hpp"
#include "gatefly/estimation/eskf/error_state_filter.hpp"
#include "gatefly/estimation/eskf/gate_sight.hpp"
#include "gatefly/estimation/eskf/process.hpp"

// The filter's own models, linearised around a trajectory: every number comes from the filter's functions.
namespace gatefly::smoothing {

/// Errors of all but the gates: those of eskf::Index up to kGates.
using BaseVector = Eigen::Matrix<double, eskf::kGates, 1>;

/// How errors of all but the gates go on over a tick: kMoving of them by F, each other one by itself.
struct Step {
  eskf::Transition F = eskf::Transition::Identity();
  BaseVector kept = BaseVector::Ones();   ///< So much of each is left; the first kMoving are F's.
  BaseVector noise = BaseVector::Zero();  ///< And so much variance comes in.
  BaseVector drift = BaseVector::Zero();  ///< The model's own end, less the trajectory's.

  [[nodiscard]] BaseVector times(const BaseVector& error) const;              ///< F e
  [[nodiscard]] BaseVector transposed_times(const BaseVector& lambda) const;  ///< Fᵀ λ
};

/// eskf::predict over a tick that begins at `x`, which is moved to its end. Its noise is independent for
/// each error.
[[nodiscard]] Step step_of(eskf::Nominal& x, std::span<const eskf::Sample> samples,
                           const eskf::Setup& setup);

/// The error of `from` that leads to `to`: eskf::add's inverse, gates left out.
[[nodiscard]] BaseVector difference(const eskf::Nominal& to, const eskf::Nominal& from);

/// A measurement, linearised: residual = H e + noise, of the errors `states`.
struct Rows {
  std::vector<int> states;
  Eigen::MatrixXd H;
  Eigen::VectorXd residual;
  Eigen::MatrixXd noise;
};

template <std::size_t N>
[[nodiscard]] Rows rows_of(const eskf::Scalar<N>& m) {
  Rows rows;
  rows.states.assign(m.states.begin(), m.states.end());
  rows.H = Eigen::Map<const Eigen::RowVectorXd>(m.jacobian.data(), static_cast<Eigen::Index>(N));
  rows.residual = Eigen::VectorXd::Constant(1, m.residual);
  rows.noise = Eigen::MatrixXd::Constant(1, 1, m.variance);
  return rows;
}

/// A sighting of landmark `sight.slot`, whose states follow kGates in the landmarks' order.
/// @param x  without gates; its corners' errors are taken for zero.
[[nodiscard]] std::optional<Rows> rows_of(const eskf::Nominal& x, const eskf::GateSight& sight,
                                          const eskf::GateBelief& gate,
                                          const eskf::GateShape& shape, double offset,
                                          const eskf::Setup& setup);

}  // namespace gatefly::smoothing
