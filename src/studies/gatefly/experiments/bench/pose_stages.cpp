// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/bench/pose_stages.hpp"

#include <array>
#include <memory>
#include <string>
#include <utility>

#include "gatefly/experiments/bench/opencv_baseline.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rng.hpp"
#include "gatefly/pose/map_pose.hpp"
#include "gatefly/pose/ray_intersection.hpp"

namespace gatefly::bench {
namespace {

constexpr double kSigmaPx = 2.5, kTiltSigma = 0.02, kYawSigma = 0.04;
const auto kCorners = gate_corners_G(1.0);

struct Gate {
  Quad px;
  Attitude attitude;
};

CameraRig straight_rig() {
  return {AnyCamera{Pinhole{}}, camera_mount(20 * kDegree), Eigen::Vector3d::Zero()};
}

/// Seen from 1.5 to 4 m, with noise on corners and attitude.
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
      gate.px[i] = rig.lens.project(R_CG * (kCorners[i] - p_GB)).value_or(Eigen::Vector2d::Zero());
      for (double& coordinate : gate.px[i]) coordinate += kSigmaPx * noise();
    }
    gate.attitude.roll += kTiltSigma * noise(), gate.attitude.pitch += kTiltSigma * noise(),
        gate.attitude.yaw += kYawSigma * noise();
  }
  return gates;
}

double by_map(const Gate& gate, const CameraRig& rig, double scale) {
  GateObservations seen;
  add_corners(seen, gate.px, 1.0, kSigmaPx);
  const auto answer = map_pose(seen,
                               {.attitude_GB = gate.attitude,
                                .roll_sigma = scale * kTiltSigma,
                                .pitch_sigma = scale * kTiltSigma,
                                .yaw_sigma = scale * kYawSigma},
                               rig);
  return answer.pose ? answer.pose->p_GB.x() : 0.0;
}

double by_rays(const Gate& gate, const CameraRig& rig) {
  const Eigen::Matrix3d R_GC = rotation_EB(gate.attitude).matrix * rig.R_BC.matrix;
  std::array<Ray, 4> rays;
  for (std::size_t i = 0; i < 4; ++i)
    rays[i] = {kCorners[i], R_GC * rig.lens.bearing(gate.px[i]).value_or(Eigen::Vector3d::UnitZ())};
  const auto camera = nearest_point(rays);
  return camera ? camera->x() : 0.0;
}

/// Compilers may not leave out what computes this.
void keep(double result) { asm volatile("" : : "g"(&result) : "memory"); }

}  // namespace

std::vector<Stage> pose_stages() {
  constexpr std::size_t kAtOnce = 25;
  const CameraRig rig = straight_rig();
  const auto gates = std::make_shared<const std::vector<Gate>>(gates_seen(rig));
  std::vector<Stage> stages;
  const auto add = [&](const std::string& name, const std::string& what, auto solve,
                       const std::string& baseline = "") {
    stages.push_back({.name = name,
                      .what = what,
                      .inputs = gates->size(),
                      .call = [gates, solve](std::size_t i) { keep(solve((*gates)[i])); },
                      .baseline = has_opencv() ? baseline : "",
                      .at_once = kAtOnce});
  };
  if (has_opencv()) {
    const Pinhole lens;
    for (const auto& [name, way] :
         {std::pair{"p3p", OpenCvPose::kP3p}, std::pair{"ippe_square", OpenCvPose::kIppeSquare},
          std::pair{"ippe", OpenCvPose::kIppe}, std::pair{"sqpnp", OpenCvPose::kSqpnp},
          std::pair{"iterative", OpenCvPose::kIterative}})
      add(name, "cv::solvePnP", [lens, way = way](const Gate& g) {
        return opencv_distance(g.px, lens.focal_px.x(), lens.center_px, way);
      });
  }
  add(
      "rays", "least squares over the rays, attitude known",
      [rig](const Gate& g) { return by_rays(g, rig); }, "p3p");
  add(
      "map", "most probable pose, attitude known to 1.1°, yaw to 2.3°",
      [rig](const Gate& g) { return by_map(g, rig, 1.0); }, "ippe_square");
  add(
      "map_walked", "the same, 4.6° and 9.2°", [rig](const Gate& g) { return by_map(g, rig, 4.0); },
      "ippe_square");
  return stages;
}

}  // namespace gatefly::bench
