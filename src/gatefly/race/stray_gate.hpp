// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "gatefly/detection/quad.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/pose/gate_fix.hpp"

namespace gatefly {

/// When a gate that the map does not have is the one that is flown to, standing elsewhere.
struct StrayParams {
  int least = 6;           ///< Seen so often at one place, ...
  double least_for = 0.3;  ///< ... over so long [s], ...
  double pause = 0.5;  ///< ... without a pause of so long [s]. [estimate: 5 Hz pictures have 0.2]
  double one_place = 0.6;       ///< Two sightings nearer than this are of one gate [m].
  double farthest = 3.5;        ///< A team places its gates better than this [m]. [estimate]
  double height = 0.6;          ///< And their heights [m].
  double turned = 0.9;          ///< And their directions [rad].
  double in_view = 0.7;         ///< The target should show this near to the camera's axis [rad].
  double within = 6.0;          ///< And at most so far away [m].
  double position_sigma = 0.5;  ///< A drone that knows less of where it is blames itself [m].
};

/// Where a detected gate stands, by its corners alone and by where the drone is; its direction is free.
///
/// Ours.
/// @param ago  the picture was exposed so long before the filter's now [s].
/// @return nullopt: no gate shows like that.
[[nodiscard]] std::optional<GateFrame> place_of(const Quad& corners_px, double side,
                                                const eskf::ErrorStateFilter& filter, double ago,
                                                const CameraRig& rig, const PoseParams& pose);

/// Watches detections that fit no gate of the map: seen at one place again and again, while the gate
/// that is flown to should show and does not, they say that the map is wrong.
class StrayGate {
 public:
  explicit StrayGate(const StrayParams& params = {}) : params_{params} {}

  void seen(const GateFrame& place, double time);
  /// The target was recognised: it stands where it is believed to.
  void target_seen() { count_ = 0; }
  /// The place of the target after all; nullopt: not certain, or too far from `map`.
  [[nodiscard]] std::optional<GateFrame> instead_of(const GateFrame& map) const;
  /// Whether the target ought to be in the picture now, the drone knowing where it is.
  [[nodiscard]] bool expects_target(const eskf::ErrorStateFilter& filter,
                                    const Eigen::Vector3d& p_BC) const;

 private:
  StrayParams params_;
  GateFrame mean_;
  int count_ = 0;
  double first_ = 0.0, last_ = 0.0;
};

}  // namespace gatefly
