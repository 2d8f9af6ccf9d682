// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/light_map.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include <unistd.h>

#include <Eigen/Geometry>

#include "gatefly/geometry/math.hpp"

namespace gatefly::sim {
namespace {

constexpr std::uint64_t kVersion = 3;  // of everything that changes what a bake gives
constexpr int kPacket = 16;
constexpr int kBounceRays = 32;  // 8 look blotchy [guide/simulation.md]
constexpr float kTiny = 1e-3f;   // keeps a ray off its own surface [m]

/// Cheap random numbers by position: the finaliser of SplitMix64.
class NodeRandom {
 public:
  explicit NodeRandom(std::uint64_t position) : state_{position * 0x9E3779B97F4A7C15ull} {}
  float uniform() {
    state_ += 0x9E3779B97F4A7C15ull;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return static_cast<float>((z ^ (z >> 31)) >> 40) * 0x1p-24f;
  }

 private:
  std::uint64_t state_;
};

struct Light {
  const Rectangle* shape;
  const Material* material;
  Eigen::Vector3f centre;
  float area;
};

struct Point {
  Eigen::Vector3f p, n;
};

bool shines(const Material& m) { return m.emission[0] + m.emission[1] + m.emission[2] > 0.0f; }

/// Share of the second albedo over a whole surface; only the bounces ask.
Color mean_albedo(const Material& m) {
  const float share = m.pattern == Pattern::kPlain ? 0.0f : 0.5f;
  Color mean;
  for (std::size_t c = 0; c < 3; ++c) mean[c] = m.albedo[c] + share * (m.second[c] - m.albedo[c]);
  return mean;
}

/// Casts light at points of a scene.
class Baker {
 public:
  Baker(const Scene& scene, const RayScene& rays) : scene_{scene}, rays_{rays} {
    for (const Rectangle& r : scene.fixed) {
      const Material& m = scene.materials[static_cast<std::size_t>(r.material)];
      if (shines(m))
        lights_.push_back({&r, &m, r.corner + 0.5f * (r.edge_u + r.edge_v), r.length.x() * r.length.y()});
    }
  }

  /// Light straight from the lamps.
  [[nodiscard]] NodeLight direct(const Point& at, NodeRandom random) const;
  /// Light that surfaces send on which themselves get `from`.
  [[nodiscard]] NodeLight bounced(const Point& at, NodeRandom random, const std::vector<NodeLight>& from) const;

 private:
  const Scene& scene_;
  const RayScene& rays_;
  std::vector<Light> lights_;
};

/// Shadow rays waiting to be cast together.
struct ShadowPacket {
  RTCRay16 ray{};
  RayScene::Valid valid{};
  std::array<Color, kPacket> light{};
  std::array<int, kPacket> group{};
  int count = 0;

  void flush(RTCScene scene, NodeLight& sum) {
    if (count == 0) return;
    for (int i = 0; i < kPacket; ++i) valid.lane[i] = i < count ? -1 : 0;
    RTCIntersectContext context = RayScene::incoherent();
    rtcOccluded16(valid.lane, scene, &context, &ray);
    for (int i = 0; i < count; ++i) {
      if (ray.tfar[i] < 0.0f) continue;
      const auto k = static_cast<std::size_t>(i);
      for (std::size_t c = 0; c < 3; ++c) sum[3 * static_cast<std::size_t>(group[k]) + c] += light[k][c];
    }
    count = 0;
  }
};

template <class Ray>
void set_ray(Ray& ray, int i, const Eigen::Vector3f& from, const Eigen::Vector3f& direction, float far) {
  ray.org_x[i] = from.x(), ray.org_y[i] = from.y(), ray.org_z[i] = from.z();
  ray.dir_x[i] = direction.x(), ray.dir_y[i] = direction.y(), ray.dir_z[i] = direction.z();
  ray.tnear[i] = kTiny, ray.tfar[i] = far;
  ray.time[i] = 0.0f, ray.mask[i] = ~0u, ray.id[i] = 0, ray.flags[i] = 0;
}

NodeLight Baker::direct(const Point& at, NodeRandom random) const {
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
      const float here = d.dot(at.n), there = -d.dot(light.shape->normal), r2 = std::max(d.squaredNorm(), 0.02f);
      if (here <= 0.0f || there <= 0.0f) continue;
      const float weight = here * there / (r2 * r2) * light.area / static_cast<float>(count);
      const auto i = static_cast<std::size_t>(packet.count);
      for (std::size_t c = 0; c < 3; ++c) packet.light[i][c] = weight * light.material->emission[c];
      packet.group[i] = light.material->group;
      set_ray(packet.ray, packet.count++, at.p, d, 0.999f);
      if (packet.count == kPacket) packet.flush(rays_.get(), sum);
    }
  }
  packet.flush(rays_.get(), sum);
  return sum;
}

