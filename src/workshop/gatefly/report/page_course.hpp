// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "gatefly/race/pilot_config.hpp"
#include "gatefly/race/track.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::report {

/// Scene of a flight, as a page shows it.
struct PageCourse {
  world::World world;                ///< True places of everything.
  Track map;                         ///< As the pilot knows it.
  double speed = 1.5;                ///< That the pilot is to fly [m/s].
  double pictures_per_second = 0.0;  ///< 0: there are none.
  std::size_t pictures = 0;          ///< How many there will be, where that is known.
  /// Systematic errors of the IMU in flight, where they are known [m/s²], [rad/s].
  std::optional<Eigen::Vector3d> accel_bias = std::nullopt, gyro_bias = std::nullopt;
  std::array<double, 2> rotor_limits{};  ///< Speeds that the pilot may ask for [rad/s].
  /// The world is the truth, and the referee goes by it; else it is the map, and the pilot counts.
  bool is_truth = true;
};
[[nodiscard]] PageCourse page_course(const PilotConfig& pilot, const world::SimConfig& sim,
                                     bool pictures);
/// Course of a recorded flight: nobody knows where things really stood.
[[nodiscard]] PageCourse page_course(const PilotConfig& pilot);

/// For the page: room, gates where they stand and on the map, obstacles, the way planned.
/// @param plan  nullopt: before the first tick.
[[nodiscard]] nlohmann::ordered_json as_json(const PageCourse& course,
                                             const std::optional<RacePlan>& plan);

/// How many pictures a flight will have: by the way planned and the speed asked for; half as much
/// again for the ground and for searches.
[[nodiscard]] double pictures_expected(const PageCourse& course, const RacePlan& plan);

/// A point in the frame of one of the world's gates; nullopt when there is no such gate.
[[nodiscard]] std::optional<Eigen::Vector3d> in_gate(const world::World& world, int gate,
                                                     const Eigen::Vector3d& p_EB);

}  // namespace gatefly::report
