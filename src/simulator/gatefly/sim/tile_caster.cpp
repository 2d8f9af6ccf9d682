// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/tile_caster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include <Eigen/Geometry>

#ifdef __x86_64__
#include <immintrin.h>
#endif

// Eight rays in one register. Whoever has no AVX2 was turned away by RayScene.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#pragma GCC push_options
#pragma GCC target("avx2")
#endif

namespace gatefly::sim {
namespace {

constexpr int kLanes = RayTile::kLanes;
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int __attribute__((vector_size(16)));
using Float8 = float __attribute__((vector_size(32)));
using Int8 = int __attribute__((vector_size(32)));
using Floats8 = float __attribute__((vector_size(32), may_alias));
using Floats4 = float __attribute__((vector_size(16), may_alias));
using Ints8 = int __attribute__((vector_size(32), may_alias));

constexpr float kNear = 0.01f;    // the camera sees nothing nearer [m]
constexpr float kFar = 1e3f;      // [m]
constexpr float kEdge = 1e-5f;    // a rectangle is that much larger: no gaps between neighbours
constexpr float kMargin = 1e-4f;  // of the bounding planes, for rounding [m]
constexpr float kWidest = 0.2f;   // cosine to the axis beyond which a tile is not bounded

#ifdef __x86_64__
inline __attribute__((always_inline)) bool any(Int8 mask) {
  return _mm256_movemask_ps(__m256(mask)) != 0;
}
inline __attribute__((always_inline)) bool any(Int4 mask) {
  return _mm_movemask_ps(__m128(mask)) != 0;
}
#else
template <class Mask>
bool any(Mask mask) {
  int all = 0;
  for (unsigned i = 0; i < sizeof mask / sizeof(int); ++i) all |= mask[i];
  return all != 0;
}
#endif

inline __attribute__((always_inline)) Float8 load(const float* from) {
  return *reinterpret_cast<const Floats8*>(from);
}
inline __attribute__((always_inline)) void store(float* to, Float8 x) {
  *reinterpret_cast<Floats8*>(to) = x;
}

}  // namespace

/// Four planes and an axis about the rays of a tile.
struct TileCaster::Bounds {
  Float4 x{}, y{}, z{};          ///< Normals, inwards.
  Float4 least{-1, -1, -1, -1};  ///< Least product of a point with each.
  Eigen::Vector3f axis = Eigen::Vector3f::Zero();
  float start = 0.0f;  ///< The most that an origin lies along the axis.
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();  ///< Mean of the origins.
  float spread = 0.0f;                               ///< How far they are from it, at most.