/// Irradiance at (u, v) of a rectangle from the nearest node.
const NodeLight& nearest(const Rectangle& r, float u, float v, const std::vector<NodeLight>& nodes) {
  const int i = std::clamp(static_cast<int>(u * static_cast<float>(r.cells_u) + 0.5f), 0, r.cells_u);
  const int j = std::clamp(static_cast<int>(v * static_cast<float>(r.cells_v) + 0.5f), 0, r.cells_v);
  return nodes[static_cast<std::size_t>(r.first_node + j * (r.cells_u + 1) + i)];
}

NodeLight Baker::bounced(const Point& at, NodeRandom random, const std::vector<NodeLight>& from) const {
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
                                radius * static_cast<float>(s.sin) * other + std::sqrt(1.0f - height2) * at.n;
      set_ray(packet.ray, i, at.p, d, 1e3f);
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      valid.lane[i] = -1;
    }
    RTCIntersectContext context = RayScene::incoherent();
    rtcIntersect16(valid.lane, rays_.get(), &context, &packet);
    for (int i = 0; i < kPacket; ++i) {
      if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      const Rectangle& r = scene_.fixed[packet.hit.primID[i]];
      const Eigen::Vector3f d{packet.ray.dir_x[i], packet.ray.dir_y[i], packet.ray.dir_z[i]};
      if (d.dot(r.normal) >= 0.0f) continue;
      const Color albedo = mean_albedo(scene_.materials[static_cast<std::size_t>(r.material)]);
      const NodeLight& light = nearest(r, packet.hit.u[i], packet.hit.v[i], from);
      for (std::size_t c = 0; c < light.size(); ++c) sum[c] += albedo[c % 3] * light[c] / kBounceRays;
    }
  }
  return sum;
}

/// A node's place, a little inside the border: there is often a wall at it.
Point node_point(const Rectangle& r, float u, float v) {
  const auto inset = [](float s, float length) {
    const float margin = std::min(0.03f / length, 0.1f);
    return std::clamp(s, margin, 1.0f - margin);
  };
  return {r.corner + inset(u, r.length.x()) * r.edge_u + inset(v, r.length.y()) * r.edge_v + 0.002f * r.normal,
          r.normal};
}

using NodeFunction = std::function<NodeLight(const Point&, NodeRandom)>;

/// Evaluates `light` at all nodes of one rectangle.
void fill(const Rectangle& r, std::uint64_t pass, const NodeFunction& light, std::vector<NodeLight>& nodes) {
  const auto random = [&](int node) { return NodeRandom{(pass << 40) + static_cast<std::uint64_t>(node)}; };
  const auto begin = nodes.begin() + r.first_node;
  if (r.flat) {
    std::fill_n(begin, r.nodes(), light(node_point(r, 0.5f, 0.5f), random(r.first_node)));
    return;
  }
  for (int j = 0; j <= r.cells_v; ++j) {
    for (int i = 0; i <= r.cells_u; ++i) {
      const int k = j * (r.cells_u + 1) + i;
      const float u = static_cast<float>(i) / static_cast<float>(r.cells_u);
      const float v = static_cast<float>(j) / static_cast<float>(r.cells_v);
      begin[k] = light(node_point(r, u, v), random(r.first_node + k));
    }
  }
}

/// Fills all rectangles, each by whichever thread is free: the result does not depend on which.
std::vector<NodeLight> filled(const std::vector<Rectangle>& rectangles, std::uint64_t pass, int threads,
                              const NodeFunction& light) {
  std::vector<NodeLight> nodes(static_cast<std::size_t>(Scene::nodes(rectangles)));
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < rectangles.size(); i = next++) fill(rectangles[i], pass, light, nodes);
  };
  std::vector<std::thread> helpers;
  for (int t = 1; t < threads; ++t) helpers.emplace_back(work);
  work();
  for (std::thread& helper : helpers) helper.join();
  return nodes;
}

/// Takes the noise out of bounced light: every node becomes the mean of its 3 x 3 neighbours.
void smooth(const std::vector<Rectangle>& rectangles, std::vector<NodeLight>& nodes) {
  const std::vector<NodeLight> before = nodes;
  for (const Rectangle& r : rectangles) {
    if (r.flat) continue;
    for (int j = 0; j <= r.cells_v; ++j) {
      for (int i = 0; i <= r.cells_u; ++i) {
        NodeLight sum{};
        float count = 0.0f;
        for (int y = std::max(j - 1, 0); y <= std::min(j + 1, r.cells_v); ++y) {
          for (int x = std::max(i - 1, 0); x <= std::min(i + 1, r.cells_u); ++x) {
            const NodeLight& one = before[static_cast<std::size_t>(r.first_node + y * (r.cells_u + 1) + x)];
            for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += one[c];
            count += 1.0f;
          }
        }
        for (float& c : sum) c /= count;
        nodes[static_cast<std::size_t>(r.first_node + j * (r.cells_u + 1) + i)] = sum;
      }
    }
  }
}

