// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/velocity_observer.hpp"

#include "gatefly/geometry/attitude.hpp"

namespace gatefly {

void VelocityObserver::update(const drag_model::State& x, const drag_model::Input& u,
                              const drag_model::Params& model, double dt) {
  if (!(dt > 0.0) || dt > 1.0 || !u.accel_B.allFinite() || !u.gyro_B.allFinite()) return;
  const Eigen::Vector3d drag_v_B = drag_model::velocity_B(x, u, model);
  const Eigen::Vector3d gravity_B =
      rotation_EB(Attitude{u.roll, u.pitch, u.yaw}).matrix.transpose() *
      Eigen::Vector3d{0, 0, model.gravity};
  const Eigen::Vector3d force_B = u.accel_B - x.segment<3>(drag_model::kBiasX);
  // Eq. (16): v̇ = R_BE g + (a − b) − ω × v.
  v_B_ += dt * (gravity_B + force_B - u.gyro_B.cross(v_B_) + params_.pull * (drag_v_B - v_B_));
  v_B_.z() = x(drag_model::kVz);
}

}  // namespace gatefly
