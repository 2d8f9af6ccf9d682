// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/bench/opencv_baseline.hpp"

#ifdef GATEFLY_HAS_OPENCV
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "gatefly/geometry/gate_corners.hpp"
#endif

namespace gatefly::bench {

#ifdef GATEFLY_HAS_OPENCV

bool has_opencv() { return true; }

int opencv_quads(const Picture& picture) {
  cv::setNumThreads(1);
  // Buffers are OpenCV's own matrices, kept from call to call.
  static thread_local cv::Mat bgr, hsv, mask;
  static thread_local std::vector<std::vector<cv::Point>> contours;
  static thread_local std::vector<cv::Point> polygon;
  const cv::Mat uyvy(picture.stored_height, picture.stored_width, CV_8UC2,
                     const_cast<std::uint8_t*>(picture.uyvy.data()));
  cv::cvtColor(uyvy, bgr, cv::COLOR_YUV2BGR_UYVY);
  cv::cvtColor(bgr, hsv, cv::COLOR_BGR2HSV);
  cv::inRange(hsv, cv::Scalar(3, 90, 70), cv::Scalar(25, 255, 255), mask);
  cv::findContours(mask, contours, cv::RETR_LIST, cv::CHAIN_APPROX_SIMPLE);
  int quads = 0;
  for (const auto& contour : contours) {
    if (cv::contourArea(contour) < 100.0) continue;
    cv::approxPolyDP(contour, polygon, 0.04 * cv::arcLength(contour, true), true);
    quads += polygon.size() == 4 && cv::isContourConvex(polygon);
  }
  return quads;
}

std::optional<Eigen::Vector3d> opencv_position(const std::array<Eigen::Vector3d, 4>& bearings_C,
                                               double side) {
  std::vector<cv::Point2d> seen;
  for (const auto& b : bearings_C) seen.emplace_back(b.x() / b.z(), b.y() / b.z());
  std::vector<cv::Point3d> gate;
  for (const auto& corner_G : gate_corners_G(side))
    gate.emplace_back(corner_G.y(), corner_G.z(), 0.0);
  cv::Vec3d rotation, translation;
  if (!cv::solvePnP(gate, seen, cv::Matx33d::eye(), cv::noArray(), rotation, translation))
    return std::nullopt;
  return Eigen::Vector3d{translation[0], translation[1], translation[2]};
}

double opencv_distance(const Quad& px, double focal_px, const Eigen::Vector2d& center_px,
                       OpenCvPose way) {
  cv::setNumThreads(1);
  static thread_local std::vector<cv::Point2d> seen(4);
  // In the order that IPPE_SQUARE asks for.
  static const std::vector<cv::Point3d> gate{
      {-.5, .5, 0}, {.5, .5, 0}, {.5, -.5, 0}, {-.5, -.5, 0}};
  constexpr std::array kWays{cv::SOLVEPNP_P3P, cv::SOLVEPNP_IPPE_SQUARE, cv::SOLVEPNP_IPPE,
                             cv::SOLVEPNP_SQPNP, cv::SOLVEPNP_ITERATIVE};
  for (std::size_t i = 0; i < 4; ++i) seen[i] = {px[i].x(), px[i].y()};
  const cv::Matx33d K{focal_px, 0, center_px.x(), 0, focal_px, center_px.y(), 0, 0, 1};
  cv::Vec3d rotation, translation;
  cv::solvePnP(gate, seen, K, cv::noArray(), rotation, translation, false,
               kWays[static_cast<std::size_t>(way)]);
  return translation[2];
}

#else

bool has_opencv() { return false; }
int opencv_quads(const Picture&) { return 0; }
std::optional<Eigen::Vector3d> opencv_position(const std::array<Eigen::Vector3d, 4>&, double) {
  return std::nullopt;
}
double opencv_distance(const Quad&, double, const Eigen::Vector2d&, OpenCvPose) { return 0.0; }

#endif

}  // namespace gatefly::bench
