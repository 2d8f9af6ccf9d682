// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

#include <Eigen/Core>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/pose/gate_fix.hpp"

namespace gatefly {

/// One thing seen of a gate: a point, or, with `along_G`, some point of a straight line.
struct GateObservation {
  Eigen::Vector2d px;  ///< Observed image point.
  /// Standard deviation of u and of v; for a line, across it.
  double sigma_px = 2.5;
  Eigen::Vector3d point_G;  ///< The map's point that shows there [m].
  /// Direction of the line through point_G; zero: the point itself.
  Eigen::Vector3d along_G = Eigen::Vector3d::Zero();
};
using GateObservations = FixedList<GateObservation, 16>;

/// Appends the four outer corners of a gate, TL TR BR BL; false when there is no room.
bool add_corners(GateObservations& seen, const Quad& outer_corners_px, double side,
                 double sigma_px);
/// Appends the two side bars, each by one point somewhere on it. `bar_distance` between their
/// middles [m].
bool add_bars(GateObservations& seen, const GateBars& bars, double bar_distance, double sigma_px);

/// Prior knowledge, one standard deviation each.
struct PosePrior {
  /// Attitude of the AHRS at exposure; yaw relative to the gate.
  Attitude attitude_GB = {};
  double roll_sigma = 0.02, pitch_sigma = 0.02;  ///< [rad] [ours: as PoseParams]
  double yaw_sigma = 0.04;                       ///< [rad] [ours: as PoseParams]
  /// Height below the gate's centre [m].
  double z = 0.0;
  /// [m]; two bars alone do not tell z.
  double z_sigma = std::numeric_limits<double>::infinity();
};

struct MapPoseParams {
  double outlier_share = 0.1;  ///< Share of outliers among all observations ... [ours: pose-grid]
  /// ... and how far they are off. [authors' detections: 10-40 px]
  double outlier_sigma_px = 20.0;
  double max_outliers = 0.25;  ///< Part of all observations.
  /// Largest normal_deviate() of the chi-square: 1 of 2,000 good fits is above. [estimate]
  double max_deviate = 3.3;
  /// The same when something was left out: parts of two gates fit better then. [estimate]
  double max_deviate_after_drop = 2.3;
  /// With a poor attitude also hypotheses worse by so much in chi-square are followed. [ours:
  /// pose-grid]
  double search_depth = 9.0;
  /// Most that hypotheses about outliers may widen the position's variance. [ours: pose-grid]
  double max_widening = 1.8;
  /// Sine of the angle between the line of sight and the gate's plane: 10°. [estimate]
  double min_incidence = 0.17;
  double max_distance = 12.0;  ///< [m] [ours: a 1 m gate is 14 px there]
  int max_steps = 40;          ///< Most fits take 4.
};

/// Why there is no pose.
enum class NoPose {
  kNone,         ///< There is one.
  kNotANumber,   ///< Or a standard deviation that is not positive.
  kOutsideLens,  ///< A pixel that the lens cannot have drawn.
  kTooFew,       ///< Observations and prior leave a direction open.
  kBehind,       ///< The gate would lie behind the camera, or the camera behind the gate.
  kEdgeOn,       ///< The gate's plane passes too near by the camera.
  kTooFar,
  kNotConverged,
  /// No gate of this size and attitude looks like that: another gate, parts of two, noise.
  kMisfit,
  kAmbiguous,  ///< Hypotheses about which observation is the outlier put the gate elsewhere.
};
[[nodiscard]] const char* text_of(NoPose reason);

/// Position and attitude of the body relative to a gate, with covariance.
struct MapPose {
  Eigen::Vector3d p_GB = Eigen::Vector3d::Zero();  ///< [m]
  Attitude attitude_GB;                            ///< The prior's, corrected.
  /// Covariance of (x, y, z, roll, pitch, yaw) [m, rad], prior included.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Identity();
  double chi2 = 0.0;     ///< Chi-square of the inliers, prior included.
  int dof = 0;           ///< Its degrees of freedom.
  unsigned dropped = 0;  ///< Bit i is set: observation i was left out.
};

struct MapPoseAnswer {
  std::optional<MapPose> pose;
  NoPose reason = NoPose::kNone;
};

/// The most probable position and attitude given all that is seen of a gate and the AHRS. Ours.
///
/// Minimises Σ (reprojection error / σ)² + Σ (attitude − AHRS)² / σ² by Levenberg-Marquardt from
/// the paper's ray intersection. An observation that costs more than an outlier would is left out.
/// With a poor attitude (σ > 0.1 rad) also from both poses that the homography of four corners
/// allows; all minima count by their probability. Derivation: docs/derivations/map_pose.md.
/// Two corners are enough; two bars need a z_sigma.
/// Cost: 3 µs for four good corners, 30-100 µs with σ > 0.06 rad; allocates nothing, throws
/// nothing.
/// @return finite numbers or a reason, for any input.
[[nodiscard]] MapPoseAnswer map_pose(const GateObservations& seen, const PosePrior& prior,
                                     const CameraRig& rig, const MapPoseParams& params = {});

/// The standard normal deviate that is as improbable as this chi-square. Wilson and Hilferty 1931;
/// 0 without degrees of freedom.
[[nodiscard]] double normal_deviate(double chi2, int dof);

}  // namespace gatefly
