// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/truth_of_findings.hpp"

#include <variant>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly::simulated_race {
namespace {

constexpr double kMeanOfHalf = 0.7724;  // of |z|, z standard normal and cut at 2.5

/// What an angle at the picture's middle is worth [px/rad], across.
double focal_of(const AnyCamera& lens) {
  if (const auto* dhane = std::get_if<DhaneFisheye>(&lens.model))
    return dhane->focal_px.x() / dhane->k;
  return std::visit([](const auto& model) { return model.focal_px.x(); }, lens.model);
}
Eigen::Vector2d center_of(const AnyCamera& lens) {
  return std::visit([](const auto& model) { return model.center_px; }, lens.model);
}

}  // namespace

TruthOfFindings truth_of_findings(const world::SimConfig& truth, const PilotConfig& told) {
  TruthOfFindings found;
  const Eigen::Matrix3d R_BC = camera_mount(truth.camera.tilt_down).matrix;
  const Eigen::Vector3d mount = turn_of(told.camera.R_BC.matrix.transpose() * R_BC);
  // About the camera's axes, right, down and forward: nose down is negative about the first.
  found.tilt = -mount.x(), found.pan = mount.y(), found.roll = mount.z();
  if (const auto axis = truth.camera.lens.bearing(center_of(told.camera.lens)))
    found.center_as_tilt = atan2(axis->y(), axis->z()),
    found.center_as_pan = atan2(axis->x(), axis->z());
  found.focal = focal_of(truth.camera.lens) / focal_of(told.camera.lens) - 1.0;

  const world::SensorTruth& sensors = truth.sensors;
  const double middle = 0.5 * (truth.camera.exposure + truth.camera.readout);
  found.latency = sensors.camera_latency + middle - told.camera_timing.latency;
  found.latency_jitter = kMeanOfHalf * sensors.latency_jitter;

  found.start_heading = wrap_angle(truth.start.heading - told.track.start_heading);
  found.hover_thrust = truth.vehicle.thrust_coefficient / truth.vehicle.mass /
                       (told.vehicle.thrust_coefficient / told.vehicle.mass);
  found.moved_gate = truth.faults.moved_gate;
  return found;
}

}  // namespace gatefly::simulated_race
