// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <tuple>

#include "gatefly/link/layout.hpp"

// Messages that autopilots send of themselves (telemetry).
// Fields have the names and the order of MAVLink's definitions (common.xml): the checksum is made of them.

namespace gatefly::mavlink {

struct Heartbeat {
  static constexpr std::uint32_t kId = 0;
  static constexpr std::string_view kName = "HEARTBEAT";
  static constexpr std::uint8_t kArduPilot = 3, kPx4 = 12;  ///< Values of `autopilot`.
  static constexpr std::uint8_t kArmedBit = 128;            ///< A bit of `base_mode`.
  std::uint32_t custom_mode = 0;
  std::uint8_t type = 0, autopilot = 0, base_mode = 0, system_status = 0, mavlink_version = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("custom_mode", m.custom_mode, "");
    visit("type", m.type, "2 quadrotor, 18 companion");
    visit("autopilot", m.autopilot, "3 ArduPilot, 12 PX4, 8 none");
    visit("base_mode", m.base_mode, "bits; 128: armed");
    visit("system_status", m.system_status, "3 standby, 4 active, 5 critical, 6 emergency");
    visit("mavlink_version", m.mavlink_version, "3");
  }
  [[nodiscard]] constexpr bool is_armed() const { return (base_mode & kArmedBit) != 0; }
};

struct SysStatus {
  static constexpr std::uint32_t kId = 1;
  static constexpr std::string_view kName = "SYS_STATUS";
  std::uint32_t onboard_control_sensors_present = 0, onboard_control_sensors_enabled = 0,
                onboard_control_sensors_health = 0;
  std::uint16_t load = 0, voltage_battery = 0;
  std::int16_t current_battery = 0;
  std::uint16_t drop_rate_comm = 0, errors_comm = 0, errors_count1 = 0, errors_count2 = 0,
                errors_count3 = 0, errors_count4 = 0;
  std::int8_t battery_remaining = 0;
  std::uint32_t onboard_control_sensors_present_extended = 0,
                onboard_control_sensors_enabled_extended = 0,
                onboard_control_sensors_health_extended = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("onboard_control_sensors_present", m.onboard_control_sensors_present, "");
    visit("onboard_control_sensors_enabled", m.onboard_control_sensors_enabled, "");
    visit("onboard_control_sensors_health", m.onboard_control_sensors_health, "");
    visit("load", m.load, "0.1 %");
    visit("voltage_battery", m.voltage_battery, "mV");
    visit("current_battery", m.current_battery, "0.01 A");
    visit("drop_rate_comm", m.drop_rate_comm, "0.01 %");
    visit("errors_comm", m.errors_comm, "");
    visit("errors_count1", m.errors_count1, "");
    visit("errors_count2", m.errors_count2, "");
    visit("errors_count3", m.errors_count3, "");
    visit("errors_count4", m.errors_count4, "");
    visit("battery_remaining", m.battery_remaining, "%");
    visit.later();
    visit("onboard_control_sensors_present_extended", m.onboard_control_sensors_present_extended,
          "");
    visit("onboard_control_sensors_enabled_extended", m.onboard_control_sensors_enabled_extended,
          "");
    visit("onboard_control_sensors_health_extended", m.onboard_control_sensors_health_extended, "");
  }
};

struct ScaledImu {
  static constexpr std::uint32_t kId = 26;
  static constexpr std::string_view kName = "SCALED_IMU";
  std::uint32_t time_boot_ms = 0;
  std::int16_t xacc = 0, yacc = 0, zacc = 0, xgyro = 0, ygyro = 0, zgyro = 0, xmag = 0, ymag = 0,
               zmag = 0, temperature = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_boot_ms", m.time_boot_ms, "ms");
    visit("xacc", m.xacc, "mg, specific force to front");
    visit("yacc", m.yacc, "mg, to right");
    visit("zacc", m.zacc, "mg, **down**: −1000 at rest");
    visit("xgyro", m.xgyro, "mrad/s, right side down");
    visit("ygyro", m.ygyro, "mrad/s, nose **up**");
    visit("zgyro", m.zgyro, "mrad/s, nose right");
    visit("xmag", m.xmag, "mgauss");
    visit("ymag", m.ymag, "mgauss");
    visit("zmag", m.zmag, "mgauss");
    visit.later();
    visit("temperature", m.temperature, "0.01 °C");
  }
};

