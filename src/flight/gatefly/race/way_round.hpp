// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/race/path.hpp"
#include "gatefly/race/solids.hpp"

namespace gatefly {

/// One end of a leg.
struct LegEnd {
  Eigen::Vector3d p_E{0, 0, 0};  ///< [m]
  double heading = 0.0;          ///< [rad]
  int gate = -1;                 ///< Flown through there; -1: the start, where one may turn first.
};

/// A way around, over or under, or why there is none.
struct WayRound {
  std::optional<Path> path;
  std::string blocked;  ///< Without a path: which gap is too narrow by how much.
};

/// The way between two gates where one pair of arcs is not free.
///
/// The shortest way on a grid that keeps its distance from everything, pulled taut; then each of its
/// corners is rounded by the widest arc that fits, or flown to a stop where not even `min_radius`
/// does. Start-up only: allocates.
///
/// @param room  the track, for how far it reaches.
/// @return      no path only if none exists: then the way whose narrowest gap is widest names that
///              gap. A grid of 0.1 m may take one for too narrow that is wide enough by less.
[[nodiscard]] WayRound way_round(const std::vector<MapSolid>& solids, const Track& room,
                                 const PlanParams& params, const LegEnd& from, const LegEnd& to);

}  // namespace gatefly
