// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/ardu_bench.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/guard/axis_check.hpp"
#include "gatefly/live/drone_answers.hpp"
#include "gatefly/live/flight_deck.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr double kLeastRate = 20.0;  ///< Samples a second.

Finding told_so(bool well, const std::string& is_well, const std::string& is_not) {
  return {well, well ? is_well : is_not};
}

/// Gives each sample to `take` until it has enough, `limit` or the link is gone.
template <class Take>
void each_sample(LinkQueries& link, std::chrono::milliseconds limit, Take&& take) {
  const RunClock clock;
  while (clock.now() < limit && !link.broken())
    if (link.serve(clock, clock.now() + 2ms) && take(link.state())) return;
}

Finding gone(const LinkQueries& link) { return {false, link.name() + ": the connection is gone"}; }

/// All that keeps an autopilot from being flown; if nothing does, `well`.
template <class Introduction, class Well>
Findings of_answers(const Introduction& said, Well&& well) {
  Findings found;
  if (said.other_client) found.push_back({false, "another program talks to the controller"});
  for (const auto complaint : guard::complaints_about(said.facts))
    found.push_back({false, std::string{guard::text_of(complaint)}});
  if (found.empty()) found.push_back({true, well()});
  return found;
}

/// A drone.toml of MAVLink, one table and key after the other.
class DroneText {
 public:
  explicit DroneText(const std::string& name) {
    table("drone");
    word("name", name);
  }
  void table(const std::string& name) { text_ += "\n[" + name + "]\n"; }
  void word(const std::string& key, const std::string& value) {
    text_ += key + " = \"" + value + "\"\n";
  }
  void number(const std::string& key, double value) {
    text_ += key + " = " + files::text_of(value) + "\n";
  }
  /// Adds what was told and not read. @return the whole file.
  [[nodiscard]] std::string end(const Told& told) {
    number("exponent", told.exponent);
    table("battery");
    number("least_v", told.least_v);
    return std::string{kDroneFileMark} + "; what was told and not read: name, exponent, least_v." +
           text_;
  }

 private:
  std::string text_;
};

}  // namespace

Findings of_introduction(const ArduIntroduction& said) {
  return of_answers(said, [&] {
    return "ArduCopter " + ardu_drone_of(said.facts).version +
           ": thrust is thrust, and it lets go of a set point in time";
  });
}

Findings of_introduction(const Px4Introduction& said) {
  return of_answers(said, [&] {
    return "PX4 " + px4_drone_of(said.facts).version + ": without set points it lands in time";
  });
}

Findings of_rest(LinkQueries& link, std::chrono::milliseconds lasts) {
  // The data that it sends by itself has first to be asked for.
  each_sample(link, 1500ms, [](const ControllerState&) { return false; });
  int samples = 0, fresh = 0;
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
  nanoseconds changed_at{0};
  each_sample(link, lasts, [&](const ControllerState& is) {
    ++samples;
    fresh += is.imu_changed_at != changed_at;
    changed_at = is.imu_changed_at;
    gyro += is.imu.gyro_B, accel += is.imu.accel_B;
    return false;
  });
  if (link.broken()) return {gone(link)};
  const double per_second = samples / std::chrono::duration<double>(lasts).count();
  const std::string rate = "IMU: " + files::fixed(per_second, 0) + " samples a second";
  Findings found{told_so(per_second >= kLeastRate, rate, rate + ", must be at least 20")};
  if (samples < 10) return found;
  if (2 * fresh < samples) {
    found.push_back({false, "IMU: it repeats itself, frozen"});
    return found;
  }
  gyro /= samples, accel /= samples;
  const double turning = gyro.norm() / kDegree, up = -accel.z(), norm = accel.norm();
  found.push_back(told_so(turning < 2.0, "gyro: still at rest",
                          "gyro: at rest it turns by " + files::fixed(turning, 1) +
                              " °/s: hold it still, or calibrate it"));
  found.push_back(told_so(up > 0.95 * norm && norm > 1.0, "accelerometer: up is up",
                          "accelerometer: level, it shows (" + files::fixed(accel.x(), 1) + ", " +
                              files::fixed(accel.y(), 1) + ", " + files::fixed(accel.z(), 1) +
                              ") m/s² to front, right, down: put the drone level, or set "
                              "AHRS_ORIENTATION, of a PX4 SENS_BOARD_ROT"));
  found.push_back(told_so(
      std::abs(norm - kGravity) < 0.05 * kGravity,
      "accelerometer: " + files::fixed(norm, 2) + " m/s² at rest",
      "accelerometer: " + files::fixed(norm, 2) + " m/s² at rest, must be 9.8: calibrate it"));
  return found;
}

