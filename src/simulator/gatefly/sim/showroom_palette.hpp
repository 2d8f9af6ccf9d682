// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "gatefly/sim/random.hpp"
#include "gatefly/sim/scene.hpp"

namespace gatefly::sim {

/// The showroom's materials, and the random numbers of its clutter (the same in every race).
struct ShowroomPalette {
  static constexpr int kCeilingLight = 0, kShowcaseLight = 1, kSpotLight = 2;

  explicit ShowroomPalette(SceneBuilder& builder);

  template <class List>
  int any_of(const List& list) {
    return list[static_cast<std::size_t>(random.uniform() * static_cast<double>(list.size()))];
  }
  bool chance(double share) { return random.uniform() < share; }

  Stream random{1, "showroom"};
  int floor, wall, ceiling, beam, pipe, column, blue, shelf, frame, lamp, strip, spot;
  int silver, skin, glass, yellow, green, carton, exit_sign;
  std::array<int, 6> glow{};     ///< Luminous back walls of show-cases.
  std::array<int, 14> things{};  /// Small exhibits: mostly grey, metal, black.
  std::array<int, 3> woods{};
  std::array<int, 5> posters{};
  std::array<int, 5> warm{};     ///< Orange, red, pink and brown things that are no gates.
  std::array<int, 3> fabrics{};  ///< Clothes and seats.
};

/// Chairs, racks, wall show-cases, doors, parts of aircraft along one wall.
///
/// @param wall  a runs along it, b into the room.
void dress_showroom_wall(SceneBuilder& builder, ShowroomPalette& palette, const FloorFrame& wall,
                         double length);

/// Beams, pipes, ducts, lamps, hanging aircraft; all above 2.6 m.
void dress_showroom_ceiling(SceneBuilder& builder, ShowroomPalette& palette,
                            const world::World& world);

/// One glazed side of a show-case: sections of luminous back wall, shelves, things, light strip.
///
/// @param frame  a runs along the side, b from the luminous wall (0) to the glass (depth).
void add_showcase_side(SceneBuilder& builder, ShowroomPalette& palette, const FloorFrame& frame,
                       double half, double depth, double top);

/// Small boxes standing on a surface at height `base` between two corners of a frame.
void add_small_things(SceneBuilder& builder, ShowroomPalette& palette, const FloorFrame& frame,
                      const Eigen::Vector2d& low, const Eigen::Vector2d& high, double base,
                      double tallest, int count);

}  // namespace gatefly::sim
