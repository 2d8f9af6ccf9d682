// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <tuple>

#include "gatefly/link/layout.hpp"

// MSP's messages of fixed layout, as Betaflight 4.4 (API 1.45) sends them; what later versions append
// is left unread. The numbers are the wire's: msp_axes.hpp makes SI and our axes of them.

namespace gatefly::msp {

struct ApiVersion {
  static constexpr std::uint16_t kId = 1;
  static constexpr std::string_view kName = "MSP_API_VERSION";
  std::uint8_t protocol = 0, major = 0, minor = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("protocol", m.protocol, "");
    visit("major", m.major, "1");
    visit("minor", m.minor, "45 of Betaflight 4.4");
  }
};

struct FcVariant {
  static constexpr std::uint16_t kId = 2;
  static constexpr std::string_view kName = "MSP_FC_VARIANT";
  std::array<char, 4> name{};
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("name", m.name, "`BTFL`: Betaflight");
  }
};

struct FcVersion {
  static constexpr std::uint16_t kId = 3;
  static constexpr std::string_view kName = "MSP_FC_VERSION";
  std::uint8_t major = 0, minor = 0, patch = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("major", m.major, "the year less 2000 from 2025 on");
    visit("minor", m.minor, "");
    visit("patch", m.patch, "");
  }
};

struct RxConfig {
  static constexpr std::uint16_t kId = 44;
  static constexpr std::string_view kName = "MSP_RX_CONFIG";
  std::uint8_t serial_provider = 0;
  std::uint16_t max_check = 0, mid = 0, min_check = 0;
  std::uint8_t spektrum_bind = 0;
  std::uint16_t least_pulse = 0, longest_pulse = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("serial_provider", m.serial_provider, "");
    visit("max_check", m.max_check, "µs");
    visit("mid", m.mid, "µs: a centred stick");
    visit("min_check", m.min_check, "µs: the throttle is zero up to here");
    visit("spektrum_bind", m.spektrum_bind, "");
    visit("least_pulse", m.least_pulse, "µs: shorter is no signal");
    visit("longest_pulse", m.longest_pulse, "µs: longer is no signal");
  }
};

struct RxMap {
  static constexpr std::uint16_t kId = 64;
  static constexpr std::string_view kName = "MSP_RX_MAP";
  std::array<std::uint8_t, 8> place{};
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("place", m.place,
          "of roll, pitch, yaw, throttle, AUX1 …: which number of `MSP_SET_RAW_RC` it is; 0 1 3 2 "
          "as a rule");
  }
};

struct RawImu {
  static constexpr std::uint16_t kId = 102;
  static constexpr std::string_view kName = "MSP_RAW_IMU";
  std::array<std::int16_t, 3> accel{}, gyro{}, mag{};
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("accel", m.accel,
          "specific force to front, left, up, in counts: 512 are 1 g, to be checked at rest");
    visit("gyro", m.gyro,
          "about front, left, up, in counts of 1/16.384 °/s: right side down, nose **down**, nose "
          "**left**");
    visit("mag", m.mag, "");
  }
};

struct Attitude {
  static constexpr std::uint16_t kId = 108;
  static constexpr std::string_view kName = "MSP_ATTITUDE";
  std::int16_t roll = 0, pitch = 0, yaw = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("roll", m.roll, "0.1°, right side down");
    visit("pitch", m.pitch, "0.1°, nose **down**");
    visit("yaw", m.yaw, "whole degrees, nose right");
  }
};

struct Altitude {
  static constexpr std::uint16_t kId = 109;
  static constexpr std::string_view kName = "MSP_ALTITUDE";
  std::int32_t height = 0;
  std::int16_t climb = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("height", m.height, "cm, up; metres off while propellers turn");
    visit("climb", m.climb, "cm/s, up");
  }
};

struct Analog {
  static constexpr std::uint16_t kId = 110;
  static constexpr std::string_view kName = "MSP_ANALOG";
  std::uint8_t coarse_voltage = 0;
  std::uint16_t drawn = 0, rssi = 0;
  std::int16_t current = 0;
  std::uint16_t voltage = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("coarse_voltage", m.coarse_voltage, "0.1 V");
    visit("drawn", m.drawn, "mAh");
    visit("rssi", m.rssi, "0 … 1023");
    visit("current", m.current, "0.01 A");
    visit("voltage", m.voltage, "0.01 V");
  }
};

