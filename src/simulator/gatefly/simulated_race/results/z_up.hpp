// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/geometry/attitude.hpp"

// Viewers have z up: the world north, west, up, the body front, left, up.
namespace gatefly::simulated_race {

/// North, east, down as north, west, up: half a turn about x.
[[nodiscard]] inline Eigen::Vector3d up(const Eigen::Vector3d& v) {
  return {v.x(), -v.y(), -v.z()};
}

/// The attitude of front, left, up in north, west, up.
[[nodiscard]] inline Quaternion up(const Attitude& attitude) {
  const Quaternion q = quaternion_of(attitude);
  return {q.w, q.x, -q.y, -q.z};
}

}  // namespace gatefly::simulated_race
