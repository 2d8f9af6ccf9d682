// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "gatefly/link/msp_axes.hpp"
#include "gatefly/link/msp_messages.hpp"
#include "gatefly/link/rate_curve.hpp"
#include "gatefly/link/throttle_curve.hpp"

namespace gatefly::live {

/// Throttle (0 … 1000, behind the throttle curve; over MAVLink thousandths of the thrust) and the thrust that it gives: (throttle / hover)^exponent times the weight.
struct Hover {
  double throttle = 0.0;
  double exponent = 1.0;
  /// Throttle that gives a specific thrust [m/s²], within 0 … 1000.
  [[nodiscard]] double throttle_for(double thrust) const;
};

/// The constants of an ArduCopter, which takes rates and thrust as they are.
struct ArduDrone {
  std::string version;  ///< "4.7.0"
  int system = 1;       ///< Its MAVLink id.
  int guided_options = 0;
  double guided_timeout_s = 0.0;
  double hover = 0.0;  ///< MOT_THST_HOVER: part of the thrust that hovers.
  double expo = 0.0, spin_min = 0.0, spin_max = 0.0;  ///< Parameters of its thrust curve.
  bool angle_boost = false;                           ///< It adds thrust itself when it is tilted.

  /// Thrust to be sent, 0 … 1, for one of 0 … 1000 along the body's axis. @param upright  cosine of the tilt.
  [[nodiscard]] double thrust_part(double throttle, double upright) const;
};

/// The constants of a PX4, which takes rates and thrust as they are.
struct Px4Drone {
  std::string version;  ///< "1.14.0"
  int system = 1;       ///< Its MAVLink id.
  double offboard_timeout_s = 0.0;
  int offboard_loss = 0;      ///< COM_OBL_RC_ACT: what it does without set points.
  double hover = 0.0;         ///< MPC_THR_HOVER: part of the thrust that hovers.
  double model_factor = 0.0;  ///< THR_MDL_FAC: of its thrust curve.
};

/// The constants of a drone that speaks TS-002, the AI Grand Prix's virtual qualifier: a simulator's, which answers no questions. Thrust is a
/// part of the most there is.
struct Ts002Drone {
  int system = 1;  ///< Its MAVLink id.
};

/// Every constant of a drone that `run` may use: drone.toml. Nothing in it has a default.
struct DroneFile {
  std::filesystem::path path;
  std::string name;
  std::optional<ArduDrone> ardu;  ///< An ArduCopter's,
  std::optional<Px4Drone> px4;    ///< a PX4's,
  std::optional<Ts002Drone>
      ts002;  ///< or a TS-002 simulator's; else a Betaflight's, which are these:
  std::string board;
  int api_minor = 0;
  msp::ImuScale imu;
  msp::RcTuning tuning;  ///< Answer that the controller must give, to the byte ...
  msp::RcDeadband deadband;
  msp::RxConfig receiver;
  msp::RxMap map;
  msp::RateProfile rates;  ///< ... and what follows of it.
  msp::ThrottleCurve throttle = msp::ThrottleCurve::from({}, {.min_check = 1050}).value();
  msp::ChannelOrder order;
  int hover_stick = 0;  ///< [µs]
  Hover hover;          ///< Common to both firmwares.
  double least_battery_v = 0.0;
  std::string tested;  ///< Fingerprint of the passed hand-over test; "": not passed.

  /// The sticks for rates about front, right, down [rad/s] and a specific thrust [m/s²].
  [[nodiscard]] msp::Sticks sticks(const Eigen::Vector3d& rates_B, double thrust) const;
  /// Whether it takes rates and thrust over MAVLink; else sticks over MSP.
  [[nodiscard]] bool by_mavlink() const { return ardu || px4 || ts002; }
  /// Throttle that hovers, and that of motors at rest, as ControllerState::sticks has them.
  [[nodiscard]] int hover_throttle() const;
  [[nodiscard]] int rest_throttle() const { return by_mavlink() ? 1000 : receiver.min_check; }
  /// Its MAVLink id.
  [[nodiscard]] int system() const {
    return ardu ? ardu->system : px4 ? px4->system : ts002 ? ts002->system : 1;
  }
  /// Thrust to be sent over MAVLink, 0 … 1, for a specific one [m/s²]. @param upright  cosine of the tilt.
  [[nodiscard]] double thrust_part(double thrust, double upright) const;
};

/// Reads drone.toml. @throws std::runtime_error one line: file, line, key, what it must be; for any key that is
///     missing or not known, rates and throttle curves that are not known here.
[[nodiscard]] DroneFile read_drone(const std::filesystem::path& path);

}  // namespace gatefly::live
