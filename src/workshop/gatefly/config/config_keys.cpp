// SPDX-License-Identifier: Apache-2.0
// The one table of configuration keys. Defaults are the structs' own; here is where they come from.
#include <utility>

#include "gatefly/config/config.hpp"
#include "gatefly/config/sim_keys.hpp"
#include "gatefly/geometry/math.hpp"

// The member behind a key, for const and mutable configurations alike.
#define AT(expression) \
  [](auto& c) -> auto& { return c.expression; }

namespace gatefly::config {
namespace {

using Keys = std::vector<Key<Config>>;

template <class Member>
Key<Config> k(const char* name, double low, double high, Member member, const char* what,
              const char* source, double unit = 1.0) {
  return key<Config>(name, low, high, member, what, source, unit);
}

Key<Config> size_key() {
  Key<Config> size;
  size.rule = {.name = "camera.size_px",
               .low = 16,
               .high = 4096,
               .what = "width, height of the upright picture",
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
                     .what = "distortion coefficients of the model; dhane: k",
                     .source = "fit on flights 3, 4, 10: 1.03-1.08",
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
              .what = "distance of the rotors from the centre along x, y",
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
                     AT(camera.model), "lens model", "Dhane et al. 2012"),
      size_key(),
      k("camera.focal_px", 10, 10000, AT(camera.focal_px), "focal lengths u, v",
        "Li18 flight code"),
      k("camera.center_px", -4096, 8192, AT(camera.center_px), "principal point",
        "authors' flight code and data: (157, 35 from below)"),
      distortion_key(),
      k("camera.stored_rotation_deg", 0, 270, AT(camera.stored_rotation_deg),
        "counter-clockwise turn that makes stored pictures upright", "the sensor is turned"),
      k("camera.tilt_deg", -90, 90, AT(camera.tilt_down), "mount angle, positive down",
        "authors' flight code and data: 16-20", kDegree),
      k("camera.position_m", -2, 2, AT(camera.p_BC), "focal point in the body frame",
        "Bebop's nose"),
      k("camera.latency_ms", 0, 500, AT(camera.latency), "end of read-out to arrival",
        "simulation.md", kMilliseconds),
      k("camera.readout_ms", 0, 200, AT(camera.readout), "rolling shutter: first to last line",
        "simulation.md", kMilliseconds),
      k("camera.exposure_ms", 0.01, 100, AT(camera.exposure), "longest exposure of a line",
        "simulation.md", kMilliseconds),
      k("camera.rate_hz", 1, 120, AT(camera.rate_hz), "pictures a second", "MT9F002_TARGET_FPS 15"),
      k("camera.jpeg_quality", 0, 100, AT(camera.jpeg_quality),
        "simulated pictures go through a JPEG, 4:2:0, of this quality; 0: none", "none on board"),
  };
}

Keys detection_keys() {
  return {
      k("color.rgb", 0, 1, AT(gate.rgb), "a gate's colour, of which the hue counts",
        "orange, as cameras see it; ours"),
      file_name<Config>("color.table", AT(gate.color_table),
                        "fitted colour model in place of color.rgb; gatefly tune writes one",
                        "none"),
      choice<Config>("detector.mode", {"ours", "fast", "careful", "paper", "flown"},
                     AT(detector_mode),
                     "fast, careful: that search alone; paper: Li18's ROC study; flown: its "
                     "flights of March 2018; both with colours of their own",
                     "both searches"),
      k("detector.min_score", -5, 10, AT(pilot.detector.min_score), "least score of a gate",
        "one such frame in two is a gate; docs/paper/results.md"),
      k("detector.sure_score", -5, 20, AT(pilot.detector.sure_score),
        "fast search: score from which on no careful search follows", "ours"),
      k("detector.adapts", 0, 1, AT(pilot.detector.adapts),
        "1: colours count by the picture's own light, contrast and blur; 0: as they are", "ours"),
      k("detector.max_roll_deg", 0, 90, AT(pilot.detector.max_roll_deg),
        "careful search: largest roll that is tried", "ours"),
      k("detector.min_side_px", 1, 500, AT(pilot.detector.min_side_px),
        "shortest side of a gate, along its bars' middle lines", "ours"),
      k("detector.max_inside", -3, 3, AT(pilot.detector.max_inside),
        "most evidence for the gate's colour in its opening [nats]", "ours"),
      k("detector.size_bonus", 0, 5, AT(pilot.detector.weights.size),
        "score added with every doubling of the side", "labelled sets"),
      k("detector.max_aspect", 1, 20, AT(pilot.detector.max_aspect),
        "longest side / shortest side of a gate", "ours"),
      k("detector.lens_deg", -1, 200, AT(lens_angle),
        "angle across the picture's width of the equidistant lens that bends bars as this one "
        "does, "
        "where none is named; 0: straight; -1: unknown; gatefly tune writes it",
        "unknown", kDegree),
      k("detector.lens_center", -0.15, 0.15, AT(lens_center),
        "its centre off the picture's middle, in widths", "the middle"),
      k("gate.side_m", 0.3, 5, AT(gate.side), "outer side of the frame", "Bebop gates"),
      k("gate.bar_m", 0.005, 1, AT(gate.bar), "width of the frame's bars", "docs/conventions.md"),
      choice<Config>("gate.corners", {"outer", "middle", "inner"}, AT(gate.corners),
                     "corners that detections and labels mean", "docs/conventions.md"),
      k("gate.map_sigma_m", 0.001, 5, AT(pilot.map_sigma),
        "map error of a gate's place relative to the one before, one sigma", "ours"),
      k("gate.height_sigma_m", 0, 2, AT(pilot.gate_height_sigma),
        "map error of a gate's height, one sigma", "simulation.md"),
      k("gate.heading_sigma_deg", 0.01, 90, AT(pilot.gate_yaw_sigma),
        "map error of a gate's heading, one sigma", "ours", kDegree),
      choice<Config>("pose.model", {"ours", "paper"}, AT(pose_model),
                     "ours: most probable pose; paper: rays of the best gate, Eq. (9), (10)",
                     "map_pose"),
      k("pose.corner_sigma_px", 0.1, 100, AT(pilot.pose.corner_sigma_px),
        "error of a detected corner, one sigma", "authors' detections: 3 px robust"),
      k("pose.attitude_sigma_deg", 0, 45, AT(pilot.pose.attitude_sigma),
        "camera's roll and pitch against the body (systematic), one sigma", "ours", kDegree),
      k("pose.heading_sigma_deg", 0, 45, AT(pilot.pose.heading_sigma),
        "yaw against the gate, one sigma", "ours: map 3°, gyro", kDegree),
      k("pose.max_lateral_m", 0.1, 100, AT(pilot.pose.max_lateral),
        "fixes farther than this from the gate's axis are refused", "Li18 flight code"),
      k("pose.max_distance_m", 0.5, 100, AT(pilot.pose.max_distance),
        "fixes farther than this from the gate are refused", "ours: 1 m is 19 px there"),
      k("pose.min_bars_distance_m", 0.05, 10, AT(pilot.pose.min_bars_distance),
        "side bars give no fix nearer than this", "Li18 flight code"),
      k("pose.max_bars_distance_m", 0.05, 10, AT(pilot.pose.max_bars_distance),
        "side bars give no fix farther than this", "Li18 flight code"),
      k("pose.max_misfit", 0.1, 1000, AT(pilot.pose.max_misfit),
        "largest mean squared residual of the corners / σ²; 1 is expected", "ours"),
      k("pose.bars_sigma_m", 0.001, 1, AT(pilot.pose.bars_sigma),
        "error of a side bar's middle line seen from 1 m, one sigma", "ours"),
      k("pose.scale_sigma", 0, 1, AT(pilot.pose.scale_sigma),
        "relative error of all distances (systematic), one sigma", "ours: 30 races"),
      k("pose.random_sigma_px", 0.01, 100, AT(pilot.pose.random_sigma_px),
        "random part of a corner's error, independent between pictures, one sigma",
        "ours: 30 races"),
      k("pose.random_part_sigma_px", 0.01, 100, AT(pilot.pose.random_part_sigma_px),
        "the same of lower corners and side bars, one sigma", "ours: 30 races"),
  };
}

Keys estimation_keys() {
  return {
      k("ahrs.omega_radps", 0, 10, AT(pilot.ahrs.omega),
        "natural frequency of the gravity correction", "Li18 code: 0.063"),
      k("ahrs.zeta", 0.1, 5, AT(pilot.ahrs.zeta), "damping of the gravity correction",
        "Li18 flight code"),
      k("ahrs.gravity_factor", 0, 1000, AT(pilot.ahrs.gravity_factor),
        "loss of its weight with accelerations other than gravity", "Li18 flight code"),
      k("ahrs.min_weight", 0, 1, AT(pilot.ahrs.min_weight),
        "least weight of the gravity correction", "Li18 flight code"),
      k("ahrs.gravity_time_s", 0.01, 100, AT(pilot.ahrs.gravity_time),
        "averaging time of the specific force", "ours"),
      k("ahrs.tilt_process", 0, 1, AT(pilot.ahrs.tilt_process),
        "process noise of roll and pitch [rad/√s]", "ours"),
      k("ahrs.gyro_delay_s", 0, 0.1, AT(pilot.ahrs.gyro_delay),
        "age of a gyro sample: only widens the covariance of roll and pitch", "ours"),
      k("ahrs.accel_bias_sigma_mps2", 0, 10, AT(pilot.ahrs.accel_bias_sigma),
        "accelerometer bias left after rest: only widens the covariance of roll and pitch", "ours"),
      k("ahrs.rest_gyro_radps", 0.001, 10, AT(pilot.ahrs.rest_gyro),
        "rest calibration: largest rate that counts as standing still", "ours"),
      k("ahrs.rest_accel_mps2", 0.01, 10, AT(pilot.ahrs.rest_accel),
        "rest calibration: largest deviation of the specific force", "ours"),
      k("ahrs.heading_process", 0, 1, AT(pilot.ahrs.heading_process),
        "process noise of the heading [rad/√s]", "ours"),
      k("ahrs.bias_process", 0, 1, AT(pilot.ahrs.bias_process),
        "process noise of the yaw gyro's bias [rad/s/√s]", "ours"),
      k("ahrs.start_heading_sigma_deg", 0, 90, AT(pilot.ahrs.start_heading_sigma),
        "heading on the pad, one sigma", "ours", kDegree),
      choice<Config>(
          "filter.model", {"ours", "drag", "paper"}, AT(filter_model),
          "ours: wind, gates, mount and delay are states; drag: air speed counts as ground "
          "speed; paper: a fix counts as of now, as filter.fix_sigma_m",
          "with memory and systematic errors"),
      k("filter.fix_sigma_m", 0.001, 10, AT(pilot.paper_filter.fix_sigma),
        "model paper: error of a fix, one sigma", "Li18 code: R 1.1, 0.1, 0.5"),
      k("filter.leg_sigma_m", 0.001, 10, AT(pilot.paper_filter.leg_sigma),
        "model paper: x and y where a leg begins, one sigma", "Li18 code"),
      k("filter.drag_per_s", -5, -0.01, AT(pilot.filter.model.drag), "drag coefficients k_x, k_y",
        "14 recorded flights"),
      k("filter.position_noise", 0, 100, AT(pilot.filter.position_noise),
        "process noise of x and y [m²/s]", "ours"),
      k("filter.height_noise", 0, 100, AT(pilot.filter.height_noise), "process noise of z [m²/s]",
        "ours"),
      k("filter.vertical_noise", 0, 100, AT(pilot.filter.vertical_noise),
        "process noise of the vertical velocity [(m/s)²/s]", "ours"),
      k("filter.bias_noise", 0, 100, AT(pilot.filter.bias_noise),
        "process noise of the accelerometer biases [(m/s²)²/s]", "ours"),
      k("filter.start_sigma_m", 0.001, 10, AT(pilot.filter.start_sigma),
        "position on the pad, one sigma", "ours"),
      k("filter.start_bias_sigma_mps2", 0.001, 10, AT(pilot.filter.start_bias_sigma),
        "accelerometer biases after the rest calibration, one sigma", "ours"),
      k("filter.wind_sigma_mps", 0.01, 10, AT(pilot.error_state.priors.wind),
        "model ours: mean wind before take-off, one sigma", "doors and fans: .3; estimate"),
      k("filter.gust_sigma_mps", 0.01, 10, AT(pilot.error_state.priors.gust),
        "model ours: gusts before take-off, one sigma; found in flight", "ours: from above"),
      k("filter.mount_sigma_deg", 0.01, 30, AT(pilot.error_state.priors.mount),
        "model ours: camera's tilt, pan and roll against what is told, one sigma", "a bracket",
        kDegree),
      k("filter.pad_sigma_deg", 0.01, 10, AT(pilot.error_state.priors.tilt),
        "model ours: how level the drone stands on the pad, one sigma", "estimate", kDegree),
      k("filter.delay_sigma_ms", 0.01, 100, AT(pilot.error_state.priors.delay),
        "model ours: pictures' latency against what is told, one sigma", "estimate", 1e-3),
      k("filter.focal_sigma", 1e-4, 0.3, AT(pilot.error_state.priors.focal),
        "model ours: focal length against what is told, relative, one sigma", "calibrations"),
      k("filter.thrust_sigma", 1e-3, 1, AT(pilot.error_state.priors.thrust),
        "model ours: thrust that a command gives against what is told, relative, one sigma",
        "estimate"),
      k("filter.corner_sigma_px", 0.05, 20, AT(pilot.error_state.sight.own),
        "model ours: each corner's own error, one sigma", "the detector on labelled pictures"),
      k("filter.gate_sigma", 0.5, 100, AT(pilot.filter.gate_sigma),
        "innovation gate: fixes more sigmas off are refused", "ours"),
      k("filter.sonar_sigma_m", 0.001, 10, AT(pilot.altimeter.sonar_sigma),
        "error of the sonar, one sigma", "ours"),
      k("filter.baro_sigma_m", 0.001, 10, AT(pilot.altimeter.baro_sigma),
        "error of a barometer sample without its drift, one sigma", "ours"),
      k("filter.sonar_max_step_m", 0.01, 10, AT(pilot.altimeter.max_step),
        "sonar nearer than expected by more than this saw furniture", "ours"),
      k("filter.max_disagreement_m", 0.01, 10, AT(pilot.altimeter.max_disagreement),
        "largest difference between sonar and smoothed barometer", "ours"),
      k("filter.baro_time_s", 0.01, 60, AT(pilot.altimeter.baro_time),
        "smoothing time of the barometer", "ours"),
      k("filter.baro_drift_time_s", 0.1, 600, AT(pilot.altimeter.drift_time),
        "time constant with which the barometer's drift is followed", "ours"),
      k("filter.sonar_lost_after_s", 0.1, 60, AT(pilot.altimeter.lost_after),
        "without a good echo for so long, the barometer alone decides which one is good", "ours"),
      k("filter.velocity_pull_per_s", 0, 50, AT(pilot.velocity.pull),
        "gain that pulls the integrated velocity to that of drag", "ours"),
      k("filter.imu_hz", 0, 512, AT(rates.filter_imu_hz),
        "model ours: samples a second of an autopilot's IMU, without stamps, that it estimates by, "
        "at least 25; 0: by every sample of the vehicle's, or as sim.autopilot_imu_hz says",
        "none"),
      k("filter.memory_ms", 20, 2000, AT(pilot.filter_memory), "how late a picture may arrive",
        "ours", kMilliseconds),
  };
}

Keys control_keys() {
  return {
      choice<Config>("control.mode", {"ours", "paper"}, AT(control_mode),
                     "paper: constant pitch, arcs open loop by each gate's exit", "ours"),
      k("control.pitch_deg", -45, -1, AT(pilot.paper_control.pitch),
        "mode paper: constant pitch θ_0", "Li18: -5, -7", kDegree),
      k("control.arc_drag_per_s", -5, 0, AT(pilot.paper_control.arc_drag),
        "mode paper: k of Eq. (26)", "Li18 code"),
      k("control.entry_speed_drag_per_s", -5, -0.01, AT(pilot.paper_control.speed_drag),
        "mode paper: k_x for the speed on entry of a turn", "Li18 code"),
      k("control.speed_mps", 0.2, 10, AT(pilot.plan.speed), "speed on straights",
        "ours; paper: 1.5-1.8"),
      k("control.max_lateral_mps2", 0.1, 20, AT(pilot.plan.max_lateral),
        "lateral acceleration v²/r that an arc may ask for", "ours: 18° of roll"),
      k("control.min_radius_m", 0.2, 20, AT(pilot.plan.min_radius), "smallest radius of an arc",
        "Li18 code: 0.9"),
      k("control.clearance_m", 0, 2, AT(pilot.plan.clearance),
        "planned distance from the body's outline to anything solid", "simulation.md"),
      k("control.least_clearance_m", 0, 2, AT(pilot.plan.least_clearance),
        "the same where a leg has no such way; control.clearance_m or more: such a course is "
        "refused",
        "ours: a gate's own opening leaves 0.25"),
      k("control.body_radius_m", 0.02, 2, AT(pilot.plan.body_radius), "half the body's width",
        "half the Bebop with guards"),
      k("control.run_in_m", 0, 10, AT(pilot.plan.run_in), "straight wanted before a gate",
        "Li18 §4: a margin of 2 m"),
      k("control.lateral_kp_rad_per_m", 0, 10, AT(pilot.lateral.kp),
        "lateral PD: proportional gain", "Li18 code: 0.35-0.50"),
      k("control.lateral_kd_rad_s_per_m", 0, 10, AT(pilot.lateral.kd),
        "lateral PD: derivative gain", "Li18 code: 0.20-0.25"),
      k("control.max_roll_deg", 1, 60, AT(pilot.lateral.max_roll), "lateral PD: largest roll",
        "Li18 flight code", kDegree),
      k("control.altitude_kp_per_s2", 0, 100, AT(pilot.altitude.kp),
        "altitude PID: proportional gain", "Li18 code: 4.3"),
      k("control.altitude_kd_per_s", 0, 100, AT(pilot.altitude.kd), "altitude PID: derivative gain",
        "Li18 code: 1.1, rings"),
      k("control.altitude_ki", 0, 100, AT(pilot.altitude.ki), "altitude PID: integral gain [1/s³]",
        "ours"),
      k("control.max_vertical_mps2", 0.1, 20, AT(pilot.altitude.max_accel),
        "altitude PID: largest vertical acceleration", "ours"),
      k("control.max_integral_mps2", 0, 20, AT(pilot.altitude.max_integral),
        "altitude PID: largest integral", "ours"),
      k("control.pitch_gain", 0, 2, AT(pilot.speed.pitch_gain), "pitch per speed error [rad/(m/s)]",
        "ours"),
      k("control.max_pitch_deg", 0, 45, AT(pilot.speed.max_pitch), "largest pitch, nose down",
        "ours", kDegree),
      k("control.min_pitch_deg", -45, 0, AT(pilot.speed.min_pitch),
        "largest pitch for braking, nose up (negative)", "ours", kDegree),
      k("control.roll_lead_ms", 0, 2000, AT(pilot.speed.roll_lead),
        "roll begins so long before a curve: INDI's lag", "ours", kMilliseconds),
      k("control.brake_lead_ms", 0, 5000, AT(pilot.speed.brake_lead),
        "braking begins so long before a curve", "ours", kMilliseconds),
      k("control.look_aside_deg", 0, 180, AT(pilot.look_aside.most),
        "the nose may leave the way so far to see the next gate from a turn; 0: not at all, as "
        "with filter.model drag or paper",
        "ours; paper: 0", kDegree),
      k("control.attitude_gain_per_s2", 0, 2000, AT(pilot.indi.attitude_gain),
        "INDI: gain of roll and pitch error, ω²", "Li18 code: 200"),
      k("control.rate_gain_per_s", 0, 500, AT(pilot.indi.rate_gain),
        "INDI: gain of their rates, 2 ζ ω", "Li18 code: 28"),
      k("control.yaw_attitude_gain_per_s2", 0, 500, AT(pilot.indi.yaw_attitude_gain),
        "INDI: gain of the yaw error", "ours"),
      k("control.yaw_rate_gain_per_s", 0, 500, AT(pilot.indi.yaw_rate_gain),
        "INDI: gain of the yaw rate", "ours"),
      k("control.max_yaw_rate_radps", 0.1, 20, AT(pilot.indi.max_yaw_rate),
        "INDI: largest yaw rate", "Li18 code: 2.1"),
      k("control.indi_filter_hz", 1, 200, AT(pilot.indi.filter_hz),
        "INDI: low-pass of rates and rotors", "Li18 code: 8"),
      k("control.indi_filter_damping", 0.1, 2, AT(pilot.indi.filter_damping),
        "INDI: damping of that low-pass", "Li18 code: 0.55"),
      choice<Config>("control.output", {"motors", "attitude_thrust", "rates_thrust"}, AT(output),
                     "motors: rotor speeds by INDI; else set points for an autopilot: roll, pitch, "
                     "yaw rate or turn rates, and thrust",
                     "as flown"),
      k("control.rates_gain_per_s", 0.1, 50, AT(pilot.rates.attitude_gain),
        "for an autopilot: turn rate per error of roll and pitch", "ours"),
      k("control.rates_yaw_gain_per_s", 0.1, 50, AT(pilot.rates.yaw_gain),
        "for an autopilot: yaw rate per error of the heading", "ours"),
      k("control.max_rate_radps", 0.1, 20, AT(pilot.rates.max_rate),
        "for an autopilot: largest rate of roll and pitch", "ours"),
      k("control.response_ms", 1, 500, AT(pilot.rates.response),
        "for an autopilot: a set point shows in the motion so much later", "ours", kMilliseconds),
      choice<Config>("control.indi_effectiveness", {"fixed", "adaptive"}, AT(indi_effectiveness),
                     "INDI: control effectiveness, fixed or adapted in flight (Smeur 2016)",
                     "as flown"),
      k("control.rest_samples", 1, 100000, AT(pilot.phase.rest_samples),
        "rest calibration: IMU samples, as if at 512 Hz", "ours: 1.5 s"),
      k("control.go_height_m", 0.1, 10, AT(pilot.phase.go_height),
        "height from which on it flies forward", "ours"),
      k("control.climb_timeout_s", 0.5, 60, AT(pilot.phase.climb_timeout),
        "longest climb after take-off", "ours"),
      k("control.first_gate_timeout_s", 0, 60, AT(pilot.phase.first_gate_timeout),
        "above the pad: longest wait for a first gate that should show from there; 0: none",
        "ours"),
      k("control.search_before_m", 0.2, 10, AT(pilot.phase.search_before),
        "distance before a gate where it decides whether to go around", "ours: 1 m stops 1.7 m/s"),
      k("control.max_lateral_sigma_m", 0.01, 10, AT(pilot.phase.max_lateral_sigma),
        "more uncertain to the side than this: go around; of gates of 1 m, of wider openings more",
        "ours"),
      k("control.search_timeout_s", 0.5, 120, AT(pilot.phase.search_timeout),
        "longest search for a gate", "ours"),
      k("control.max_tilt_deg", 20, 180, AT(pilot.phase.max_tilt),
        "tilt beyond which the flight is given up", "ours", kDegree),
      k("control.imu_timeout_ms", 5, 5000, AT(pilot.phase.imu_timeout),
        "time without IMU samples after which the flight is given up", "ours", kMilliseconds),
  };
}

Keys vehicle_keys() {
  return {
      k("vehicle.mass_kg", 0.02, 20, AT(vehicle.mass), "mass", "Bebop 1 with guards"),
      k("vehicle.inertia_kgm2", 1e-6, 10, AT(vehicle.inertia),
        "moments of inertia about the body axes", "ours: box model"),
      arm_key(),
      k("vehicle.thrust_coefficient", 1e-9, 1e-3, AT(vehicle.thrust_coefficient),
        "thrust / rotor speed² [N/(rad/s)²]", "hovers at 7,380 rpm"),
      k("vehicle.torque_coefficient_m", 1e-4, 1, AT(vehicle.torque_coefficient),
        "yaw torque / thrust", "Bebop"),
      k("vehicle.min_rotor_radps", 0, 20000, AT(vehicle.min_speed), "lowest rotor speed", "ours"),
      k("vehicle.max_rotor_radps", 10, 20000, AT(vehicle.max_speed), "highest rotor speed",
        "Bebop: 12,000 rpm"),
      k("vehicle.rotor_time_constant_ms", 1, 500, AT(vehicle.rotor_time_constant),
        "lag of the rotors, as the pilot's model has it", "Li18 code: 0.1 a sample", kMilliseconds),
      k("vehicle.imu_hz", 50, 4000, AT(rates.imu_hz), "IMU samples a second", "Li18 flight code"),
      choice<Config>("vehicle.sonar", {"yes", "none"}, AT(rates.sonar),
                     "none: height comes from gates and IMU", "Bebop"),
      choice<Config>("vehicle.baro", {"yes", "none"}, AT(rates.baro),
                     "none: height comes from gates and IMU", "Bebop"),
      k("vehicle.sonar_hz", 1, 200, AT(rates.sonar_hz), "sonar readings a second", "Bebop"),
      k("vehicle.baro_hz", 1, 200, AT(rates.baro_hz), "barometer readings a second", "Bebop"),
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

}  // namespace gatefly::config

#undef AT
