// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace gatefly::sim {

/// Obstacles between two points of a world.
class Sight {
 public:
  virtual ~Sight() = default;

  /// Whether a point of the earth frame is hidden from another by anything solid.
  [[nodiscard]] virtual bool occluded(const Eigen::Vector3d& from_E,
                                      const Eigen::Vector3d& to_E) const = 0;

  /// Distance from `from_E` along the unit `direction_E` to the first solid thing, at most `max`
  /// [m].
  [[nodiscard]] virtual double range(const Eigen::Vector3d& from_E,
                                     const Eigen::Vector3d& direction_E, double max) const = 0;
};

}  // namespace gatefly::sim
