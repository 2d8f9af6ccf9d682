// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "gatefly/sim/rectangle_tree.hpp"
#include "gatefly/sim/scene.hpp"

namespace gatefly::sim {

/// Rays that go much the same way, eight and eight from one point, and what they hit.
struct alignas(64) RayTile {
  static constexpr int kLanes = 8, kMostGroups = 32, kMost = kLanes * kMostGroups;

  float ox[kMostGroups], oy[kMostGroups], oz[kMostGroups];  ///< Origin of each group [m].
  /// Unit direction of each ray, earth frame; zero: a ray that hits nothing.
  float dx[kMost], dy[kMost], dz[kMost];

  float t[kMost];  ///< Distance of the nearest hit so far [m]; what is farther is not looked at.
  float u[kMost], v[kMost];  ///< Place on the rectangle, along edges.
  int hit[kMost];            ///< The rectangle; -1: none, or one that is seen from behind (black).

  int groups = 0;  ///< In use, from the first on.
};

/// Finds the nearest of many rectangles for a tile of rays at once.
///
/// One walk through the tree serves all rays of a tile: boxes outside of its four bounding planes,
/// or behind all that was hit, are left out. Each rectangle left over is tried with eight rays at a
/// time. Plain arithmetic without fused operations: the same bits on every machine.
class TileCaster {
 public:
  /// A hit's number is the rectangle's place in the lists, one after the other, plus `first`.
  explicit TileCaster(const std::vector<const std::vector<Rectangle>*>& lists, int first = 0);

  /// Forgets what a tile has hit.
  static void clear(RayTile& tile);
  /// Goes on with what the tile has hit so far: several casters may look at one tile in turn.
  void cast(RayTile& tile) const;

 private:
  /// A rectangle as rays want it: its plane, and the vectors whose products are u and v.
  struct alignas(16) Face {
    float corner_x[4], corner_y[4], corner_z[4];
    float n[3], n_c, a[3], a_c, b[3], b_c;
    int number;
    bool closed;
  };
  struct Bounds;

  static Face face_of(const Rectangle& r, int number);
  static bool meet(const Face& face, RayTile& tile);

  std::vector<RectangleTree::Node> nodes_;
  std::vector<Face> faces_;  // in the order of the leaves
};

}  // namespace gatefly::sim
