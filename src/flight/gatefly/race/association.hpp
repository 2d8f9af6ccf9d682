// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/estimation/eskf/error_state_filter.hpp"
#include "gatefly/pose/gate_fix.hpp"
#include "gatefly/race/race_params.hpp"

// Which gate of the map, and which face of it, a detection is.
namespace gatefly {

/// A camera's pictures: what turns pixels into sightings.
struct PictureClock {
  const CameraRig& camera;
  const CameraTiming& timing;
  double arrival = 0.0;  ///< [s]
  Eigen::Vector2d size_px{315.0, 160.0};
  double jitter = 0.010;    ///< Standard deviation of the arrival time [s].
  double interval = 0.066;  ///< Usual time from one picture to the next [s].
};

/// Nullopt: a corner is outside of the lens' field of view.
[[nodiscard]] std::optional<eskf::GateSight> sight_of(const Quad& corners_px,
                                                      const PictureClock& picture);
/// A sighting of a gate that the border cuts, or of an opening, by its corners in view; nullopt also
/// for fewer than two.
[[nodiscard]] std::optional<eskf::GateSight> sight_of_cut(const GateDetection& cut,
                                                          const PictureClock& picture);
[[nodiscard]] std::optional<eskf::GateSight> sight_of(const LowerCorners& lower,
                                                      const PictureClock& picture);
[[nodiscard]] std::optional<eskf::GateSight> sight_of(const GateBars& bars,
                                                      const PictureClock& picture);

/// A sighting with the hypothesis that explains it best.
struct Associated {
  eskf::GateSight sight;
  eskf::Innovation innovation;
  double margin = 0.0;  ///< The next best one's −2 ln p is so much greater.
};

/// The most probable of all gates that have a slot, and both faces of each; nullopt when none is
/// within `max_nis`.
[[nodiscard]] std::optional<Associated> associate(const eskf::ErrorStateFilter& filter,
                                                  const eskf::GateSight& sight, double max_nis);

}  // namespace gatefly
