// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/hand_over_mark.hpp"

#include <cstdint>
#include <sstream>
#include <string_view>

#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"
#include "gatefly/files/xxh64.hpp"

namespace gatefly::live {
namespace {

constexpr std::string_view kTestTable = "[hand_over_test]";

/// All constants as text, in one order.
std::string constants_of(const DroneFile& d) {
  std::string all = d.name + "|" + d.board;
  const auto add = [&all](double value) { all += "|" + files::text_of(value); };
  const msp::RcTuning& t = d.tuning;
  for (const double value :
       {double(d.api_minor), d.imu.gyro_counts_per_deg_per_s, d.imu.accel_counts_per_g,
        double(t.rates_type), double(t.roll_rc_rate), double(t.pitch_rc_rate),
        double(t.yaw_rc_rate), double(t.roll_expo), double(t.pitch_expo), double(t.yaw_expo),
        double(t.throttle_mid), double(t.throttle_expo), double(d.receiver.mid),
        double(d.receiver.min_check), double(d.deadband.roll_and_pitch), double(d.deadband.yaw),
        double(d.hover_stick), d.hover.exponent, d.least_battery_v})
    add(value);
  for (std::size_t i = 0; i < 3; ++i) add(t.super_rate[i]), add(t.rate_limit[i]);
  for (std::size_t i = 0; i < 4; ++i) add(d.map.place[i]);
  if (d.px4) {
    const Px4Drone& p = *d.px4;
    all += "|PX4|" + p.version;
    for (const double value :
         {double(p.system), p.offboard_timeout_s, double(p.offboard_loss), p.hover, p.model_factor})
      add(value);
  }
  if (!d.ardu) return all;
  const ArduDrone& a = *d.ardu;
  all += "|" + a.version;
  for (const double value : {double(a.system), double(a.guided_options), a.guided_timeout_s,
                             a.hover, a.expo, a.spin_min, a.spin_max, double(a.angle_boost)})
    add(value);
  return all;
}

}  // namespace

bool hand_over_tested(const DroneFile& drone, const std::string& program) {
  return drone.ts002 || (!drone.tested.empty() && drone.tested == hand_over_mark(drone, program));
}

std::string hand_over_mark(const DroneFile& drone, const std::string& program) {
  const std::string all = constants_of(drone) + "|" + program;
  return files::text_of_xxh64(
      files::xxh64({reinterpret_cast<const std::uint8_t*>(all.data()), all.size()}));
}

std::string with_hand_over_mark(const DroneFile& drone, const std::string& text,
                                const std::string& mark) {
  std::istringstream lines{text};
  std::string kept;
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first != std::string::npos && line[first] == '[')
      inside = line.compare(first, kTestTable.size(), kTestTable) == 0;
    if (!inside) kept += line + "\n";
  }
  while (kept.ends_with("\n\n")) kept.pop_back();
  const files::TomlFile left(drone.path, kept);
  if (left.content().contains("hand_over_test"))
    files::Table{left}.fail("hand_over_test", "written as a table: " + std::string{kTestTable});
  if (mark.empty()) return kept;
  return kept + "\n" + std::string{kTestTable} + "\npassed = \"" + mark + "\"\n";
}

std::string program_mark(const std::filesystem::path& program) {
  const std::string bytes = files::read_file(program, std::uintmax_t{1} << 30);
  return files::text_of_xxh64(
      files::xxh64({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}));
}

}  // namespace gatefly::live