struct RawImu {
  static constexpr std::uint32_t kId = 27;
  static constexpr std::string_view kName = "RAW_IMU";
  std::uint64_t time_usec = 0;
  std::int16_t xacc = 0, yacc = 0, zacc = 0, xgyro = 0, ygyro = 0, zgyro = 0, xmag = 0, ymag = 0,
               zmag = 0;
  std::uint8_t id = 0;
  std::int16_t temperature = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_usec", m.time_usec, "µs");
    visit("xacc", m.xacc, "counts, specific force to front");
    visit("yacc", m.yacc, "counts, to right");
    visit("zacc", m.zacc, "counts, **down**");
    visit("xgyro", m.xgyro, "counts, right side down");
    visit("ygyro", m.ygyro, "counts, nose **up**");
    visit("zgyro", m.zgyro, "counts, nose right");
    visit("xmag", m.xmag, "");
    visit("ymag", m.ymag, "");
    visit("zmag", m.zmag, "");
    visit.later();
    visit("id", m.id, "");
    visit("temperature", m.temperature, "0.01 °C");
  }
};

struct Attitude {
  static constexpr std::uint32_t kId = 30;
  static constexpr std::string_view kName = "ATTITUDE";
  std::uint32_t time_boot_ms = 0;
  float roll = 0, pitch = 0, yaw = 0, rollspeed = 0, pitchspeed = 0, yawspeed = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_boot_ms", m.time_boot_ms, "ms");
    visit("roll", m.roll, "rad, right side down");
    visit("pitch", m.pitch, "rad, nose **up**");
    visit("yaw", m.yaw, "rad, nose right");
    visit("rollspeed", m.rollspeed, "rad/s, right side down");
    visit("pitchspeed", m.pitchspeed, "rad/s, nose **up**");
    visit("yawspeed", m.yawspeed, "rad/s, nose right");
  }
};

struct AttitudeQuaternion {
  static constexpr std::uint32_t kId = 31;
  static constexpr std::string_view kName = "ATTITUDE_QUATERNION";
  std::uint32_t time_boot_ms = 0;
  float q1 = 0, q2 = 0, q3 = 0, q4 = 0, rollspeed = 0, pitchspeed = 0, yawspeed = 0;
  std::array<float, 4> repr_offset_q{};
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_boot_ms", m.time_boot_ms, "ms");
    visit("q1", m.q1, "w of body to north, east, down");
    visit("q2", m.q2, "x");
    visit("q3", m.q3, "y");
    visit("q4", m.q4, "z");
    visit("rollspeed", m.rollspeed, "rad/s, right side down");
    visit("pitchspeed", m.pitchspeed, "rad/s, nose **up**");
    visit("yawspeed", m.yawspeed, "rad/s, nose right");
    visit.later();
    visit("repr_offset_q", m.repr_offset_q, "");
  }
};

struct LocalPositionNed {
  static constexpr std::uint32_t kId = 32;
  static constexpr std::string_view kName = "LOCAL_POSITION_NED";
  std::uint32_t time_boot_ms = 0;
  float x = 0, y = 0, z = 0, vx = 0, vy = 0, vz = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_boot_ms", m.time_boot_ms, "ms");
    visit("x", m.x, "m, north");
    visit("y", m.y, "m, east");
    visit("z", m.z, "m, **down**");
    visit("vx", m.vx, "m/s, north");
    visit("vy", m.vy, "m/s, east");
    visit("vz", m.vz, "m/s, **down**");
  }
};

struct AttitudeTarget {
  static constexpr std::uint32_t kId = 83;
  static constexpr std::string_view kName = "ATTITUDE_TARGET";
  std::uint32_t time_boot_ms = 0;
  std::array<float, 4> q{};
  float body_roll_rate = 0, body_pitch_rate = 0, body_yaw_rate = 0, thrust = 0;
  std::uint8_t type_mask = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_boot_ms", m.time_boot_ms, "ms");
    visit("q", m.q, "w, x, y, z: body (front, right, down) to north, east, down");
    visit("body_roll_rate", m.body_roll_rate, "rad/s, right side down");
    visit("body_pitch_rate", m.body_pitch_rate, "rad/s, nose **up**");
    visit("body_yaw_rate", m.body_yaw_rate, "rad/s, nose right");
    visit("thrust", m.thrust, "0 … 1");
    visit("type_mask", m.type_mask, "bits of what is ignored");
  }
};

