// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "gatefly/race/pilot.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/referee.hpp"
#include "gatefly/simulated_race/closed_loop/truth_of_findings.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::simulated_race {

/// An estimate of something that was told wrong: how far off it is from the truth, and how far
/// off the filter says it may be.
struct FoundError {
  double error = 0.0, sigma = 0.0;
};

/// A gate that the pilot said does not stand where the map has it.
struct MapReport {
  std::size_t gate = 0;                              ///< From 0.
  double time = 0.0;                                 ///< When it was said first [s].
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< Along its way, right, down, as said [m].
  bool before_its_plane = false;                     ///< And the drone had never passed it yet.
};

/// The filter's findings in flight, against the truth.
struct Discoveries {
  /// After the first lap. Nullopt: it was not finished, or another filter flies.
  struct AfterLap {
    FoundError camera_tilt, heading;  ///< [rad]
    FoundError thrust;                ///< Relative, of the thrust that a command gives.
    FoundError latency;               ///< [s]
  };
  std::optional<AfterLap> after_lap;
  std::vector<MapReport> map_reports;  ///< In the order they were made.
  /// Horizontal RMS error in the frame of the gate as it stands, while it was flown to; one each pass
  /// [m].
  std::vector<double> gate_rmse;
};

/// Fills it while a race goes on.
class DiscoveryWatch {
 public:
  DiscoveryWatch(const PilotConfig& told, const world::SimConfig& truth)
      : vehicle_{told.vehicle}, gates_{truth.world.gates}, truth_{truth_of_findings(truth, told)} {}

  /// A tick of the pilot, the drone being where `state` says.
  /// @param passes  gates passed so far, by the referee.
  void update(const Pilot& pilot, const sim::BodyState& state, double now, std::size_t passes);
  [[nodiscard]] const Discoveries& result() const { return result_; }

 private:
  void follow_thrust(const sim::BodyState& state, double now);
  void note_reports(const eskf::ErrorStateFilter& filter, double now, std::size_t passes);
  void note_lap(const eskf::ErrorStateFilter& filter, const sim::BodyState& state);

  VehicleParams vehicle_;  ///< As told.
  std::vector<world::WorldGate> gates_;
  TruthOfFindings truth_;
  Discoveries result_;
  double thrust_ = 0.0, last_ = 0.0;  ///< Relative, of the rotors' true one; when it was taken [s].
  double squares_ = 0.0, next_report_ = 0.0;
  int samples_ = 0;  ///< In squares_: since the last pass.
  std::size_t passes_ = 0;
};

}  // namespace gatefly::simulated_race
