// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/drone_answers.hpp"

#include <cmath>
#include <cstdint>
#include <optional>

#include "gatefly/files/text.hpp"

namespace gatefly::live {
namespace {

/// A parameter is a float: of its decimals those that somebody may have written.
double written(std::optional<float> parameter) {
  return std::round(1e5 * double(parameter.value_or(0.0f))) / 1e5;
}

std::string version_of(const std::optional<mavlink::AutopilotVersion>& told) {
  const std::uint32_t version = told ? told->flight_sw_version : 0;
  const auto part = [version](int shift) { return std::to_string((version >> shift) & 0xFF); };
  return part(24) + "." + part(16) + "." + part(8);
}

/// Collects in what a controller is another than the file says.
class Comparison {
 public:
  void text(const char* what, const std::string& told, const std::string& wanted) {
    if (told != wanted)
      found_.push_back(std::string{what} + " is " + told + ", in the file " + wanted);
  }
  void number(const char* what, double told, double wanted) {
    text(what, files::text_of(told), files::text_of(wanted));
  }
  /// Hover is learnt while it flies; more than a tenth is another drone.
  void hover(const char* what, double told, double wanted) {
    constexpr double kLearns = 0.1;
    if (std::abs(told - wanted) > kLearns * wanted) number(what, told, wanted);
  }
  [[nodiscard]] const std::vector<std::string>& found() const { return found_; }

 private:
  std::vector<std::string> found_;
};

}  // namespace

std::vector<std::string> differences(const DroneFile& drone, const guard::DroneFacts& facts,
                                     const std::string& board) {
  std::vector<std::string> found;
  const auto compare = [&](const char* what, const auto& told, const auto& expected) {
    const std::string says = files::text_of(double(told)),
                      wanted = files::text_of(double(expected));
    if (says != wanted)
      found.push_back(std::string{what} + " is " + says + ", in the file " + wanted);
  };
  if (board != drone.board)
    found.push_back("board is " + files::one_line(board) + ", in the file " + drone.board);
  if (facts.api) compare("api_minor", facts.api->minor, drone.api_minor);
  if (facts.tuning) {
    const msp::RcTuning &t = *facts.tuning, &e = drone.tuning;
    compare("rates_type", t.rates_type, e.rates_type);
    compare("roll rc_rate", t.roll_rc_rate, e.roll_rc_rate);
    compare("pitch rc_rate", t.pitch_rc_rate, e.pitch_rc_rate);
    compare("yaw rc_rate", t.yaw_rc_rate, e.yaw_rc_rate);
    compare("roll expo", t.roll_expo, e.roll_expo);
    compare("pitch expo", t.pitch_expo, e.pitch_expo);
    compare("yaw expo", t.yaw_expo, e.yaw_expo);
    for (std::size_t i = 0; i < 3; ++i) {
      compare("super_rate", t.super_rate[i], e.super_rate[i]);
      compare("rate limit", t.rate_limit[i], e.rate_limit[i]);
    }
    compare("throttle mid", t.throttle_mid, e.throttle_mid);
    compare("throttle expo", t.throttle_expo, e.throttle_expo);
  }
  if (facts.deadband) {
    compare("deadband", facts.deadband->roll_and_pitch, drone.deadband.roll_and_pitch);
    compare("yaw deadband", facts.deadband->yaw, drone.deadband.yaw);
  }
  if (facts.receiver) {
    compare("mid_us", facts.receiver->mid, drone.receiver.mid);
    compare("min_check_us", facts.receiver->min_check, drone.receiver.min_check);
  }
  if (facts.map)
    for (std::size_t i = 0; i < 4; ++i)
      compare("channel place", facts.map->place[i], drone.map.place[i]);
  return found;
}

ArduDrone ardu_drone_of(const guard::ArduFacts& facts) {
  using Parameter = guard::ArduParameter;
  const auto is = [&](Parameter which) { return written(facts.parameter(which)); };
  return {.version = version_of(facts.version),
          .system = 1,
          .guided_options = static_cast<int>(is(Parameter::kGuidedOptions)),
          .guided_timeout_s = is(Parameter::kGuidedTimeout),
          .hover = is(Parameter::kHoverThrust),
          .expo = is(Parameter::kThrustExpo),
          .spin_min = is(Parameter::kSpinMin),
          .spin_max = is(Parameter::kSpinMax),
          .angle_boost = is(Parameter::kAngleBoost) != 0.0};
}

Px4Drone px4_drone_of(const guard::Px4Facts& facts) {
  using Parameter = guard::Px4Parameter;
  const auto is = [&](Parameter which) { return written(facts.parameter(which)); };
  return {.version = version_of(facts.version),
          .system = 1,
          .offboard_timeout_s = is(Parameter::kOffboardTimeout),
          .offboard_loss = static_cast<int>(is(Parameter::kOffboardLoss)),
          .hover = is(Parameter::kHoverThrust),
          .model_factor = is(Parameter::kModelFactor)};
}

std::vector<std::string> differences(const DroneFile& drone, const guard::ArduFacts& facts) {
  const ArduDrone is = ardu_drone_of(facts);
  const ArduDrone& file = *drone.ardu;
  Comparison compare;
  compare.text("version", is.version, file.version);
  compare.number("GUID_OPTIONS", is.guided_options, file.guided_options);
  compare.number("GUID_TIMEOUT", is.guided_timeout_s, file.guided_timeout_s);
  compare.number("MOT_THST_EXPO", is.expo, file.expo);
  compare.number("MOT_SPIN_MIN", is.spin_min, file.spin_min);
  compare.number("MOT_SPIN_MAX", is.spin_max, file.spin_max);
  compare.number("ATC_ANGLE_BOOST", double(is.angle_boost), double(file.angle_boost));
  compare.hover("MOT_THST_HOVER", is.hover, file.hover);
  return compare.found();
}

std::vector<std::string> differences(const DroneFile& drone, const guard::Px4Facts& facts) {
  const Px4Drone is = px4_drone_of(facts);
  const Px4Drone& file = *drone.px4;
  Comparison compare;
  compare.text("version", is.version, file.version);
  compare.number("COM_OF_LOSS_T", is.offboard_timeout_s, file.offboard_timeout_s);
  compare.number("COM_OBL_RC_ACT", is.offboard_loss, file.offboard_loss);
  compare.number("THR_MDL_FAC", is.model_factor, file.model_factor);
  compare.hover("MPC_THR_HOVER", is.hover, file.hover);
  return compare.found();
}

}  // namespace gatefly::live
