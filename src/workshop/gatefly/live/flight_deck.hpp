// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <type_traits>

#include "gatefly/guard/command_guard.hpp"
#include "gatefly/guard/hand_over.hpp"
#include "gatefly/live/dialect.hpp"
#include "gatefly/live/wires.hpp"
#include "gatefly/race/path.hpp"
#include "gatefly/race/track.hpp"

namespace gatefly::live {

/// Set points come so often: what MSP at 115,200 baud bears beside the questions.
inline constexpr std::chrono::nanoseconds kStickPeriod = std::chrono::milliseconds{25};

/// A TS-002 simulator that is silent for longer has gone; and no ending of its drone lasts longer.
inline constexpr std::chrono::nanoseconds kSimulatorGone = std::chrono::seconds{5},
                                          kSimulatorEnds = std::chrono::seconds{30};

/// The box around the map that the drone must not leave.
struct Fence {
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();  ///< [m]
  double height = 0.0;                                                            ///< [m]
  [[nodiscard]] bool holds(const Eigen::Vector3d& p_EB) const;
};
/// So far around gates and start, and half as far around the planned way; so far above the highest gate's centre and half as far above the
/// way, but not above the room [m].
[[nodiscard]] Fence fence_around(const Track& track, const RacePlan& plan, double aside,
                                 double above);

/// All that is needed to bring a drone down. It is copied from one process to the other byte by byte.
struct EndingState {
  guard::CommandGuard guard{};
  double yaw = 0.0, v_x = 0.0, v_y = 0.0, v_z = 0.0;  ///< Last believed; earth [m/s].
  double roll = 0.0, pitch = 0.0;                     ///< Last told by the controller [rad].
  double ending_for = 0.0;                            ///< [s]; 0: it flies.
  bool stands = false;                                ///< The pilot has landed, it says.
  bool in_air = false;                                ///< Silence now would be an accident.
};
static_assert(std::is_trivially_copyable_v<EndingState>);

/// The part of a speed that is left after braking for one stick period without a new estimate.
[[nodiscard]] double left_after_braking(const guard::CommandLimits& limits);
/// Rates that turn a drone, of whose attitude roll and pitch are known, towards a command [rad/s].
[[nodiscard]] Eigen::Vector3d rates_towards(const AttitudeCommand& command, double roll,
                                            double pitch);

/// Decides, period by period, what is sent: what the pilot wants, or what guard/hand_over says instead.
class FlightDeck {
 public:
  struct Params {
    guard::HandOverParams hand_over;
    guard::CommandLimits limits;
    Fence fence;
    bool hand_over_tested = false;
  };
  explicit FlightDeck(const Params& params) : params_{params}, guard_{params.limits} {}

  struct Sent {
    guard::Action action = guard::Action::kSilent;
    Demand demand;
  };
  [[nodiscard]] Sent step(const ControllerState& controller, const Wanted& wanted, bool told_to_end,
                          std::chrono::nanoseconds now);
  [[nodiscard]] const guard::HandOver& state() const { return state_; }
  /// The state from which the keeper would go on if this process died now.
  [[nodiscard]] const EndingState& ending() const { return ending_; }

 private:
  [[nodiscard]] guard::Situation situation(const ControllerState& controller, const Wanted& wanted,
                                           bool told_to_end, std::chrono::nanoseconds now) const;

  Params params_;
  guard::CommandGuard guard_;
  guard::HandOver state_;
  EndingState ending_;
  Eigen::Vector3d v_E_ = Eigen::Vector3d::Zero();  ///< To brake against [m/s].
  std::chrono::nanoseconds wanted_at_ = Wanted::kNever;
};

}  // namespace gatefly::live
