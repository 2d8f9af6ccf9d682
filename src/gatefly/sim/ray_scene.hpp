// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <embree3/rtcore.h>

#include "gatefly/sim/scene.hpp"

namespace gatefly::sim {

/// Rectangles that rays can be cast at: the one place that sets Embree up.
///
/// A hit's `primID` is the rectangle's index in the lists given, one after the other; (u, v) run
/// along edge_u and edge_v.
class RayScene {
 public:
  /// The parameters of one Embree call: sixteen rays that start and point much alike.
  static RTCIntersectContext coherent();
  /// Sixteen rays in any directions.
  static RTCIntersectContext incoherent();
  /// Marks which of sixteen rays are cast.
  struct alignas(64) Valid {
    int lane[16];
  };

  /// @throws std::runtime_error when Embree cannot start.
  explicit RayScene(const std::vector<const std::vector<Rectangle>*>& lists);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  [[nodiscard]] RTCScene get() const { return scene_; }

 private:
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

}  // namespace gatefly::sim
