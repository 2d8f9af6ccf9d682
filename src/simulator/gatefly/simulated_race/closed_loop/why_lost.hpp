// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "gatefly/race/path.hpp"
#include "gatefly/race/track.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::simulated_race {

/// The camera's record since the last fix: a gate counts where all of it could be seen.
struct LooksSinceFix {
  int pictures = 0, gate_in_view = 0, gate_found = 0;
};

/// A fix that was taken of something else than the target.
struct WrongFix {
  double time = 0.0;       ///< [s]
  std::string taken_of{};  ///< "gate 2", "false gate 1", "no gate".
};

/// One moment of a race as it was recorded: truth, belief and plan. Positions in earth axes [m].
struct LossMoment {
  double time = 0.0;  ///< [s]
  Eigen::Vector3d true_p_EB = Eigen::Vector3d::Zero(), p_EB = Eigen::Vector3d::Zero();
  /// Shares of the error from the target gate, as in ErrorLedger.
  Eigen::Vector3d estimate = Eigen::Vector3d::Zero(), detection = Eigen::Vector3d::Zero(),
                  map = Eigen::Vector3d::Zero();
  int target = 0;   ///< Gate that the pilot flies to.
  int counted = 0;  ///< Gates that the pilot has counted ...
  int passed = 0;   ///< ... and the referee.
  enum class Flying { kTakeOff, kCourse, kSearch, kLand } flying = Flying::kCourse;
  double wait_x = 0.0;  ///< Waiting place of a search on the gate's axis [m].
  Eigen::Vector2d wind_E = Eigen::Vector2d::Zero();  ///< [m/s]
  std::optional<double> since_fix = std::nullopt;    ///< [s]
  std::optional<Eigen::Vector3d> fix_error = std::nullopt;
  std::optional<WrongFix> wrong_fix = std::nullopt;
  LooksSinceFix looks{};
};

/// The surroundings of the loss: what stood there and what was planned.
struct LossPlace {
  const world::World& world;
  const Track& map;
  const RacePlan& plan;
};

/// Why a race was not finished.
struct WhyLost {
  enum class How {
    kContact,
    kMissedGate,  ///< Counted by the pilot, not by the referee.
    kNotFound,    ///< Searched for the gate until it gave up.
    kGivenUp,     ///< For another reason: a sensor, the motors.
    kTimeout,
  };
  enum class Cause { kEstimate, kGuidance, kMap, kDetection, kInTheWay, kGivenUp, kTimeout };

  How how = How::kContact;
  Cause cause = Cause::kEstimate;
  double time = 0.0;         ///< When it touched, missed or gave up [s].
  int gate = 1;              ///< The first one of the race that was not passed, from 1.
  std::string reason{};      ///< Why the pilot gave up; "" when it did not.
  std::string object{};      ///< "right bar of gate 3", "east wall"; "" when nothing was touched.
  bool at_its_gate = false;  ///< The object, or what was missed, is a part of the gate it flew to.
  /// The miss is measured from the middle of a gate; else from the way that was planned.
  bool from_gate = false;

  // Along the gate's axis or the way, to its right, down [m]. The four add up to the miss.
  Eigen::Vector3d miss = Eigen::Vector3d::Zero();
  Eigen::Vector3d estimate = Eigen::Vector3d::Zero();   ///< Share of IMU, drag and wind.
  Eigen::Vector3d guidance = Eigen::Vector3d::Zero();   ///< Believed place less its aim.
  Eigen::Vector3d map = Eigen::Vector3d::Zero();        ///< Gates that stand elsewhere.
  Eigen::Vector3d detection = Eigen::Vector3d::Zero();  ///< Share of wrong fixes.
  /// Parts of the miss's length, in its direction, in this order; negative: against it [m].
  std::array<double, 4> shares{};

  std::optional<double> since_fix = std::nullopt;           ///< [s]
  std::optional<Eigen::Vector3d> fix_error = std::nullopt;  ///< Last fix's, as the miss [m].
  std::optional<WrongFix> wrong_fix = std::nullopt;
  LooksSinceFix looks{};
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< Along and to the right, then [m/s].
  double wind_mean = 0.0;                          ///< Its speed, over the flight [m/s].
};

/// Renames an object of the physics, "gate 3 right bar", "obstacle 2", to "right bar of gate 3",
/// "obstacle 2 (a pole)".
[[nodiscard]] std::string named(const std::string& object, const world::World& world);

/// Splits the miss of a moment: the truth from its aim.
///
/// At the target gate, or the one just counted, the aim is the middle of the gate as it stands; else
/// the place of the planned way that is nearest to where the drone believed to be.
/// @param object  as physics calls it; "" when nothing was touched.
[[nodiscard]] WhyLost why_lost(const LossMoment& moment, const LossPlace& place, WhyLost::How how,
                               const std::string& object);

}  // namespace gatefly::simulated_race
