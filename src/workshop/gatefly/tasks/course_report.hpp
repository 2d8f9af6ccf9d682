// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "gatefly/config/track_file.hpp"
#include "gatefly/race/path.hpp"
#include "gatefly/tasks/arguments.hpp"

namespace gatefly::tasks {

/// The planned way to one gate.
struct LegReport {
  int from = -1, to = 0;  ///< Gates, counted from 0; -1: the start.
  double length = 0.0;    ///< [m]
  double time = 0.0;      ///< At the planned speeds [s].
  double slowest = 0.0;   ///< [m/s]
  double radius = 0.0;    ///< The tightest turn's [m]; infinite without one.
  double run_in = 0.0;    ///< Straight before the gate [m].
  Clearance clearance;
};

/// Report on a course before it is flown.
struct CourseReport {
  std::filesystem::path path;
  config::TrackFile file;
  PlanParams params;
  std::optional<RacePlan> plan;  ///< None: there is no way.
  std::string reason;            ///< Why there is none.
  std::vector<LegReport> legs;   ///< The start's first, then gate to gate.
  std::optional<double> lap_length,
      lap_time;                               ///< From a gate to itself; none in a race of one lap.
  double race_length = 0.0, race_time = 0.0;  ///< From the start to the last gate [m], [s].
  std::vector<std::string> notes;             ///< Remarks of the configuration.

  [[nodiscard]] const LegReport& tightest() const;
  [[nodiscard]] const LegReport& shortest_run_in() const;
  [[nodiscard]] const LegReport& nearest() const;  ///< With the least clearance.
};

/// Plans the way as the pilot of this configuration does: control.mode.
///
/// @param track  a file or a name in tracks/.
/// @throws std::runtime_error one line, when file or configuration cannot be used.
[[nodiscard]] CourseReport checked_course(const std::string& track,
                                          const ConfigArguments& arguments);

[[nodiscard]] nlohmann::json as_json(const CourseReport& report);

}  // namespace gatefly::tasks
