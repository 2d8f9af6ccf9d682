// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "gatefly/detection/quad.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/pose/gate_fix.hpp"

namespace gatefly {

/// When a gate that the map does not have is the one that is flown to, standing elsewhere.
struct StrayParams {
  int least = 5;            ///< Seen so often at one place, ...
  double least_for = 0.25;  ///< ... over so long [s], ...
  double pause = 4.0;       ///< ... without a pause of so long [s].
  double one_place = 0.5;   ///< Two sightings nearer than this are of one gate [m].
  double least_off = 0.8;   ///< Less is what a map may err by; the filter finds that by itself [m].
  double farthest = 3.5;    ///< A team places its gates better than this [m]. [estimate]
  double height = 0.6;      ///< And their heights [m].
  double turned = 0.9;      ///< And their directions [rad].
  double in_view = 0.7;     ///< The target should show this near to the camera's axis [rad].
  double within = 9.0;      ///< And at most so far away [m].
  double decided_after = 1.5;  ///< Time by which it is the target, or never [s].
  /// A drone blames itself for what is off by less than so many sigmas of its own place. [estimate]
  double own_sigmas = 2.2;
  double heading_sigma = 0.1;  ///< Nor is one to judge that knows its heading no better [rad].
  double least_fitness =
      0.6;  ///< Least fitness of a detection; low, as clutter does not repeat at one place.
};

/// The place of a detected gate, by its corners alone and by where the drone is; its direction is free.
///
/// Ours.
/// @param ago  the picture was exposed so long before the filter's now [s].
/// @return nullopt: no gate shows like that.
[[nodiscard]] std::optional<GateFrame> place_of(const Quad& corners_px, double side,
                                                const eskf::ErrorStateFilter& filter, double ago,
                                                const CameraRig& rig, const PoseParams& pose);

/// Whether another gate of the map than `target` stands there, as far as can be told.
/// @param sigma  of `place_E` [m].
[[nodiscard]] bool is_another_gate(const Eigen::Vector3d& place_E, double sigma,
                                   const eskf::Landmarks& map, std::size_t target,
                                   const StrayParams& params = {});

/// Watches detections that fit no gate of the map: seen at one place again and again, while the gate
/// that is flown to should show and does not, they say that the map is wrong.
class StrayGate {
 public:
  explicit StrayGate(const StrayParams& params = {}) : params_{params} {}

  /// @param sigma  of the drone's own place then [m].
  void seen(const GateFrame& place, double sigma, double time);
  /// The target was recognised: it stands where it is believed to, now and in later laps.
  /// @param gate  which one, of the map.
  void target_seen(std::size_t gate) {
    count_ = 0;
    if (gate < 64) recognised_ |= std::uint64_t{1} << gate;
  }
  [[nodiscard]] bool was_recognised(std::size_t gate) const {
    return gate < 64 && (recognised_ >> gate & 1) != 0;
  }
  /// The place of the target after all; nullopt: not certain, or too far from `map`.
  [[nodiscard]] std::optional<GateFrame> instead_of(const GateFrame& map) const;
  /// Whether something has been seen at one place lately, and it is not decided yet what it is.
  [[nodiscard]] bool is_followed(double time) const {
    return count_ > 1 && time - last_ < params_.pause && time - first_ < params_.decided_after;
  }
  /// Whether the target ought to be in the picture now, the drone knowing where it is.
  [[nodiscard]] bool expects_target(const eskf::ErrorStateFilter& filter,
                                    const Eigen::Vector3d& p_BC) const;

 private:
  StrayParams params_;
  GateFrame mean_;
  int count_ = 0;
  std::uint64_t recognised_ = 0;  ///< Gates of the map, a bit each.
  double first_ = 0.0, last_ = 0.0, sigma_ = 0.0;
};

}  // namespace gatefly
