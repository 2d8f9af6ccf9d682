// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/half_circles.hpp"
#include "gatefly/experiments/mocap_take.hpp"

namespace gatefly::experiments {

/// pitch(ψ) = mean + amplitude cos(ψ - heading) [rad]. The command is the same everywhere: what goes
/// with the heading is fixed to the room, as a tilt error of the drone's own attitude is.
struct PitchByHeading {
  double mean = 0.0, amplitude = 0.0, heading = 0.0;
};

/// The four takes of tudelft_bebop_mocap_laps and the half circles in them.
struct RecordedArcs {
  struct Take {
    MocapTake take;
    std::vector<SmoothSample> motion = {};
    HalfCircles found = {};
    /// Median on the straights before the arcs: is the nose where the frame says? [rad]
    double course_off_nose = 0.0;
    PitchByHeading pitch = {};  ///< From the first arc to the last.
    double roughness = 0.0;     ///< Largest distance of a sample inside an arc from the curve [m].
  };
  std::vector<Take> takes;  ///< Empty where the data is not there.

  [[nodiscard]] std::vector<BlindArc> arcs() const;
};

/// @throws std::runtime_error a take is wrong; Stopped.
[[nodiscard]] RecordedArcs recorded_arcs(const Options& options);

/// Take by take: its arcs, and the turns that are none. Other days, other settings perhaps.
void report_takes(const RecordedArcs& recorded, Result& result);

/// How far the mean end point moves when the rule of where an arc begins and ends does.
void report_rules(const RecordedArcs& recorded, Result& result);

}  // namespace gatefly::experiments
