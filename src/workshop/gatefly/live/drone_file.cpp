// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/drone_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"
#include "gatefly/files/xxh64.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::live {
namespace {

constexpr int kByte = 255;
constexpr std::string_view kTestTable = "[hand_over_test]";

/// A table of which every key must be there.
class Strict {
 public:
  explicit Strict(files::Table table) : table_{std::move(table)} {}

  double number(const std::string& key, double low, double high) {
    return table_.number(key, low, high);
  }
  int whole(const std::string& key, int low, int high) {
    const double value = table_.number(key, low, high);
    if (value != std::floor(value)) table_.fail(key, "a whole number");
    return static_cast<int>(value);
  }
  template <std::size_t N>
  std::array<int, N> wholes(const std::string& key, int low, int high) {
    const std::vector<double> values = table_.numbers(key, N, low, high);
    std::array<int, N> result{};
    for (std::size_t i = 0; i < N; ++i) {
      if (values[i] != std::floor(values[i])) table_.fail(key, "whole numbers");
      result[i] = static_cast<int>(values[i]);
    }
    return result;
  }
  std::string text(const std::string& key) {
    if (!table_.has(key)) table_.fail(key, "there: it has no default");
    return table_.text(key, "");
  }
  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    table_.fail(key, what);
  }
  files::Table& table() { return table_; }

 private:
  files::Table table_;
};

template <class To>
To narrow(int value) {
  return static_cast<To>(value);
}

/// An ArduCopter's [controller].
void read_ardu(Strict controller, DroneFile& drone) {
  ArduDrone& ardu = drone.ardu.emplace();
  ardu.version = controller.text("version");
  ardu.system = controller.whole("system", 1, 254);
  ardu.guided_options = controller.whole("guided_options", 0, 65535);
  ardu.guided_timeout_s = controller.number("guided_timeout_s", 0.1, 5.0);
  controller.table().refuse_others();
}

void read_thrust(Strict thrust, DroneFile& drone) {
  ArduDrone& ardu = *drone.ardu;
  ardu.hover = thrust.number("hover", 0.05, 0.8);
  ardu.expo = thrust.number("expo", -1.0, 1.0);
  ardu.spin_min = thrust.number("spin_min", 0.0, 0.3);
  ardu.spin_max = thrust.number("spin_max", 0.5, 1.0);
  ardu.angle_boost = thrust.whole("angle_boost", 0, 1) == 1;
  drone.hover = {.throttle = 1e3 * ardu.hover, .exponent = thrust.number("exponent", 0.8, 3.0)};
  thrust.table().refuse_others();
}

/// [controller] and [thrust] of a PX4.
void read_px4(Strict controller, DroneFile& drone) {
  Px4Drone& px4 = drone.px4.emplace();
  px4.version = controller.text("version");
  px4.system = controller.whole("system", 1, 254);
  px4.offboard_timeout_s = controller.number("offboard_timeout_s", 0.01, 5.0);
  px4.offboard_loss = controller.whole("offboard_loss", 0, 20);
  controller.table().refuse_others();
}

void read_px4_thrust(Strict thrust, DroneFile& drone) {
  Px4Drone& px4 = *drone.px4;
  px4.hover = thrust.number("hover", 0.05, 0.8);
  px4.model_factor = thrust.number("model_factor", 0.0, 1.0);
  drone.hover = {.throttle = 1e3 * px4.hover, .exponent = thrust.number("exponent", 0.8, 3.0)};
  thrust.table().refuse_others();
}

/// [controller] and [thrust] of a TS-002 simulator's drone.
void read_ts002(Strict controller, DroneFile& drone) {
  drone.ts002.emplace().system = controller.whole("system", 1, 254);
  controller.table().refuse_others();
}

void read_ts002_thrust(Strict thrust, DroneFile& drone) {
  drone.hover = {.throttle = 1e3 * thrust.number("hover", 0.05, 0.8),
                 .exponent = thrust.number("exponent", 0.8, 3.0)};
  thrust.table().refuse_others();
}

