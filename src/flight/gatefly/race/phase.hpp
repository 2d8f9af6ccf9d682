// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <variant>

#include <Eigen/Core>

#include "gatefly/control/arc.hpp"

namespace gatefly {

/// Standing on the pad: biases are learnt, motors are off.
struct OnGround {};
/// Straight up, until it is high enough to go and has seen the first gate, if that should show from there.
struct TakeOff {
  double since = 0.0;  ///< [s]
  /// Since when it is high enough, and waits for that gate [s].
  std::optional<double> waits_since = std::nullopt;
};
/// On a straight: PD onto the line, Li18 Eq. (22).
struct Straight {};
/// In a turn: feed-forward on the predicted velocity, Li18 Eq. (29).
struct Turn {
  Arc arc;
};
/// The gate should be in view and is not: wait before it and look around. Or the place has become too
/// uncertain for the room beside the way: stand and turn round until a gate tells.
struct Search {
  double since = 0.0;    ///< [s]
  double gate_x = -2.2;  ///< Waiting place on the gate's axis; negative: before the gate [m].
  std::optional<Eigen::Vector2d> stand_at = std::nullopt;  ///< Here instead, turning round [m], ...
  double yaw = 0.0;                                        ///< ... from this heading [rad] ...
  double rate = 1.2;                                       ///< ... so fast [rad/s].
  double drift = 0.0;  ///< Situation::drift_sigma when a stand began [m].
  /// Since when it had waited before the gate, where a stand interrupts that [s].
  std::optional<double> waited_since = std::nullopt;
};
/// All gates passed, or given up: level, down.
struct Land {
  double since = 0.0;       ///< [s]
  double z = 0.0;           ///< Height when it began, z down [m].
  bool in_a_hurry = false;  ///< Where it is grows less certain while it waits: down at once.
};
/// Motors off.
struct Landed {};

/// OnGround -> TakeOff -> Straight <-> Turn -> ... -> Land -> Landed; Straight <-> Search; any ->
/// Land.
using Phase = std::variant<OnGround, TakeOff, Straight, Turn, Search, Land, Landed>;

/// Why a flight was given up; kNone while it was not.
enum class AbortReason { kNone, kGateNotFound, kNoClimb, kUpset, kSensorsLost, kNoPictures };

/// Between take-off and landing.
[[nodiscard]] bool is_flying(const Phase& phase);

[[nodiscard]] const char* name_of(const Phase& phase);
[[nodiscard]] const char* text_of(AbortReason reason);

/// The part of belief and plan that decides the phase.
struct Situation {
  double time = 0.0;          ///< [s]
  int rest_samples = 0;       ///< Samples of the rest calibration so far.
  bool lifted = false;        ///< Another pilot flies, and has taken off.
  double height = 0.0;        ///< Above the pad [m].
  bool course_done = false;   ///< Every gate of every lap passed, and the last one left behind.
  bool turn_ahead = false;    ///< The path curves at the look-ahead point.
  double to_go = 10.0;        ///< Along the path to the gate [m].
  double to_stop = 1e9;       ///< Along the path to the next stop of the plan [m].
  double gate_x = -10.0;      ///< Along the gate's axis, negative before it [m].
  double room_before = 1e9;   ///< On the axis before the gate, to stand and wait in [m].
  double gate_y = 0.0;        ///< To the right of the axis [m].
  double gate_y_ahead = 0.0;  ///< Predicted gate_y in the gate's plane [m].
  /// Standard deviation of gate_y, without the part by the gate's heading: it vanishes in the
  /// gate's plane [m].
  double lateral_sigma = 0.0;
  Eigen::Vector2d p_EB{0, 0}, v_E{0, 0};  ///< On the floor plan [m] [m/s].
  /// Drift of p_EB since a gate last confirmed or contradicted it: one standard deviation along the
  /// worse axis [m]. The map's own error is not in it.
  double drift_sigma = 0.0;
  double since_doubt = 1e9;    ///< Since gates in view contradicted the place [s].
  double room_beside = 1e9;    ///< From the outline to anything solid while it could stop [m].
  double speed = 0.0;          ///< [m/s]
  double forward_speed = 0.0;  ///< [m/s]
  double yaw = 0.0;            ///< [rad]
  double since_fix = 0.0;      ///< Since a sighting of the target was accepted [s].
  bool shows_whole = true;     ///< From here, level, the camera would see the whole gate.
  /// The last picture should have shown it: Sighting::expected. False where another pilot flies.
  bool gate_expected = false;
  double tilt = 0.0;        ///< Between body and earth vertical [rad].
  double since_imu = 0.0;   ///< Since the last finite IMU sample [s].
  bool imu_stuck = false;   ///< Its samples stay the same.
  double since_gate = 1e9;  ///< Since the last gate was passed [s].
  /// Since a picture came, whatever was in it; 0 before the first, and where another pilot flies [s].
  double since_picture = 0.0;
  double picture_interval = 0.0;  ///< From one to the next, in the mean [s].
};

struct PhaseParams {
  int rest_samples = 768;      ///< 1.5 s at 512 Hz. [estimate]
  double go_height = 0.7;      ///< Start forward flight above this [m] ... [estimate]
  double go_after = 0.0;       ///< ... and after so long [s]. [Li18 code: 2]
  double climb_timeout = 6.0;  ///< [s]
  /// A first gate that should show from above the pad is waited for until it has been seen within so
  /// long [s] ...
  double seen_at_start = 1.0;
  /// ... and it comes down again after so long, for by drag alone it drifts half a metre a second at
  /// worst; 0: it is not waited for [s]. [estimate]
  double first_gate_timeout = 2.5;

