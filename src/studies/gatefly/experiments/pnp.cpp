// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/pnp.hpp"

#ifdef GATEFLY_HAVE_OPENCV
#include <vector>

#include <opencv2/calib3d.hpp>

#include "gatefly/geometry/gate_corners.hpp"
#endif

namespace gatefly::experiments {

#ifdef GATEFLY_HAVE_OPENCV
namespace {

using Objects = std::vector<cv::Point3d>;
using Pixels = std::vector<cv::Point2d>;

/// As IPPE_SQUARE wants them: x right, y up, z towards the camera.
Objects objects_of(double side) {
  Objects objects;
  for (const auto& corner_G : gate_corners_G(side))
    objects.emplace_back(corner_G.y(), -corner_G.z(), 0.0);
  return objects;
}

struct CameraPose {
  cv::Mat rotation, translation;  ///< Rodrigues vector, object to camera.
};

/// In G: x = -z, y = x, z = -y of the object's axes.
Eigen::Vector3d camera_G(const CameraPose& pose) {
  cv::Matx33d R;
  cv::Rodrigues(pose.rotation, R);
  const cv::Matx31d t{pose.translation.at<double>(0), pose.translation.at<double>(1),
                      pose.translation.at<double>(2)};
  const cv::Matx31d camera = -(R.t() * t);
  return {-camera(2), camera(0), -camera(1)};
}

cv::SolvePnPMethod flag_of(Pnp method) {
  switch (method) {
    case Pnp::kIppe:
      return cv::SOLVEPNP_IPPE;
    case Pnp::kIppeSquare:
      return cv::SOLVEPNP_IPPE_SQUARE;
    case Pnp::kSqpnp:
      return cv::SOLVEPNP_SQPNP;
    case Pnp::kIterative:
      return cv::SOLVEPNP_ITERATIVE;
    case Pnp::kP3p:
      break;
  }
  return cv::SOLVEPNP_P3P;
}

}  // namespace

bool has_pnp() { return true; }

std::optional<Eigen::Vector3d> camera_by(Pnp method, const Quad& corners, double focal_px,
                                         double side) try {
  const Objects objects = objects_of(side);
  Pixels pixels;
  for (const Eigen::Vector2d& px : corners) pixels.emplace_back(px.x(), px.y());
  const cv::Matx33d K{focal_px, 0.0, 0.0, 0.0, focal_px, 0.0, 0.0, 0.0, 1.0};
  CameraPose pose;
  if (!cv::solvePnP(objects, pixels, K, cv::noArray(), pose.rotation, pose.translation, false,
                    flag_of(method)))
    return std::nullopt;
  const Eigen::Vector3d camera = camera_G(pose);
  return camera.allFinite() ? std::optional{camera} : std::nullopt;
} catch (const cv::Exception&) {
  return std::nullopt;  // its way to say: no solution
}

#else

bool has_pnp() { return false; }
std::optional<Eigen::Vector3d> camera_by(Pnp, const Quad&, double, double) { return std::nullopt; }

#endif

}  // namespace gatefly::experiments
