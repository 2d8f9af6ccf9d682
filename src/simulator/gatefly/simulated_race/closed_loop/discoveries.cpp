// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/discoveries.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/estimation/eskf/findings.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::simulated_race {
namespace {

constexpr double kReportPeriod = 0.05;  // A pilot's findings are read so often [s].
constexpr double kThrustTime = 1.0;     // The true thrust is a mean over so long [s].

double heading_of(const Eigen::Matrix3d& R_EB) { return atan2(R_EB(1, 0), R_EB(0, 0)); }

}  // namespace

void DiscoveryWatch::update(const Pilot& pilot, const sim::BodyState& state, double now,
                            std::size_t passes) {
  const eskf::ErrorStateFilter* filter = pilot.navigator().error_state();
  const bool flies = filter != nullptr && filter->has_started();
  if (flies) follow_thrust(state, now);
  const auto target = static_cast<std::size_t>(pilot.target_gate());
  if (passes > passes_) {
    result_.gate_rmse.push_back(samples_ > 0 ? std::sqrt(squares_ / samples_) : 0.0);
    squares_ = 0.0, samples_ = 0, passes_ = passes;
    if (flies && passes == gates_.size()) note_lap(*filter, state);
  }
  if (target != passes_ % gates_.size()) return;  // the pilot is elsewhere in the course
  const world::WorldGate& gate = gates_[target];
  const Eigen::Vector3d p_GB = rotation_z(-gate.yaw_EG) * (state.p_EB - gate.p_EG);
  squares_ += (pilot.estimate().p_GB - p_GB).head<2>().squaredNorm(), ++samples_;
  if (flies && now >= next_report_) note_reports(*filter, now, passes);
}

// Compares the reading of an accelerometer without errors with what these rotor speeds give by the data sheet.
void DiscoveryWatch::follow_thrust(const sim::BodyState& state, double now) {
  const double dt = std::clamp(now - last_, 0.0, kThrustTime);
  last_ = now;
  double squares = 0.0;
  for (const double speed : state.rotor_speed) squares += speed * speed;
  const double told = vehicle_.thrust_coefficient * squares / vehicle_.mass;
  if (told > 0.5 * kGravity)
    thrust_ += dt / kThrustTime * (-state.specific_force_B.z() / told - 1.0 - thrust_);
}

void DiscoveryWatch::note_reports(const eskf::ErrorStateFilter& filter, double now,
                                  std::size_t passes) {
  next_report_ = now + kReportPeriod;
  for (const eskf::GateOff& off : eskf::findings_of(filter).off) {
    const auto same = [&](const MapReport& report) { return report.gate == off.gate; };
    const auto& reports = result_.map_reports;
    if (std::any_of(reports.begin(), reports.end(), same)) continue;
    result_.map_reports.push_back({off.gate, now, off.offset, passes <= off.gate});
  }
}

void DiscoveryWatch::note_lap(const eskf::ErrorStateFilter& filter, const sim::BodyState& state) {
  const eskf::Nominal& x = filter.now();
  const eskf::Findings findings = eskf::findings_of(filter);
  const auto against = [](const eskf::Found& found, double truth) {
    return FoundError{found.value - truth, found.sigma};
  };
  Discoveries::AfterLap& found = result_.after_lap.emplace();
  // A principal point that is off cannot be told from a tilt.
  found.camera_tilt = against(findings.tilt, truth_.tilt + truth_.center_as_tilt);
  found.heading = {wrap_angle(heading_of(x.R_EB) - heading_of(sim::R_EB_of(state.q_EB))),
                   filter.sigma(eskf::kTheta + 2)};
  found.thrust = against(findings.thrust, thrust_);
  found.latency = against({-findings.delay.value, findings.delay.sigma},
                          truth_.latency + truth_.latency_jitter);
}

}  // namespace gatefly::simulated_race
