// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/drone_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "gatefly/files/text.hpp"
#include "gatefly/files/toml_file.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::live {
namespace {

constexpr int kByte = 255;

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

/// Part of the thrust that hovers, and the exponent of thrust over what is sent, of one that takes set points. @return the part.
double read_hover(Strict& thrust, DroneFile& drone) {
  const double part = thrust.number("hover", 0.05, 0.8);
  drone.hover = {.throttle = 1e3 * part, .exponent = thrust.number("exponent", 0.8, 3.0)};
  return part;
}

void read_ardu_thrust(Strict thrust, DroneFile& drone) {
  ArduDrone& ardu = *drone.ardu;
  ardu.hover = read_hover(thrust, drone);
  ardu.expo = thrust.number("expo", -1.0, 1.0);
  ardu.spin_min = thrust.number("spin_min", 0.0, 0.3);
  ardu.spin_max = thrust.number("spin_max", 0.5, 1.0);
  ardu.angle_boost = thrust.whole("angle_boost", 0, 1) == 1;
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
  px4.hover = read_hover(thrust, drone);
  px4.model_factor = thrust.number("model_factor", 0.0, 1.0);
  thrust.table().refuse_others();
}

/// [controller] and [thrust] of a TS-002 simulator's drone.
void read_ts002(Strict controller, DroneFile& drone) {
  drone.ts002.emplace().system = controller.whole("system", 1, 254);
  controller.table().refuse_others();
}

void read_ts002_thrust(Strict thrust, DroneFile& drone) {
  (void)read_hover(thrust, drone);
  thrust.table().refuse_others();
}

void read_controller(Strict controller, DroneFile& drone) {
  const std::string firmware = controller.text("firmware");
  if (firmware == "ARDU") return read_ardu(std::move(controller), drone);
  if (firmware == "PX4") return read_px4(std::move(controller), drone);
  if (firmware == "TS-002") return read_ts002(std::move(controller), drone);
  if (firmware != "BTFL")
    controller.fail("firmware",
                    "\"BTFL\": Betaflight, \"ARDU\": ArduCopter, \"PX4\", or \"TS-002\"");
  drone.board = controller.text("board");
  if (drone.board.size() != 4) controller.fail("board", "the four letters of MSP_BOARD_INFO");
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
    read_ardu_thrust(Strict{file.table("thrust")}, drone);
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

}  // namespace gatefly::live
