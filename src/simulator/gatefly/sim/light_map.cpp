// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/light_map.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <stop_token>
#include <string>
#include <system_error>
#include <thread>

#include <Eigen/Geometry>
#include <unistd.h>

namespace gatefly::sim {
namespace {

constexpr std::uint64_t kVersion = 4;  // of everything that changes what a bake gives

/// A node's place, a little inside the border: there is often a wall at it.
SurfacePoint node_point(const Rectangle& r, float u, float v) {
  const auto inset = [](float s, float length) {
    const float margin = std::min(0.03f / length, 0.1f);
    return std::clamp(s, margin, 1.0f - margin);
  };
  return {r.corner + inset(u, r.length.x()) * r.edge_u + inset(v, r.length.y()) * r.edge_v +
              0.002f * r.normal,
          r.normal};
}

using NodeFunction = std::function<NodeLight(const SurfacePoint&, NodeRandom)>;

/// Some nodes of a rectangle, counted from its first: milliseconds of work even in a large hall.
struct Piece {
  const Rectangle* rectangle;
  int from, to;
};

std::vector<Piece> pieces_of(const std::vector<Rectangle>& rectangles) {
  constexpr int kMost = 64;
  std::vector<Piece> pieces;
  for (const Rectangle& r : rectangles) {
    const int step = r.flat ? r.nodes() : kMost;
    for (int from = 0; from < r.nodes(); from += step)
      pieces.push_back({&r, from, std::min(from + step, r.nodes())});
  }
  return pieces;
}

/// Evaluates `light` at the nodes of one piece.
void fill(const Piece& piece, std::uint64_t pass, const NodeFunction& light,
          std::vector<NodeLight>& nodes) {
  const Rectangle& r = *piece.rectangle;
  const auto random = [&](int node) {
    return NodeRandom{(pass << 40) + static_cast<std::uint64_t>(node)};
  };
  const auto begin = nodes.begin() + r.first_node;
  if (r.flat) {
    std::fill_n(begin, r.nodes(), light(node_point(r, 0.5f, 0.5f), random(r.first_node)));
    return;
  }
  for (int k = piece.from; k < piece.to; ++k) {
    const int i = k % (r.cells_u + 1), j = k / (r.cells_u + 1);
    const float u = static_cast<float>(i) / static_cast<float>(r.cells_u);
    const float v = static_cast<float>(j) / static_cast<float>(r.cells_v);
    begin[k] = light(node_point(r, u, v), random(r.first_node + k));
  }
}

/// Calls a function now and then, however often it could: it may be as slow as a lock.
class NowAndThen {
 public:
  explicit NowAndThen(const std::function<void()>& call) : call_{call} {}
  void operator()() {
    const auto now = std::chrono::steady_clock::now();  // no result depends on it
    if (!call_ || now < next_) return;
    next_ = now + std::chrono::milliseconds{50};
    call_();
  }

 private:
  const std::function<void()>& call_;
  std::chrono::steady_clock::time_point next_{};
};

/// Fills all rectangles, piece by piece, each by whichever thread is free: the result does not depend
/// on which. What `while_baking` throws ends the other threads, too.
std::vector<NodeLight> filled(const std::vector<Rectangle>& rectangles, std::uint64_t pass,
                              int threads, const std::function<void()>& while_baking,
                              const NodeFunction& light) {
  std::vector<NodeLight> nodes(static_cast<std::size_t>(Scene::nodes(rectangles)));
  const std::vector<Piece> pieces = pieces_of(rectangles);
  std::atomic<std::size_t> next{0};
  const auto help = [&](const std::stop_token& stop) {
    for (std::size_t i = next++; i < pieces.size() && !stop.stop_requested(); i = next++)
      fill(pieces[i], pass, light, nodes);
  };
  std::vector<std::jthread> helpers;
  try {
    for (int t = 1; t < threads; ++t) helpers.emplace_back(help);
  } catch (const std::system_error&) {  // no more threads to be had: it takes longer
  }
  NowAndThen ask{while_baking};
  for (std::size_t i = next++; i < pieces.size(); i = next++) {
    ask();
    fill(pieces[i], pass, light, nodes);
  }
  for (std::jthread& helper : helpers) helper.join();
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
            const NodeLight& one =
                before[static_cast<std::size_t>(r.first_node + y * (r.cells_u + 1) + x)];
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

std::vector<NodeLight> baked(const Scene& scene, const RayScene& rays, int threads,
                             const std::function<void()>& while_baking) {
  const Baker baker{scene, rays};
  std::vector<NodeLight> sum =
      filled(scene.fixed, 1, threads, while_baking,
             [&](const SurfacePoint& at, NodeRandom random) { return baker.direct(at, random); });
  std::vector<NodeLight> last = sum;
  for (std::uint64_t bounce = 2; bounce <= 3; ++bounce) {
    const std::vector<NodeLight> from = std::move(last);
    last = filled(
        scene.fixed, bounce, threads, while_baking,
        [&](const SurfacePoint& at, NodeRandom random) { return baker.bounced(at, random, from); });
    smooth(scene.fixed, last);
    add(sum, last);
  }
  return sum;
}

/// Header before the nodes in a cache file.
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

bool read_cache(const std::filesystem::path& path, std::uint64_t scene,
                std::vector<NodeLight>& nodes) {
  std::ifstream file{path, std::ios::binary};
  CacheHeader header{};
  if (!file.read(reinterpret_cast<char*>(&header), sizeof header)) return false;
  if (header.version != kVersion || header.scene != scene || header.count != nodes.size())
    return false;
  const auto bytes = static_cast<std::streamsize>(nodes.size() * sizeof(NodeLight));
  return file.read(reinterpret_cast<char*>(nodes.data()), bytes) &&
         header.checksum == checksum(nodes);
}

/// Writes aside and renames: a reader sees a whole file or none.
void write_cache(const std::filesystem::path& path, std::uint64_t scene,
                 const std::vector<NodeLight>& nodes) {
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

LightMap fixed_light(const Scene& scene, const RayScene& rays,
                     const std::filesystem::path& cache_dir, int threads,
                     const std::function<void()>& while_baking) {
  const std::uint64_t hash = scene.fixed_hash() ^ (kVersion * 0x9E3779B97F4A7C15ull);
  const std::filesystem::path path = cache_dir / file_name(hash);
  LightMap map;
  map.nodes.resize(static_cast<std::size_t>(Scene::nodes(scene.fixed)));
  if (!cache_dir.empty() && read_cache(path, hash, map.nodes)) return map;
  // Only the report of how long it took sees this clock.
  const auto start = std::chrono::steady_clock::now();
  map.nodes = baked(scene, rays, threads, while_baking);
  map.bake_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!cache_dir.empty()) write_cache(path, hash, map.nodes);
  return map;
}

LightMap moved_light(const Scene& scene, const RayScene& rays, const LightMap& fixed,
                     const std::function<void()>& while_baking) {
  const Baker baker{scene, rays};
  LightMap map;
  map.nodes =
      filled(scene.moved, 4, 1, while_baking,
             [&](const SurfacePoint& at, NodeRandom random) { return baker.direct(at, random); });
  add(map.nodes,
      filled(scene.moved, 5, 1, while_baking, [&](const SurfacePoint& at, NodeRandom random) {
        return baker.bounced(at, random, fixed.nodes);
      }));
  return map;
}

}  // namespace gatefly::sim
