// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/state.hpp"

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly::eskf {

void add(Nominal& x, const ErrorVector& error) {
  x.p_EB += error.segment<3>(kP);
  x.v_E += error.segment<3>(kV);
  x.R_EB = rotation_of(error.segment<3>(kTheta)) * x.R_EB;
  x.turned += error(kTheta + 2);
  x.gyro_bias += error.segment<3>(kGyroBias);
  x.accel_bias += error.segment<3>(kAccelBias);
  x.gust += error.segment<2>(kGust);
  x.wind += error.segment<2>(kWind);
  x.drag += error.segment<2>(kDrag);
  x.R_BC = x.R_BC * rotation_of(error.segment<3>(kMount));
  x.focal += error(kFocal), x.bend += error(kBend), x.delay += error(kDelay);
  x.corner += error.segment<3>(kCorner);
  x.thrust += error(kThrust);
  const int gates = (static_cast<int>(error.size()) - kGates) / kPerGate;
  for (int slot = 0; slot < gates; ++slot) {
    GateBelief& gate = x.gates[static_cast<std::size_t>(slot)];
    gate.p_EG += error.segment<3>(gate_at(slot) + kGateP);
    gate.yaw_EG = wrap_angle(gate.yaw_EG + error(gate_at(slot) + kGateYaw));
    gate.size += error(gate_at(slot) + kGateSize);
  }
}

}  // namespace gatefly::eskf
