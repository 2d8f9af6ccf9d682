// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

namespace gatefly::smoothing {

/// A position at a time.
struct Place {
  double time = 0.0;                               ///< [s]
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();  ///< [m]
};

/// How far a path is from the truth once it is laid on it.
struct Alignment {
  Eigen::Vector3d rms = Eigen::Vector3d::Zero();  ///< North, east, down [m].
  double lag = 0.0;                               ///< The truth is so much late [s].
  double turned = 0.0;                            ///< The path had to be turned by so much [rad].
};

/// Lays a path on the truth by a shift, a heading and a lag: what neither a camera nor an IMU can know
/// without the course's place in the room, and what a radio link adds to motion capture.
///
/// As trajectories are compared (Zhang and Scaramuzza 2018, four degrees of freedom); the lag from -50 to
/// 150 ms by steps of 5. nullopt: less than ten places.
/// @param path  at least two, in order of time.
[[nodiscard]] std::optional<Alignment> aligned(std::span<const Place> path,
                                               std::span<const Place> truth);

}  // namespace gatefly::smoothing
