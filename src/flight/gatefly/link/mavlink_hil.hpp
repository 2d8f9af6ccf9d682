// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <tuple>

#include "gatefly/link/layout.hpp"

// Messages between a simulator and PX4 (hardware in the loop).
// Fields have the names and the order of MAVLink's definitions (common.xml): the checksum is made of them.

namespace gatefly::mavlink {

struct HilActuatorControls {
  static constexpr std::uint32_t kId = 93;
  static constexpr std::string_view kName = "HIL_ACTUATOR_CONTROLS";
  std::uint64_t time_usec = 0, flags = 0;
  std::array<float, 16> controls{};
  std::uint8_t mode = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_usec", m.time_usec, "µs");
    visit("flags", m.flags, "");
    visit("controls", m.controls, "motors 0 … 1");
    visit("mode", m.mode, "bits; 128: armed");
  }
};

struct HilSensor {
  static constexpr std::uint32_t kId = 107;
  static constexpr std::string_view kName = "HIL_SENSOR";
  std::uint64_t time_usec = 0;
  float xacc = 0, yacc = 0, zacc = 0, xgyro = 0, ygyro = 0, zgyro = 0, xmag = 0, ymag = 0, zmag = 0,
        abs_pressure = 0, diff_pressure = 0, pressure_alt = 0, temperature = 0;
  std::uint32_t fields_updated = 0;
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
    visit("fields_updated", m.fields_updated, "bits of what is new; 0x1FFF all");
    visit.later();
    visit("id", m.id, "");
  }
};

struct HilGps {
  static constexpr std::uint32_t kId = 113;
  static constexpr std::string_view kName = "HIL_GPS";
  std::uint64_t time_usec = 0;
  std::int32_t lat = 0, lon = 0, alt = 0;
  std::uint16_t eph = 0, epv = 0, vel = 0;
  std::int16_t vn = 0, ve = 0, vd = 0;
  std::uint16_t cog = 0;
  std::uint8_t fix_type = 0, satellites_visible = 0, id = 0;
  std::uint16_t yaw = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("time_usec", m.time_usec, "µs");
    visit("lat", m.lat, "1e-7 °");
    visit("lon", m.lon, "1e-7 °");
    visit("alt", m.alt, "mm");
    visit("eph", m.eph, "");
    visit("epv", m.epv, "");
    visit("vel", m.vel, "cm/s");
    visit("vn", m.vn, "cm/s, north");
    visit("ve", m.ve, "cm/s, east");
    visit("vd", m.vd, "cm/s, down");
    visit("cog", m.cog, "0.01°, course over ground");
    visit("fix_type", m.fix_type, "");
    visit("satellites_visible", m.satellites_visible, "");
    visit.later();
    visit("id", m.id, "");
    visit("yaw", m.yaw, "0.01°, of the vehicle; 0 none");
  }
};

/// All of this file.
using HardwareInLoop = std::tuple<HilActuatorControls, HilSensor, HilGps>;

}  // namespace gatefly::mavlink
