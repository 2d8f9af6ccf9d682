// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/sim_keys.hpp"

#include "gatefly/geometry/math.hpp"

// The member behind a key, for const and mutable configurations alike.
#define AT(expression) \
  [](auto& c) -> auto& { return c.expression; }

namespace gatefly::config {
namespace {

constexpr double kMicro = 1e-6;

template <class Member>
Key<Config> k(const char* name, double low, double high, Member member, const char* what,
              const char* source, double unit = 1.0) {
  return key<Config>(name, low, high, member, what, source, unit);
}

}  // namespace

std::vector<Key<Config>> sim_keys() {
  const char* logs = "real logs";
  return {
      choice<Config>("sim.camera_quality", {"full", "fast"}, AT(sim.camera_quality),
                     "fast: one ray a pixel, without motion blur, red fringes, bloom, glare",
                     "simulation.md"),
      choice<Config>("sim.ideal_detector", {"ours", "paper"}, AT(sim.ideal_vision.detector),
                     "ideal vision: whose detection statistics", "simulation.md"),
      k("sim.outliers_percent", 0, 100, AT(sim.ideal_vision.outliers),
        "ideal vision: gates detected displaced, as if seen from up to 3 m away", "none", 0.01),
      k("sim.false_alarms_factor", 0, 100, AT(sim.ideal_vision.false_alarms),
        "ideal vision: false alarms / the detector's own", "measured"),
      k("sim.pixel_footprint_px", 0.1, 4, AT(sim.imaging.footprint_px),
        "side of the square of light that a pixel gathers", "real pictures"),
      k("sim.red_shift_px", -2, 2, AT(sim.imaging.red_shift_px),
        "how far red lies above green and blue: fringes", "real pictures"),
      k("sim.chroma_smoothing", 0, 8, AT(sim.imaging.chroma_smoothing),
        "passes of [1 2 1]/4 over the colours, along upright lines", "real pictures"),
      k("sim.saturation", 0, 4, AT(sim.imaging.saturation), "of colours, after the colour matrix",
        "real pictures"),
      k("sim.paint_width", 0.1, 1, AT(sim.paint.width),
        "part of a gate's bar that shows colour; of boards, from 0.1 m on, all but 1 cm at least",
        "real pictures"),
      k("sim.paint_blue", 0, 2, AT(sim.paint.blue), "gates' blue / that of their colour's name",
        "real pictures"),
      k("sim.paint_wear", 0, 1, AT(sim.paint.wear), "colour gone where a bar is dirtiest",
        "real pictures"),
      k("sim.timeout_s", 1, 3600, AT(sim.timeout), "longest flight", "ours"),
      k("sim.bake_threads", 1, 64, AT(sim.bake_threads),
        "threads that compute the light map; it does not depend on them", "ours"),
      k("sim.size_m", 0.02, 2, AT(sim.vehicle.size), "size of the body along x, y, z",
        "with guards: simulation.md"),
      k("sim.propeller_radius_m", 0.01, 1, AT(sim.vehicle.propeller_radius),
        "radius of a propeller", "Bebop"),
      k("sim.rotor_time_constant_ms", 1, 500, AT(sim.vehicle.rotor_time_constant),
        "true lag of the rotors", "Bebop", kMilliseconds),
      k("sim.rotor_drag_per_s", -5, 0, AT(sim.vehicle.rotor_drag), "drag of the rotors at hover",
        "recorded flights"),
      k("sim.body_drag_per_m", 0, 2, AT(sim.vehicle.body_drag),
        "drag of the body, grows with speed²", "ours"),
      k("sim.inertia_ratio", 0.1, 10, AT(sim.inertia_ratio),
        "true moments of inertia / the vehicle file's", "recorded flights"),
      k("sim.air_moment_nms_per_m", 0, 2, AT(sim.vehicle.air_moment),
        "moment of the air about roll, pitch per speed to the side, ahead", "recorded flights"),
      k("sim.sag_time_s", 1, 3600, AT(sim.vehicle.sag_time),
        "time after which battery sag is complete", "ours"),
      k("sim.accel_bias_mps2", -5, 5, AT(sim.sensors.accel_bias), "bias of the accelerometer",
        logs),
      k("sim.gyro_bias_radps", -1, 1, AT(sim.sensors.gyro_bias), "bias of the gyro", logs),
      k("sim.accel_noise_mps2", 0, 20, AT(sim.sensors.accel_noise),
        "white noise of the accelerometer at 512 Hz", logs),
      k("sim.accel_vibration_mps2", 0, 50, AT(sim.sensors.accel_vibration),
        "vibration of the rotors in the accelerometer, RMS", logs),
      k("sim.gyro_noise_radps", 0, 5, AT(sim.sensors.gyro_noise),
        "white noise of the gyro at 512 Hz", logs),
      k("sim.gyro_vibration_radps", 0, 5, AT(sim.sensors.gyro_vibration),
        "vibration of the rotors in the gyro, RMS", logs),
      k("sim.gyro_rumble_radps", 0, 5, AT(sim.sensors.gyro_rumble),
        "noise of the gyro from 3 to 12 Hz", logs),
      k("sim.imu_jitter_us", 0, 1000, AT(sim.sensors.imu_jitter), "jitter of the sampling interval",
        "ours", kMicro),
      k("sim.autopilot_imu_hz", 0, 512, AT(sim.sensors.autopilot_imu_hz),
        "samples of the IMU that an autopilot hands on to the estimator, a second, at least 25; 0: "
        "it gets every one itself",
        "Betaflight's MSP: 23-92"),
      k("sim.autopilot_gyro_cutoff_hz", 0, 2000, AT(sim.sensors.autopilot_gyro_cutoff),
        "second-order low-pass of the autopilot's gyro; 0: raw", "Betaflight: 100-250"),
      k("sim.autopilot_accel_cutoff_hz", 0, 2000, AT(sim.sensors.autopilot_accel_cutoff),
        "second-order low-pass of the autopilot's accelerometer; 0: raw", "Betaflight: 25"),
      k("sim.autopilot_imu_jitter_ms", 0, 100, AT(sim.sensors.autopilot_imu_jitter),
        "what a sample is late on its way from the autopilot, one sigma of a half normal",
        "ours: a tick or two of a driver", kMilliseconds),
      k("sim.autopilot_hz", 5, 512, AT(sim.autopilot.hz),
        "set points a second that reach an autopilot (control.output)", "AI Grand Prix 2026: 40"),
      k("sim.autopilot_delay_ms", 0, 500, AT(sim.autopilot.delay),
        "least time from a set point to the autopilot", "AI Grand Prix 2026: 10-30", kMilliseconds),
      k("sim.autopilot_delay_jitter_ms", 0, 200, AT(sim.autopilot.delay_jitter),
        "what a set point is later than that, one sigma of a half normal",
        "AI Grand Prix 2026: 95 % in 20-30", kMilliseconds),
      k("sim.autopilot_smoothing_hz", 0, 250, AT(sim.autopilot.smoothing_hz),
        "the autopilot's low-pass over set points; 0: none", "AI Grand Prix 2026: 15"),
      k("sim.autopilot_gain", 0.1, 3, AT(sim.autopilot.gain),
        "the autopilot's rate loop / one well tuned for the vehicle", "ours"),
      k("sim.autopilot_angle_gain_per_s", 0.5, 50, AT(sim.autopilot.angle_gain),
        "the autopilot's rate for an angle's error, attitude_thrust only", "Betaflight: 5"),
      k("sim.autopilot_max_angle_deg", 10, 80, AT(sim.autopilot.most_angle),
        "angle with the stick at its end, attitude_thrust only", "Betaflight: 60", kDegree),
      k("sim.autopilot_rc_rate", 1, 255, AT(sim.autopilot.rc_rate),
        "Betaflight's rc_rate of roll, pitch, yaw", "AI Grand Prix 2026"),
      k("sim.autopilot_super_rate", 0, 99, AT(sim.autopilot.super_rate),
        "Betaflight's super rate of roll, pitch, yaw", "AI Grand Prix 2026"),
      k("sim.autopilot_rc_expo", 0, 100, AT(sim.autopilot.rc_expo),
        "Betaflight's expo of roll, pitch, yaw", "AI Grand Prix 2026: 0"),
      k("sim.autopilot_throttle_mid", 0, 100, AT(sim.autopilot.throttle_mid),
        "Betaflight's thr_mid", "AI Grand Prix 2026"),
      k("sim.autopilot_throttle_expo", 0, 100, AT(sim.autopilot.throttle_expo),
        "Betaflight's thr_expo", "AI Grand Prix 2026"),
      k("sim.sonar_noise_m", 0, 1, AT(sim.sensors.sonar_noise), "noise of the sonar", "ours"),
      k("sim.sonar_max_m", 0.5, 20, AT(sim.sensors.sonar_max), "range of the sonar",
        "Li18 code: 5"),
      k("sim.baro_noise_m", 0, 5, AT(sim.sensors.baro_noise), "noise of the barometer", "ours"),
      k("sim.baro_drift_m", 0, 5, AT(sim.sensors.baro_drift),
        "random walk of the barometer in 10 s", "ours"),
      k("sim.baro_airspeed", 0, 1, AT(sim.sensors.baro_airspeed),
        "part of the dynamic pressure that the barometer takes for height", "ours"),
      k("sim.warming_time_s", 1, 3600, AT(sim.sensors.warming_time),
        "time constant with which the IMU warms up", "ours"),
      k("sim.gust_length_m", 0.05, 500, AT(sim.wind.gust_length), "length of the gusts",
        "ours: a hall"),
      k("sim.gust_vertical", 0, 2, AT(sim.wind.gust_vertical),
        "vertical / horizontal standard deviation of the gusts", "ours"),
      k("sim.battery_capacity_ah", 0.05, 100, AT(sim.vehicle.battery.capacity),
        "charge of the battery", "Bebop: 1.2", 3600.0),
      k("sim.battery_full_v", 1, 100, AT(sim.vehicle.battery.full),
        "open-circuit voltage when it is full", "three cells"),
      k("sim.battery_empty_v", 1, 100, AT(sim.vehicle.battery.empty), "and when it is empty",
        "three cells"),
      k("sim.battery_resistance_ohm", 0, 10, AT(sim.vehicle.battery.resistance),
        "its inner resistance", "ours: 20 mOhm a cell"),
      k("sim.hover_power_w", 1, 10000, AT(sim.vehicle.battery.hover_power),
        "power of the rotors at hover", "Bebop: 11 minutes"),
      k("sim.electronics_power_w", 0, 1000, AT(sim.vehicle.battery.electronics),
        "power of everything else", "ours"),
  };
}

}  // namespace gatefly::config

#undef AT
