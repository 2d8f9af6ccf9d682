// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <tuple>

#include "gatefly/link/layout.hpp"

// Messages by which autopilots are commanded and asked, and their answers.
// Fields have the names and the order of MAVLink's definitions (common.xml): the checksum is made of them.

namespace gatefly::mavlink {

struct ParamRequestRead {
  static constexpr std::uint32_t kId = 20;
  static constexpr std::string_view kName = "PARAM_REQUEST_READ";
  std::int16_t param_index = 0;
  std::uint8_t target_system = 0, target_component = 0;
  std::array<char, 16> param_id{};
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("param_index", m.param_index, "-1: by name");
    visit("target_system", m.target_system, "");
    visit("target_component", m.target_component, "");
    visit("param_id", m.param_id, "zeros behind its end");
  }
};

struct ParamValue {
  static constexpr std::uint32_t kId = 22;
  static constexpr std::string_view kName = "PARAM_VALUE";
  float param_value = 0;
  std::uint16_t param_count = 0, param_index = 0;
  std::array<char, 16> param_id{};
  std::uint8_t param_type = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("param_value", m.param_value, "");
    visit("param_count", m.param_count, "");
    visit("param_index", m.param_index, "");
    visit("param_id", m.param_id, "zeros behind its end");
    visit("param_type", m.param_type, "9 float");
  }
};

struct ParamSet {
  static constexpr std::uint32_t kId = 23;
  static constexpr std::string_view kName = "PARAM_SET";
  float param_value = 0;
  std::uint8_t target_system = 0, target_component = 0;
  std::array<char, 16> param_id{};
  std::uint8_t param_type = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("param_value", m.param_value, "");
    visit("target_system", m.target_system, "");
    visit("target_component", m.target_component, "");
    visit("param_id", m.param_id, "zeros behind its end");
    visit("param_type", m.param_type, "9 float");
  }
};

struct CommandLong {
  static constexpr std::uint32_t kId = 76;
  static constexpr std::string_view kName = "COMMAND_LONG";
  float param1 = 0, param2 = 0, param3 = 0, param4 = 0, param5 = 0, param6 = 0, param7 = 0;
  std::uint16_t command = 0;
  std::uint8_t target_system = 0, target_component = 0, confirmation = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("param1", m.param1, "");
    visit("param2", m.param2, "");
    visit("param3", m.param3, "");
    visit("param4", m.param4, "");
    visit("param5", m.param5, "");
    visit("param6", m.param6, "");
    visit("param7", m.param7, "");
    visit("command", m.command, "176 set mode, 400 arm");
    visit("target_system", m.target_system, "");
    visit("target_component", m.target_component, "");
    visit("confirmation", m.confirmation, "");
  }
};

struct CommandAck {
  static constexpr std::uint32_t kId = 77;
  static constexpr std::string_view kName = "COMMAND_ACK";
  std::uint16_t command = 0;
  std::uint8_t result = 0, progress = 0;
  std::int32_t result_param2 = 0;
  std::uint8_t target_system = 0, target_component = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("command", m.command, "");
    visit("result", m.result, "0 done, 1 not now, 2 refused, 3 unknown, 4 failed, 5 in progress");
    visit.later();
    visit("progress", m.progress, "%");
    visit("result_param2", m.result_param2, "");
    visit("target_system", m.target_system, "");
    visit("target_component", m.target_component, "");
  }
};

struct SetAttitudeTarget {
  static constexpr std::uint32_t kId = 82;
  static constexpr std::string_view kName = "SET_ATTITUDE_TARGET";
  std::uint32_t time_boot_ms = 0;
  std::array<float, 4> q{};
  float body_roll_rate = 0, body_pitch_rate = 0, body_yaw_rate = 0, thrust = 0;
  std::uint8_t target_system = 0, target_component = 0, type_mask = 0;
  std::array<float, 3> thrust_body{};
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_boot_ms", m.time_boot_ms, "ms");
    visit("q", m.q, "w, x, y, z: body (front, right, down) to north, east, down");
    visit("body_roll_rate", m.body_roll_rate, "rad/s, right side down");
    visit("body_pitch_rate", m.body_pitch_rate, "rad/s, nose **up**");
    visit("body_yaw_rate", m.body_yaw_rate, "rad/s, nose right");
    visit("thrust", m.thrust, "0 … 1");
    visit("target_system", m.target_system, "");
    visit("target_component", m.target_component, "");
    visit("type_mask", m.type_mask,
          "bits of what to ignore: 1, 2, 4 rates, 64 thrust, 128 attitude");
    visit.later();
    visit("thrust_body", m.thrust_body, "");
  }
};

struct SetPositionTargetLocalNed {
  static constexpr std::uint32_t kId = 84;
  static constexpr std::string_view kName = "SET_POSITION_TARGET_LOCAL_NED";
  std::uint32_t time_boot_ms = 0;
  float x = 0, y = 0, z = 0, vx = 0, vy = 0, vz = 0, afx = 0, afy = 0, afz = 0, yaw = 0,
        yaw_rate = 0;
  std::uint16_t type_mask = 0;
  std::uint8_t target_system = 0, target_component = 0, coordinate_frame = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_boot_ms", m.time_boot_ms, "ms");
    visit("x", m.x, "m, north");
    visit("y", m.y, "m, east");
    visit("z", m.z, "m, **down**");
    visit("vx", m.vx, "m/s, north");
    visit("vy", m.vy, "m/s, east");
    visit("vz", m.vz, "m/s, **down**");
    visit("afx", m.afx, "m/s², north");
    visit("afy", m.afy, "m/s², east");
    visit("afz", m.afz, "m/s², **down**");
    visit("yaw", m.yaw, "rad, nose right");
    visit("yaw_rate", m.yaw_rate, "rad/s, nose right");
    visit("type_mask", m.type_mask,
          "bits of what to ignore: 7 position, 56 velocity, 448 acceleration, 1024 yaw, 2048 its "
          "rate");
    visit("target_system", m.target_system, "");
    visit("target_component", m.target_component, "");
    visit("coordinate_frame", m.coordinate_frame, "1 earth, 8 body");
  }
};

struct Timesync {
  static constexpr std::uint32_t kId = 111;
  static constexpr std::string_view kName = "TIMESYNC";
  std::int64_t tc1 = 0, ts1 = 0;
  std::uint8_t target_system = 0, target_component = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("tc1", m.tc1,
          "ns, 0: a question; else when it was answered, by the clock of who answers");
    visit("ts1", m.ts1, "ns, when the question was sent, by the clock of who asked");
    visit.later();
    visit("target_system", m.target_system, "");
    visit("target_component", m.target_component, "");
  }
};

/// All of this file.
using Commands = std::tuple<ParamRequestRead, ParamValue, ParamSet, CommandLong, CommandAck,
                            SetAttitudeTarget, SetPositionTargetLocalNed, Timesync>;

}  // namespace gatefly::mavlink
