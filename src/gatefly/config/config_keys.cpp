// SPDX-License-Identifier: Apache-2.0
// The one table of configuration keys. Defaults are the structs' own; here is where they come from.
#include <utility>

#include "gatefly/config/config.hpp"
#include "gatefly/geometry/math.hpp"

// The member behind a key, for const and mutable configurations alike.
#define AT(expression) \
  [](auto& c) -> auto& { return c.expression; }

namespace gatefly::io {
namespace {

using Keys = std::vector<Key<Config>>;
constexpr double kMilli = 1e-3, kMicro = 1e-6;

template <class Member>
Key<Config> k(const char* name, double low, double high, Member member, const char* source,
              double unit = 1.0) {
  return key<Config>(name, low, high, member, source, unit);
}

Key<Config> size_key() {
  Key<Config> size;
  size.rule = {.name = "camera.size_px",
               .low = 16,
               .high = 4096,
               .source = "Bebop, scaler 1/8",
               .kind = KeyRule::Kind::kNumbers,
               .count = 2,
               .whole = true};
  size.get = [](const Config& c) { return nlohmann::json{c.camera.width, c.camera.height}; };
  size.set = [](Config& c, const nlohmann::json& v) {
    c.camera.width = v[0].get<int>();
    c.camera.height = v[1].get<int>();
  };
  return size;
}

/// As many coefficients as the model has; how many that are is checked with the model. One may
/// stand alone.
Key<Config> distortion_key() {
  Key<Config> distortion;
  distortion.rule = {.name = "camera.distortion",
                     .low = -1000,
                     .high = 1000,
                     .source = "dhane: k; fit on flights 3, 4, 10: 1.03-1.08",
                     .kind = KeyRule::Kind::kNumberOrList,
                     .count = 5};
  distortion.get = [](const Config& c) {
    return c.camera.distortion.size() == 1 ? nlohmann::json(c.camera.distortion[0])
                                           : nlohmann::json(c.camera.distortion);
  };
  distortion.set = [](Config& c, const nlohmann::json& v) {
    c.camera.distortion =
        v.is_array() ? v.get<std::vector<double>>() : std::vector<double>{v.get<double>()};
  };
  return distortion;
}

/// Two plain members as one pair.
Key<Config> arm_key() {
  Key<Config> arm;
  arm.rule = {.name = "vehicle.arm_m",
              .low = 0.01,
              .high = 2,
              .source = "Bebop, measured on drawings",
              .kind = KeyRule::Kind::kNumbers,
              .count = 2};
  arm.get = [](const Config& c) { return nlohmann::json{c.vehicle.arm_x, c.vehicle.arm_y}; };
  arm.set = [](Config& c, const nlohmann::json& v) {
    c.vehicle.arm_x = v[0].get<double>();
    c.vehicle.arm_y = v[1].get<double>();
  };
  return arm;
}

Keys camera_keys() {
  return {
      choice<Config>("camera.model", {"dhane", "pinhole", "brown-conrady", "kannala-brandt"},
                     AT(camera.model), "Dhane et al. 2012"),
      size_key(),
      k("camera.focal_px", 10, 10000, AT(camera.focal_px), "Li18 flight code"),
      k("camera.center_px", -4096, 8192, AT(camera.center_px),
        "authors' flight code and data: (157, 35 from below)"),
      distortion_key(),
      k("camera.stored_rotation_deg", 0, 270, AT(camera.stored_rotation_deg),
        "the sensor is turned"),
      k("camera.tilt_deg", -90, 90, AT(camera.tilt_down),
        "down; authors' flight code and data: 16-20", kDegree),
      k("camera.position_m", -2, 2, AT(camera.p_BC), "in the body frame; Bebop's nose"),
      k("camera.latency_ms", 0, 500, AT(camera.latency),
        "end of read-out to arrival; simulation.md", kMilli),
      k("camera.readout_ms", 0, 200, AT(camera.readout), "first to last line; simulation.md",
        kMilli),
      k("camera.exposure_ms", 0.01, 100, AT(camera.exposure), "longest; simulation.md", kMilli),
      k("camera.rate_hz", 1, 120, AT(camera.rate_hz), "MT9F002_TARGET_FPS 15"),
  };
}

Keys detection_keys() {
  return {
      k("color.rgb", 0, 1, AT(gate.rgb), "orange, as cameras see it; ours"),
      file_name<Config>("color.table", AT(gate.color_table),
                        "none: color.rgb; gatefly tune writes one"),
      choice<Config>("detector.mode", {"ours", "fast", "careful", "paper", "flown"},
                     AT(detector_mode),
                     "paper: ROC study, flown: basement, March 2018, each with its own colours and "
                     "numbers"),
      k("detector.min_score", -5, 10, AT(pilot.detector.min_score),
        "one such frame in two is a gate; docs/paper/results.md"),
      k("detector.sure_score", -5, 20, AT(pilot.detector.sure_score),
        "a frame of the fast search that needs no careful one; ours"),
      k("detector.max_roll_deg", 0, 90, AT(pilot.detector.max_roll_deg),
        "turns that are tried; ours"),
      k("detector.min_side_px", 1, 500, AT(pilot.detector.min_side_px),
        "of the bars' middle lines; ours"),
      k("detector.max_inside", -3, 3, AT(pilot.detector.max_inside),
        "evidence in the opening, nats; ours"),
      k("detector.size_bonus", 0, 5, AT(pilot.detector.weights.size),
        "score with every doubling of the side; labelled sets"),
      k("detector.max_aspect", 1, 20, AT(pilot.detector.max_aspect),
        "longest side / shortest; ours"),
      k("gate.side_m", 0.3, 5, AT(gate.side), "outer side; Bebop gates"),
      k("gate.bar_m", 0.005, 1, AT(gate.bar), "docs/conventions.md"),
      choice<Config>("gate.corners", {"outer", "middle", "inner"}, AT(gate.corners),
                     "docs/conventions.md"),
      k("gate.map_sigma_m", 0.001, 5, AT(pilot.map_sigma), "ours"),
      k("gate.height_sigma_m", 0, 2, AT(pilot.gate_height_sigma), "simulation.md"),
      k("gate.heading_sigma_deg", 0.01, 90, AT(pilot.gate_yaw_sigma), "ours", kDegree),
      choice<Config>("pose.model", {"ours", "paper"}, AT(pose_model),
                     "paper: rays of the best gate, Eq. (9), (10)"),
      k("pose.corner_sigma_px", 0.1, 100, AT(pilot.pose.corner_sigma_px),
        "authors' detections: 3 px robust"),
      k("pose.attitude_sigma_deg", 0, 45, AT(pilot.pose.attitude_sigma), "ours", kDegree),
      k("pose.heading_sigma_deg", 0, 45, AT(pilot.pose.heading_sigma), "ours: map 3°, gyro",
        kDegree),
      k("pose.max_lateral_m", 0.1, 100, AT(pilot.pose.max_lateral), "Li18 flight code"),
      k("pose.max_distance_m", 0.5, 100, AT(pilot.pose.max_distance), "ours: 1 m is 19 px there"),
      k("pose.min_bars_distance_m", 0.05, 10, AT(pilot.pose.min_bars_distance), "Li18 flight code"),
      k("pose.max_bars_distance_m", 0.05, 10, AT(pilot.pose.max_bars_distance), "Li18 flight code"),
      k("pose.max_misfit", 0.1, 1000, AT(pilot.pose.max_misfit),
        "mean squared residual / σ²; ours"),
      k("pose.bars_sigma_m", 0.001, 1, AT(pilot.pose.bars_sigma), "at 1 m; ours"),
      k("pose.scale_sigma", 0, 1, AT(pilot.pose.scale_sigma),
        "part of the distance; ours: 30 races"),
      k("pose.white_px", 0.01, 100, AT(pilot.pose.white_px),
        "new in every picture; ours: 30 races"),
      k("pose.white_part_px", 0.01, 100, AT(pilot.pose.white_part_px),
        "the same of lower corners and bars; ours: 30 races"),
  };
}

Keys estimation_keys() {
  return {
      k("ahrs.omega_radps", 0, 10, AT(pilot.ahrs.omega), "Li18 code: 0.063"),
      k("ahrs.zeta", 0.1, 5, AT(pilot.ahrs.zeta), "Li18 flight code"),
      k("ahrs.gravity_factor", 0, 1000, AT(pilot.ahrs.gravity_factor), "Li18 flight code"),
      k("ahrs.min_weight", 0, 1, AT(pilot.ahrs.min_weight), "Li18 flight code"),
      k("ahrs.gravity_time_s", 0.01, 100, AT(pilot.ahrs.gravity_time), "ours"),
      k("ahrs.tilt_process", 0, 1, AT(pilot.ahrs.tilt_process), "rad/√s; ours"),
      k("ahrs.gyro_delay_s", 0, 0.1, AT(pilot.ahrs.gyro_delay), "doubt only; ours"),
      k("ahrs.accel_bias_sigma_mps2", 0, 10, AT(pilot.ahrs.accel_bias_sigma), "doubt only; ours"),
      k("ahrs.rest_gyro_radps", 0.001, 10, AT(pilot.ahrs.rest_gyro), "ours"),
      k("ahrs.rest_accel_mps2", 0.01, 10, AT(pilot.ahrs.rest_accel), "ours"),
      k("ahrs.heading_process", 0, 1, AT(pilot.ahrs.heading_process), "rad/√s; ours"),
      k("ahrs.bias_process", 0, 1, AT(pilot.ahrs.bias_process), "rad/s/√s; ours"),
      k("ahrs.start_heading_sigma_deg", 0, 90, AT(pilot.ahrs.start_heading_sigma), "ours", kDegree),
      choice<Config>("filter.model", {"ours", "paper"}, AT(filter_model),
                     "paper: a fix counts as of now, as filter.fix_sigma_m"),
      k("filter.fix_sigma_m", 0.001, 10, AT(pilot.paper_filter.fix_sigma),
        "model paper; Li18 code: R 1.1, 0.1, 0.5"),
      k("filter.leg_sigma_m", 0.001, 10, AT(pilot.paper_filter.leg_sigma),
        "model paper, where a leg begins; Li18 code"),
      k("filter.drag_per_s", -5, -0.01, AT(pilot.filter.model.drag),
        "k_x, k_y; 14 recorded flights"),
      k("filter.position_noise", 0, 100, AT(pilot.filter.position_noise), "m²/s, x and y; ours"),
      k("filter.height_noise", 0, 100, AT(pilot.filter.height_noise), "m²/s; ours"),
      k("filter.vertical_noise", 0, 100, AT(pilot.filter.vertical_noise), "(m/s)²/s; ours"),
      k("filter.bias_noise", 0, 100, AT(pilot.filter.bias_noise), "(m/s²)²/s; ours"),
      k("filter.start_sigma_m", 0.001, 10, AT(pilot.filter.start_sigma), "on the pad; ours"),
      k("filter.start_bias_sigma_mps2", 0.001, 10, AT(pilot.filter.start_bias_sigma),
        "after rest; ours"),
      k("filter.gate_sigma", 0.5, 100, AT(pilot.filter.gate_sigma),
        "fixes farther off are refused; ours"),
      k("filter.sonar_sigma_m", 0.001, 10, AT(pilot.altimeter.sonar_sigma), "ours"),
      k("filter.baro_sigma_m", 0.001, 10, AT(pilot.altimeter.baro_sigma), "ours"),
      k("filter.sonar_max_step_m", 0.01, 10, AT(pilot.altimeter.max_step),
        "nearer is furniture; ours"),
      k("filter.max_disagreement_m", 0.01, 10, AT(pilot.altimeter.max_disagreement),
        "sonar, barometer; ours"),
      k("filter.baro_time_s", 0.01, 60, AT(pilot.altimeter.baro_time), "smoothing; ours"),
      k("filter.baro_drift_time_s", 0.1, 600, AT(pilot.altimeter.drift_time), "ours"),
      k("filter.sonar_lost_after_s", 0.1, 60, AT(pilot.altimeter.lost_after), "ours"),
      k("filter.velocity_pull_per_s", 0, 50, AT(pilot.velocity.pull), "ours"),
      k("filter.memory_ms", 20, 2000, AT(pilot.filter_memory), "how late a picture may come; ours",
        kMilli),
  };
}

Keys control_keys() {
  return {
      choice<Config>("control.mode", {"ours", "paper"}, AT(control_mode),
                     "paper: constant pitch, arcs open loop by each gate's exit"),
      k("control.pitch_deg", -45, -1, AT(pilot.paper_control.pitch), "mode paper; Li18: -5, -7",
        kDegree),
      k("control.arc_drag_per_s", -5, 0, AT(pilot.paper_control.arc_drag),
        "mode paper, k of Eq. (26); Li18 code"),
      k("control.entry_speed_drag_per_s", -5, -0.01, AT(pilot.paper_control.speed_drag),
        "mode paper, k_x of a turn's first speed; Li18 code"),
      k("control.speed_mps", 0.2, 10, AT(pilot.plan.speed), "paper: 1.5-1.8"),
      k("control.max_lateral_mps2", 0.1, 20, AT(pilot.plan.max_lateral), "ours: 18° of roll"),
      k("control.min_radius_m", 0.2, 20, AT(pilot.plan.min_radius), "Li18 code: 0.9"),
      k("control.clearance_m", 0, 2, AT(pilot.plan.clearance), "simulation.md"),
      k("control.body_radius_m", 0.02, 2, AT(pilot.plan.body_radius), "half the Bebop with guards"),
      k("control.run_in_m", 0, 10, AT(pilot.plan.run_in), "Li18 §4: a margin of 2 m"),
      k("control.lateral_kp_rad_per_m", 0, 10, AT(pilot.lateral.kp), "Li18 code: 0.35-0.50"),
      k("control.lateral_kd_rad_s_per_m", 0, 10, AT(pilot.lateral.kd), "Li18 code: 0.20-0.25"),
      k("control.max_roll_deg", 1, 60, AT(pilot.lateral.max_roll), "Li18 flight code", kDegree),
      k("control.altitude_kp_per_s2", 0, 100, AT(pilot.altitude.kp), "Li18 code: 4.3"),
      k("control.altitude_kd_per_s", 0, 100, AT(pilot.altitude.kd), "Li18 code: 1.1, rings"),
      k("control.altitude_ki", 0, 100, AT(pilot.altitude.ki), "ours"),
      k("control.max_vertical_mps2", 0.1, 20, AT(pilot.altitude.max_accel), "ours"),
      k("control.max_integral_mps2", 0, 20, AT(pilot.altitude.max_integral), "ours"),
      k("control.pitch_gain", 0, 2, AT(pilot.speed.pitch_gain), "rad/(m/s); ours"),
      k("control.max_pitch_deg", 0, 45, AT(pilot.speed.max_pitch), "nose down; ours", kDegree),
      k("control.min_pitch_deg", -45, 0, AT(pilot.speed.min_pitch), "braking; ours", kDegree),
      k("control.roll_lead_ms", 0, 2000, AT(pilot.speed.roll_lead), "INDI's lag; ours", kMilli),
      k("control.brake_lead_ms", 0, 5000, AT(pilot.speed.brake_lead), "ours", kMilli),
      k("control.attitude_gain_per_s2", 0, 2000, AT(pilot.indi.attitude_gain), "Li18 code: 200"),
      k("control.rate_gain_per_s", 0, 500, AT(pilot.indi.rate_gain), "Li18 code: 28"),
      k("control.yaw_attitude_gain_per_s2", 0, 500, AT(pilot.indi.yaw_attitude_gain), "ours"),
      k("control.yaw_rate_gain_per_s", 0, 500, AT(pilot.indi.yaw_rate_gain), "ours"),
      k("control.max_yaw_rate_radps", 0.1, 20, AT(pilot.indi.max_yaw_rate), "Li18 code: 2.1"),
      k("control.indi_filter_hz", 1, 200, AT(pilot.indi.filter_hz), "Li18 code: 8"),
      k("control.indi_filter_damping", 0.1, 2, AT(pilot.indi.filter_damping), "Li18 code: 0.55"),
      choice<Config>("control.indi_effectiveness", {"fixed", "adaptive"}, AT(indi_effectiveness),
                     "as flown: fixed; adaptive: Smeur 2016"),
      k("control.rest_samples", 1, 100000, AT(pilot.phase.rest_samples),
        "as if at 512 Hz; ours: 1.5 s"),
      k("control.go_height_m", 0.1, 10, AT(pilot.phase.go_height), "ours"),
      k("control.climb_timeout_s", 0.5, 60, AT(pilot.phase.climb_timeout), "ours"),
      k("control.search_before_m", 0.2, 10, AT(pilot.phase.search_before),
        "ours: 1 m stops 1.7 m/s"),
      k("control.max_lateral_sigma_m", 0.01, 10, AT(pilot.phase.max_lateral_sigma), "ours"),
      k("control.search_timeout_s", 0.5, 120, AT(pilot.phase.search_timeout), "ours"),
      k("control.max_tilt_deg", 20, 180, AT(pilot.phase.max_tilt), "beyond it the flight is lost",
        kDegree),
      k("control.imu_timeout_ms", 5, 5000, AT(pilot.phase.imu_timeout), "ours", kMilli),
  };
}

Keys vehicle_keys() {
  return {
      k("vehicle.mass_kg", 0.02, 20, AT(vehicle.mass), "Bebop 1 with guards"),
      k("vehicle.inertia_kgm2", 1e-6, 10, AT(vehicle.inertia), "ours: box model"),
      arm_key(),
      k("vehicle.thrust_coefficient", 1e-9, 1e-3, AT(vehicle.thrust_coefficient),
        "N/(rad/s)²; hovers at 7,380 rpm"),
      k("vehicle.torque_coefficient_m", 1e-4, 1, AT(vehicle.torque_coefficient),
        "yaw torque / thrust"),
      k("vehicle.min_rotor_radps", 0, 20000, AT(vehicle.min_speed), "ours"),
      k("vehicle.max_rotor_radps", 10, 20000, AT(vehicle.max_speed), "Bebop: 12,000 rpm"),
      k("vehicle.rotor_time_constant_ms", 1, 500, AT(vehicle.rotor_time_constant),
        "Li18 code: 0.1 a sample", kMilli),
      k("vehicle.imu_hz", 50, 4000, AT(rates.imu_hz), "Li18 flight code"),
      k("vehicle.sonar_hz", 1, 200, AT(rates.sonar_hz), "Bebop"),
      k("vehicle.baro_hz", 1, 200, AT(rates.baro_hz), "Bebop"),
  };
}

Keys sim_keys() {
  const char* logs = "real logs";
  return {
      choice<Config>("sim.ideal_detector", {"ours", "paper"}, AT(sim.ideal_vision.detector),
                     "whose statistics --vision ideal draws from: simulation.md"),
      k("sim.ghosts_percent", 0, 100, AT(sim.ideal_vision.ghosts),
        "ideal vision: gates seen as from up to 3 m away", 0.01),
      k("sim.false_alarms_factor", 0, 100, AT(sim.ideal_vision.false_alarms),
        "ideal vision: times the detector's own rate"),
      k("sim.timeout_s", 1, 3600, AT(sim.timeout), "ours"),
      k("sim.bake_threads", 1, 64, AT(sim.bake_threads),
        "ours; the light map does not depend on it"),
      k("sim.size_m", 0.02, 2, AT(sim.vehicle.size), "with guards: simulation.md"),
      k("sim.propeller_radius_m", 0.01, 1, AT(sim.vehicle.propeller_radius), "Bebop"),
      k("sim.rotor_time_constant_ms", 1, 500, AT(sim.vehicle.rotor_time_constant), "Bebop", kMilli),
      k("sim.rotor_drag_per_s", -5, 0, AT(sim.vehicle.rotor_drag), "at hover"),
      k("sim.body_drag_per_m", 0, 2, AT(sim.vehicle.body_drag), "ours"),
      k("sim.sag_time_s", 1, 3600, AT(sim.vehicle.sag_time), "ours"),
      k("sim.accel_bias_mps2", -5, 5, AT(sim.sensors.accel_bias), logs),
      k("sim.gyro_bias_radps", -1, 1, AT(sim.sensors.gyro_bias), logs),
      k("sim.accel_noise_mps2", 0, 20, AT(sim.sensors.accel_noise), logs),
      k("sim.accel_vibration_mps2", 0, 50, AT(sim.sensors.accel_vibration), logs),
      k("sim.gyro_noise_radps", 0, 5, AT(sim.sensors.gyro_noise), logs),
      k("sim.gyro_vibration_radps", 0, 5, AT(sim.sensors.gyro_vibration), logs),
      k("sim.imu_jitter_us", 0, 1000, AT(sim.sensors.imu_jitter), "ours", kMicro),
      k("sim.sonar_noise_m", 0, 1, AT(sim.sensors.sonar_noise), "ours"),
      k("sim.sonar_max_m", 0.5, 20, AT(sim.sensors.sonar_max), "Li18 code: 5"),
      k("sim.baro_noise_m", 0, 5, AT(sim.sensors.baro_noise), "ours"),
      k("sim.baro_drift_m", 0, 5, AT(sim.sensors.baro_drift), "per √(10 s); ours"),
  };
}

}  // namespace

const std::vector<Key<Config>>& config_keys() {
  static const Keys all = [] {
    Keys keys;
    for (Keys part : {camera_keys(), detection_keys(), estimation_keys(), control_keys(),
                      vehicle_keys(), sim_keys()})
      for (Key<Config>& each : part) keys.push_back(std::move(each));
    return keys;
  }();
  return all;
}

}  // namespace gatefly::io