void add(std::vector<NodeLight>& sum, const std::vector<NodeLight>& other) {
  for (std::size_t k = 0; k < sum.size(); ++k)
    for (std::size_t c = 0; c < sum[k].size(); ++c) sum[k][c] += other[k][c];
}

std::vector<NodeLight> baked(const Scene& scene, const RayScene& rays, int threads) {
  const Baker baker{scene, rays};
  std::vector<NodeLight> sum = filled(scene.fixed, 1, threads, [&](const Point& at, NodeRandom random) {
    return baker.direct(at, random);
  });
  std::vector<NodeLight> last = sum;
  for (std::uint64_t bounce = 2; bounce <= 3; ++bounce) {
    const std::vector<NodeLight> from = std::move(last);
    last = filled(scene.fixed, bounce, threads, [&](const Point& at, NodeRandom random) {
      return baker.bounced(at, random, from);
    });
    smooth(scene.fixed, last);
    add(sum, last);
  }
  return sum;
}

/// What stands before the nodes in a cache file.
struct CacheHeader {
  std::uint64_t version, scene, count, checksum;
};

std::uint64_t checksum(const std::vector<NodeLight>& nodes) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const NodeLight& node : nodes) {
    for (const float x : node) {
      std::uint32_t word = 0;
      std::memcpy(&word, &x, sizeof word);
      hash = (hash ^ word) * 0x100000001b3ull;
    }
  }
  return hash;
}

bool read_cache(const std::filesystem::path& path, std::uint64_t scene, std::vector<NodeLight>& nodes) {
  std::ifstream file{path, std::ios::binary};
  CacheHeader header{};
  if (!file.read(reinterpret_cast<char*>(&header), sizeof header)) return false;
  if (header.version != kVersion || header.scene != scene || header.count != nodes.size()) return false;
  const auto bytes = static_cast<std::streamsize>(nodes.size() * sizeof(NodeLight));
  return file.read(reinterpret_cast<char*>(nodes.data()), bytes) && header.checksum == checksum(nodes);
}

/// Writes aside and renames: a reader sees a whole file or none.
void write_cache(const std::filesystem::path& path, std::uint64_t scene, const std::vector<NodeLight>& nodes) {
  std::error_code ignored;
  std::filesystem::create_directories(path.parent_path(), ignored);
  static std::atomic<int> writers{0};  // other threads of this process may bake the same scene
  const std::filesystem::path aside =
      path.string() + "." + std::to_string(getpid()) + "-" + std::to_string(writers++) + ".tmp";
  const CacheHeader header{kVersion, scene, nodes.size(), checksum(nodes)};
  std::ofstream file{aside, std::ios::binary};
  file.write(reinterpret_cast<const char*>(&header), sizeof header);
  file.write(reinterpret_cast<const char*>(nodes.data()),
             static_cast<std::streamsize>(nodes.size() * sizeof(NodeLight)));
  file.close();
  if (file) std::filesystem::rename(aside, path, ignored);
  if (!file || ignored) std::filesystem::remove(aside, ignored);
}

std::string file_name(std::uint64_t hash) {
  std::string name = "light-";
  for (int shift = 60; shift >= 0; shift -= 4) name += "0123456789abcdef"[(hash >> shift) & 15];
  return name + ".bin";
}

}  // namespace

LightMap fixed_light(const Scene& scene, const RayScene& rays, const std::filesystem::path& cache_dir,
                     int threads) {
  const std::uint64_t hash = scene.fixed_hash() ^ (kVersion * 0x9E3779B97F4A7C15ull);
  const std::filesystem::path path = cache_dir / file_name(hash);
  LightMap map;
  map.nodes.resize(static_cast<std::size_t>(Scene::nodes(scene.fixed)));
  if (read_cache(path, hash, map.nodes)) return map;
  // Only the report of how long it took sees this clock.
  const auto start = std::chrono::steady_clock::now();
  map.nodes = baked(scene, rays, threads);
  map.bake_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  write_cache(path, hash, map.nodes);
  return map;
}

LightMap moved_light(const Scene& scene, const RayScene& rays, const LightMap& fixed) {
  const Baker baker{scene, rays};
  LightMap map;
  map.nodes = filled(scene.moved, 4, 1, [&](const Point& at, NodeRandom random) {
    return baker.direct(at, random);
  });
  add(map.nodes, filled(scene.moved, 5, 1, [&](const Point& at, NodeRandom random) {
        return baker.bounced(at, random, fixed.nodes);
      }));
  return map;
}

}  // namespace gatefly::sim
