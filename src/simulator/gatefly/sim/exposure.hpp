// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "gatefly/sim/camera.hpp"
#include "gatefly/sim/sight.hpp"

namespace gatefly::sim {

/// The camera during one exposure: where points of the world are drawn in the upright picture.
class Exposure {
 public:
  /// Camera and history must live as long.
  /// @param t_start  when the first stored line begins its exposure [s].
  /// @param history  body poses, ascending in t, covering the exposure.
  Exposure(const world::CameraTruth& camera, double t_start, std::span<const BodyPose> history);

  [[nodiscard]] int width() const { return camera_.width(); }
  [[nodiscard]] int height() const { return camera_.height(); }
  /// On the lens' axis.
  [[nodiscard]] double px_per_radian() const { return px_per_radian_; }
  /// Place of the camera; after project() at the time of what was projected.
  [[nodiscard]] const Eigen::Vector3d& eye_E() const { return eye_E_; }

  [[nodiscard]] bool inside(const Eigen::Vector2d& px) const {
    return px.x() >= 0 && px.y() >= 0 && px.x() <= width() - 1 && px.y() <= height() - 1;
  }
  /// Pixel of a point, by the pose at the time its stored line is exposed; nullopt behind.
  [[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_E);
  /// Unit vector to what a pixel shows, earth frame, by the pose in the middle of the exposure;
  /// nullopt outside the lens's field of view.
  [[nodiscard]] std::optional<Eigen::Vector3d> direction_E(const Eigen::Vector2d& px);

 private:
  void at(double t);
  [[nodiscard]] std::optional<Eigen::Vector2d> projected(const Eigen::Vector3d& p_E) const {
    return camera_.lens.project(R_CE_ * (p_E - eye_E_));
  }

  const world::CameraTruth& camera_;
  double start_, px_per_radian_;
  std::span<const BodyPose> history_;
  Eigen::Matrix3d R_BC_, R_CE_;
  Eigen::Vector3d eye_E_;
};

}  // namespace gatefly::sim