  explicit Bounds(const RayTile& tile);
  [[nodiscard]] inline bool outside(const RectangleTree::Node& node) const {
    const auto reach = [&](Float4 n, int i) {
      const Float4 one = n * node.low[i], two = n * node.high[i];
      return one > two ? one : two;
    };
    return any(reach(x, 0) + reach(y, 1) + reach(z, 2) < least);
  }
  [[nodiscard]] inline float nearest(const RectangleTree::Node& node) const {
    float sum = -start;
    for (int i = 0; i < 3; ++i) sum += std::min(axis[i] * node.low[i], axis[i] * node.high[i]);
    return sum;
  }
  /// Whether no ray can meet it nearer than `far`, or would see but the inside of a closed thing.
  [[nodiscard]] inline bool outside(const Face& face, float far) const {
    if (face.closed && face.n[0] * middle.x() + face.n[1] * middle.y() + face.n[2] * middle.z() <
                           face.n_c - spread)
      return true;
    const auto corner = [](const float* c) { return *reinterpret_cast<const Floats4*>(c); };
    const Float4 cx = corner(face.corner_x), cy = corner(face.corner_y), cz = corner(face.corner_z);
    for (int i = 0; i < 4; ++i)
      if (!any(x[i] * cx + y[i] * cy + z[i] * cz >= Float4{} + least[i])) return true;
    return !any(axis.x() * cx + axis.y() * cy + axis.z() * cz < Float4{} + (far + start));
  }
};

TileCaster::Bounds::Bounds(const RayTile& tile) {
  Float8 sum_x{}, sum_y{}, sum_z{};
  const int rays = tile.groups * kLanes;
  for (int i = 0; i < rays; i += kLanes)
    sum_x += load(tile.dx + i), sum_y += load(tile.dy + i), sum_z += load(tile.dz + i);
  Eigen::Vector3f w = Eigen::Vector3f::Zero();
  for (int i = 0; i < kLanes; ++i) w += Eigen::Vector3f{sum_x[i], sum_y[i], sum_z[i]};
  const Eigen::Map<const Eigen::ArrayXf> ox{tile.ox, tile.groups}, oy{tile.oy, tile.groups},
      oz{tile.oz, tile.groups};
  const Eigen::Vector3f low_o{ox.minCoeff(), oy.minCoeff(), oz.minCoeff()},
      high_o{ox.maxCoeff(), oy.maxCoeff(), oz.maxCoeff()};
  middle = 0.5f * (low_o + high_o);
  spread = 0.5f * (high_o - low_o).norm() + kMargin;
  const float length = w.norm();
  if (!(length > 0.0f)) return;
  w /= length;
  const Eigen::Vector3f a = w.unitOrthogonal(), b = w.cross(a);

  // How far the rays lean along a and b, per length along w.
  const Float8 most = Float8{} + 1e9f;
  Float8 low_a = most, high_a = -most, low_b = most, high_b = -most, along = most;
  for (int i = 0; i < rays; i += kLanes) {
    const Float8 dx = load(tile.dx + i), dy = load(tile.dy + i), dz = load(tile.dz + i);
    const Int8 used = dx * dx + dy * dy + dz * dz > 0.25f;
    const Float8 one = Float8{} + 1.0f, cosine = w.x() * dx + w.y() * dy + w.z() * dz;
    const Float8 c = used ? cosine : one;
    const Float8 s = (a.x() * dx + a.y() * dy + a.z() * dz) / c,
                 r = (b.x() * dx + b.y() * dy + b.z() * dz) / c;
    along = c < along ? c : along;
    const Float8 s_low = used ? s : most, s_high = used ? s : -most, r_low = used ? r : most,
                 r_high = used ? r : -most;
    low_a = s_low < low_a ? s_low : low_a;
    high_a = s_high > high_a ? s_high : high_a;
    low_b = r_low < low_b ? r_low : low_b;
    high_b = r_high > high_b ? r_high : high_b;
  }
  float low[2] = {1e9f, 1e9f}, high[2] = {-1e9f, -1e9f}, cosine = 1.0f;
  for (int i = 0; i < kLanes; ++i) {
    low[0] = std::min(low[0], low_a[i]), high[0] = std::max(high[0], high_a[i]);
    low[1] = std::min(low[1], low_b[i]), high[1] = std::max(high[1], high_b[i]);
    cosine = std::min(cosine, along[i]);
  }
  start = 1e9f;
  if (cosine < kWidest) return;
  const Eigen::Vector3f normals[4] = {a - low[0] * w, high[0] * w - a, b - low[1] * w,
                                      high[1] * w - b};
  axis = w;
  start = -1e9f;
  least += 1e9f + 1.0f;
  for (int i = 0; i < 4; ++i) x[i] = normals[i].x(), y[i] = normals[i].y(), z[i] = normals[i].z();
  for (int g = 0; g < tile.groups; ++g) {
    const Float4 at = x * tile.ox[g] + y * tile.oy[g] + z * tile.oz[g] - kMargin;
    least = at < least ? at : least;
    start = std::max(start, w.x() * tile.ox[g] + w.y() * tile.oy[g] + w.z() * tile.oz[g] + kMargin);
  }
}

TileCaster::TileCaster(const std::vector<const std::vector<Rectangle>*>& lists, int first) {
  std::vector<const Rectangle*> all;
  for (const auto* list : lists)
    for (const Rectangle& r : *list) all.push_back(&r);
  const RectangleTree tree{all};
  nodes_ = tree.nodes();
  for (const int i : tree.order())
    faces_.push_back(face_of(*all[static_cast<std::size_t>(i)], first + i));
}

TileCaster::Face TileCaster::face_of(const Rectangle& r, int number) {
  Face face{};
  const Eigen::Vector3f corners[4] = {r.corner, r.corner + r.edge_u, r.corner + r.edge_u + r.edge_v,
                                      r.corner + r.edge_v};
  for (int i = 0; i < 4; ++i)
    face.corner_x[i] = corners[i].x(), face.corner_y[i] = corners[i].y(),
    face.corner_z[i] = corners[i].z();
  // a · edge_u = 1 and a · edge_v = 0; b the other way round.
  const Eigen::Vector3d u = r.edge_u.cast<double>(), v = r.edge_v.cast<double>(), n = u.cross(v);
  const Eigen::Vector3d a = v.cross(n) / n.squaredNorm(), b = n.cross(u) / n.squaredNorm();
  const Eigen::Vector3d c = r.corner.cast<double>();
  Eigen::Map<Eigen::Vector3f>{face.n} = n.normalized().cast<float>();
  Eigen::Map<Eigen::Vector3f>{face.a} = a.cast<float>();
  Eigen::Map<Eigen::Vector3f>{face.b} = b.cast<float>();
  face.n_c = static_cast<float>(n.normalized().dot(c));
  face.a_c = static_cast<float>(a.dot(c));
  face.b_c = static_cast<float>(b.dot(c));
  face.number = number;
  face.closed = r.closed;
  return face;
}

void TileCaster::clear(RayTile& tile) {
  for (int i = 0; i < tile.groups * kLanes; i += kLanes) {
    const Float8 dx = load(tile.dx + i), dy = load(tile.dy + i), dz = load(tile.dz + i);
    store(tile.t + i, dx * dx + dy * dy + dz * dz > 0.25f ? Float8{} + kFar : Float8{});
    *reinterpret_cast<Ints8*>(tile.hit + i) = Int8{} - 1;
  }
}

bool TileCaster::meet(const Face& face, RayTile& tile) {
  // Terms of the origins only.
  alignas(32) float to_plane[RayTile::kMostGroups], from_a[RayTile::kMostGroups],
      from_b[RayTile::kMostGroups];
  for (int g = 0; g < tile.groups; g += kLanes) {
    const Float8 ox = load(tile.ox + g), oy = load(tile.oy + g), oz = load(tile.oz + g);
    store(to_plane + g, face.n_c - (face.n[0] * ox + face.n[1] * oy + face.n[2] * oz));
    store(from_a + g, face.a[0] * ox + face.a[1] * oy + face.a[2] * oz - face.a_c);
    store(from_b + g, face.b[0] * ox + face.b[1] * oy + face.b[2] * oz - face.b_c);
  }
  bool met = false;
  for (int g = 0; g < tile.groups; ++g) {
    const int i = g * kLanes;
    const Float8 dx = load(tile.dx + i), dy = load(tile.dy + i), dz = load(tile.dz + i),
                 best = load(tile.t + i);
    const Float8 towards = face.n[0] * dx + face.n[1] * dy + face.n[2] * dz;
    const Float8 t = to_plane[g] / towards;
    const Int8 nearer = (t > kNear) & (t < best);
    if (!any(nearer)) continue;
    const Float8 u = from_a[g] + t * (face.a[0] * dx + face.a[1] * dy + face.a[2] * dz);
    const Float8 v = from_b[g] + t * (face.b[0] * dx + face.b[1] * dy + face.b[2] * dz);
    const Int8 in =
        nearer & (u >= -kEdge) & (u <= 1.0f + kEdge) & (v >= -kEdge) & (v <= 1.0f + kEdge);
    if (!any(in)) continue;
    met = true;
    store(tile.t + i, in ? t : best);
    store(tile.u + i, in ? u : load(tile.u + i));
    store(tile.v + i, in ? v : load(tile.v + i));
    Ints8& hit = *reinterpret_cast<Ints8*>(tile.hit + i);
    const Int8 seen = towards < 0.0f ? Int8{} + face.number : Int8{} - 1;
    hit = in ? seen : hit;
  }
  return met;
}

void TileCaster::cast(RayTile& tile) const {
  if (nodes_.empty()) return;
  const Bounds bounds{tile};
  const auto farthest = [&] {
    Float8 most{};
    for (int i = 0; i < tile.groups * kLanes; i += kLanes) {
      const Float8 t = load(tile.t + i);
      most = t > most ? t : most;
    }
    float result = 0.0f;
    for (int i = 0; i < kLanes; ++i) result = std::max(result, most[i]);
    return result;
  };
  float far = farthest();
  struct Waiting {
    int node;
    float nearest;
  };
  std::array<Waiting, RectangleTree::kDeepest + 2> stack;
  std::size_t waiting = 0;
  const auto push = [&](int index) {
    const RectangleTree::Node& node = nodes_[static_cast<std::size_t>(index)];
    if (bounds.outside(node)) return;
    const float nearest = bounds.nearest(node);
    if (nearest < far) stack[waiting++] = {index, nearest};
  };
  push(0);
  while (waiting > 0) {
    const auto [index, nearest] = stack[--waiting];
    if (nearest >= far) continue;
    const RectangleTree::Node& node = nodes_[static_cast<std::size_t>(index)];
    if (node.count == 0) {
      const std::size_t before = waiting;
      push(node.first);
      push(node.first + 1);
      // The nearer one is looked at first.
      if (waiting == before + 2 && stack[before].nearest < stack[before + 1].nearest)
        std::swap(stack[before], stack[before + 1]);
      continue;
    }
    bool met = false;
    for (int k = node.first; k < node.first + node.count; ++k) {
      const Face& face = faces_[static_cast<std::size_t>(k)];
      if (!bounds.outside(face, far)) met |= meet(face, tile);
    }
    if (met) far = farthest();
  }
}

}  // namespace gatefly::sim

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif
