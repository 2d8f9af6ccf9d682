// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/estimation/eskf/findings.hpp"
#include "gatefly/flight_log/tick.hpp"
#include "gatefly/race/pilot.hpp"
#include "gatefly/sensing/sensor_health.hpp"
#include "gatefly/simulated_race/closed_loop/consistency.hpp"
#include "gatefly/simulated_race/closed_loop/discoveries.hpp"
#include "gatefly/simulated_race/closed_loop/truth_of_findings.hpp"
#include "gatefly/simulated_race/closed_loop/why_lost.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::simulated_race {

/// Source of the pilot's sightings.
enum class Vision {
  kRendered,  ///< Pictures are rendered and really detected; MuJoCo moves the body.
  /// Corners drawn from the detector's statistics; the twin body. Hundreds of times real time.
  kIdeal,
};

struct RaceConfig {
  Vision vision = Vision::kRendered;
  PilotConfig pilot;
  world::SimConfig sim;    ///< Already drawn for the seed.
  double timeout = 240.0;  ///< Limit of the whole flight [s].
  /// May put other sensors in place of what the pilot is about to be told, for tests; may be empty.
  std::function<void(Sensors&)> sensors;
  /// Allocations of the process so far, for tests that count them; may be empty.
  std::function<std::uint64_t()> allocations;
  /// Called some twenty times a second while the room's light is baked, before the first tick; may
  /// throw to stop; may be empty.
  std::function<void()> while_baking;
};

struct StageTime {
  std::string stage;
  double p50_us = 0.0, p99_us = 0.0, max_us = 0.0;
};

/// The referee's verdict, the detector's hits, and the cost of a race.
struct RaceResult {
  bool finished = false;
  int gates_passed = 0, gates_total = 0;
  int through_false_gates = 0, through_other_gates = 0;  ///< As sim::StrayPasses counts them.
  double race_time = 0.0;                                ///< Motors on to last gate [s].
  std::vector<double> lap_times;
  double mean_speed = 0.0, max_speed = 0.0;  ///< First to last gate plane [m/s].
  std::optional<double> crash_time;          ///< [s]
  std::string crash_object;
  bool landed = false;  ///< The pilot has switched the motors off.
  /// Contact after the last gate other than with the floor; empty when there was none.
  std::string landing_contact;
  std::string stop_reason;                    ///< finished, crash, timeout, abort
  std::string abort_reason;                   ///< In words; empty when not aborted.
  std::optional<WhyLost> why_lost;            ///< For a race that is over and not finished.
  std::vector<Eigen::Vector2d> gate_offsets;  ///< Lateral, vertical (down) at each pass [m].
  /// Earth frame, first to last gate [m].
  Eigen::Vector3d estimation_rmse = Eigen::Vector3d::Zero();
  Consistency consistency;                 ///< Whether the pilot knew how wrong it was.
  Discoveries discoveries;                 ///< The filter's findings against the truth.
  std::optional<eskf::Findings> findings;  ///< On camera, air and map, by the filter of kOurs.
  TruthOfFindings truth;                   ///< True values of the findings.
  SensorHealth sensor_health;              ///< Readings that the pilot refused.
  std::optional<eskf::Monitor::Verdict> divergence;  ///< As the pilot says, without any truth.
  std::vector<world::WorldGate> true_gates;          ///< As they stood.
  int frames = 0, frames_with_gate = 0, true_positives = 0, false_positives = 0;
  int careful_searches = 0;  ///< Frames that the pilot searched carefully.
  int searches = 0;          ///< How often the pilot had to look for a gate.
  double flight_time = 0.0;  ///< Simulated [s].
  double bake_seconds = 0.0, wall_seconds = 0.0, cpu_seconds = 0.0;  ///< CPU without the bake.
  std::uint64_t step_allocations = 0;  ///< By Pilot::step, when counted (tests).
  std::vector<StageTime> timings;      ///< pilot, camera, physics, ...
};

class AnyFlight;

/// One race, tick by tick: pilot against simulator, in lock-step. For who wants to look in between.
///
///   Flight flight{config};
///   while (flight.step()) look_at(flight.tick());
///   const RaceResult result = flight.result();
class Flight {
 public:
  /// @throws std::invalid_argument when the pilot finds that the course cannot be flown.
  explicit Flight(const RaceConfig& config);
  ~Flight();
  Flight(const Flight&) = delete;
  Flight& operator=(const Flight&) = delete;

  /// One IMU sample, one Pilot::step. False, and nothing happens, when the race is over.
  bool step();
  /// The last one; before the first step nothing is in it. Valid until the next.
  [[nodiscard]] flight_log::Tick tick() const;
  /// After a crash, 1.5 s long: a tick of the world alone, with motors off, for who draws it. The
  /// pilot is not asked any more, and the result stays what it was. False when there is none.
  bool fall();
  /// Over now, for the reason "stopped".
  void stop();
  /// Finished, crashed, aborted, timed out or stopped.
  [[nodiscard]] bool over() const;
  /// The race so far; its seconds of CPU and wall include the caller's work between ticks.
  [[nodiscard]] RaceResult result() const;

 private:
  std::unique_ptr<AnyFlight> flight_;
};

/// Flies one race: pilot against simulator, in lock-step, until finished, crashed, aborted or timed
/// out.
///
/// @param on_tick  called after every pilot step; may be empty. Return false to stop (Ctrl-C).
/// Same configuration, same result, to the byte (but the timings).
[[nodiscard]] RaceResult fly(const RaceConfig& config,
                             const std::function<bool(const flight_log::Tick&)>& on_tick);

}  // namespace gatefly::simulated_race
