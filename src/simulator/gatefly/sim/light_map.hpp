// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "gatefly/sim/baker.hpp"
#include "gatefly/sim/ray_scene.hpp"
#include "gatefly/sim/scene.hpp"

namespace gatefly::sim {

/// Light that falls on every node of a list of rectangles, by light group.
///
/// Lights of a group are as bright as their materials say; a seed's group gains multiply later, so
/// one map serves every seed.
struct LightMap {
  std::vector<NodeLight>
      nodes;  ///< Rectangle r's node (i, j) is r.first_node + j (r.cells_u + 1) + i.
  double bake_seconds = 0.0;  ///< 0 when it came from the cache.
};

/// The light map of `scene.fixed`: area lights and two bounces.
///
/// Random numbers go by node, so any number of threads gives the same bits. The result is kept in
/// `cache_dir` under a hash of the scene. A damaged file is baked again; a directory that cannot be
/// written to is no error, an empty name means no cache.
/// @param rays  of scene.fixed alone.
/// @param while_baking  called some twenty times a second by the caller's thread; may throw to stop;
///     may be empty.
[[nodiscard]] LightMap fixed_light(const Scene& scene, const RayScene& rays,
                                   const std::filesystem::path& cache_dir, int threads,
                                   const std::function<void()>& while_baking = {});

/// The same for `scene.moved`, lit by the fixed scene; moved things neither shade nor light others.
[[nodiscard]] LightMap moved_light(const Scene& scene, const RayScene& rays, const LightMap& fixed,
                                   const std::function<void()>& while_baking = {});

}  // namespace gatefly::sim