struct RcTuning {
  static constexpr std::uint16_t kId = 111;
  static constexpr std::string_view kName = "MSP_RC_TUNING";
  std::uint8_t roll_rc_rate = 0, roll_expo = 0;
  std::array<std::uint8_t, 3> super_rate{};
  std::uint8_t tpa_rate = 0, throttle_mid = 0, throttle_expo = 0;
  std::uint16_t tpa_breakpoint = 0;
  std::uint8_t yaw_expo = 0, yaw_rc_rate = 0, pitch_rc_rate = 0, pitch_expo = 0;
  std::uint8_t throttle_limit = 0, throttle_limit_percent = 0;
  std::array<std::uint16_t, 3> rate_limit{};
  std::uint8_t rates_type = 0;
  std::uint8_t throttle_hover = kNoHover;
  /// Value of throttle_hover before API 1.47, which has no such field.
  static constexpr std::uint8_t kNoHover = 255;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("roll_rc_rate", m.roll_rc_rate, "%");
    visit("roll_expo", m.roll_expo, "%");
    visit("super_rate", m.super_rate, "% of roll, pitch, yaw");
    visit("tpa_rate", m.tpa_rate, "no longer used");
    visit("throttle_mid", m.throttle_mid, "%");
    visit("throttle_expo", m.throttle_expo, "%");
    visit("tpa_breakpoint", m.tpa_breakpoint, "no longer used");
    visit("yaw_expo", m.yaw_expo, "%");
    visit("yaw_rc_rate", m.yaw_rc_rate, "%");
    visit("pitch_rc_rate", m.pitch_rc_rate, "%");
    visit("pitch_expo", m.pitch_expo, "%");
    visit("throttle_limit", m.throttle_limit, "0 none, 1 scaled, 2 clipped");
    visit("throttle_limit_percent", m.throttle_limit_percent, "%");
    visit("rate_limit", m.rate_limit, "°/s of roll, pitch, yaw");
    visit("rates_type", m.rates_type, "0 Betaflight, 1 RaceFlight, 2 KISS, 3 Actual, 4 Quick");
    visit.later();
    visit("throttle_hover", m.throttle_hover, "%; from API 1.47 on, with another throttle curve");
  }
};

struct RcDeadband {
  static constexpr std::uint16_t kId = 125;
  static constexpr std::string_view kName = "MSP_RC_DEADBAND";
  std::uint8_t roll_and_pitch = 0, yaw = 0, altitude_hold = 0;
  std::uint16_t throttle_3d = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("roll_and_pitch", m.roll_and_pitch, "µs");
    visit("yaw", m.yaw, "µs");
    visit("altitude_hold", m.altitude_hold, "µs");
    visit("throttle_3d", m.throttle_3d, "µs");
  }
};

struct BatteryState {
  static constexpr std::uint16_t kId = 130;
  static constexpr std::string_view kName = "MSP_BATTERY_STATE";
  std::uint8_t cells = 0;
  std::uint16_t capacity = 0;
  std::uint8_t coarse_voltage = 0;
  std::uint16_t drawn = 0;
  std::int16_t current = 0;
  std::uint8_t state = 0;
  std::uint16_t voltage = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("cells", m.cells, "0: no battery was found");
    visit("capacity", m.capacity, "mAh");
    visit("coarse_voltage", m.coarse_voltage, "0.1 V");
    visit("drawn", m.drawn, "mAh");
    visit("current", m.current, "0.01 A");
    visit("state", m.state, "0 well, 1 low, 2 critical, 3 none, 4 not known yet");
    visit("voltage", m.voltage, "0.01 V");
  }
};

/// Every message of fixed layout; the tables of docs/link.md are printed from it.
using Messages = std::tuple<ApiVersion, FcVariant, FcVersion, RxConfig, RxMap, RawImu, Attitude,
                            Altitude, Analog, RcTuning, RcDeadband, BatteryState>;

}  // namespace gatefly::msp
