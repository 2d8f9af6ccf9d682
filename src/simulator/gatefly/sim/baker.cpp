// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/baker.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "gatefly/geometry/math.hpp"

namespace gatefly::sim {
namespace {

constexpr int kPacket = 16;
constexpr int kBounceRays = 32;  // 8 look blotchy [docs/simulation.md]
static_assert(kBounceRays == 8 * 4, "stratified so");
static_assert(kBounceRays % kPacket == 0 && sizeof(RayScene::Valid) == kPacket * sizeof(int));
constexpr float kTiny = 1e-3f;  // keeps a ray off its own surface, share of its length or [m]

/// Light sent into the room: showcases look cyan through glass, but their tubes are white.
Color light_of(const Material& m) {
  const float mean = (m.emission[0] + m.emission[1] + m.emission[2]) / 3.0f;
  Color light;
  for (std::size_t c = 0; c < 3; ++c) light[c] = mean + 0.4f * (m.emission[c] - mean);
  return light;
}

bool shines(const Material& m) { return m.emission[0] + m.emission[1] + m.emission[2] > 0.0f; }

/// Share of the second albedo over a whole surface; only the bounces ask.
Color mean_albedo(const Material& m) {
  const float share = m.pattern == Pattern::kPlain ? 0.0f : 0.5f;
  Color mean;
  for (std::size_t c = 0; c < 3; ++c) mean[c] = m.albedo[c] + share * (m.second[c] - m.albedo[c]);
  return mean;
}

/// Shadow rays waiting to be cast together.
struct ShadowPacket {
  RTCRay16 ray{};
  RayScene::Valid valid{};
  std::array<Color, kPacket> light{};
  std::array<int, kPacket> group{};
  int count = 0;

  void flush(const RayScene& scene, NodeLight& sum) {
    if (count == 0) return;
    for (int i = 0; i < kPacket; ++i) valid.lane[i] = i < count ? -1 : 0;
    scene.occluded(valid, ray);
    for (int i = 0; i < count; ++i) {
      if (ray.tfar[i] < 0.0f) continue;
      const auto k = static_cast<std::size_t>(i);
      for (std::size_t c = 0; c < 3; ++c)
        sum[3 * static_cast<std::size_t>(group[k]) + c] += light[k][c];
    }
    count = 0;
  }
};

template <class Ray>
void set_ray(Ray& ray, int i, const Eigen::Vector3f& from, const Eigen::Vector3f& direction,
             float far) {
  ray.org_x[i] = from.x(), ray.org_y[i] = from.y(), ray.org_z[i] = from.z();
  ray.dir_x[i] = direction.x(), ray.dir_y[i] = direction.y(), ray.dir_z[i] = direction.z();
  ray.tnear[i] = kTiny, ray.tfar[i] = far;
  ray.time[i] = 0.0f, ray.id[i] = 0, ray.flags[i] = 0;
}

/// Irradiance at (u, v) of a rectangle from the nearest node.
const NodeLight& nearest(const Rectangle& r, float u, float v,
                         const std::vector<NodeLight>& nodes) {
  const int i =
      std::clamp(static_cast<int>(u * static_cast<float>(r.cells_u) + 0.5f), 0, r.cells_u);
  const int j =
      std::clamp(static_cast<int>(v * static_cast<float>(r.cells_v) + 0.5f), 0, r.cells_v);
  return nodes[static_cast<std::size_t>(r.first_node + j * (r.cells_u + 1) + i)];
}

}  // namespace

Baker::Baker(const Scene& scene, const RayScene& rays) : scene_{scene}, rays_{rays} {
  for (const Rectangle& r : scene.fixed) {
    const Material& m = scene.materials[static_cast<std::size_t>(r.material)];
    if (shines(m))
      lights_.push_back({&r, m.group, light_of(m), r.corner + 0.5f * (r.edge_u + r.edge_v),
                         r.length.x() * r.length.y()});
  }
}

NodeLight Baker::direct(const SurfacePoint& at, NodeRandom random) const {
  NodeLight sum{};
  ShadowPacket packet;
  for (const Light& light : lights_) {
    const float near2 = std::max((light.centre - at.p).squaredNorm(), 0.05f);
    const int count = std::clamp(static_cast<int>(8.0f * light.area / near2), 1, 6);
    for (int k = 0; k < count; ++k) {
      const float u = (static_cast<float>(k) + random.uniform()) / static_cast<float>(count);
      const Eigen::Vector3f q =
          light.shape->corner + u * light.shape->edge_u + random.uniform() * light.shape->edge_v;
      const Eigen::Vector3f d = q - at.p;
      const float here = d.dot(at.n), there = -d.dot(light.shape->normal),
                  r2 = std::max(d.squaredNorm(), 0.02f);
      if (here <= 0.0f || there <= 0.0f) continue;
      const float weight = here * there / (r2 * r2) * light.area / static_cast<float>(count);
      const auto i = static_cast<std::size_t>(packet.count);
      for (std::size_t c = 0; c < 3; ++c) packet.light[i][c] = weight * light.radiance[c];
      packet.group[i] = light.group;
      set_ray(packet.ray, packet.count++, at.p, d, 0.999f);
      if (packet.count == kPacket) packet.flush(rays_, sum);
    }
  }
  packet.flush(rays_, sum);
  return sum;
}

NodeLight Baker::bounced(const SurfacePoint& at, NodeRandom random,
                         const std::vector<NodeLight>& from) const {
  const Eigen::Vector3f side = at.n.unitOrthogonal(), other = at.n.cross(side);
  NodeLight sum{};
  for (int first = 0; first < kBounceRays; first += kPacket) {
    RTCRayHit16 packet{};
    RayScene::Valid valid{};
    for (int i = 0; i < kPacket; ++i) {
      // Cosine-weighted and stratified in 8 x 4, so that the mean over rays is the irradiance / π.
      const int cell = first + i;
      const float height2 = (static_cast<float>(cell / 8) + random.uniform()) / 4.0f;
      const double angle = 2 * kPi * (cell % 8 + static_cast<double>(random.uniform())) / 8;
      const SinCos s = sincos(angle);
      const float radius = std::sqrt(height2);
      const Eigen::Vector3f d = radius * static_cast<float>(s.cos) * side +
                                radius * static_cast<float>(s.sin) * other +
                                std::sqrt(1.0f - height2) * at.n;
      set_ray(packet.ray, i, at.p, d, 1e3f);
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      valid.lane[i] = -1;
    }
    rays_.intersect(valid, packet, RayScene::Rays::kIncoherent);
    for (int i = 0; i < kPacket; ++i) {
      if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      const Rectangle& r = scene_.fixed[packet.hit.primID[i]];
      const Eigen::Vector3f d{packet.ray.dir_x[i], packet.ray.dir_y[i], packet.ray.dir_z[i]};
      if (d.dot(r.normal) >= 0.0f) continue;
      const Color albedo = mean_albedo(scene_.materials[static_cast<std::size_t>(r.material)]);
      const NodeLight& light = nearest(r, packet.hit.u[i], packet.hit.v[i], from);
      for (std::size_t c = 0; c < light.size(); ++c)
        sum[c] += albedo[c % 3] * light[c] / kBounceRays;
    }
  }
  return sum;
}

}  // namespace gatefly::sim
