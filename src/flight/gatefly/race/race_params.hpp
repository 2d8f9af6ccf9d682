// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/geometry/math.hpp"

// Parameters of lookout, course and guidance, given before take-off. The plan's and the phases' own
// numbers are in path.hpp and phase.hpp.

namespace gatefly {

struct CameraTiming {
  double latency = 0.044;  ///< From the middle of the exposure of the middle line to arrival [s].
  /// Leftmost to rightmost upright column; negative: from right to left [s].
  double readout = 0.020;
  double readout_down = 0.0;  ///< The same from row to row, of a camera whose lines are rows [s].

  /// How much later than the picture's middle a pixel is exposed [s].
  [[nodiscard]] double later(const Eigen::Vector2d& px, const Eigen::Vector2d& size_px) const {
    const Eigen::Vector2d off =
        (px.cwiseQuotient(size_px).array() - 0.5).cwiseMax(-0.5).cwiseMin(0.5);
    return off.x() * readout + off.y() * readout_down;
  }
};

/// When a detection is the gate that is looked for. NIS: normalised innovation squared of its fix.
struct SightParams {
  /// NIS below which nothing better is looked for: 3 in 4 of the right ones. [chi-square, 3]
  double convincing = 4.1;
  /// NIS above which a second sighting has to agree: 1 in 20 of the right ones. [chi-square, 3]
  double confirm_above = 7.8;
  double blind_after = 1.0;  ///< Without a fix for this long a leg was flown blind [s]. [estimate]
  double agree =
      0.4;  ///< Two sightings from places nearer than this agree [m]. [ours: 66 ms apart]
  /// Only nearer gates restart the position: errors of farther ones last for a second, so that they
  /// agree with each other, too [m]. [estimate]
  double restart_within = 7.0;
  /// The estimate may be off by this and still tell gates apart [m]. [estimate]
  double tell_apart = 1.5;
  /// Below this confidence a detection counts where a gate is expected only. [estimate]
  double sure = 0.9;
  /// Nearer than this the upper bar of a gate of 1 m may be cut off; of others by their side [m].
  /// [estimate]
  double parts_from = 4.5;
  /// The estimate says where the gate shows for so long after a fix [s]. [ours: .24 m off after 2 s]
  double expect_for = 2.0;
  /// A gate that should show is looked for carefully so long after a fix [s], ... [estimate]
  double careful_after = 0.2;
  int careful_every = 6;  ///< ... any gate in every so many pictures in any case. [estimate]
  int blind_every = 3;  ///< ... in every so many where no gate has told for expect_for. [estimate]
  /// A drone that knows its place no better looks for gates wherever they may be; asked of the filter
  /// that has the map [m]. [estimate]
  double lost_sigma = 0.8;
  /// Neighbouring pictures share their errors: a heading counts as one of so many. [estimate]
  double heading_repeats = 3.0;
};

struct CourseParams {
  double back = 0.5, ahead = 0.8;  ///< The nearest point is looked for so far around the last [m].
  double end = 1.5;    ///< A gate is passed only on this last part of the way to it [m]. [estimate]
  double past = 0.10;  ///< So far behind its plane a gate is passed [m]. [Li18 code: 0.1-0.5]
  double shortest_approach = 1.0;  ///< Straight way to a gate that was searched for [m]. [estimate]
  /// Flown of the way behind the last gate before it brakes: it may drift back by half a metre while it goes
  /// down, and land against the gate [m]. [ours: two of ten over a link that loses pictures]
  double run_out = 1.0;
  // A stop is done where it stands still, ...
  double stopped_within = 0.35;           ///< near the place [m], [estimate]
  double stopped_speed = 0.4;             ///< nearly [m/s], [estimate]
  double stopped_height = 0.2;            ///< at the height to go on at [m] [estimate]
  double stopped_angle = 12.0 * kDegree;  ///< and the heading. [estimate]
};

/// How fast the drone slows down: speeds that are planned are speeds that are flown [m/s²].
struct Braking {
  double on_the_way = 2.0;  ///< Before a curve. [ours: 12° nose up]
  double to_a_stop = 0.6;   ///< [ours: the pitch follows 0.4 m/s late]
};

struct SpeedParams {
  /// [rad/(m/s)] of speed error. [ours; paper: constant pitch]
  double pitch_gain = 0.14;
  double max_pitch = 14.0 * kDegree;   ///< Nose down.
  double min_pitch = -12.0 * kDegree;  ///< As nose up: braking.
  /// Roll starts this long before the curve [s]: INDI's lag. [estimate]
  double roll_lead = 0.16;
  /// A turn goes on by no more than this while the roll comes [rad]. [ours: INDI's 160 ms allow radii
  /// of 0.7 m at 3.2 m/s²; an autopilot's 240 ms are led off tighter turns]
  double turn_in_lead = 0.34;
  double brake_lead = 0.7;  ///< Slow down this long before the curve [s]. [estimate]
  Braking braking = {};     ///< Before that, and towards a stop.
  /// From the last turn to the gate at least [s]. [ours: PD, 2.1 rad/s]
  double settle = 1.3;
  double slowest = 1.0;  ///< ... unless that asks for less than this [m/s]. [estimate]
  /// Towards a gate that has not been seen from here [m/s]. [estimate]
  double unsure = 1.1;
  double unsure_before = 3.0;  ///< ... once it is nearer than this [m]. [estimate]
  double unsure_after = 0.6;   ///< Not seen means: not for so long [s] ... [estimate]
  double unsure_sigma = 0.2;   ///< ... and more uncertain to the side than this [m]. [estimate]
  double max_climb = 1.2;   ///< Up or down along a ramp [m/s]. [ours: half of what thrust can stop]
  double stand_from = 0.5;  ///< So near a stop the place is held [m]. [estimate]
  /// Limit of turn and correction together. [ours: INDI follows 40°]
  double max_roll = 38.0 * kDegree;
};

/// How far the nose may leave the way, so that the camera sees the next gate from a turn.
struct LookAsideParams {
  /// To either side of the way; 0: the nose goes where the drone goes, as the paper flies [rad].
  /// [ours: 60 and 180 degrees fly as well; docs/paper/deviations.md#look-aside]
  double most = 120.0 * kDegree;
  double rate = 1.8;  ///< [rad/s] [docs/paper/deviations.md#look-aside]
  /// Nearer to the gate than this part of its side the nose goes through it. [ours: estimate]
  double until_sides = 1.0;
};

/// Position hold: before take-off is done, while searching, while landing.
struct HoldParams {
  double stiffness = 0.9;     ///< [1/s²] [ours: with the damping ω 0.95, ζ 1]
  double damping = 2.0;       ///< [1/s] [estimate]
  double integral = 0.25;     ///< [1/s³] [ours: 1° of tilt would hold it 0.2 m beside]
  double max_integral = 0.5;  ///< [m/s²] [ours: 3° of tilt]
  double max_distance = 1.0;  ///< Farther away pulls no more [m]. [estimate]
  double max_accel = 1.8;     ///< [m/s²] [ours: 10°]
  double max_braking = 3.5;   ///< [m/s²] [ours: 1.7 m/s stop in 0.9 m, roll's lag included]
  double brake_from = 1.5;    ///< Above this speed it brakes before it steers [m/s]. [estimate]
  double climb_until = 0.25;  ///< Nearer to the floor the drone only goes up [m]. [estimate]
};

/// The paper's outer loop. Its other numbers are LateralParams and AltitudeParams.
struct PaperControlParams {
  double pitch = -5.0 * kDegree;                ///< θ_0, all the way. [Li18 §4: -5° or -7°]
  Eigen::Vector3d arc_drag{-0.53, -0.47, 0.0};  ///< k of Eq. (26) [1/s]. [Li18 code]
  double speed_drag = -0.55;                    ///< k_x of the speed on entry [1/s]. [Li18 code]
  double speed_time = 1.0;         ///< ... which is a mean over so long [s]. [Li18 code]
  double arc_end = 3.0 * kDegree;  ///< A turn is done so near its heading. [Li18 code]
  double take_off = 2.0;           ///< Climbs so long before the first straight [s]. [Li18 code]
};

}  // namespace gatefly
