// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Frame tags; one letter each in variable names. Drawings: docs/conventions.md.
namespace gatefly::frame {
struct Earth {};   ///< E  north-east-down, fixed to the ground.
struct Body {};    ///< B  front-right-down, origin at the centre of mass.
struct Camera {};  ///< C  right-down-forward, origin at the focal point.
struct Flat {};    ///< F  Earth turned by yaw only, origin at the drone [Li18 §4].
struct Gate {};    ///< G  x through the gate, y right, z down, origin at its centre.
}  // namespace gatefly::frame

namespace gatefly {

/// Orientation of `From` seen in `To`: v_E = R_EB * v_B. The paper writes R_EB as ℜ_B^E.
template <class To, class From>
struct Rotation {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();  ///< Orthonormal, det = +1.

  Eigen::Vector3d operator*(const Eigen::Vector3d& v) const { return matrix * v; }
  [[nodiscard]] Rotation<From, To> inverse() const { return {matrix.transpose()}; }
};

/// R_AC = R_AB * R_BC. The inner frames must match; anything else does not compile.
template <class A, class B, class C>
Rotation<A, C> operator*(const Rotation<A, B>& R_AB, const Rotation<B, C>& R_BC) {
  return {R_AB.matrix * R_BC.matrix};
}

using RotationEB = Rotation<frame::Earth, frame::Body>;
using RotationBC = Rotation<frame::Body, frame::Camera>;
using RotationGB = Rotation<frame::Gate, frame::Body>;

}  // namespace gatefly
