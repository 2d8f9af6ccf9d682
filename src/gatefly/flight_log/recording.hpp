// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/race/pilot.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::flight_log {

/// One recorded IMU tick: what the sensors said, and where the drone really was, if the log knows.
struct RecordedTick {
  Sensors sensors;                      ///< Without its image.
  std::optional<std::size_t> picture;   ///< Index of the picture that arrived with it.
  std::optional<Eigen::Vector3d> p_EB;  ///< Truth [m].
};

/// What stands in for the sonar of a log that has no height at all: motion capture's.
struct SonarStandIn {
  double period = 0.0;                 ///< Between two readings [s]; 0: one with each new position.
  std::function<double()> noise = {};  ///< Of each reading [m]; none when empty.
};

/// A recording as the pilot had it: what each row of the log says, nothing added.
///
/// A log without a single height (sonar or barometer) gets one from its true positions, as a sonar
/// has it: along the body's axis, by the log's attitude; level where it has none. Of two pictures
/// in one row the later counts.
/// @throws std::invalid_argument when a picture arrives in a row that is not there.
[[nodiscard]] std::vector<RecordedTick> ticks_of(const io::FlightFolder& folder,
                                                 const SonarStandIn& sonar = {});

/// Reads the recording's pictures, upright, for replay(): each view is valid until the next.
///
/// @param folder  must live as long.
/// @param stored_width,stored_height  of raw pictures, which do not know their size [px].
[[nodiscard]] std::function<Image(std::size_t)> picture_loader(const io::FlightFolder& folder,
                                                               int stored_width, int stored_height,
                                                               int rotation_deg);

}  // namespace gatefly::flight_log