Findings of_turns(LinkQueries& link, std::chrono::milliseconds limit,
                  const std::function<void(const std::string&)>& say) {
  constexpr std::array<const char*, 3> kNames{"front (roll)", "right (pitch)", "down (yaw)"};
  guard::AxisCheck check;
  std::optional<nanoseconds> last;
  nanoseconds said{0};
  each_sample(link, limit, [&](const ControllerState& is) {
    check.take(is.imu.gyro_B, is.attitude, last ? seconds(is.imu_taken - *last) : 0.0);
    last = is.imu_taken;
    if (is.imu_at - said < 1s) return check.all_agree();
    said = is.imu_at;
    std::string left;
    for (int axis = 0; axis < 3; ++axis)
      if (check.verdict(axis) == guard::AxisVerdict::kNotTurned)
        left += (left.empty() ? "" : ", ") + std::string{kNames[static_cast<std::size_t>(axis)]};
    if (!left.empty()) say("turn it by a quarter and back, in a second, about: " + left);
    return left.empty();
  });
  if (link.broken()) return {gone(link)};
  Findings found;
  for (int axis = 0; axis < 3; ++axis) {
    const guard::AxisVerdict verdict = check.verdict(axis);
    const auto part = check.scale(axis);
    std::string line = "gyro about " + std::string{kNames[static_cast<std::size_t>(axis)]} + ": " +
                       std::string{guard::text_of(verdict)};
    if (part) line += " (" + files::fixed(*part, 2) + " of it)";
    found.push_back({verdict == guard::AxisVerdict::kAgrees, line});
  }
  return found;
}

Findings of_link(LinkCommands& link, std::chrono::milliseconds lasts) {
  const RunClock clock;
  int sent = 0, samples = 0;
  for (nanoseconds next{0}; clock.now() < lasts && !link.broken(); next += kStickPeriod) {
    while (clock.now() < next && !link.broken())
      samples += link.serve(clock, std::min(next, clock.now() + 2ms));
    sent += link.send({}, clock);
  }
  if (link.broken()) return {gone(link)};
  const double per_second = samples / std::chrono::duration<double>(lasts).count();
  const int answered = link.state().acknowledged;
  const std::string timing = files::fixed(per_second, 0) + " samples a second beside 40 set points";
  return {told_so(per_second >= kLeastRate, "link: " + timing, "link: too slow: " + timing),
          told_so(10 * answered > 9 * sent, "link: set points are acknowledged",
                  "link: of " + std::to_string(sent) + " set points " + std::to_string(answered) +
                      " were acknowledged")};
}

std::string drone_toml(const ArduDrone& drone, const Told& told) {
  DroneText text{told.name};
  text.table("controller");
  text.word("firmware", "ARDU");
  text.word("version", drone.version);
  text.number("system", drone.system);
  text.number("guided_options", drone.guided_options);
  text.number("guided_timeout_s", drone.guided_timeout_s);
  text.table("thrust");
  text.number("hover", drone.hover);
  text.number("expo", drone.expo);
  text.number("spin_min", drone.spin_min);
  text.number("spin_max", drone.spin_max);
  text.number("angle_boost", drone.angle_boost ? 1 : 0);
  return text.end(told);
}

std::string drone_toml(const Px4Drone& drone, const Told& told) {
  DroneText text{told.name};
  text.table("controller");
  text.word("firmware", "PX4");
  text.word("version", drone.version);
  text.number("system", drone.system);
  text.number("offboard_timeout_s", drone.offboard_timeout_s);
  text.number("offboard_loss", drone.offboard_loss);
  text.table("thrust");
  text.number("hover", drone.hover);
  text.number("model_factor", drone.model_factor);
  return text.end(told);
}

}  // namespace gatefly::live
