// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/smoothing/linear_model.hpp"

#include <cmath>

#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly::smoothing {

using namespace eskf;

BaseVector Step::times(const BaseVector& error) const {
  BaseVector out = kept.cwiseProduct(error);
  out.head<kMoving>() = F * error.head<kMoving>();
  return out;
}

BaseVector Step::transposed_times(const BaseVector& lambda) const {
  BaseVector out = kept.cwiseProduct(lambda);
  out.head<kMoving>() = F.transpose() * lambda.head<kMoving>();
  return out;
}

// Noise shows where nothing was before, what is kept where everything was 1.
Step step_of(Nominal& x, std::span<const Sample> samples, const Setup& setup) {
  const double px = setup.camera.radians_per_px;
  Step step;
  step.F = transition(x, mean_of(samples), setup.params);
  Covariance nothing = Covariance::Zero(kGates, kGates),
             ones = Covariance::Identity(kGates, kGates);
  Nominal same = x;
  predict(same, ones, samples, setup.params, px);
  predict(x, nothing, samples, setup.params, px);
  step.noise = nothing.diagonal();
  for (int i = kMoving; i < kGates; ++i)
    step.kept(i) = std::sqrt(std::max(0.0, ones(i, i) - nothing(i, i)));
  return step;
}

BaseVector difference(const Nominal& to, const Nominal& from) {
  BaseVector e;
  e.segment<3>(kP) = to.p_EB - from.p_EB;
  e.segment<3>(kV) = to.v_E - from.v_E;
  e.segment<3>(kTheta) = turn_of(to.R_EB * from.R_EB.transpose());
  e.segment<3>(kGyroBias) = to.gyro_bias - from.gyro_bias;
  e.segment<3>(kAccelBias) = to.accel_bias - from.accel_bias;
  e.segment<2>(kGust) = to.gust - from.gust;
  e.segment<2>(kWind) = to.wind - from.wind;
  e.segment<2>(kDrag) = to.drag - from.drag;
  e.segment<3>(kMount) = turn_of(from.R_BC.transpose() * to.R_BC);
  e(kFocal) = to.focal - from.focal, e(kBend) = to.bend - from.bend;
  e(kDelay) = to.delay - from.delay;
  e.segment<3>(kCorner) = to.corner - from.corner;
  e(kThrust) = to.thrust - from.thrust;
  return e;
}

std::optional<Rows> rows_of(const Nominal& x, const GateSight& sight, const GateBelief& gate,
                            const GateShape& shape, double offset, const Setup& setup) {
  Nominal at = x;
  at.corner.setZero();
  at.gates[0] = gate;
  GateSight in_first_slot = sight;
  in_first_slot.slot = 0;
  const auto seen =
      gate_rows(at, in_first_slot, shape, offset, false, setup.camera, setup.params.sight);
  if (!seen) return std::nullopt;
  Rows rows;
  rows.states.assign(seen->states.begin(), seen->states.end());
  for (int& state : rows.states)
    if (state >= kGates) state += kPerGate * sight.slot;
  rows.H = seen->jacobian;
  rows.residual = seen->residual;
  rows.noise = seen->noise;
  return rows;
}

}  // namespace gatefly::smoothing
