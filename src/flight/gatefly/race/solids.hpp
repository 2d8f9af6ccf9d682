// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/race/path.hpp"
#include "gatefly/race/track.hpp"

namespace gatefly {

/// Something solid on the map, between two heights: an upright box, or beyond a wall.
struct MapSolid {
  enum class Kind { kObstacle, kGate, kWall, kFloor, kCeiling };
  Kind kind = Kind::kObstacle;
  int number = 0;                  ///< Index of the obstacle or gate, from 0.
  MapObstacle footprint;           ///< Its place on the floor plan; its height is not used.
  double bottom = 0.0, top = 1e9;  ///< Heights above the floor [m].
  Eigen::Vector2d inwards{0, 0};   ///< Walls only: unit vector into the room ...
  Eigen::Vector2d foot{0, 0};      ///< ... and a point of it [m].

  /// On the floor plan, negative inside [m].
  [[nodiscard]] double beside(const Eigen::Vector2d& p) const;
  /// Above it or below it, negative between its two heights [m].
  [[nodiscard]] double above_or_below(double height) const;
  [[nodiscard]] std::string name() const;  ///< "a wall", "obstacle 1", "gate 2", "the floor".
};

/// Walls, then obstacles, then the gates' frames and the poles they stand on, floor and ceiling.
///
/// A frame is a board as high and as wide as the gate's outer side. It stands on the floor, on the
/// frame of the gate beneath, or on a pole.
[[nodiscard]] std::vector<MapSolid> solids_of(const Track& track);

/// How much room there is between two things, and how much is needed.
struct Gap {
  std::string between;  ///< "between gate 1 and a wall".
  double width = 0.0;   ///< [m]
  double needed = 0.0;  ///< [m]
};

/// The gap between two things, on the floor plan or in height.
[[nodiscard]] Gap gap_between(const MapSolid& one, const MapSolid& other, const PlanParams& params);

/// The nearest solid thing on a way, from its middle line.
struct Nearest {
  double distance = 1e9;  ///< On the floor plan, of what is not well above or below [m].
  const MapSolid* solid = nullptr;
};

/// A part of a way, so far along it [m].
struct Stretch {
  double from = 0.0, to = 0.0;
};

/// Floor and ceiling are not looked at: a way's heights lie between its gates', or were searched for.
/// @param from_gate, to_gate  flown through at the two ends; a little way off they are in the way, too.
/// @param near_enough  looks no further once something is nearer than this [m].
[[nodiscard]] Nearest nearest_between(const std::vector<MapSolid>& solids, const PlanParams& params,
                                      const Path& path, const Stretch& stretch, int from_gate,
                                      int to_gate, double near_enough = -1e9);

/// The same of the whole way.
[[nodiscard]] Nearest nearest_solid(const std::vector<MapSolid>& solids, const PlanParams& params,
                                    const Path& path, int from_gate, int to_gate,
                                    double near_enough);

}  // namespace gatefly
