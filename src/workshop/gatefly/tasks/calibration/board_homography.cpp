// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/board_homography.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Dense>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/rng.hpp"

namespace gatefly::calibration {

namespace {

/// A corner's ray, and its place on the board in coordinates of size 1 around the board's middle.
struct Sight {
  Eigen::Vector3d bearing_C, p;
};

/// H with bearing × H (X, Y, 1) = 0, of whichever sign and size, by least squares.
std::optional<Eigen::Matrix3d> homography(const std::vector<Sight>& sights) {
  Eigen::Matrix<double, 9, 9> sum = Eigen::Matrix<double, 9, 9>::Zero();
  for (const Sight& sight : sights) {
    const Eigen::Matrix3d cross = skew(sight.bearing_C);
    Eigen::Matrix<double, 3, 9> rows;
    rows << sight.p.x() * cross, sight.p.y() * cross, sight.p.z() * cross;
    sum += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(sum);
  if (!(solver.eigenvalues()[1] > 1e-9 * solver.eigenvalues()[8])) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
  return Eigen::Map<const Eigen::Matrix3d>(h.data());
}

/// Sine of the angle between where a corner is seen and where it should be.
double misfit(const Sight& sight, const Eigen::Matrix3d& H) {
  return sight.bearing_C.cross((H * sight.p).normalized()).norm();
}

double median_misfit(const std::vector<Sight>& sights, const Eigen::Matrix3d& H) {
  std::vector<double> misfits;
  for (const Sight& sight : sights) misfits.push_back(misfit(sight, H));
  const auto middle = misfits.begin() + static_cast<std::ptrdiff_t>(misfits.size() / 2);
  std::nth_element(misfits.begin(), middle, misfits.end());
  return *middle;
}

/// The homography of the corners that agree: least median of squares over small samples [Rousseeuw
/// 1984], then all that are no more than three times as far off as usual.
std::optional<Eigen::Matrix3d> robust_homography(const std::vector<Sight>& sights) {
  constexpr int kSamples = 20;  // all with a bad corner: one in a million at 10 % bad ones
  constexpr std::size_t kSampleSize = 6;
  Rng rng{1};
  std::optional<Eigen::Matrix3d> best = homography(sights);
  if (!best || sights.size() <= kSampleSize) return best;
  double least = median_misfit(sights, *best);
  for (int sample = 0; sample < kSamples; ++sample) {
    std::vector<Sight> some;
    for (std::size_t i = 0; i < kSampleSize; ++i)
      some.push_back(
          sights[static_cast<std::size_t>(rng.uniform_index(static_cast<int>(sights.size())))]);
    const auto H = homography(some);
    if (!H) continue;
    if (const double middle = median_misfit(sights, *H); middle < least) {
      least = middle;
      best = H;
    }
  }
  std::vector<Sight> rest;
  for (const Sight& sight : sights)
    if (misfit(sight, *best) <= 3.0 * least) rest.push_back(sight);
  const auto all_good = homography(rest);
  return all_good ? all_good : best;
}

}  // namespace

std::optional<BoardPose> pose_from_homography(const BoardView& view, const AnyCamera& lens) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double size = 0.0;
  for (const BoardCorner& corner : view.corners)
    middle += corner.p_W / static_cast<double>(view.corners.size());
  for (const BoardCorner& corner : view.corners)
    size = std::max(size, (corner.p_W - middle).norm());
  if (!(size > 0.0)) return std::nullopt;
  std::vector<Sight> sights;
  for (const BoardCorner& corner : view.corners)
    if (const auto bearing = lens.bearing(corner.px))
      sights.push_back({*bearing, ((corner.p_W - middle) / size).homogeneous()});

  if (sights.size() < 4) return std::nullopt;
  const auto found = robust_homography(sights);
  if (!found) return std::nullopt;
  Eigen::Matrix3d H = *found;
  // its middle is in front
  H *= (H(2, 2) < 0.0 ? -1.0 : 1.0) * 2.0 / (H.col(0).norm() + H.col(1).norm());

  Eigen::Matrix3d R;
  R << H.col(0), H.col(1), H.col(0).cross(H.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  R = svd.matrixU() * svd.matrixV().transpose();
  if (!(R.determinant() > 0.0) || !H.allFinite()) return std::nullopt;
  BoardPose pose;
  const Eigen::AngleAxisd turn(R);
  pose.head<3>() = turn.angle() * turn.axis();
  pose.tail<3>() = size * H.col(2) - R * Eigen::Vector3d{middle.x(), middle.y(), 0.0};
  for (const BoardCorner& corner : view.corners)
    if (!(in_camera(pose, corner.p_W).z() > 0.0)) return std::nullopt;
  return pose;
}

}  // namespace gatefly::calibration