  bool goes_around = true;  ///< Waits and searches where the gate is uncertain. [estimate]
  // Into a search ...
  double search_before = 2.2;  ///< Decide between here ...  [m] [estimate]
  /// ... and here before the gate: 1.2 m and half a body stop 2.0 m/s [m]. [estimate]
  double search_until = 1.4;
  double search_detour =
      0.8;  ///< A way that is longer by this leads past the gate first [m]. [estimate]
  double unseen_after = 0.4;  ///< Not seen means: not for so long [s]. [estimate]
  /// More uncertain about y than this: no pass. [ours: opening 0.9, body 0.38]
  double max_lateral_sigma = 0.22;
  /// Expected farther off the axis than this: go around. [ours: 0.27 touches]
  double max_miss = 0.20;
  double wait_before = 2.2;  ///< Waits at least so far before the gate [m] ... [estimate]
  double fall_back = 0.5;    ///< ... and so far behind where it is [m], [estimate]
  /// ... but so far from what ends the room, towards which it may drift while it sees nothing [m].
  /// [estimate]
  double drift = 0.5;

  // Stands and turns round where it may have drifted by more than this part of the room beside the way,
  // and than so much [m]: half of it and 0.35 m stop races that need no stop. [ours]
  double lost_part = 0.65, lost_sigma = 0.45;
  /// With a stop of the plan nearer than this it goes there: it stands and turns there anyway, and may
  /// have to climb before it sees anything [m]. [estimate]
  double lost_before_stop = 1.5;
  /// With rarer pictures than this a turn would pass over the gates: the drone flies on [s]. [ours]
  double lost_pictures = 0.25;
  double stops_within = 0.4;   ///< Comes to rest so much further on: this long at its speed [s].
  double turn_rate = 1.2;      ///< Turns so fast [rad/s], [estimate]
  double turns = 1.5;          ///< so often, then it lands, [estimate]
  double hopeless = 1.5;       ///< or once it may have drifted by so many times as much [ours]
  double doubt_settles = 1.0;  ///< and no gate has contradicted that for so long [s]. [estimate]

  // ... and out of it.
  /// Found again: seen so short ago [s], unless it is too near to be seen whole, [estimate]
  double seen_within = 0.3;
  double certain_part = 0.6;     ///< at most this part of max_lateral_sigma uncertain, [estimate]
  double max_found_miss = 0.5;   ///< not farther off the axis [m], [estimate]
  double found_slope = 0.3;      ///< nor than max_miss and this part of the way left, [estimate]
  double min_run_in = 1.2;       ///< with so much way left [m], [estimate]
  double max_found_speed = 0.7;  ///< and nearly standing still [m/s]. [estimate]
  double search_timeout = 15.0;  ///< [s]

  double landed_height = 0.12;  ///< Motors off below this [m] ... [ours: sonar on its feet]
  double land_timeout = 12.0;   ///< ... or after this [s]. [ours: 1 s, then 0.5 m/s from 5 m]
  double max_tilt = 1.2;        ///< Beyond it the flight is lost [rad].
  double imu_timeout = 0.2;     ///< [s]
  /// Without an IMU nothing levels the drone: motors off. Else an autopilot has one of its own, and is
  /// told to land.
  bool cuts_without_imu = true;
  // A camera is dead that sends nothing for so long ...
  double picture_timeout = 1.25;   ///< [s] [ours: with 1.5 m of sinking, F4's 3 s]
  double picture_intervals = 8.0;  ///< ... and that often its mean pause: 1 in 3000 at random.
};

struct Transition {
  Phase phase;
  AbortReason reason = AbortReason::kNone;
};

/// The phase after `phase`. Pure: no clock, no memory.
[[nodiscard]] Transition next_phase(const Phase& phase, const Situation& now,
                                    const PhaseParams& params);

}  // namespace gatefly
