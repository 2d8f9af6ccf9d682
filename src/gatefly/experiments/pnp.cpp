// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/pnp.hpp"

#ifdef GATEFLY_HAVE_OPENCV
#include <cmath>
#include <limits>
#include <vector>

#include <opencv2/calib3d.hpp>
#endif

namespace gatefly::experiments {

#ifdef GATEFLY_HAVE_OPENCV
namespace {

using Objects = std::vector<cv::Point3d>;
using Pixels = std::vector<cv::Point2d>;

/// As IPPE_SQUARE wants them: x right, y up, z towards the camera.
Objects objects_of(double side) {
  const double h = 0.5 * side;
  return {{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}};
}

struct CameraPose {
  cv::Mat rotation, translation;  ///< Rodrigues vector, object to camera.
};

/// In G: x = -z, y = x, z = -y of the object's axes.
Eigen::Vector3d camera_G(const CameraPose& pose) {
  cv::Matx33d R;
  cv::Rodrigues(pose.rotation, R);
  const cv::Matx31d t{pose.translation.at<double>(0), pose.translation.at<double>(1), pose.translation.at<double>(2)};
  const cv::Matx31d camera = -(R.t() * t);
  return {-camera(2), camera(0), -camera(1)};
}

double squared_error(const CameraPose& pose, const Objects& objects, const Pixels& pixels, const cv::Matx33d& K) {
  Pixels drawn;
  cv::projectPoints(objects, pose.rotation, pose.translation, K, cv::noArray(), drawn);
  double sum = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i) sum += (drawn[i] - pixels[i]).dot(drawn[i] - pixels[i]);
  return sum;
}

std::optional<CameraPose> best_of_four_triples(const Objects& objects, const Pixels& pixels, const cv::Matx33d& K) {
  std::optional<CameraPose> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t left_out = 0; left_out < 4; ++left_out) {
    Objects three;
    Pixels seen;
    for (std::size_t i = 1; i < 4; ++i) three.push_back(objects[(left_out + i) % 4]), seen.push_back(pixels[(left_out + i) % 4]);
    std::vector<cv::Mat> rotations, translations;
    const int count = cv::solveP3P(three, seen, K, cv::noArray(), rotations, translations, cv::SOLVEPNP_P3P);
    for (int i = 0; i < count; ++i) {
      const CameraPose pose{rotations[static_cast<std::size_t>(i)], translations[static_cast<std::size_t>(i)]};
      const double error = squared_error(pose, objects, pixels, K);
      if (error < least) least = error, best = pose;
    }
  }
  return best;
}

cv::SolvePnPMethod flag_of(Pnp method) {
  switch (method) {
    case Pnp::kIppe: return cv::SOLVEPNP_IPPE;
    case Pnp::kIppeSquare: return cv::SOLVEPNP_IPPE_SQUARE;
    case Pnp::kSqpnp: return cv::SOLVEPNP_SQPNP;
    case Pnp::kIterative: return cv::SOLVEPNP_ITERATIVE;
    case Pnp::kP3p:
    case Pnp::kP3pOfFour: break;
  }
  return cv::SOLVEPNP_P3P;
}

}  // namespace

bool has_pnp() { return true; }

std::optional<Eigen::Vector3d> camera_by(Pnp method, const Quad& corners, double focal_px, double side) try {
  const Objects objects = objects_of(side);
  Pixels pixels;
  for (const Eigen::Vector2d& px : corners) pixels.emplace_back(px.x(), px.y());
  const cv::Matx33d K{focal_px, 0.0, 0.0, 0.0, focal_px, 0.0, 0.0, 0.0, 1.0};
  std::optional<CameraPose> pose;
  if (method == Pnp::kP3pOfFour) {
    pose = best_of_four_triples(objects, pixels, K);
  } else {
    pose.emplace();
    if (!cv::solvePnP(objects, pixels, K, cv::noArray(), pose->rotation, pose->translation, false, flag_of(method))) return std::nullopt;
  }
  if (!pose) return std::nullopt;
  const Eigen::Vector3d camera = camera_G(*pose);
  return camera.allFinite() ? std::optional{camera} : std::nullopt;
} catch (const cv::Exception&) {
  return std::nullopt;  // its way to say: no solution
}

#else

bool has_pnp() { return false; }
std::optional<Eigen::Vector3d> camera_by(Pnp, const Quad&, double, double) { return std::nullopt; }

#endif

}  // namespace gatefly::experiments
