// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "gatefly/experiments/bench/picture.hpp"
#include "gatefly/experiments/bench/stage.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"

namespace gatefly::bench {

/// Sensor input and sightings of the first seconds of a race.
struct RecordedFlight {
  struct Moment {
    Imu imu;
    Attitude attitude;
    Eigen::Vector3d v_B = Eigen::Vector3d::Zero();
    AttitudeCommand command;
    double dt = 1.0 / 512.0;
  };
  struct Sight {
    Quad corners_px{};
    RotationGB R_GB;
  };
  std::vector<Moment> moments;                     ///< In the air.
  std::vector<Picture> pictures;                   ///< In the air.
  std::vector<Sight> sights;                       ///< Gates that corrected the pilot's position.
  std::vector<simulated_race::StageTime> timings;  ///< The race's own: whole steps.
};

/// Flies until so many pictures were taken in the air. @param stopped  asked often; true ends it
/// early.
[[nodiscard]] RecordedFlight recorded_flight(const simulated_race::RaceConfig& race,
                                             std::size_t pictures,
                                             const std::function<bool()>& stopped);

/// Stages behind detection, and the planner.
[[nodiscard]] std::vector<Stage> flight_stages(std::shared_ptr<const RecordedFlight> flight,
                                               const PilotConfig& config);

}  // namespace gatefly::bench
