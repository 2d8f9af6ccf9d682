// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gatefly/sim/ray_scene.hpp"
#include "gatefly/sim/scene.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// Irradiance at one node of a light map: r, g, b of each light group in turn.
using NodeLight = std::array<float, 3 * world::LightConditions::kGroups>;

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

/// A point of a surface and its normal, earth frame.
struct SurfacePoint {
  Eigen::Vector3f p, n;
};

/// Casts light at points of a scene.
class Baker {
 public:
  /// @param rays  of scene.fixed alone; both outlive the baker.
  Baker(const Scene& scene, const RayScene& rays);

  /// Light straight from the lamps.
  [[nodiscard]] NodeLight direct(const SurfacePoint& at, NodeRandom random) const;
  /// Light that surfaces send on which themselves get `from`.
  [[nodiscard]] NodeLight bounced(const SurfacePoint& at, NodeRandom random,
                                  const std::vector<NodeLight>& from) const;

 private:
  /// A rectangle that shines.
  struct Light {
    const Rectangle* shape;
    int group;
    Color radiance;
    Eigen::Vector3f centre;
    float area;
  };

  const Scene& scene_;
  const RayScene& rays_;
  std::vector<Light> lights_;
};

}  // namespace gatefly::sim