void read_controller(Strict controller, DroneFile& drone) {
  const std::string firmware = controller.text("firmware");
  if (firmware == "ARDU") return read_ardu(std::move(controller), drone);
  if (firmware == "PX4") return read_px4(std::move(controller), drone);
  if (firmware == "TS-002") return read_ts002(std::move(controller), drone);
  drone.board = controller.text("board");
  if (drone.board.size() != 4) controller.fail("board", "the four letters of MSP_BOARD_INFO");
  if (firmware != "BTFL")
    controller.fail("firmware",
                    "\"BTFL\": Betaflight, \"ARDU\": ArduCopter, \"PX4\", or \"TS-002\"");
  drone.api_minor = controller.whole("api_minor", 43, 46);
  controller.table().refuse_others();
}

void read_imu(Strict imu, DroneFile& drone) {
  if (imu.text("axes") != "front-left-up")
    imu.fail("axes", "\"front-left-up\", Betaflight's own: align the board in the controller");
  drone.imu.gyro_counts_per_deg_per_s = imu.number("gyro_counts_per_deg_per_s", 1, 200);
  drone.imu.accel_counts_per_g = imu.number("accel_counts_per_g", 100, 20000);
  imu.table().refuse_others();
}

void read_rates(Strict rates, DroneFile& drone) {
  const std::string type = rates.text("type");
  if (type != "betaflight" && type != "actual") rates.fail("type", "\"betaflight\" or \"actual\"");
  msp::RcTuning& tuning = drone.tuning;
  tuning.rates_type = type == "actual" ? 3 : 0;
  const auto rc_rate = rates.wholes<3>("rc_rate", 0, kByte);
  const auto super_rate = rates.wholes<3>("super_rate", 0, kByte);
  const auto expo = rates.wholes<3>("expo", 0, 100);
  const auto limit = rates.wholes<3>("limit_deg_per_s", 200, 1998);
  tuning.roll_rc_rate = narrow<std::uint8_t>(rc_rate[0]);
  tuning.pitch_rc_rate = narrow<std::uint8_t>(rc_rate[1]);
  tuning.yaw_rc_rate = narrow<std::uint8_t>(rc_rate[2]);
  tuning.roll_expo = narrow<std::uint8_t>(expo[0]);
  tuning.pitch_expo = narrow<std::uint8_t>(expo[1]);
  tuning.yaw_expo = narrow<std::uint8_t>(expo[2]);
  for (std::size_t i = 0; i < 3; ++i) {
    tuning.super_rate[i] = narrow<std::uint8_t>(super_rate[i]);
    tuning.rate_limit[i] = narrow<std::uint16_t>(limit[i]);
  }
  drone.receiver.mid = narrow<std::uint16_t>(rates.whole("mid_us", 1401, 1599));
  drone.deadband.roll_and_pitch = narrow<std::uint8_t>(rates.whole("deadband_us", 0, 32));
  drone.deadband.yaw = narrow<std::uint8_t>(rates.whole("yaw_deadband_us", 0, 100));
  rates.table().refuse_others();
}

void read_throttle(Strict throttle, DroneFile& drone) {
  drone.tuning.throttle_mid = narrow<std::uint8_t>(throttle.whole("mid_percent", 0, 100));
  drone.tuning.throttle_expo = narrow<std::uint8_t>(throttle.whole("expo_percent", 0, 100));
  drone.tuning.throttle_limit_percent = 100;
  drone.receiver.min_check = narrow<std::uint16_t>(throttle.whole("min_check_us", 885, 1200));
  drone.hover_stick = throttle.whole("hover_stick_us", 1000, 2000);
  drone.hover.exponent = throttle.number("exponent", 0.8, 3.0);
  throttle.table().refuse_others();
}

void read_channels(Strict channels, DroneFile& drone) {
  const auto place = channels.wholes<4>("place", 0, 3);
  for (std::size_t i = 0; i < place.size(); ++i)
    drone.map.place[i] = narrow<std::uint8_t>(place[i]);
  const auto override_us = channels.wholes<4>("override", 0, 3);
  auto sorted = override_us;
  std::sort(sorted.begin(), sorted.end());
  if (sorted != std::array{0, 1, 2, 3})
    channels.fail("override",
                  "[0, 1, 2, 3]: roll, pitch, yaw and throttle are overridden, the switches never");
  channels.table().refuse_others();
}

