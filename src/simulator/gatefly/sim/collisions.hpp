// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/solids.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// The eight corners of a vehicle's box, in the body frame [m].
[[nodiscard]] std::vector<Eigen::Vector3d> corners_of(const world::VehicleTruth& vehicle);

/// All points that have to fit through a gate: the box's corners and twelve on each propeller's rim
/// [m].
[[nodiscard]] std::vector<Eigen::Vector3d> outline_of(const world::VehicleTruth& vehicle);

/// Contacts of the vehicle's box, as MuJoCo has them: boxes and poles by separating axes. Not the
/// floor.
///
/// At 1 kHz nothing is flown through between two steps: that would take 50 m/s at a gate's bar.
class Collisions {
 public:
  Collisions(const world::World& world, const world::VehicleTruth& vehicle);

  /// The first thing that the body touches; nullptr when it flies free. Allocates nothing.
  [[nodiscard]] const std::string* touched(const BodyState& state) const;

 private:
  struct Shape {
    std::string name;
    Eigen::Vector3d center_E, half;
    Eigen::Matrix3d R_SE;  ///< Into its own axes.
    bool pole;
  };
  [[nodiscard]] bool touches(const Shape& shape, const BodyState& state,
                             const Eigen::Matrix3d& R_EB) const;

  Eigen::Vector3d half_;
  std::vector<Shape> shapes_;
};

}  // namespace gatefly::sim
