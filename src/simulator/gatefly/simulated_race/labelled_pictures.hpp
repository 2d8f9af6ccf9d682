// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "gatefly/sim/ideal_vision.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"
#include "gatefly/simulated_race/race_maker.hpp"

namespace gatefly::simulated_race {

/// Which pictures of a course.
struct PictureOrder {
  std::size_t pictures = 100;
  std::size_t per_seed = 40;  ///< Pictures per world and light.
  std::uint64_t first_seed = 1;
  double around = 0.3;  ///< Part of them from anywhere in the room instead of the racing line.
  /// 1 σ by which pictures of a race are turned away from its attitudes, roll; yaw 0.8, pitch 0.5
  /// times as much: as a camera held by hand is [rad].
  double shake = 0.0;
  bool varied = false;  ///< Looks take turns, and all else is drawn: varied_look.hpp.
  bool masks = false;
  bool without_gates = false;  ///< The same places and looks, but nobody set up a gate.
};

/// A camera's picture of one moment, and the truth in it.
struct Picture {
  std::size_t number = 0;
  std::uint64_t seed = 0;              ///< The race's.
  bool around = false;                 ///< Not from a race.
  std::vector<std::uint8_t> uyvy{};    ///< As stored, turned by 90°.
  sim::BodyPose pose{};                ///< In the middle of the exposure.
  std::vector<sim::GateView> gates{};  ///< In view, nearest first; whole or not.
  std::vector<std::uint8_t> mask{};    ///< CameraRenderer::gate_mask(); empty when not asked for.
};

/// Renders the pictures of one seed, in order; seeds are independent of each other.
///
/// On the racing line: the moments at which the camera exposed in an ideal race of that seed,
/// evenly chosen. Around: at 0.8 to 7 m from a gate, seen from up to 60° aside or from behind, one
/// in five looking anywhere, moving at up to 2.5 m/s. Each meters its own light.
/// @param nth  from 0; the last one may have fewer pictures.
/// @param each  takes a picture; false stops.
/// @param between  called often, also while the room's light is baked; may throw to stop; may be
///     empty.
void render_seed(const RaceMaker& maker, const PictureOrder& order, std::size_t nth,
                 const std::function<bool(Picture&&)>& each,
                 const std::function<void()>& between = {});

/// How many seeds an order takes.
[[nodiscard]] std::size_t seeds_of(const PictureOrder& order);

}  // namespace gatefly::simulated_race
