// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "gatefly/sim/scene.hpp"

namespace gatefly::sim {

/// Rectangles that rays can be cast at: the one place that sets Embree up.
///
/// A hit's `primID` is the rectangle's index in the lists given, one after the other; (u, v) run
/// along edge_u and edge_v.
class RayScene {
 public:
  /// How sixteen rays go: starting and pointing much alike, or in any directions.
  enum class Rays { kCoherent, kIncoherent };
  /// Marks which of sixteen rays are cast.
  struct alignas(64) Valid {
    int lane[16];
  };

  /// @param moving  how many of the last rectangles `move` may put elsewhere.
  /// @throws std::runtime_error when Embree cannot start, or has no memory.
  explicit RayScene(const std::vector<const std::vector<Rectangle>*>& lists,
                    std::size_t moving = 0);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  /// The moving ones' new places; a tree of their own, so that the rest stays as it is.
  void move(std::span<const Rectangle> rectangles);

  /// The nearest hit of each ray; Embree's own conventions, but that masks need not be set.
  void intersect(const Valid& valid, RTCRayHit16& rays, Rays kind) const;
  void intersect(RTCRayHit& ray) const;
  /// tfar is negative afterwards where something is in the way.
  void occluded(const Valid& valid, RTCRay16& rays) const;
  void occluded(RTCRay& ray) const;

 private:
  void build(const std::vector<const std::vector<Rectangle>*>& lists, std::size_t moving);
  void release();

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  RTCScene moving_ = nullptr;  ///< Null where nothing moves.
  RTCGeometry moving_quads_ = nullptr;
  unsigned still_ = 0;  ///< Rectangles before the moving ones.
};

}  // namespace gatefly::sim
