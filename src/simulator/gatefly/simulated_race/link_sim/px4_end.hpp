// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "gatefly/link/mavlink.hpp"
#include "gatefly/link/mavlink_axes.hpp"
#include "gatefly/link/mavlink_hil.hpp"
#include "gatefly/live/port.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/sim/sensors.hpp"
#include "gatefly/simulated_race/link_sim/controller.hpp"
#include "gatefly/simulated_race/link_sim/tcp_door.hpp"
#include "gatefly/simulated_race/link_sim/troubled_line.hpp"

namespace gatefly::link_sim {

/// The person with the radio, for a controller that is armed and switched by MAVLink: a ground station's commands, said again until
/// the drone has done what a switch was moved to.
class GroundStation {
 public:
  explicit GroundStation(int port) : line_{Datagrams::to(port)} {}
  /// Takes a heartbeat of the drone's.
  void heard(const mavlink::Heartbeat& beat);
  /// Switches at `now` [s].
  void step(double now, bool armed, bool offboard);

 private:
  void command(const mavlink::CommandLong& command);
  template <class Message>
  void say(const Message& message);

  /// One of the radio's, and when its command was last said [s].
  struct Switch {
    bool on = false, done = true;
    std::optional<double> said_at;

    void move(bool to);
    [[nodiscard]] bool is_to_be_said(double now);
  };

  Datagrams line_;
  Switch arm_, offboard_;
  std::optional<double> beaten_at_;  ///< [s]
  bool is_armed_ = false;
  std::uint8_t sequence_ = 0;
};

/// PX4's simulator target. It calls over TCP, hears 250 times a second what its sensors feel and tells its motors; its clock is what we
/// tell it. What it says to a computer aboard over UDP, and hears of one, goes to the program that flies and back, over a network that
/// may lose and swap; the radio's switches become a ground station's commands.
class Px4End : public Controller {
 public:
  struct Params {
    int simulator = 4560;   ///< TCP, here: PX4 calls.
    int companion = 14540;  ///< UDP, here: what it says to a computer aboard.
    int station = 18570;    ///< UDP, there: where it hears a ground station.
    int port = 14551;       ///< UDP, there: the program that flies.
    NetworkTroubles network;
  };
  /// @throws std::runtime_error one line: a port is taken.
  Px4End(const Params& params, const world::SimConfig& config);

  void listen(double now) override;
  void feel(const betaflight_sitl::State& is, const sim::BodyState& body) override;
  void hear_radio(std::chrono::nanoseconds time, const msp::Sticks& sticks,
                  const std::array<std::uint16_t, 12>& switches) override;
  /// Motors of an armed PX4 may stand.
  [[nodiscard]] bool turn() const override { return armed_; }
  [[nodiscard]] bool called() const override;
  [[nodiscard]] double held_for() const override;
  void cut() override { cut_ = true; }

 private:
  void hear_motors();
  void relay();
  template <class Message>
  void say(const Message& message);
  [[nodiscard]] mavlink::HilSensor sensors(const betaflight_sitl::State& is,
                                           const sim::BodyState& body);

  TcpDoor door_;
  std::optional<live::Port> px4_;
  mavlink::Stream motors_told_, said_by_px4_, said_by_program_;
  Datagrams companion_;
  TroubledLine program_;
  GroundStation station_;
  sim::BaroModel baro_;
  sim::Stream magnetometer_;
  Eigen::Vector3d gyro_ = Eigen::Vector3d::Zero(), accel_ = Eigen::Vector3d::Zero();
  int felt_ = 0;
  long sent_ = 0;
  double now_ = 0.0;
  std::optional<double> heard_at_, set_point_at_;  ///< [s]
  std::uint8_t sequence_ = 0;
  bool armed_ = false, cut_ = false;
};

}  // namespace gatefly::link_sim
