// SPDX-License-Identifier: Apache-2.0
// What a pose costs beside OpenCV's, on the same 500 gates: medians of interleaved rounds, so that whatever else
// runs slows all of them.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/calib3d.hpp>

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rng.hpp"
#include "gatefly/pose/map_pose.hpp"
#include "gatefly/pose/ray_intersection.hpp"

namespace {

using namespace gatefly;

constexpr double kSigmaPx = 2.5;

struct Gate {
  Quad px;
  Attitude attitude;
  std::vector<cv::Point2d> pixels;
};

const std::array<Eigen::Vector3d, 4> kCorners{{{0, -.5, -.5}, {0, .5, -.5}, {0, .5, .5}, {0, -.5, .5}}};

std::vector<Gate> gates_seen(const CameraRig& rig) {
  Rng rng{3};
  const auto noise = [&] {  // nearly normal: twelve uniform numbers
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += rng.uniform(0.0, 1.0);
    return sum;
  };
  std::vector<Gate> gates(500);
  for (Gate& gate : gates) {
    const double x = rng.uniform(-4, -1.5), y = rng.uniform(-0.5, 0.5);
    const Eigen::Vector3d p_GB{x, y, rng.uniform(-0.3, 0.3)};
    gate.attitude = {0.0, -0.08, rng.uniform(-0.2, 0.2)};
    const Eigen::Matrix3d R_CG = (rotation_EB(gate.attitude).matrix * rig.R_BC.matrix).transpose();
    for (std::size_t i = 0; i < 4; ++i) {
      gate.px[i] = *rig.lens.project(R_CG * (kCorners[i] - p_GB));
      for (double& coordinate : gate.px[i]) coordinate += kSigmaPx * noise();
      gate.pixels.emplace_back(gate.px[i].x(), gate.px[i].y());
    }
    gate.attitude.roll += 0.02 * noise(), gate.attitude.pitch += 0.02 * noise(), gate.attitude.yaw += 0.04 * noise();
  }
  return gates;
}

struct Contestant {
  std::string name;
  std::function<double(const Gate&)> solve;
  std::vector<double> us = {};

  [[nodiscard]] double median() {
    std::nth_element(us.begin(), us.begin() + static_cast<std::ptrdiff_t>(us.size() / 2), us.end());
    return us[us.size() / 2];
  }
};

double by_map(const Gate& gate, const CameraRig& rig, double scale) {
  GateObservations seen;
  add_corners(seen, gate.px, 1.0, kSigmaPx);
  const auto answer = map_pose(seen, {.attitude_GB = gate.attitude, .roll_sigma = scale * 0.02, .pitch_sigma = scale * 0.02, .yaw_sigma = scale * 0.04}, rig);
  return answer.pose ? answer.pose->p_GB.x() : 0.0;
}

double by_rays(const Gate& gate, const CameraRig& rig) {
  const Eigen::Matrix3d R_GC = rotation_EB(gate.attitude).matrix * rig.R_BC.matrix;
  std::array<Ray, 4> rays;
  for (std::size_t i = 0; i < 4; ++i) rays[i] = {kCorners[i], R_GC * *rig.lens.bearing(gate.px[i])};
  const auto camera = nearest_point(rays);
  return camera ? camera->x() : 0.0;
}

double by_opencv(const Gate& gate, int method) {
  static const std::vector<cv::Point3d> objects{{-.5, .5, 0}, {.5, .5, 0}, {.5, -.5, 0}, {-.5, -.5, 0}};
  static const cv::Matx33d K{168, 0, 157, 0, 168, 124, 0, 0, 1};
  cv::Vec3d rotation, translation;
  cv::solvePnP(objects, gate.pixels, K, cv::noArray(), rotation, translation, false, method);
  return translation[2];
}

}  // namespace

int main() {
  cv::setNumThreads(1);
  const CameraRig rig{AnyCamera{Pinhole{}}, camera_mount(20 * kDegree), Eigen::Vector3d::Zero()};
  const std::vector<Gate> gates = gates_seen(rig);
  std::vector<Contestant> all{{"rays", [&](const Gate& g) { return by_rays(g, rig); }},
                              {"MAP, attitude 1.1°, yaw 2.3°", [&](const Gate& g) { return by_map(g, rig, 1.0); }},
                              {"MAP, attitude 4.6°, yaw 9.2° (walked)", [&](const Gate& g) { return by_map(g, rig, 4.0); }},
                              {"OpenCV P3P", [](const Gate& g) { return by_opencv(g, cv::SOLVEPNP_P3P); }},
                              {"OpenCV IPPE_SQUARE", [](const Gate& g) { return by_opencv(g, cv::SOLVEPNP_IPPE_SQUARE); }},
                              {"OpenCV IPPE", [](const Gate& g) { return by_opencv(g, cv::SOLVEPNP_IPPE); }},
                              {"OpenCV SQPNP", [](const Gate& g) { return by_opencv(g, cv::SOLVEPNP_SQPNP); }},
                              {"OpenCV ITERATIVE", [](const Gate& g) { return by_opencv(g, cv::SOLVEPNP_ITERATIVE); }}};
  double sum = 0.0;
  for (int round = 0; round < 21; ++round)
    for (Contestant& one : all) {
      const auto start = std::chrono::steady_clock::now();
      for (const Gate& gate : gates) sum += one.solve(gate);
      one.us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count() / static_cast<double>(gates.size()));
    }
  for (Contestant& one : all) std::printf("%8.2f us  %s\n", one.median(), one.name.c_str());
  std::printf("rays / P3P %.3f, MAP / IPPE_SQUARE %.2f (sum %.0f)\n", all[0].median() / all[3].median(), all[1].median() / all[4].median(), sum);
}
