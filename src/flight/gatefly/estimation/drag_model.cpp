// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/drag_model.hpp"

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::drag_model {

Eigen::Vector3d velocity_B(const State& x, const Input& u, const Params& params) {
  // Eq. (14): v = K⁻¹ (a − b). Drag makes the accelerometer a speedometer.
  return {(u.accel_B.x() - x(kBiasX)) / params.drag.x(),
          (u.accel_B.y() - x(kBiasY)) / params.drag.y(), x(kVz)};
}

State derivative(const State& x, const Input& u, const Params& params) {
  const Eigen::Vector3d v_B = velocity_B(x, u, params);
  State dx = State::Zero();  // Eq. (18): ḃ = 0.
  // Eq. (11), (15): ṗ = R v_B.
  dx.segment<3>(kX) = rotation_EB(Attitude{u.roll, u.pitch, u.yaw}) * v_B;
  // Eq. (17): v̇_z = (a_z − b_z) + g cosθ cosφ + q v_x − p v_y.
  const double gravity_z = params.gravity * cos(u.pitch) * cos(u.roll);
  dx(kVz) = u.accel_B.z() - x(kBiasZ) + gravity_z + u.gyro_B.y() * v_B.x() - u.gyro_B.x() * v_B.y();
  return dx;
}

StateMatrix jacobian(const State&, const Input& u, const Params& params) {
  StateMatrix F = StateMatrix::Zero();
  const Eigen::Matrix3d R = rotation_EB(Attitude{u.roll, u.pitch, u.yaw}).matrix;
  F.block<3, 1>(kX, kVz) = R.col(2);
  F.block<3, 1>(kX, kBiasX) = -R.col(0) / params.drag.x();
  F.block<3, 1>(kX, kBiasY) = -R.col(1) / params.drag.y();
  F(kVz, kBiasX) = -u.gyro_B.y() / params.drag.x();
  F(kVz, kBiasY) = u.gyro_B.x() / params.drag.y();
  F(kVz, kBiasZ) = -1.0;
  return F;
}

}  // namespace gatefly::drag_model
