// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/sim/sight.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::sim {

/// A solid thing: an upright box, or an upright pole of diameter size.x().
struct Solid {
  std::string name;  ///< "north wall", "gate 1 left bar", "obstacle 3", ...
  Eigen::Vector3d center_E{0, 0, 0};
  Eigen::Vector3d size{0, 0, 0};  ///< Along its own axes [m].
  double heading = 0.0;           ///< [rad]
  bool pole = false;
};

/// Everything solid in a world but the floor: walls, ceiling, gates, obstacles, decoys.
[[nodiscard]] std::vector<Solid> solids_of(const world::World& world);

/// Looks through a world of boxes and poles; the floor is in sight, too.
class SolidSight final : public Sight {
 public:
  explicit SolidSight(const world::World& world);

  [[nodiscard]] bool occluded(const Eigen::Vector3d& from_E,
                              const Eigen::Vector3d& to_E) const override;
  [[nodiscard]] double range(const Eigen::Vector3d& from_E, const Eigen::Vector3d& direction_E,
                             double max) const override;

 private:
  struct Shape {
    Eigen::Vector3d center_E, half;
    double cos, sin;  ///< Heading of it.
    bool pole;
  };
  std::vector<Shape> shapes_;
};

}  // namespace gatefly::sim
