// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/randomize_keys.hpp"

#include <algorithm>
#include <stdexcept>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::config {
namespace {

constexpr double kPercent = 0.01;
const char* const kSource = "level of simulation.md";

template <class Member>
Key<world::Randomize> sigma(const char* name, const char* what, double high, Member member,
                            double unit = 1.0) {
  return key<world::Randomize>(std::string{"randomize."} + name, 0.0, high, member, what, kSource,
                               unit);
}

std::vector<Key<world::Randomize>> make_keys() {
  return {
      sigma(
          "gate_position_m", "a gate's place on the floor plan", 2,
          [](auto& r) -> auto& { return r.gate_position; }),
      sigma(
          "gate_heading_deg", "a gate's heading", 45,
          [](auto& r) -> auto& { return r.gate_heading; }, kDegree),
      sigma(
          "gate_height_m", "a gate's height", 1, [](auto& r) -> auto& { return r.gate_height; }),
      sigma(
          "start_position_m", "start position", 2,
          [](auto& r) -> auto& { return r.start_position; }),
      sigma(
          "start_heading_deg", "start heading", 45,
          [](auto& r) -> auto& { return r.start_heading; }, kDegree),
      sigma(
          "camera_focal_percent", "focal length", 20,
          [](auto& r) -> auto& { return r.camera_focal; }, kPercent),
      sigma(
          "camera_center_px", "principal point", 50,
          [](auto& r) -> auto& { return r.camera_center_px; }),
      sigma(
          "camera_k", "k of Dhane's lens; a pinhole's is 1", 0.3,
          [](auto& r) -> auto& { return r.camera_k; }),
      sigma(
          "camera_k1_percent", "first distortion coefficient of the polynomial lenses", 30,
          [](auto& r) -> auto& { return r.camera_k1; }, kPercent),
      sigma(
          "camera_tilt_deg", "mount angles of the camera", 20,
          [](auto& r) -> auto& { return r.camera_tilt; }, kDegree),
      sigma(
          "camera_latency_ms", "camera latency", 200,
          [](auto& r) -> auto& { return r.camera_latency; }, 1e-3),
      sigma(
          "gate_side_percent", "a gate's side", 20, [](auto& r) -> auto& { return r.gate_side; },
          kPercent),
      sigma(
          "drag_percent", "drag", 35, [](auto& r) -> auto& { return r.drag; }, kPercent),
      sigma(
          "mass_percent", "mass", 30, [](auto& r) -> auto& { return r.mass; }, kPercent),
      sigma(
          "thrust_percent", "thrust", 30, [](auto& r) -> auto& { return r.thrust; }, kPercent),
      sigma(
          "sag_percent", "thrust lost to the battery (not drawn)", 50,
          [](auto& r) -> auto& { return r.sag; }, kPercent),
      sigma(
          "accel_bias_mps2", "accelerometer bias", 5,
          [](auto& r) -> auto& { return r.accel_bias; }),
      sigma(
          "gyro_bias_degps", "gyro bias", 20, [](auto& r) -> auto& { return r.gyro_bias; },
          kDegree),
      sigma(
          "scale_percent", "scale of accelerometer and gyro", 20,
          [](auto& r) -> auto& { return r.scale; }, kPercent),
      sigma(
          "flight_bias_mps2", "accelerometer bias that vibration adds in flight", 5,
          [](auto& r) -> auto& { return r.flight_bias; }),
      sigma(
          "noise_scale", "factor on the noise of IMU and pictures (not drawn)", 20,
          [](auto& r) -> auto& { return r.noise_scale; }),
      sigma(
          "light_percent", "brightness of each light group", 100,
          [](auto& r) -> auto& { return r.light; }, kPercent),
      sigma(
          "exposure_percent", "auto-exposure's aim", 100,
          [](auto& r) -> auto& { return r.exposure; }, kPercent),
      sigma(
          "hue_deg", "gates' hue", 60, [](auto& r) -> auto& { return r.hue; }, kDegree),
      sigma(
          "white_balance_percent", "white balance gains", 50,
          [](auto& r) -> auto& { return r.white_balance; }, kPercent),
      sigma(
          "saturation_percent", "how colourful pictures are", 100,
          [](auto& r) -> auto& { return r.saturation; }, kPercent),
      sigma(
          "frame_loss_percent", "pictures that never arrive (not drawn)", 100,
          [](auto& r) -> auto& { return r.frame_loss; }, kPercent),
      sigma(
          "latency_jitter_ms", "jitter of the latency from picture to picture", 200,
          [](auto& r) -> auto& { return r.latency_jitter; }, 1e-3),
      sigma(
          "wind_mps", "mean wind", 5, [](auto& r) -> auto& { return r.wind; }),
      sigma(
          "gust_mps", "gusts", 5, [](auto& r) -> auto& { return r.gust; }),
      sigma(
          "jet_mps",
          "air across the way between two gates, 1 m wide (where is drawn, not how much)", 5,
          [](auto& r) -> auto& { return r.jet; }),
      sigma(
          "shear_per_s", "air that is faster the farther from the middle (whereto is drawn)", 2,
          [](auto& r) -> auto& { return r.shear; }),
      sigma(
          "wash", "part of the own wash that comes back from walls within 1 m (not drawn)", 1,
          [](auto& r) -> auto& { return r.wash; }),
      sigma(
          "imbalance_percent", "vibration of each rotor", 100,
          [](auto& r) -> auto& { return r.imbalance; }, kPercent),
      sigma(
          "accel_warming_mps2", "accelerometer bias that comes as the IMU warms up", 5,
          [](auto& r) -> auto& { return r.accel_warming; }),
      sigma(
          "gyro_warming_degps", "gyro bias that comes as the IMU warms up", 20,
          [](auto& r) -> auto& { return r.gyro_warming; }, kDegree),
      sigma(
          "sonar_loss_percent", "sonar echoes that never come back (not drawn)", 100,
          [](auto& r) -> auto& { return r.sonar_loss; }, kPercent),
      sigma(
          "sonar_double_percent", "sonar echoes that show twice the height (not drawn)", 100,
          [](auto& r) -> auto& { return r.sonar_double; }, kPercent),
      sigma(
          "decoys", "things of the gate's colour (number)", 50,
          [](auto& r) -> auto& { return r.decoys; }),
      sigma(
          "people", "people who walk along the walls (number)", 50,
          [](auto& r) -> auto& { return r.people; }),
  };
}

const Key<world::Randomize>* find(const std::string& name) {
  const auto& keys = randomize_keys();
  const auto found = std::find_if(
      keys.begin(), keys.end(), [&](const auto& k) { return k.rule.name == "randomize." + name; });
  return found == keys.end() ? nullptr : &*found;
}

}  // namespace

