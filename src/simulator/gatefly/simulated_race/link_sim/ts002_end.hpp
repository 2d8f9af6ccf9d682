// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <variant>

#include "gatefly/link/mavlink.hpp"
#include "gatefly/sim/autopilot/autopilot.hpp"
#include "gatefly/simulated_race/link_sim/controller.hpp"
#include "gatefly/simulated_race/link_sim/set_points.hpp"
#include "gatefly/simulated_race/link_sim/troubled_line.hpp"

namespace gatefly::link_sim {

/// The simulator's end of TS-002, the AI Grand Prix's virtual qualifier, with a flight controller of our own simulator inside: MAVLink 2
/// over UDP, nothing else.
///
/// It calls the pilot's port, and sends HEARTBEAT, HIGHRES_IMU and, but in the second round, ATTITUDE. It hears HEARTBEAT, TIMESYNC,
/// SET_ATTITUDE_TARGET and SET_POSITION_TARGET_LOCAL_NED. There is no word that arms: who starts the race does.
class Ts002End : public Controller {
 public:
  struct Params {
    int port = 14550;            ///< The pilot's.
    bool tells_attitude = true;  ///< Not in the second round.
    NetworkTroubles network;
  };
  /// @throws std::runtime_error one line.
  Ts002End(const Params& params, const world::SimConfig& config);

  void listen(double now) override;
  void feel(const betaflight_sitl::State& told, const sim::BodyState& body) override;
  void hear_radio(std::chrono::nanoseconds time, const msp::Sticks& sticks,
                  const std::array<std::uint16_t, 12>& switches) override;
  [[nodiscard]] bool called() const override;
  [[nodiscard]] double held_for() const override;
  void cut() override { cut_ = true; }

 private:
  void take(const mavlink::Frame& frame);
  template <class SetPoint>
  void take_set_point(const SetPoint& target);
  void transmit(const betaflight_sitl::State& is);
  template <class Message>
  void say(const Message& message);
  [[nodiscard]] RatesAndThrust wanted(const betaflight_sitl::State& is) const;

  Params params_;
  TroubledLine line_;
  sim::StickCurves curves_;
  sim::Autopilot autopilot_;
  double highest_, hover_, now_ = 0.0;
  sim::LowPass1<3> gyro_, accel_;
  Eigen::Vector3d start_ = Eigen::Vector3d::Zero();
  std::optional<double> heard_at_, set_point_at_;  ///< [s]
  std::variant<mavlink::SetAttitudeTarget, mavlink::SetPositionTargetLocalNed> set_point_;
  mavlink::Stream stream_;
  long steps_ = 0;
  std::uint8_t sequence_ = 0;
  std::uint32_t stamp_ = 0;  ///< Stamp of the last set point [ms].
  bool armed_ = false, told_armed_ = false, cut_ = false;
};

}  // namespace gatefly::link_sim
