// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <variant>

#include "gatefly/control/rotor_thrust.hpp"
#include "gatefly/estimation/eskf/monitor.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/race/messages.hpp"
#include "gatefly/race/path.hpp"
#include "gatefly/race/phase.hpp"
#include "gatefly/race/pilot_config.hpp"
#include "gatefly/sensing/sensor_health.hpp"

namespace gatefly {

/// The drone's mind: sensors in, motor commands out. One object, no threads, no clock.
class Pilot {
 public:
  /// Plans the course. @throws std::invalid_argument when it cannot be flown, or pictures come later
  ///     than the filter remembers, saying why.
  explicit Pilot(const PilotConfig& config);
  Pilot(Pilot&&) noexcept;
  Pilot& operator=(Pilot&&) noexcept;
  ~Pilot();

  /// One tick, at the IMU's rate. Never throws, never allocates; what is no reading is not used, and
  /// counted: health().
  Command step(const Sensors& sensors);

  [[nodiscard]] Estimate estimate() const;
  /// The estimator, e.g. for its covariance.
  [[nodiscard]] const Navigator& navigator() const { return navigator_; }
  [[nodiscard]] const Phase& phase() const { return phase_; }
  [[nodiscard]] AbortReason abort_reason() const { return abort_reason_; }
  [[nodiscard]] const Sighting& sighting() const;
  /// Counts of the readings that were refused.
  [[nodiscard]] const SensorHealth& health() const;
  /// Whether the filter has diverged, judged without ground truth; kOurs only, else nullopt.
  [[nodiscard]] std::optional<eskf::Monitor::Verdict> divergence() const;
  [[nodiscard]] bool finished() const;
  [[nodiscard]] bool landed() const { return std::holds_alternative<Landed>(phase_); }
  [[nodiscard]] int target_gate() const;
  [[nodiscard]] const RacePlan& plan() const;

 private:
  struct Parts;  ///< Lookout, course, guidance and INDI; private to the pilot.

  void navigate(const Sensors& sensors);
  void look(const Sensors& sensors);
  void follow_course();
  void change_phase(const Sensors& sensors);
  [[nodiscard]] Situation situation();
  [[nodiscard]] double drift_sigma(const NavigationState& now);
  AttitudeCommand guide();
  Command command(const AttitudeCommand& attitude);

  MapUncertainty map_uncertainty_;
  Navigator navigator_;
  NavigationState now_;  ///< The navigator's, renewed after all that changes it.
  std::unique_ptr<Parts> parts_;
  PhaseParams phase_params_;
  RotorThrust thrust_;
  std::array<double, 4> motors_{};  ///< As last commanded [rad/s].
  bool uses_sonar_, uses_baro_;
  Phase phase_ = OnGround{};
  double passed_at_ = -1e9;   ///< When the last gate was passed [s].
  double known_sigma_ = 0.0;  ///< NavigationState::place_sigma when a gate last told [m].
  AbortReason abort_reason_ = AbortReason::kNone;
};

}  // namespace gatefly
