// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/exposure.hpp"

#include <algorithm>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sim/body_state.hpp"

namespace gatefly::sim {
namespace {

double px_per_radian_of(const AnyCamera& lens) {
  constexpr double kStep = 0.01;  // [rad]
  const auto axis = lens.project({0, 0, 1}), beside = lens.project({kStep, 0, 1});
  return axis && beside ? (*beside - *axis).norm() / kStep : 0.0;
}

}  // namespace

Exposure::Exposure(const world::CameraTruth& camera, double t_start,
                   std::span<const BodyPose> history)
    : camera_{camera},
      start_{t_start + 0.5 * camera.exposure},
      px_per_radian_{px_per_radian_of(camera.lens)},
      history_{history},
      R_BC_{camera_mount(camera.tilt_down).matrix} {
  at(start_ + 0.5 * camera.readout);
}

std::optional<Eigen::Vector2d> Exposure::project(const Eigen::Vector3d& p_E) {
  at(start_ + 0.5 * camera_.readout);
  auto px = projected(p_E);
  if (!px) return px;
  at(start_ + camera_.readout * camera_.part_of_readout(*px));
  return projected(p_E);
}

std::optional<Eigen::Vector3d> Exposure::direction_E(const Eigen::Vector2d& px) {
  at(start_ + 0.5 * camera_.readout);
  const auto bearing_C = camera_.lens.bearing(px);
  if (!bearing_C) return std::nullopt;
  return Eigen::Vector3d{R_CE_.transpose() * *bearing_C};
}

void Exposure::at(double t) {
  const BodyPose pose = interpolated(history_, t);
  const Eigen::Matrix3d R_EB = R_EB_of(pose.q_EB.normalized());
  eye_E_ = pose.p_EB + R_EB * camera_.p_BC;
  R_CE_ = (R_EB * R_BC_).transpose();
}

}  // namespace gatefly::sim
