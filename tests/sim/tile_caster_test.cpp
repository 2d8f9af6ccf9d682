// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/tile_caster.hpp"

#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "gatefly/sim/random.hpp"

namespace gatefly::sim {
namespace {

using Eigen::Vector3f;

Vector3f any_vector(Stream& draw, double size) {
  return Eigen::Vector3d{draw.uniform(-size, size), draw.uniform(-size, size),
                         draw.uniform(-size, size)}
      .cast<float>();
}

std::vector<Rectangle> any_rectangles(Stream& draw, int count) {
  std::vector<Rectangle> all;
  for (int i = 0; i < count; ++i) {
    Rectangle r{};
    r.corner = any_vector(draw, 5.0);
    r.edge_u = any_vector(draw, i % 10 == 0 ? 4.0 : 0.7);
    r.edge_v = r.edge_u.cross(any_vector(draw, 1.0)).normalized() * 0.5f;
    r.normal = r.edge_u.cross(r.edge_v).normalized();
    all.push_back(r);
  }
  return all;
}

/// One ray and all rectangles, one after the other.
struct Nearest {
  float t = 1e3f, u = 0.0f, v = 0.0f;
  int hit = -1;
};
Nearest nearest(const std::vector<Rectangle>& rectangles, const Vector3f& from, const Vector3f& d) {
  Nearest best;
  for (std::size_t i = 0; i < rectangles.size(); ++i) {
    const Rectangle& r = rectangles[i];
    const float towards = r.normal.dot(d), t = r.normal.dot(r.corner - from) / towards;
    const Vector3f at = from + t * d - r.corner;
    const float u = at.dot(r.edge_u) / r.edge_u.squaredNorm(),
                v = at.dot(r.edge_v) / r.edge_v.squaredNorm();
    if (t < 0.01f || t >= best.t || u < 0.0f || u > 1.0f || v < 0.0f || v > 1.0f) continue;
    best = {t, u, v, towards < 0.0f ? static_cast<int>(i) : -1};
  }
  return best;
}

/// Rays about one direction, each group from a place of its own.
RayTile any_tile(Stream& draw, double width) {
  RayTile tile;
  tile.groups = 32;
  const Vector3f from = any_vector(draw, 4.0), axis = any_vector(draw, 1.0).normalized();
  for (int g = 0; g < tile.groups; ++g) {
    const Vector3f origin = from + any_vector(draw, 0.02);
    tile.ox[g] = origin.x(), tile.oy[g] = origin.y(), tile.oz[g] = origin.z();
    for (int lane = 0; lane < RayTile::kLanes; ++lane) {
      const int i = g * RayTile::kLanes + lane;
      const Vector3f d = (axis + any_vector(draw, width)).normalized();
      tile.dx[i] = d.x(), tile.dy[i] = d.y(), tile.dz[i] = d.z();
    }
  }
  return tile;
}

void expect_the_nearest(const RayTile& tile, const std::vector<Rectangle>& rectangles, int& hits) {
  int differ = 0;
  for (int i = 0; i < RayTile::kMost; ++i) {
    const int g = i / RayTile::kLanes;
    const Nearest expected = nearest(rectangles, {tile.ox[g], tile.oy[g], tile.oz[g]},
                                     {tile.dx[i], tile.dy[i], tile.dz[i]});
    if (std::abs(tile.t[i] - expected.t) > 1e-3f * expected.t || tile.hit[i] != expected.hit) {
      ++differ;  // a ray along an edge: rounding decides
      continue;
    }
    if (tile.hit[i] < 0) continue;
    ++hits;
    EXPECT_NEAR(tile.u[i], expected.u, 1e-3);
    EXPECT_NEAR(tile.v[i], expected.v, 1e-3);
  }
  EXPECT_LE(differ, 1);
}

TEST(TileCaster, FindsWhatLookingAtEveryRectangleFinds) {
  Stream draw{1, "tiles"};
  const std::vector<Rectangle> rectangles = any_rectangles(draw, 400);
  const TileCaster caster{{&rectangles}};
  int hits = 0;
  for (const double width : {0.02, 0.1, 3.0})  // the last one looks everywhere: not bounded
    for (int k = 0; k < 40; ++k) {
      RayTile tile = any_tile(draw, width);
      TileCaster::clear(tile);
      caster.cast(tile);
      expect_the_nearest(tile, rectangles, hits);
    }
  EXPECT_GT(hits, 5000);
}

TEST(TileCaster, TwoInTurnFindWhatOneOfAllFinds) {
  Stream draw{2, "tiles"};
  const std::vector<Rectangle> one = any_rectangles(draw, 100), two = any_rectangles(draw, 100);
  const TileCaster both{{&one, &two}}, first{{&one}}, second{{&two}, 100};
  for (int k = 0; k < 40; ++k) {
    RayTile tile = any_tile(draw, 0.1), other = tile;
    TileCaster::clear(tile);
    TileCaster::clear(other);
    both.cast(tile);
    first.cast(other);
    second.cast(other);
    for (int i = 0; i < RayTile::kMost; ++i) {
      EXPECT_EQ(tile.t[i], other.t[i]);
      EXPECT_EQ(tile.hit[i], other.hit[i]);
    }
  }
}

TEST(TileCaster, WithoutRectanglesOrDirectionsNothingIsHit) {
  Stream draw{3, "tiles"};
  const std::vector<Rectangle> none, some = any_rectangles(draw, 50);
  RayTile tile = any_tile(draw, 0.1);
  TileCaster::clear(tile);
  TileCaster{{&none}}.cast(tile);
  for (const int hit : tile.hit) EXPECT_EQ(hit, -1);
  for (auto* part : {tile.dx, tile.dy, tile.dz}) std::fill_n(part, RayTile::kMost, 0.0f);
  TileCaster::clear(tile);
  TileCaster{{&some}}.cast(tile);
  for (const int hit : tile.hit) EXPECT_EQ(hit, -1);
}

TEST(RectangleTree, HoldsEveryRectangleThatHasASizeOnceAndInsideItsBoxes) {
  Stream draw{4, "tree"};
  std::vector<Rectangle> rectangles = any_rectangles(draw, 300);
  rectangles[7].edge_u.setZero();
  rectangles[100] = rectangles[101] = rectangles[102] = rectangles[103];
  std::vector<const Rectangle*> all;
  for (const Rectangle& r : rectangles) all.push_back(&r);
  const RectangleTree tree{all};
  std::vector<int> found(rectangles.size());
  for (const RectangleTree::Node& node : tree.nodes())
    for (int k = node.first; k < node.first + node.count; ++k) {
      const auto index = static_cast<std::size_t>(tree.order()[static_cast<std::size_t>(k)]);
      ++found[index];
      const Vector3f middle =
          rectangles[index].corner + 0.5f * (rectangles[index].edge_u + rectangles[index].edge_v);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(middle[axis], node.low[axis]);
        EXPECT_LE(middle[axis], node.high[axis]);
      }
    }
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], i == 7 ? 0 : 1) << i;
}

}  // namespace
}  // namespace gatefly::sim
