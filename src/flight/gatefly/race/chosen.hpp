// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include <Eigen/Core>

#include "gatefly/estimation/eskf/monitor.hpp"
#include "gatefly/race/course.hpp"
#include "gatefly/race/guidance.hpp"
#include "gatefly/race/lookout.hpp"
#include "gatefly/race/map_lookout.hpp"
#include "gatefly/race/paper/paper_guidance.hpp"
#include "gatefly/race/paper/paper_lookout.hpp"
#include "gatefly/race/pilot_config.hpp"

// Each box of the system diagram that exists twice, ours and the paper's: chosen here, by the configuration, and nowhere else.
// Variants and not virtual functions, so that the bound on the stack holds for whatever is called.

namespace gatefly {

/// The legs of the course: planned, or by the paper's exits.
[[nodiscard]] Course course_of(const PilotConfig& config);

/// The eye: one for the filter that has the map among its states, one that knows the next gate alone, or the paper's.
class ChosenLookout {
 public:
  explicit ChosenLookout(const PilotConfig& config);

  /// See Lookout::look.
  void look(const Sensors& sensors, bool looking, const Course& course, Navigator& navigator);
  /// Result of the last picture.
  [[nodiscard]] const Sighting& sighting() const;
  /// See MapLookout::would_show_whole; the others do not know, and answer true.
  [[nodiscard]] bool would_show_whole(const MapGate& gate, const Eigen::Vector3d& p_GB) const;
  /// Whether the filter has diverged; null where the eye does not judge it.
  [[nodiscard]] const eskf::Monitor* monitor() const;

 private:
  std::variant<Lookout, PaperLookout, MapLookout> lookout_;
};

/// The outer loop: ours, or the paper's. Each function does what Guidance says of it.
class ChosenGuidance {
 public:
  explicit ChosenGuidance(const PilotConfig& config);

  AttitudeCommand command(Phase& phase, const NavigationState& now, const Course& course);
  void reset();
  [[nodiscard]] bool uses_pictures(const Phase& phase) const;
  [[nodiscard]] double entry_speed(const NavigationState& now) const;
  [[nodiscard]] double lateral_at_gate(const NavigationState& now, const Course& course) const;
  [[nodiscard]] bool turn_ahead(const NavigationState& now, const Course& course) const;

 private:
  std::variant<Guidance, PaperGuidance> guidance_;
};

}  // namespace gatefly