struct HighresImu {
  static constexpr std::uint32_t kId = 105;
  static constexpr std::string_view kName = "HIGHRES_IMU";
  std::uint64_t time_usec = 0;
  float xacc = 0, yacc = 0, zacc = 0, xgyro = 0, ygyro = 0, zgyro = 0, xmag = 0, ymag = 0, zmag = 0,
        abs_pressure = 0, diff_pressure = 0, pressure_alt = 0, temperature = 0;
  std::uint16_t fields_updated = 0;
  std::uint8_t id = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_usec", m.time_usec, "µs");
    visit("xacc", m.xacc, "m/s², specific force to front");
    visit("yacc", m.yacc, "m/s², to right");
    visit("zacc", m.zacc, "m/s², **down**: −9.81 m/s² at rest");
    visit("xgyro", m.xgyro, "rad/s, right side down");
    visit("ygyro", m.ygyro, "rad/s, nose **up**");
    visit("zgyro", m.zgyro, "rad/s, nose right");
    visit("xmag", m.xmag, "gauss");
    visit("ymag", m.ymag, "gauss");
    visit("zmag", m.zmag, "gauss");
    visit("abs_pressure", m.abs_pressure, "hPa");
    visit("diff_pressure", m.diff_pressure, "hPa");
    visit("pressure_alt", m.pressure_alt, "");
    visit("temperature", m.temperature, "°C");
    visit("fields_updated", m.fields_updated, "bits of what is new");
    visit.later();
    visit("id", m.id, "");
  }
};

struct DistanceSensor {
  static constexpr std::uint32_t kId = 132;
  static constexpr std::string_view kName = "DISTANCE_SENSOR";
  std::uint32_t time_boot_ms = 0;
  std::uint16_t min_distance = 0, max_distance = 0, current_distance = 0;
  std::uint8_t type = 0, id = 0, orientation = 0, covariance = 0;
  float horizontal_fov = 0, vertical_fov = 0;
  std::array<float, 4> quaternion{};
  std::uint8_t signal_quality = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_boot_ms", m.time_boot_ms, "ms");
    visit("min_distance", m.min_distance, "cm");
    visit("max_distance", m.max_distance, "cm");
    visit("current_distance", m.current_distance, "cm, the range");
    visit("type", m.type, "");
    visit("id", m.id, "");
    visit("orientation", m.orientation, "25 downwards");
    visit("covariance", m.covariance, "cm²");
    visit.later();
    visit("horizontal_fov", m.horizontal_fov, "rad");
    visit("vertical_fov", m.vertical_fov, "rad");
    visit("quaternion", m.quaternion, "");
    visit("signal_quality", m.signal_quality, "%");
  }
};

struct Altitude {
  static constexpr std::uint32_t kId = 141;
  static constexpr std::string_view kName = "ALTITUDE";
  std::uint64_t time_usec = 0;
  float altitude_monotonic = 0, altitude_amsl = 0, altitude_local = 0, altitude_relative = 0,
        altitude_terrain = 0, bottom_clearance = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_usec", m.time_usec, "µs");
    visit("altitude_monotonic", m.altitude_monotonic, "m");
    visit("altitude_amsl", m.altitude_amsl, "m");
    visit("altitude_local", m.altitude_local, "m");
    visit("altitude_relative", m.altitude_relative, "m");
    visit("altitude_terrain", m.altitude_terrain, "m");
    visit("bottom_clearance", m.bottom_clearance, "m");
  }
};

struct BatteryStatus {
  static constexpr std::uint32_t kId = 147;
  static constexpr std::string_view kName = "BATTERY_STATUS";
  std::int32_t current_consumed = 0, energy_consumed = 0;
  std::int16_t temperature = 0;
  std::array<std::uint16_t, 10> voltages{};
  std::int16_t current_battery = 0;
  std::uint8_t id = 0, battery_function = 0, type = 0;
  std::int8_t battery_remaining = 0;
  std::int32_t time_remaining = 0;
  std::uint8_t charge_state = 0;
  std::array<std::uint16_t, 4> voltages_ext{};
  std::uint8_t mode = 0;
  std::uint32_t fault_bitmask = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("current_consumed", m.current_consumed, "mAh");
    visit("energy_consumed", m.energy_consumed, "100 J");
    visit("temperature", m.temperature, "0.01 °C");
    visit("voltages", m.voltages, "mV");
    visit("current_battery", m.current_battery, "0.01 A");
    visit("id", m.id, "");
    visit("battery_function", m.battery_function, "");
    visit("type", m.type, "");
    visit("battery_remaining", m.battery_remaining, "%");
    visit.later();
    visit("time_remaining", m.time_remaining, "s");
    visit("charge_state", m.charge_state, "");
    visit("voltages_ext", m.voltages_ext, "mV");
    visit("mode", m.mode, "");
    visit("fault_bitmask", m.fault_bitmask, "");
  }
};

