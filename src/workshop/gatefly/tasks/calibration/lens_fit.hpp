// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "gatefly/tasks/calibration/board_view.hpp"
#include "gatefly/tasks/calibration/lens_model.hpp"

namespace gatefly::calibration {

/// Pose of the board in the camera frame: rotation vector [rad], then its origin [m].
using BoardPose = Eigen::Matrix<double, 6, 1>;

/// A lens and where it saw the board in each view.
struct LensFit {
  LensModel model = LensModel::kKannalaBrandt;
  Eigen::VectorXd parameters;  ///< As parameter_names() has them.
  /// One standard deviation of each; empty when the views do not determine them all.
  Eigen::VectorXd sigma;
  std::vector<BoardPose> poses;  ///< One for each view.
  std::vector<int> fixed;        ///< Which parameters are not fitted.

  [[nodiscard]] AnyCamera lens() const { return lens_of(model, parameters); }
};

/// A point of the board in the camera frame [m].
[[nodiscard]] Eigen::Vector3d in_camera(const BoardPose& pose, const Eigen::Vector2d& p_W);

/// Errors count linearly from here on: several times a corner's scatter. [ours, estimate]
inline constexpr double kHuberPx = 1.0;

/// A first lens (Kannala-Brandt) without any knowledge: the equidistant fisheye of the focal length
/// that fits best of a few, poses from homographies of rays, then a bundle adjustment in which
/// large errors count linearly.
///
/// Views that have no pose in front of such a lens are removed from `views`.
[[nodiscard]] LensFit first_guess(BoardViews& views, const Eigen::Vector2i& size_px);

/// The same lens as another model would describe it near its axis; poses as they are.
[[nodiscard]] LensFit as_model(const LensFit& fit, LensModel model);

/// Bundle adjustment: lens and poses that make the squared distances in the pictures least [Triggs
/// et al. 2000].
///
/// @param huber_px  distances above count linearly only; 0: all count squared, and sigma is filled
///     in.
/// @returns nullopt when it finds no minimum in front of the camera.
[[nodiscard]] std::optional<LensFit> fit_lens(const BoardViews& views, const LensFit& start,
                                              double huber_px = 0.0);

/// The pose alone, the lens as it is. nullopt as above.
[[nodiscard]] std::optional<BoardPose> fit_pose(const BoardView& view, const LensFit& lens,
                                                const BoardPose& start);

/// Seen minus drawn for every corner [px], by the flight code's lens; NaN where it shows nothing.
[[nodiscard]] std::vector<Eigen::Vector2d> residuals_px(const BoardView& view,
                                                        const AnyCamera& lens,
                                                        const BoardPose& pose);

}  // namespace gatefly::calibration
