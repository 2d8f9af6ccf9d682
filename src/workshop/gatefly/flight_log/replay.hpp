// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/estimation/eskf/findings.hpp"
#include "gatefly/flight_log/recording.hpp"
#include "gatefly/flight_log/replay_score.hpp"
#include "gatefly/race/pilot.hpp"

namespace gatefly::flight_log {

/// A row of estimates.csv.
struct EstimateRow {
  double t = 0.0;
  Estimate estimate;
  Sighting::Source source = Sighting::Source::kNone;  ///< Source of this tick's correction.
};

/// The pilot's handling of one picture.
struct PictureRow {
  std::size_t picture = 0;
  double t = 0.0;
  Sighting sighting;
};

struct ReplayResult {
  std::vector<EstimateRow> estimates;
  std::vector<PictureRow> pictures;
  std::vector<Command> commands;  ///< Computed, not flown.
  int gates_passed = 0;
  bool finite = true;               ///< Every number of every command and estimate is.
  std::optional<double> first_fix;  ///< When a gate first corrected the filter [s].
  std::optional<double> last_gate;  ///< When the pilot thought it passed the last gate [s].
  Eigen::Vector3d rmse = Eigen::Vector3d::Zero();  ///< From first fix to the gate; earth frame [m].
  int rmse_samples = 0;                            ///< 0: the log has no truth there.
  ReplayScore score;                               ///< In the same time.
  /// How sure the filter of kOurs was after the last sighting that it took, across the floor from the
  /// gate, one standard deviation [m].
  std::optional<double> known_to;
  std::optional<eskf::Monitor::Verdict> divergence;  ///< Told without truth.
  std::optional<eskf::Findings> findings;            ///< By the filter of kOurs, at the end.
  HashCheck hashes;  ///< The pictures', where the recording has hashes; for loaders.
};

/// Estimator whose states a replay reports.
enum class Estimator {
  kPilots,  ///< That of the filter the pilot is configured with.
  kDrag,    ///< The 7-state drag filter's.
  kEskf,    ///< The error-state filter's, whose states are also wind, gates, mount and delay.
  /// The classic inertial filter's, fed with what the pilot sees; the pilot flies on by its own.
  kImu15,
};

/// State that an observer may look at after each tick.
struct ReplayedTick {
  std::size_t index = 0;  ///< Number of the recorded one.
  const Sensors& sensors;
  const Command& command;
  const Pilot& pilot;
  const Estimate& estimate;  ///< Output of the chosen estimator.
};

/// Feeds a recorded flight to the very Pilot::step that flies the simulator.
///
/// @param load_picture  answers the view of picture i; it must stay valid until the next call.
/// @param on_tick  called after every step (none while a tick is held); may be empty.
/// @param true_gates  as they stand, where somebody knows: for the score alone.
[[nodiscard]] ReplayResult replay(const PilotConfig& config, const std::vector<RecordedTick>& ticks,
                                  const std::function<Image(std::size_t)>& load_picture,
                                  Estimator estimator = Estimator::kDrag,
                                  const std::function<void(const ReplayedTick&)>& on_tick = {},
                                  const std::vector<MapGate>& true_gates = {});

}  // namespace gatefly::flight_log
