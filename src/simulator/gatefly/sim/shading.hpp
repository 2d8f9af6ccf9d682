// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "gatefly/sim/light_map.hpp"
#include "gatefly/sim/scene.hpp"
#include "gatefly/sim/tile_caster.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// Four floats that the compiler keeps in one register: r, g, b, unused.
using Float4 = float __attribute__((vector_size(16)));

/// Looks up the light that leaves a surface: texture times baked irradiance, plus what it emits.
class Shader {
 public:
  Shader(const Scene& scene, const LightMap& fixed, const LightMap& moved,
         const world::LightConditions& light);

  /// Radiance at (u, v) of a rectangle; those of `scene.moved` count on after `scene.fixed`.
  ///
  /// A pattern also modulates what its surface emits. Cost: four nodes, allocates nothing.
  [[nodiscard]] Float4 radiance(unsigned rectangle, float u, float v) const;

  /// Mean radiance of one pixel's rays: of `samples` groups from `group` on, the ray `lane` of each.
  ///
  /// Where all hit the same rectangle its light is looked up once, in their middle; the pattern for
  /// each of them.
  [[nodiscard]] Float4 radiance(const RayTile& rays, int group, int lane, int samples) const;

 private:
  static constexpr int kNoise = 64;  // side of the noise table

  /// Everything one look-up needs, side by side in memory.
  struct Surface {
    Float4 albedo, to_second, emission;
    float pattern_u, pattern_v, cells_u, cells_v;
    int last_u, last_v, first_node, row;
    unsigned salt;
    Pattern pattern;
  };

  void append(const Scene& scene, const std::vector<Rectangle>& rectangles, const LightMap& map,
              const world::LightConditions& light);
  [[nodiscard]] float noise(unsigned x, unsigned y) const {
    return noise_[(y % kNoise) * kNoise + x % kNoise];
  }
  [[nodiscard]] Float4 light(const Surface& surface, float u, float v) const;
  [[nodiscard]] float second_share(const Surface& surface, float u, float v) const;

  std::vector<Surface> surfaces_;
  std::vector<Float4> nodes_;  // irradiance / π with the seed's gains
  std::array<float, static_cast<std::size_t>(kNoise) * kNoise> noise_{};
};

}  // namespace gatefly::sim
