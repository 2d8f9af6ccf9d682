// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/part_params.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "gatefly/geometry/gate_corners.hpp"

namespace gatefly {

namespace {

// The angle of one pixel on the lens' axis [rad].
double radians_per_px(const AnyCamera& lens) {
  const auto on_axis = lens.project({0, 0, 1});
  if (!on_axis) return eskf::CameraModel{}.radians_per_px;
  const auto a = lens.bearing(*on_axis), b = lens.bearing(*on_axis + Eigen::Vector2d{1, 0});
  return a && b ? (*b - *a).norm() : eskf::CameraModel{}.radians_per_px;
}

eskf::Landmark landmark_of(const MapGate& gate, const eskf::Priors& priors) {
  eskf::Landmark landmark{
      gate.p_EG, gate.yaw_EG, {gate.side, gate.bar, near_face(gate.side, gate.bar, gate.depth)}};
  eskf::GateSigmas sigmas = eskf::prior_of(landmark, priors);
  if (gate.position_sigma) sigmas.head<3>() = *gate.position_sigma;
  if (gate.yaw_sigma) sigmas(eskf::kGateYaw) = *gate.yaw_sigma;
  if (gate.side_sigma) sigmas(eskf::kGateSize) = *gate.side_sigma / gate.side;
  landmark.sigmas = sigmas;
  return landmark;
}

eskf::Setup error_state_setup(const PilotConfig& config) {
  eskf::Setup setup;
  setup.params = config.error_state;
  setup.params.drag = config.filter.model.drag;
  setup.params.gravity = config.filter.model.gravity;
  setup.params.priors.position = config.filter.start_sigma;
  setup.params.priors.heading = config.ahrs.start_heading_sigma;
  setup.params.priors.map = config.map_sigma;
  setup.params.priors.map_height = config.gate_height_sigma;
  setup.params.priors.map_yaw = config.gate_yaw_sigma;
  for (const MapGate& gate : config.track.gates)
    setup.map.push_back(landmark_of(gate, setup.params.priors));
  setup.R_BC = config.camera.R_BC.matrix;
  setup.camera = {config.camera.p_BC, radians_per_px(config.camera.lens)};
  return setup;
}

/// The numbers are those of gates of 1 m that leave a Bebop 0.25 m on either side: a large gate is
/// in view from farther away only, and may be passed farther off its axis.
void fit_to_gates(PhaseParams& params, const PilotConfig& config) {
  constexpr double kSide = 1.0, kBar = 0.05, kBody = 0.20;
  double larger = 1e9, wider = 1e9;
  for (const MapGate& gate : config.track.gates) {
    const double beside = 0.5 * gate.side - gate.bar - config.plan.body_radius;
    larger = std::min(larger, gate.side / kSide);
    wider = std::min(wider, beside / (0.5 * kSide - kBar - kBody));
  }
  if (config.track.gates.empty()) return;
  params.wait_before *= std::max(1.0, larger);
  params.search_before *= std::max(1.0, larger);
  params.search_until *= std::max(1.0, larger);
  params.max_miss *= std::max(1.0, wider);
  params.max_lateral_sigma *= std::max(1.0, wider);
}

}  // namespace

// Positions alone are all that the paper's eye gives: the drag filter takes those.
FilterModel filter_model(const PilotConfig& config) {
  const bool fixes_only = config.pose_scheme == Scheme::kPaper;
  const bool ours = config.filter_model == FilterModel::kOurs;
  return ours && fixes_only ? FilterModel::kDrag : config.filter_model;
}

double slow_imu_hz(const PilotConfig& config) {
  return filter_model(config) == FilterModel::kOurs ? config.filter_imu_hz : 0.0;
}

NavigatorParams navigator_params(const PilotConfig& config) {
  NavigatorParams params;
  const FilterModel model = filter_model(config);
  if (model == FilterModel::kOurs) params.ours = error_state_setup(config);
  if (model == FilterModel::kPaper) params.use = use_of_paper(config.paper_filter);
  params.ahrs = config.ahrs;
  params.filter = config.filter;
  params.velocity = config.velocity;
  params.altimeter = config.altimeter;
  params.imu_hz = config.imu_hz;
  params.slow_imu_hz = slow_imu_hz(config);
  params.filter_memory = config.filter_memory;
  return params;
}

LookoutParams lookout_params(const PilotConfig& config) {
  LookoutParams params;
  params.camera = config.camera;
  params.timing = config.camera_timing;
  params.gate_color = config.gate_color;
  params.detector = config.detector;
  // A pilot's pictures are its camera's, of whatever size.
  if (!params.detector.lens.model) params.detector.lens = {.model = config.camera.lens};
  params.detector_mode = config.detector_mode;
  params.pose = config.pose;
  params.sight = config.sight;
  params.gate_sigma = config.filter.gate_sigma;
  params.gate_yaw_sigma = config.gate_yaw_sigma;
  return params;
}

GuidanceParams guidance_params(const PilotConfig& config) {
  GuidanceParams params;
  params.speed = config.speed;
  params.lateral = config.lateral;
  params.altitude = config.altitude;
  params.hold = config.hold;
  params.look_aside = config.look_aside;
  // A filter that reads the speed off the drag needs the nose along the way.
  if (config.filter_model != FilterModel::kOurs) params.look_aside.most = 0.0;
  params.cruise = config.plan.speed;
  params.max_lateral = config.plan.max_lateral;
  params.drag = config.filter.model.drag;
  params.gravity = config.filter.model.gravity;
  return params;
}

IndiParams indi_params(const PilotConfig& config) {
  IndiParams params = config.indi;
  params.sample_hz = config.imu_hz;
  return params;
}

PhaseParams phase_params(const PilotConfig& config) {
  constexpr double kUsualHz = 512.0;
  PhaseParams params = config.phase;
  if (config.control_scheme == Scheme::kPaper) {
    params.go_after = config.paper_control.take_off;
    params.goes_around = false;
  }
  const bool papers_eye =
      config.detector_mode == DetectorMode::kPaper || config.detector_mode == DetectorMode::kFlown;
  if (papers_eye) params.first_gate_timeout = 0.0;  // it misses a gate in view for longer than that
  fit_to_gates(params, config);
  params.cuts_without_imu = config.output == Output::kMotors;
  const double slow = slow_imu_hz(config), hz = slow > 0.0 ? slow : config.imu_hz;
  params.rest_samples = static_cast<int>(std::lround(config.phase.rest_samples * hz / kUsualHz));
  return params;
}

MapUncertainty map_uncertainty(const PilotConfig& config) {
  return {config.map_sigma, config.gate_height_sigma, config.gate_yaw_sigma};
}

void check_latency(const PilotConfig& config) {
  const auto ms = [](double seconds) { return std::to_string(std::lround(1e3 * seconds)) + " ms"; };
  if (config.filter_model == FilterModel::kPaper) return;  // a fix counts as of now
  const double oldest =
      config.camera_timing.latency +
      0.5 * (std::abs(config.camera_timing.readout) + std::abs(config.camera_timing.readout_down));
  if (oldest <= config.filter_memory) return;
  throw std::invalid_argument("pictures arrive " + ms(oldest) +
                              " after their exposure (camera.latency_ms, readout_ms, exposure_ms), "
                              "the filter remembers filter.memory_ms = " +
                              ms(config.filter_memory));
}

}  // namespace gatefly
