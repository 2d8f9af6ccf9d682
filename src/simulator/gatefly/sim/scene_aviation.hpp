// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/sim/showroom_palette.hpp"

namespace gatefly::sim {

// Parts of aircraft as they stand about in the showroom. All take a floor frame with a along the
// wall and b, at most 0.38 m, into the room.

/// A piece of a fuselage: white skin in fields, a row of windows, often a green edge.
void add_fuselage_panel(SceneBuilder& builder, ShowroomPalette& palette, const FloorFrame& wall,
                        double a, double width);
/// Ribs and spars of an uncovered wing, upright.
void add_rib_frame(SceneBuilder& builder, ShowroomPalette& palette, const FloorFrame& wall,
                   double a, double width);
/// Slender blades and wings that lean on the wall.
void add_leaning_wings(SceneBuilder& builder, ShowroomPalette& palette, const FloorFrame& wall,
                       double a, double width);
/// An engine on a stand: a drum, cylinders, pipes.
void add_engine(SceneBuilder& builder, ShowroomPalette& palette, const FloorFrame& wall, double a);
/// A wheel that leans on the wall.
void add_wheel(SceneBuilder& builder, ShowroomPalette& palette, const FloorFrame& wall, double a);
/// A row of aircraft seats.
void add_seats(SceneBuilder& builder, ShowroomPalette& palette, const FloorFrame& wall, double a,
               double width);
/// A small aircraft below the ceiling, no part of it lower than `low`.
void add_hanging_aircraft(SceneBuilder& builder, ShowroomPalette& palette, const FloorFrame& nose,
                          double low, double top);

}  // namespace gatefly::sim
