// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/derived.hpp"

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"

namespace gatefly::config {
namespace {

AnyCamera lens_of(const CameraDescription& c) {
  const auto& d = c.distortion;
  if (c.model == "pinhole") return {Pinhole{c.focal_px, c.center_px}};
  if (c.model == "brown-conrady")
    return {BrownConrady{c.focal_px, c.center_px, {d[0], d[1], d[2], d[3], d[4]}}};
  if (c.model == "kannala-brandt")
    return {KannalaBrandt{c.focal_px, c.center_px, RadialPolynomial{{d[0], d[1], d[2], d[3]}}}};
  return {DhaneFisheye{c.focal_px, c.center_px, d[0]}};
}

/// Dhane's model with k = 1 is the straight lens, and has a k that a seed can vary.
AnyCamera lens_with_distortion(const CameraDescription& c) {
  if (c.model == "pinhole") return {DhaneFisheye{c.focal_px, c.center_px, 1.0}};
  return lens_of(c);
}

/// The lens that pictures were taken with, where a file or flag says so: a picture's own is not known
/// else, but for how it bends bars, which `tune` finds.
PictureLens picture_lens(const Config& c) {
  for (const char* key :
       {"camera.model", "camera.focal_px", "camera.center_px", "camera.distortion"})
    if (c.set_by.contains(key))
      return {.model = lens_of(c.camera), .width = c.camera.width, .height = c.camera.height};
  if (c.lens_angle >= 0.0) return equidistant_lens(c.lens_angle, c.lens_center);
  return {};
}

/// How large the gate is that detections mean, in sides of its bars' middle lines.
double corner_scale(const GateDescription& gate) {
  const double bar = gate.bar / gate.side;
  const double meant = gate.corners == "outer"   ? 1.0
                       : gate.corners == "inner" ? 1.0 - 2.0 * bar
                                                 : 1.0 - bar;
  return meant / (1.0 - bar);
}

DetectorMode detector_mode_of(const std::string& name) {
  static const std::map<std::string, DetectorMode> modes{{"ours", DetectorMode::kOurs},
                                                         {"fast", DetectorMode::kFast},
                                                         {"careful", DetectorMode::kCareful},
                                                         {"paper", DetectorMode::kPaper},
                                                         {"flown", DetectorMode::kFlown}};
  return modes.at(name);
}

Scheme scheme_of(const std::string& name) {
  return name == "paper" ? Scheme::kPaper : Scheme::kOurs;
}

Output output_of(const std::string& name) {
  return name == "attitude_thrust" ? Output::kAttitudeThrust
         : name == "rates_thrust"  ? Output::kRatesThrust
                                   : Output::kMotors;
}

world::AutopilotTruth::Takes taken_by_autopilot(Output output) {
  using Takes = world::AutopilotTruth::Takes;
  return output == Output::kAttitudeThrust ? Takes::kAngles
         : output == Output::kRatesThrust  ? Takes::kRates
                                           : Takes::kNone;
}

/// As a camera shows an albedo in white light: sRGB.
Eigen::Vector3d shown(const Eigen::Vector3d& albedo) {
  return albedo.unaryExpr(
      [](double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055; });
}

ColorModel described(const Eigen::Vector3d& rgb) {
  return ColorModel::described({rgb.x(), rgb.y(), rgb.z()});
}

/// Colour of the chosen detector: Li18's two have their own colours, which are orange.
ColorModel looked_for(const Config& config) {
  const DetectorMode mode = detector_mode_of(config.detector_mode);
  return mode == DetectorMode::kPaper || mode == DetectorMode::kFlown
             ? described(GateDescription{}.rgb)
             : config.pilot.gate_color;
}

/// Whether bars of this albedo speak for a gate, before grey that is as bright.
bool speaks_for_gate(const ColorModel& model, const Eigen::Vector3d& albedo) {
  const auto byte = [](double c) { return static_cast<std::uint8_t>(std::lround(255.0 * c)); };
  const Eigen::Vector3d rgb = shown(albedo);
  const Yuv color = yuv_of_rgb(byte(rgb.x()), byte(rgb.y()), byte(rgb.z()));
  return model.evidence(color, {color.y, 128, 128}) > 0;
}

/// Whether it says what a gate looks like: the generic orange says nothing.
bool names_color(const GateDescription& gate) {
  return !gate.color_table.empty() || gate.rgb != GateDescription{}.rgb;
}

}  // namespace

Config on_course(Config config, const TrackFile& track) {
  const auto& gates = track.world.gates;
  const bool told = config.set_by.contains("gate.side_m") || config.set_by.contains("gate.bar_m");
  if (!told && !gates.empty()) {
    config.gate.side = gates.front().side, config.gate.bar = gates.front().bar;
    config.pilot = pilot_config(config);
  }
  if (!names_color(config.gate) && !gates.empty() &&
      !speaks_for_gate(looked_for(config), gates.front().color)) {
    config.gate.rgb = shown(gates.front().color);
    config.pilot = pilot_config(config);
  }
  const ColorModel color = looked_for(config);
  std::vector<std::string> unseen;
  for (std::size_t i = 0; i < gates.size(); ++i)
    if (!speaks_for_gate(color, gates[i].color)) unseen.push_back(std::to_string(i + 1));
  if (!unseen.empty())
    config.notes.push_back(track.track.name + ": gate " + files::joined(unseen) +
                           " not of the colour that the pilot looks for (color.rgb, color.table): "
                           "will not be seen");
  return config;
}

PilotConfig pilot_config(const Config& config) {
  PilotConfig pilot = config.pilot;

  pilot.detector_mode = detector_mode_of(config.detector_mode);
  pilot.pose_scheme = scheme_of(config.pose_model);
  pilot.filter_model = config.filter_model == "paper"  ? FilterModel::kPaper
                       : config.filter_model == "drag" ? FilterModel::kDrag
                                                       : FilterModel::kOurs;
  pilot.control_scheme = scheme_of(config.control_mode);
  pilot.output = output_of(config.output);
  pilot.indi.adaptive = config.indi_effectiveness == "adaptive";

  const CameraDescription& camera = config.camera;
  pilot.camera = {lens_of(camera), camera_mount(camera.tilt_down), camera.p_BC};
  // A stored line is an upright row or column, the first one the topmost or leftmost, or the last.
  const bool along_rows = camera.stored_rotation_deg % 180 == 0;
  const double turned = camera.stored_rotation_deg < 180 ? 1.0 : -1.0;
  // From the middle of the exposure of the middle line: half of both, then the way to the pilot.
  pilot.camera_timing = {.latency = camera.latency + 0.5 * (camera.exposure + camera.readout),
                         .readout = along_rows ? 0.0 : turned * camera.readout,
                         .readout_down = along_rows ? turned * camera.readout : 0.0};

  const GateDescription& gate = config.gate;
  pilot.detector.bar_ratio = gate.bar / gate.side;
  pilot.detector.corner_scale = corner_scale(gate);
  pilot.detector.lens = picture_lens(config);
  pilot.gate_color = gate.fitted_color ? *gate.fitted_color : described(gate.rgb);

  pilot.vehicle = config.vehicle;
  pilot.imu_hz = config.rates.imu_hz;
  // The nominal rate is told, as that of the vehicle's IMU is.
  pilot.filter_imu_hz = config.rates.filter_imu_hz > 0.0 ? config.rates.filter_imu_hz
                                                         : config.sim.sensors.autopilot_imu_hz;
  pilot.altimeter.sonar_hz = config.rates.sonar_hz;
  pilot.uses_sonar = config.rates.sonar != "none";
  pilot.uses_baro = config.rates.baro != "none";
  return pilot;
}

/// True inertia about each axis: never more than the other two together, which no body
/// has. What the vehicle file says itself is not touched.
Eigen::Vector3d true_inertia(const Eigen::Vector3d& known, const Eigen::Vector3d& ratio) {
  constexpr double kMost = 0.99;
  Eigen::Vector3d inertia = known.cwiseProduct(ratio);
  for (int i = 0; i < 3; ++i) {
    const double others = inertia.sum() - inertia[i];
    if (ratio[i] > 1.0) inertia[i] = std::max(known[i], std::min(inertia[i], kMost * others));
  }
  return inertia;
}

world::SimConfig simulator_config(const Config& config, const TrackFile& track) {
  world::SimConfig nominal;
  nominal.world = track.world;
  nominal.world.paint = config.sim.paint;
  for (auto& gate : nominal.world.gates)
    gate.sought = speaks_for_gate(looked_for(config), gate.color);
  nominal.start = track.start;
  nominal.ideal_vision = config.sim.ideal_vision;
  nominal.bake_threads = config.sim.bake_threads;

  const CameraDescription& camera = config.camera;
  nominal.camera = {.lens = lens_with_distortion(camera),
                    .p_BC = camera.p_BC,
                    .tilt_down = camera.tilt_down,
                    .stored_width = camera.stored_width(),
                    .stored_height = camera.stored_height(),
                    .stored_rotation = camera.stored_rotation_deg,
                    .jpeg_quality = camera.jpeg_quality,
                    .exposure = camera.exposure,
                    .readout = camera.readout,
                    .fast = config.sim.camera_quality == "fast",
                    .imaging = config.sim.imaging};
  nominal.sensors = config.sim.sensors;
  nominal.autopilot = config.sim.autopilot;
  nominal.autopilot.takes = taken_by_autopilot(output_of(config.output));
  nominal.wind = config.sim.wind;
  nominal.sensors.camera_hz = camera.rate_hz;
  nominal.sensors.camera_latency = camera.latency;
  nominal.sensors.imu_hz = config.rates.imu_hz;
  nominal.sensors.sonar_hz = config.rates.sonar_hz;
  nominal.sensors.baro_hz = config.rates.baro_hz;

  const VehicleDescription& known = config.vehicle;
  nominal.vehicle = config.sim.vehicle;
  nominal.vehicle.mass = known.mass;
  nominal.vehicle.inertia = true_inertia(known.inertia, config.sim.inertia_ratio);
  nominal.vehicle.arm_x = known.arm_x;
  nominal.vehicle.arm_y = known.arm_y;
  nominal.vehicle.thrust_coefficient = known.thrust_coefficient;
  nominal.vehicle.torque_coefficient = known.torque_coefficient;
  nominal.vehicle.max_speed = known.max_speed;
  return nominal;
}

}  // namespace gatefly::config
