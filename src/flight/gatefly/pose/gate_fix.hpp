// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/geometry/frames.hpp"
#include "gatefly/sensing/camera.hpp"

namespace gatefly {

/// A camera and how it sits on the drone, as the team measured it.
struct CameraRig {
  AnyCamera lens;
  RotationBC R_BC;
  Eigen::Vector3d p_BC = Eigen::Vector3d::Zero();  ///< Focal point in the body frame [m].
};

/// Systematic errors of a fix: the same in every picture of a gate, so that no averaging helps. The
/// filter considers them (Schmidt-Kalman filter), it does not estimate them.
namespace systematic {
enum Index : int { kTiltX, kTiltY, kHeading, kGateYaw, kScale, kHeight, kCount };
}
/// How far one standard deviation of each moves a position, one column each [m].
using Sensitivities = Eigen::Matrix<double, 3, systematic::kCount>;

struct PoseParams {
  /// Independent part. [authors' detections: 3 px robust; ours after line fits]
  double corner_sigma_px = 2.5;
  /// Roll and pitch of the camera; the pilot adds the AHRS's own uncertainty [rad]. [docs/simulation.md:
  /// mount 1°]
  double attitude_sigma = 0.017;
  double heading_sigma = 0.04;  ///< Yaw against the gate [rad]. [ours: map 3°, gyro]
  double gate_yaw_sigma = 0.0;  ///< The gate's part of heading_sigma [rad].
  /// Relative error of all distances: lens, side of the gate. [ours: 30 races]
  double scale_sigma = 0.025;
  /// Random part of a corner's error: independent between pictures ... [ours: 30 races]
  double random_sigma_px = 0.35;
  double random_part_sigma_px = 0.7;  ///< ... and of lower corners and bars. [ours: 30 races]
  double max_lateral = 4.0;           ///< |y| beyond this is no gate fix [m]. [Li18 flight code]
  double max_distance = 9.0;          ///< [m] [ours: a 1 m gate is 19 px there]
  double min_bars_distance = 0.3;     ///< [m] [Li18 flight code]
  double max_bars_distance = 1.8;     ///< [m] [Li18 flight code]
  /// |y| beyond this part of the bars' distance is no fix. [ours: beside the opening]
  double max_bars_lateral = 0.8;
  /// Limit for rays of the mean squared corner residual / σ²; 1 is expected. [ours: estimate]
  double max_misfit = 4.0;
  /// Error of a bar's middle at 1 m: lean, curtains behind it [m]. [ours: estimate]
  double bars_sigma = 0.05;
};

/// Position of the body relative to a gate, from one picture.
struct Fix {
  Eigen::Vector3d p_GB = Eigen::Vector3d::Zero();  ///< [m]; z is 0 when !has_height.
  /// Covariance of p_GB by random and systematic errors together, for a single picture [m²].
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  /// The same in two parts, to fuse many pictures: random errors, independent in each [m²] ...
  Eigen::Matrix3d random_covariance = Eigen::Matrix3d::Zero();
  /// ... and systematic ones. Zero: all of the covariance is random.
  Sensitivities systematic = Sensitivities::Zero();
  bool has_height = true;
  std::optional<double> yaw_error = std::nullopt;  ///< Correction to add to R_GB's yaw [rad].
  double yaw_variance = 0.0;                       ///< Variance of yaw_error [rad²].
};

/// Position from four corners and the attitude. Li18 §3.2, Eq. (5)-(9).
///
/// The corners also say how far the assumed heading is off: `yaw_error` is the fourth unknown of a
/// second least-squares problem (ours; the paper trusts the heading).
/// @param outer_corners_px  clockwise from top-left, outer corners of the frame.
/// @param R_GB              attitude at the moment of exposure, relative to the gate.
/// @param side              outer side of the gate [m].
/// @return nullopt when the rays do not meet in a point before the gate.
[[nodiscard]] std::optional<Fix> fix_from_corners(const Quad& outer_corners_px,
                                                  const RotationGB& R_GB, double side,
                                                  const CameraRig& rig, const PoseParams& params);

/// The same by the most probable pose (map_pose.hpp): corners that no gate in this attitude could
/// show are refused. Ours.
///
/// What the corners say about the heading is in `yaw_error`, the assumed heading taken out again.
/// @return nullopt for another gate, for a frame put together from two, for one too far off.
[[nodiscard]] std::optional<Fix> map_fix_from_corners(const Quad& outer_corners_px,
                                                      const RotationGB& R_GB, double side,
                                                      const CameraRig& rig,
                                                      const PoseParams& params);

/// Position from the two lower corners of a gate that is cut off above; no heading. Ours.
[[nodiscard]] std::optional<Fix> fix_from_lower_corners(const LowerCorners& gate,
                                                        const RotationGB& R_GB, double side,
                                                        const CameraRig& rig,
                                                        const PoseParams& params);

/// Position across and before the gate from its two side bars. Li18 Eq. (10), corrected.
///
/// Signed bearings, right positive, rotated by the full attitude (the flown code ignores tilt and
/// roll): x = s / (tan α₂ − tan α₁) before the gate, y = s/2 − x tan α₂.
/// @param bar_distance  between the centres of the two bars [m].
[[nodiscard]] std::optional<Fix> fix_from_bars(const GateBars& bars, const RotationGB& R_GB,
                                               double bar_distance, const CameraRig& rig,
                                               const PoseParams& params);

}  // namespace gatefly
