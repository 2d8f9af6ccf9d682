// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "gatefly/sim/camera.hpp"
#include "gatefly/sim/sight.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::sim {

/// A gate in a picture, as a perfect detector would mark it.
struct GateView {
  int gate = 0;                     ///< Index into the world's gates.
  double distance = 0.0;            ///< From the camera to its centre [m].
  bool whole = false;               ///< All four corners are in the picture and in sight.
  bool only_lower_corners = false;  ///< The lower two are, the upper two are above the picture.
  std::array<Eigen::Vector2d, 4> corners_px{};  ///< Outer ones, clockwise from top-left as seen.
  std::array<bool, 4> drawn{};                  ///< Before the lens, in the picture or not.
  std::array<bool, 4> seen{};                   ///< In the picture, and nothing before it.
  std::array<bool, 4> inner_seen{};             ///< The opening's corners: the same.
  /// Its side as it would look face to face, on the lens' axis [px].
  double side_px = 0.0;
  /// Middle of the left and right bar's part in view.
  std::optional<std::array<Eigen::Vector2d, 2>> bars_px;
};

/// How many of its corners are seen.
[[nodiscard]] int seen_corners(const GateView& view);

/// Which corners of a gate that the border cuts are seen.
enum class CutKind { kUpper, kLower, kSide, kDiagonal, kThree };
inline constexpr std::size_t kCutKinds = 5;
/// Nullopt: fewer than two, or all four.
[[nodiscard]] std::optional<CutKind> cut_kind(const std::array<bool, 4>& seen);

/// Which gates the camera sees, and where. Each corner at the time its own column is exposed.
///
/// @param t_start  when the first column begins its exposure [s].
/// @param history  body poses, ascending in t, covering the exposure.
[[nodiscard]] std::vector<GateView> gates_in_view(const world::World& world,
                                                  const world::CameraTruth& camera,
                                                  const Sight& sight, double t_start,
                                                  std::span<const BodyPose> history);

/// Whether a whole gate is big and square enough for the detector to be asked for it.
[[nodiscard]] bool detectable(const std::array<Eigen::Vector2d, 4>& corners_px);

/// The one of them that looks largest of those that are whole and detectable; null without any.
[[nodiscard]] const GateView* largest_of(std::span<const GateView> views);

}  // namespace gatefly::sim