struct AutopilotVersion {
  static constexpr std::uint32_t kId = 148;
  static constexpr std::string_view kName = "AUTOPILOT_VERSION";
  std::uint64_t capabilities = 0, uid = 0;
  std::uint32_t flight_sw_version = 0, middleware_sw_version = 0, os_sw_version = 0,
                board_version = 0;
  std::uint16_t vendor_id = 0, product_id = 0;
  std::array<std::uint8_t, 8> flight_custom_version{}, middleware_custom_version{},
      os_custom_version{};
  std::array<std::uint8_t, 18> uid2{};
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("capabilities", m.capabilities, "bits");
    visit("uid", m.uid, "");
    visit("flight_sw_version", m.flight_sw_version,
          "major, minor, patch, kind: a byte each, the highest first");
    visit("middleware_sw_version", m.middleware_sw_version, "");
    visit("os_sw_version", m.os_sw_version, "");
    visit("board_version", m.board_version, "");
    visit("vendor_id", m.vendor_id, "");
    visit("product_id", m.product_id, "");
    visit("flight_custom_version", m.flight_custom_version, "");
    visit("middleware_custom_version", m.middleware_custom_version, "");
    visit("os_custom_version", m.os_custom_version, "");
    visit.later();
    visit("uid2", m.uid2, "");
  }
};

struct Statustext {
  static constexpr std::uint32_t kId = 253;
  static constexpr std::string_view kName = "STATUSTEXT";
  std::uint8_t severity = 0;
  std::array<char, 50> text{};
  std::uint16_t id = 0;
  std::uint8_t chunk_seq = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("severity", m.severity, "0 worst … 7");
    visit("text", m.text, "");
    visit.later();
    visit("id", m.id, "");
    visit("chunk_seq", m.chunk_seq, "");
  }
};

struct Odometry {
  static constexpr std::uint32_t kId = 331;
  static constexpr std::string_view kName = "ODOMETRY";
  std::uint64_t time_usec = 0;
  float x = 0, y = 0, z = 0;
  std::array<float, 4> q{};
  float vx = 0, vy = 0, vz = 0, rollspeed = 0, pitchspeed = 0, yawspeed = 0;
  std::array<float, 21> pose_covariance{}, velocity_covariance{};
  std::uint8_t frame_id = 0, child_frame_id = 0, reset_counter = 0, estimator_type = 0;
  std::int8_t quality = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_usec", m.time_usec, "µs");
    visit("x", m.x, "m, in frame_id");
    visit("y", m.y, "m, in frame_id");
    visit("z", m.z, "m, in frame_id");
    visit("q", m.q, "w, x, y, z: child_frame_id to frame_id");
    visit("vx", m.vx, "m/s, in child_frame_id");
    visit("vy", m.vy, "m/s, in child_frame_id");
    visit("vz", m.vz, "m/s, in child_frame_id");
    visit("rollspeed", m.rollspeed, "rad/s, right side down");
    visit("pitchspeed", m.pitchspeed, "rad/s, nose **up**");
    visit("yawspeed", m.yawspeed, "rad/s, nose right");
    visit("pose_covariance", m.pose_covariance, "upper triangle");
    visit("velocity_covariance", m.velocity_covariance, "upper triangle");
    visit("frame_id", m.frame_id, "");
    visit("child_frame_id", m.child_frame_id, "");
    visit.later();
    visit("reset_counter", m.reset_counter, "");
    visit("estimator_type", m.estimator_type, "");
    visit("quality", m.quality, "%");
  }
};

/// All of this file.
using Telemetry = std::tuple<Heartbeat, SysStatus, ScaledImu, RawImu, Attitude, AttitudeQuaternion,
                             LocalPositionNed, AttitudeTarget, HighresImu, DistanceSensor, Altitude,
                             BatteryStatus, AutopilotVersion, Statustext, Odometry>;

}  // namespace gatefly::mavlink
