// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/faults.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"

// The member behind a key, for const and mutable faults alike.
#define AT(member) \
  [](auto& f) -> auto& { return f.member; }

namespace gatefly::config {
namespace {

constexpr double kPercent = 0.01;
constexpr double kLongest = 1e9;  // [s] as good as for ever

template <class Member>
Key<world::Faults> k(const char* name, double low, double high, Member member, const char* what,
                     double unit = 1.0) {
  return key<world::Faults>(std::string{"faults."} + name, low, high, member, what, "no fault",
                            unit);
}

std::vector<Key<world::Faults>> make_keys() {
  return {
      k("camera_drop_percent", 0, 100, AT(camera_drop), "pictures that never arrive", kPercent),
      k("camera_out_s", 0, kLongest, AT(camera_out), "no pictures: from, for how long"),
      k("camera_stuck_s", 0, kLongest, AT(camera_stuck),
        "the last picture again with new stamps: from, for how long"),
      k("camera_delay_ms", -1000, 1000, AT(camera_delay),
        "pictures later than the calibration says; negative: younger, not before read-out's end",
        kMilliseconds),
      k("camera_tilt_deg", -45, 45, AT(camera_tilt), "camera tilted down by so much more", kDegree),
      k("focal_percent", -20, 20, AT(focal), "focal length longer by so much", kPercent),
      k("light_out_s", 0, kLongest, AT(light_out), "all lamps at 2 %: from, for how long"),
      k("hue_deg", -180, 180, AT(hue), "gates of another hue than the configuration's", kDegree),
      k("imu_stuck_s", 0, kLongest, AT(imu_stuck), "the last IMU sample again: from, for how long"),
      k("imu_nan_s", 0, kLongest, AT(imu_nan),
        "IMU samples that are no numbers: from, for how long"),
      k("accel_range_mps2", 1, 78, AT(accel_range), "where the accelerometer saturates"),
      k("gyro_range_degps", 10, 997, AT(gyro_range), "where the gyro saturates", kDegree),
      k("bias_step_at_s", 0, kLongest, AT(bias_step_at), "when the two bias steps happen"),
      k("accel_bias_step_mps2", -20, 20, AT(accel_bias_step), "step of the accelerometer bias"),
      k("gyro_bias_step_degps", -100, 100, AT(gyro_bias_step), "step of the gyro bias", kDegree),
      k("imu_tilt_deg", -45, 45, AT(imu_tilt), "IMU mounted rolled, pitched by this", kDegree),
      k("time_jump_s", -kLongest, kLongest, AT(time_jump), "the clock jumps: when, by how much"),
      k("sonar_drop_percent", 0, 100, AT(sonar_drop), "sonar readings that never arrive", kPercent),
      k("sonar_out_s", 0, kLongest, AT(sonar_out), "no sonar: from, for how long"),
      k("moved_gate", -1, 100, AT(moved_gate),
        "the gate that is not where the map says; 0: none; -1: one that the seed draws"),
      k("gate_moved_m", -20, 20, AT(gate_moved), "by how much: north, east, down"),
      k("gate_aside_m", -20, 20, AT(gate_aside), "and by how much to its own right"),
      k("gate_turned_deg", -180, 180, AT(gate_turned), "and turned clockwise", kDegree),
      k("course_scale_percent", -30, 30, AT(course_scale),
        "all gates so much farther from the pad than the map says; negative: nearer", kPercent),
      k("missing_gate", 0, 100, AT(missing_gate), "the gate that is not there; 0: none"),
      k("hidden_gate", 0, 100, AT(hidden_gate), "the gate that is seen late; 0: none"),
      k("gate_hidden_m", 0, 100, AT(gate_hidden), "not from farther away than this"),
      k("false_gates", 0, 20, AT(false_gates), "gates like the others that are not in the map"),
      k("start_heading_deg", -180, 180, AT(start_heading), "turned clockwise on the pad", kDegree),
      k("hover_thrust_percent", -50, 100, AT(hover_thrust),
        "so much more of the thrust command to hover: rotors give 1 / (1 + this) of their thrust",
        kPercent),
      k("thrust_loss_percent", 0, 100, AT(thrust_loss), "thrust lost", kPercent),
      k("weak_rotor", 0, 4, AT(weak_rotor),
        "by one rotor (front left, front right, back right, back left); 0: by all"),
      k("thrust_loss_s", 0, kLongest, AT(thrust_loss_during), "from, for how long"),
      k("battery_sag_percent", 0, 90, AT(battery_sag),
        "thrust lost to the battery by sim.sag_time_s", kPercent),
      k("wind_mps", -20, 20, AT(wind), "wind towards north, east"),
      k("wind_s", 0, kLongest, AT(wind_during), "from, for how long"),
  };
}

const Key<world::Faults>* find(const std::string& name) {
  const auto& keys = fault_keys();
  const auto found = std::find_if(keys.begin(), keys.end(),
                                  [&](const auto& k) { return k.rule.name == "faults." + name; });
  return found == keys.end() ? nullptr : &*found;
}

}  // namespace

const std::vector<Key<world::Faults>>& fault_keys() {
  static const std::vector<Key<world::Faults>> keys = make_keys();
  return keys;
}

void check_fault(const std::string& key, const nlohmann::json& value, const std::string& where) {
  if (const auto* known = find(key)) {
    (void)checked(known->rule, value, where);
    return;
  }
  std::vector<std::string> names;
  for (const auto& each : fault_keys()) names.push_back(each.rule.name.substr(7));
  throw std::runtime_error(where + ": faults." + files::one_line(key) + " is not a known key" +
                           files::suggestion(key, names));
}

world::Faults with_faults(const world::Faults& base, const nlohmann::json& table,
                          const std::string& where) {
  world::Faults result = base;
  for (const auto& [key, value] : table.items()) {
    check_fault(key, value, where);
    find(key)->set(result, value);
  }
  return result;
}

void expect_gates_of(const world::Faults& faults, std::size_t gates, const std::string& track) {
  for (const auto& [name, number] :
       {std::pair{"moved_gate", faults.moved_gate}, std::pair{"missing_gate", faults.missing_gate},
        std::pair{"hidden_gate", faults.hidden_gate}})
    if (number > static_cast<int>(gates))
      throw std::runtime_error(std::string{"faults."} + name + " = " + std::to_string(number) +
                               ", but " + track + " has " + files::amount(gates, "gate") +
                               ", must be in " + files::text_of(find(name)->rule.low) + ".." +
                               std::to_string(gates));
}

}  // namespace gatefly::config

#undef AT
