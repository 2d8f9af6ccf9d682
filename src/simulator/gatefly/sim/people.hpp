// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "gatefly/world/world.hpp"

namespace gatefly::sim {

/// A person's place at time t [s]; they walk to one end, then back, without a pause.
[[nodiscard]] Eigen::Vector2d place_of(const world::Person& person, double t);

/// Which person a drone touches at time t, counted from 0.
///
/// A person is an upright cylinder 0.5 m wide; the drone a sphere about its centre.
/// @param radius  of the drone [m].
[[nodiscard]] std::optional<int> touched_person(std::span<const world::Person> people,
                                                const Eigen::Vector3d& p_EB, double radius,
                                                double t);

}  // namespace gatefly::sim