/// The curves that follow of what is set; nobody flies by another kind.
void derive(files::Table& file, DroneFile& drone) {
  const auto rates = msp::RateProfile::from(drone.tuning, drone.deadband, drone.receiver);
  if (!rates) file.fail("rates", "rates that a Betaflight can have");
  const auto throttle = msp::ThrottleCurve::from(drone.tuning, drone.receiver);
  if (!throttle) file.fail("throttle", "a curve that a Betaflight up to 4.5 can have");
  const auto order = msp::ChannelOrder::from(drone.map);
  if (!order) file.fail("channels", "each of the four places once");
  drone.rates = *rates, drone.throttle = *throttle, drone.order = *order;
  drone.hover.throttle = drone.throttle.throttle(drone.hover_stick);
  if (drone.hover.throttle < 50 || drone.hover.throttle > 800)
    file.fail("throttle", "a hover_stick_us that gives a throttle of 5 to 80 %, it gives " +
                              files::text_of(0.1 * drone.hover.throttle, 3) + " %");
}

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

double Hover::throttle_for(double thrust) const {
  constexpr double kMost = 1000.0;
  if (!(thrust > 0.0)) return 0.0;
  return std::min(kMost, throttle * std::pow(thrust / kGravity, 1.0 / exponent));
}

double ArduDrone::thrust_part(double throttle, double upright) const {
  const double part = 1e-3 * throttle;
  return angle_boost ? part * std::clamp(upright, 0.5, 1.0) : part;
}

double DroneFile::thrust_part(double thrust, double upright) const {
  const double wanted = hover.throttle_for(thrust);
  return ardu ? ardu->thrust_part(wanted, upright) : 1e-3 * wanted;
}

int DroneFile::hover_throttle() const {
  return by_mavlink() ? 1000 + static_cast<int>(std::lround(hover.throttle)) : hover_stick;
}

msp::Sticks DroneFile::sticks(const Eigen::Vector3d& rates_B, double thrust) const {
  msp::Sticks sticks = rates.sticks(rates_B);
  sticks.throttle = static_cast<std::uint16_t>(
      throttle.stick(static_cast<int>(std::lround(hover.throttle_for(thrust)))));
  return sticks;
}

bool DroneFile::hand_over_tested(const std::string& program) const {
  return ts002 || (!tested.empty() && tested == hand_over_mark(*this, program));
}

DroneFile read_drone(const std::filesystem::path& path) {
  const files::TomlFile content(path);
  files::Table file(content);
  DroneFile drone;
  drone.path = path;
  const auto expect = [&file](std::initializer_list<const char*> sections) {
    for (const char* section : sections)
      if (!file.has(section)) file.fail(section, "there: a drone has no defaults");
  };
  expect({"drone", "controller"});
  Strict identity{file.table("drone")};
  drone.name = identity.text("name");
  identity.table().refuse_others();
  read_controller(Strict{file.table("controller")}, drone);
  if (drone.ardu) {
    expect({"thrust"});
    read_thrust(Strict{file.table("thrust")}, drone);
  } else if (drone.px4) {
    expect({"thrust"});
    read_px4_thrust(Strict{file.table("thrust")}, drone);
  } else if (drone.ts002) {
    expect({"thrust"});
    read_ts002_thrust(Strict{file.table("thrust")}, drone);
    file.refuse_others();
    return drone;
  } else {
    expect({"imu", "rates", "throttle", "channels"});
    read_imu(Strict{file.table("imu")}, drone);
    read_rates(Strict{file.table("rates")}, drone);
    read_throttle(Strict{file.table("throttle")}, drone);
    read_channels(Strict{file.table("channels")}, drone);
  }
  expect({"battery"});
  Strict battery{file.table("battery")};
  drone.least_battery_v = battery.number("least_v", 0, 60);
  battery.table().refuse_others();
  if (file.has("hand_over_test")) {
    Strict test{file.table("hand_over_test")};
    drone.tested = test.text("passed");
    test.table().refuse_others();
  }
  file.refuse_others();
  if (!drone.by_mavlink()) derive(file, drone);
  return drone;
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

namespace {

/// A parameter is a float: of its decimals those that somebody may have written.
double written(std::optional<float> parameter) {
  return std::round(1e5 * double(parameter.value_or(0.0f))) / 1e5;
}

std::string version_of(const std::optional<mavlink::AutopilotVersion>& told) {
  const std::uint32_t version = told ? told->flight_sw_version : 0;
  const auto part = [version](int shift) { return std::to_string((version >> shift) & kByte); };
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
