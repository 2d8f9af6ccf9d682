// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "gatefly/sim/exposure.hpp"
#include "gatefly/sim/gates_in_view.hpp"
#include "gatefly/sim/sight.hpp"
#include "gatefly/world/world.hpp"

// Things that a detector may take for a gate: the source of false alarms.

namespace gatefly::sim {

/// Something in a picture that is no gate.
struct LookAlike {
  int which = 0;                                ///< The same thing has the same number.
  std::array<Eigen::Vector2d, 4> corners_px{};  ///< Clockwise from top-left.
};

/// Frames that a bar of one gate and a bar of another make, where all four of their ends are seen.
[[nodiscard]] std::vector<LookAlike> frames_of_two(std::span<const GateView> views);

/// Decoys in sight whose middle is in the picture: the box around each.
[[nodiscard]] std::vector<LookAlike> decoys_in_view(const world::World& world, const Sight& sight,
                                                    Exposure& exposure);

/// A spot in the room that has something of a gate: a lamp, a show-case's edge.
struct Place {
  Eigen::Vector3d p_E{0, 0, 0};
  double size = 0.0;    ///< 0..1: which part of all alarms is smaller than those from here.
  double chance = 0.0;  ///< Standard normal: how good or bad a gate it makes.
};
/// Twelve of them on walls, one seed's.
[[nodiscard]] std::vector<Place> places_of(const world::World& world, std::uint64_t seed);

/// Which of them are in sight and in the picture.
[[nodiscard]] std::vector<int> places_in_view(std::span<const Place> places, const Sight& sight,
                                              Exposure& exposure);

}  // namespace gatefly::sim
