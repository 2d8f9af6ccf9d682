// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/pose/gate_fix.hpp"
#include "gatefly/race/lookout.hpp"
#include "gatefly/race/messages.hpp"
#include "gatefly/race/track.hpp"

namespace gatefly {

/// Attitude against the gate's frame at a moment.
[[nodiscard]] RotationGB R_GB_of(const Navigator::Past& then);

/// A fix of the target gate, from a picture.
struct SeenFix {
  Fix fix;
  const Navigator::Past* then = nullptr;  ///< When it was exposed.
  Sighting::Source source = Sighting::Source::kNone;
  bool may_restart = false;  ///< See DelayedFilter::correct.
};

/// Corrects the navigator, and says in the sighting what came of it. False: the filter refused.
/// @param gate_yaw_sigma  how well the gate's heading is known [rad].
bool fuse(const SeenFix& seen, const MapGate& gate, double gate_yaw_sigma, Navigator& navigator,
          Sighting& sighting);

}  // namespace gatefly
