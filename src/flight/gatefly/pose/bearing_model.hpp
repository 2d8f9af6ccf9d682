// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

namespace gatefly {

/// A camera at one moment, as believed, with what its calibration may have wrong.
struct CameraPose {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Matrix3d R_EB = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d R_BC = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p_BC = Eigen::Vector3d::Zero();  ///< [m]
  /// The lens draws a point at slope t from the axis as if it were at t (1 + focal + bend t²).
  double focal = 0.0, bend = 0.0;
};

/// Residual of an observed bearing and its derivatives.
///
/// Two rows: right and down in the plane that touches the unit sphere where it was seen [rad]. The
/// derivatives are those of the prediction; an error of R_EB or R_BC turns it by
/// rotation_of(error), in the earth's axes for R_EB (from the left), in the camera's for R_BC
/// (from the right).
struct PointBearing {
  Eigen::Vector2d residual;  ///< Seen less predicted [rad].
  Eigen::Matrix<double, 2, 3>
      by_point;  ///< Derivative by the point [rad/m]; the negative of that by the body's position.
  Eigen::Matrix<double, 2, 3> by_turn;   ///< Derivative by R_EB.
  Eigen::Matrix<double, 2, 3> by_mount;  ///< Derivative by R_BC.
  Eigen::Vector2d by_focal, by_bend;
};

/// @param seen_C  unit bearing by the calibration as it is.
/// @return nullopt when the point is beside or behind the camera.
[[nodiscard]] std::optional<PointBearing> point_bearing(const Eigen::Vector3d& point_E,
                                                        const Eigen::Vector3d& seen_C,
                                                        const CameraPose& camera);

/// The same of a line through `point_E`: one row, across it. Where along the line it was seen is
/// left open.
struct LineBearing {
  double residual;  ///< [rad]
  Eigen::Matrix<double, 1, 3> by_point, by_turn, by_mount;
  double by_focal, by_bend;
  double distance;  ///< From the camera to the point of the line that was seen [m].
};
[[nodiscard]] std::optional<LineBearing> line_bearing(const Eigen::Vector3d& point_E,
                                                      const Eigen::Vector3d& along_E,
                                                      const Eigen::Vector3d& seen_C,
                                                      const CameraPose& camera);

}  // namespace gatefly
