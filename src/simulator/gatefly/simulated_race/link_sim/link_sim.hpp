// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/link/betaflight_sitl.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/simulated_race/link_sim/picture_feed.hpp"
#include "gatefly/simulated_race/link_sim/safety_pilot.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::link_sim {

/// The flight controller: somebody else's program, or our own behind TS-002.
enum class Autopilot { kBetaflight, kArduCopter, kPx4, kTs002 };

/// Ports of 127.0.0.1. The first four are those of Betaflight's simulator target.
struct Ports {
  int servos = 9001;      ///< UDP: what it tells the motors, here.
  int state = 9003;       ///< UDP: what its sensors feel, there.
  int radio = 9004;       ///< UDP: the safety pilot's receiver, there.
  int controller = 5761;  ///< TCP: its first serial line.
  int msp = 5771;         ///< TCP: that line as the program has it, paced.
  int pictures = 5600;    ///< UDP: the program's camera.
  int mavlink = 14550;    ///< UDP: the program's end of TS-002, or of a PX4.
};

/// A moment of a flight, as it truly was.
struct TrueMoment {
  double time = 0.0;  ///< Since the simulator began [s].
  bool armed = false, overridden = false;
  sim::BodyState state;
  std::array<double, 4> motors{};  ///< 0 … 1: front left, front right, rear right, rear left.
  double sticks_held = 0.0;        ///< StickGaps since the moment before [s].
  int gates_passed = 0;
};

/// Those of ArduCopter: it asks and is answered at one, so that there is none of its own for its state.
inline constexpr Ports kArduCopterPorts{
    .servos = 9002, .state = 0, .radio = 5501, .controller = 5760};

/// Those of PX4: TCP for sensors and motors, here; UDP of its ground station, there, and of its computer aboard, here. It says itself
/// what it says to a ground station at 14550.
inline constexpr Ports kPx4Ports{
    .servos = 0, .state = 4560, .radio = 18570, .controller = 14540, .mavlink = 14551};

struct LinkSimParams {
  Autopilot autopilot = Autopilot::kBetaflight;
  Ports ports;
  betaflight_sitl::Release release = betaflight_sitl::Release::k4_5;
  int baud = 115200;
  NetworkTroubles network;     ///< Acts on pictures, and on every datagram of TS-002 and PX4.
  bool tells_attitude = true;  ///< TS-002 does not, in its second round.
  SafetyPilot::Params radio;
  /// So long after the hand-over the cable is pulled, or the camera hangs [s]; nullopt: never.
  std::optional<double> link_out, camera_out;
};

/// How a flight went, by the truth, and how well this machine kept real time.
struct Outcome {
  std::string reason;  ///< landed, hit ..., time limit, stopped, no controller.
  bool finished = false, landed = false;
  int gates_passed = 0, gates_total = 0;
  double flight_time = 0.0;  ///< From the hand-over to taking it back [s].
  double race_time = 0.0;    ///< From the hand-over to the last gate that was passed [s].
  double mean_speed = 0.0;   ///< From the first gate's plane to the last one's [m/s].
  std::vector<Eigen::Vector2d> gate_offsets;  ///< Right, down of the middle at each pass [m].
  Eigen::Vector3d last_p_EB = Eigen::Vector3d::Zero();
  long pictures = 0, pictures_left_out = 0, pictures_late = 0;
  double longest_stall = 0.0;  ///< By which the physics was behind the clock [s].
};

/// Flies a seed's drone by somebody else's flight controller and program, in real time: physics a thousand times a
/// second, pictures as slices of JPEG, the safety pilot's radio, the serial line at its speed.
///
/// @param say   hears what happens, a line each. @param look  is shown the truth 50 times a second. @param stop  asked often; true ends it.
/// @param while_baking  called while the room's light is baked; may throw to stop.
/// @throws std::runtime_error one line: a port is taken.
[[nodiscard]] Outcome fly(const world::SimConfig& config, int laps, const LinkSimParams& params,
                          const std::function<void(const std::string&)>& say,
                          const std::function<void(const TrueMoment&)>& look,
                          const std::function<bool()>& stop,
                          const std::function<void()>& while_baking);

/// Holds a seed's drone at a bench, propellers off, until `stop`: level and still, turned and switched as new lines of
/// the file `asks` say (BenchHand), with the same controller, line and camera.
///
/// @return false: no controller has told its motors.
/// @throws std::runtime_error one line: a port is taken, `asks` cannot be read.
[[nodiscard]] bool hold(const world::SimConfig& config, const std::string& asks,
                        const LinkSimParams& params,
                        const std::function<void(const std::string&)>& say,
                        const std::function<bool()>& stop,
                        const std::function<void()>& while_baking);

}  // namespace gatefly::link_sim