const KeyRule& randomize_level_rule() {
  static const KeyRule rule{.name = "randomize.level",
                            .what = "how much a seed changes",
                            .source = "tracks: race",
                            .choices = {"none", "race", "hard"},
                            .kind = KeyRule::Kind::kText};
  return rule;
}

const std::vector<Key<world::Randomize>>& randomize_keys() {
  static const std::vector<Key<world::Randomize>> keys = make_keys();
  return keys;
}

void check_randomize(const std::string& key, const nlohmann::json& value,
                     const std::string& where) {
  if (key == "level") {
    (void)checked(randomize_level_rule(), value, where);
  } else if (const auto* known = find(key)) {
    (void)checked(known->rule, value, where);
  } else {
    std::vector<std::string> names{"level"};
    for (const auto& each : randomize_keys()) names.push_back(each.rule.name.substr(10));
    throw std::runtime_error(where + ": randomize." + files::one_line(key) + " is not a known key" +
                             files::suggestion(key, names));
  }
}

world::Randomize randomized(const world::Randomize& base, const nlohmann::json& table,
                            const std::string& where) {
  for (const auto& [key, value] : table.items()) check_randomize(key, value, where);
  world::Randomize result =
      table.contains("level") ? world::randomize_level(table.at("level").get<std::string>()) : base;
  for (const auto& [key, value] : table.items())
    if (const auto* known = find(key)) known->set(result, value);
  // Version 0.2 had one key for both.
  if (table.contains("camera_k") && !table.contains("camera_k1_percent"))
    result.camera_k1 = result.camera_k;
  return result;
}

}  // namespace gatefly::config
