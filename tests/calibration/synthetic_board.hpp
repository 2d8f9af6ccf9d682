// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rng.hpp"
#include "gatefly/tasks/calibration/board_view.hpp"
#include "gatefly/tasks/calibration/lens_fit.hpp"

#include "support/generators.hpp"

namespace gatefly::calibration::test {

using gatefly::test::normal;

/// How somebody holds a board before a camera.
struct Holding {
  int views = 20;
  double max_tilt = 40.0 * kDegree;  ///< Board against the line of sight.
  double noise_px = 0.1;             ///< One standard deviation per axis.
  int columns = 8, rows = 6;
  double square = 0.03;  ///< [m]
};

/// Pictures of a board, every corner inside the picture.
inline BoardViews synthetic_views(const AnyCamera& lens, const Eigen::Vector2i& size_px,
                                  const Holding& how, Rng& rng) {
  BoardViews views;
  const Eigen::Vector2d half{0.5 * how.square * (how.columns - 1),
                             0.5 * how.square * (how.rows - 1)};
  while (views.size() < static_cast<std::size_t>(how.views)) {
    const auto ray =
        lens.bearing({rng.uniform(0, size_px.x() - 1), rng.uniform(0, size_px.y() - 1)});
    if (!ray) continue;
    const Eigen::Matrix3d towards =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), *ray).toRotationMatrix();
    const double direction = rng.uniform(-kPi, kPi);
    const Eigen::AngleAxisd tilt(rng.uniform(-1, 1) * how.max_tilt,
                                 Eigen::Vector3d{std::cos(direction), std::sin(direction), 0});
    const Eigen::AngleAxisd spin(rng.uniform(-0.3, 0.3), Eigen::Vector3d::UnitZ());
    const Eigen::Matrix3d R = towards * (tilt * spin).toRotationMatrix();
    const Eigen::Vector3d middle_C = rng.uniform(0.2, 0.5) * *ray;
    BoardView view{"view " + std::to_string(views.size()), {}};
    for (int i = 0; i < how.columns * how.rows; ++i) {
      const Eigen::Vector2d p_W{how.square * (i % how.columns), how.square * (i / how.columns)};
      const auto px =
          lens.project(middle_C + R * Eigen::Vector3d{p_W.x() - half.x(), p_W.y() - half.y(), 0.0});
      if (!px || px->minCoeff() < 0.0 || px->x() > size_px.x() - 1 || px->y() > size_px.y() - 1)
        break;
      view.corners.push_back({p_W, *px + how.noise_px * Eigen::Vector2d{normal(rng), normal(rng)}});
    }
    if (view.corners.size() == static_cast<std::size_t>(how.columns * how.rows))
      views.push_back(std::move(view));
  }
  return views;
}

inline const Eigen::Vector2i kSize{640, 480};

/// One lens of each model that a 640x480 camera might have.
inline AnyCamera typical_lens(LensModel model) {
  const Eigen::Vector2d focal{400.0, 405.0}, wide{250.0, 252.0}, center{322.0, 236.0};
  switch (model) {
    case LensModel::kPinhole:
      return {Pinhole{focal, center}};
    case LensModel::kDhane:
      return {DhaneFisheye{focal, center, 1.4}};
    case LensModel::kKannalaBrandt:
      return {KannalaBrandt{wide, center, RadialPolynomial{{0.02, -0.01, 0.008, -0.003}}}};
    case LensModel::kBrownConrady:
      break;
  }
  return {BrownConrady{focal, center, {-0.28, 0.09, 0.001, -0.0008, -0.01}}};
}

}  // namespace gatefly::calibration::test
