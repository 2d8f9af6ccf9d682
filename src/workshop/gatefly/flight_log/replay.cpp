// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/replay.hpp"

#include <cmath>

#include "gatefly/flight_log/inertial_follower.hpp"
#include "gatefly/geometry/seconds.hpp"

namespace gatefly::flight_log {
namespace {

bool is_finite(const Command& c) {
  bool finite = std::isfinite(c.attitude.roll) && std::isfinite(c.attitude.pitch) &&
                std::isfinite(c.attitude.yaw) && std::isfinite(c.attitude.thrust);
  for (const double speed : c.motors) finite = finite && std::isfinite(speed);
  return finite;
}

bool is_finite(const Estimate& e) {
  return e.p_EB.allFinite() && e.v_E.allFinite() && e.accel_bias.allFinite() &&
         e.covariance_GB.allFinite() && std::isfinite(e.attitude.roll) &&
         std::isfinite(e.attitude.pitch) && std::isfinite(e.attitude.yaw);
}

// A filter that has no gate among its states takes it from where the map has it.
ScoredEstimate on_map(const EstimateRow& row, const MapGate& gate) {
  const Eigen::Vector3d& p_EB = row.estimate.p_EB;
  return {.t = row.t,
          .p_EB = p_EB,
          .p_GB = rotation_z(-gate.yaw_EG) * (p_EB - gate.p_EG),
          .covariance_EB = std::nullopt,
          .covariance_GB = std::nullopt};
}

PilotConfig with_filter_of(PilotConfig config, Estimator estimator) {
  if (estimator == Estimator::kEskf) config.filter_model = FilterModel::kOurs;
  const bool other = config.filter_model == FilterModel::kOurs;
  // The inertial filter is fed with fixes, as the drag filter is.
  if (other && (estimator == Estimator::kDrag || estimator == Estimator::kImu15))
    config.filter_model = FilterModel::kDrag;
  return config;
}

}  // namespace

ReplayResult replay(const PilotConfig& config, const std::vector<RecordedTick>& ticks,
                    const std::function<Image(std::size_t)>& load_picture, Estimator estimator,
                    const std::function<void(const ReplayedTick&)>& on_tick,
                    const std::vector<MapGate>& true_gates) {
  Pilot pilot{with_filter_of(config, estimator)};
  InertialFollower inertial;
  ReplayResult result;
  result.estimates.reserve(ticks.size());
  result.commands.reserve(ticks.size());
  ReplayScorer scorer{true_gates};
  Eigen::Vector3d error2 = Eigen::Vector3d::Zero();
  for (const RecordedTick& tick : ticks) {
    if (tick.held) {
      result.estimates.push_back({seconds(tick.sensors.time), pilot.estimate()});
      result.commands.emplace_back();
      continue;
    }
    Sensors sensors = tick.sensors;
    if (tick.picture) sensors.image = load_picture(*tick.picture);
    const Command command = pilot.step(sensors);
    const double t = seconds(sensors.time);

    if (estimator == Estimator::kImu15) inertial.update(sensors, pilot);
    EstimateRow row{t,
                    estimator == Estimator::kImu15 ? inertial.estimate(pilot) : pilot.estimate()};
    if (on_tick) on_tick({result.estimates.size(), sensors, command, pilot, row.estimate});
    if (tick.picture) {
      row.source = pilot.sighting().source;
      result.pictures.push_back({*tick.picture, t, pilot.sighting()});
      scorer.add_sighting(pilot.sighting());
      if (row.source != Sighting::Source::kNone) {
        if (!result.first_fix) result.first_fix = t;
        if (pilot.navigator().error_state() != nullptr)
          result.known_to = std::sqrt(
              pilot.estimate().covariance_GB.diagonal().head<2>().cwiseMax(0.0).maxCoeff());
      }
    }
    if (pilot.finished() && !result.last_gate) result.last_gate = t;
    result.finite = result.finite && is_finite(command) && is_finite(row.estimate);
    if (result.first_fix && !result.last_gate && tick.p_EB) {
      error2 += (row.estimate.p_EB - *tick.p_EB).cwiseAbs2();
      ++result.rmse_samples;
      const auto target = static_cast<std::size_t>(pilot.target_gate());
      scorer.add(estimator == Estimator::kImu15 ? on_map(row, config.track.gates[target])
                                                : scored_estimate(pilot),
                 *tick.p_EB, target);
    }
    result.estimates.push_back(row);
    result.commands.push_back(command);
  }
  result.score = scorer.score();
  result.divergence = pilot.divergence();
  const eskf::ErrorStateFilter* filter = pilot.navigator().error_state();
  if (filter != nullptr && filter->has_started()) result.findings = eskf::findings_of(*filter);
  result.gates_passed = pilot.estimate().gates_passed;
  if (result.rmse_samples > 0) result.rmse = (error2 / result.rmse_samples).cwiseSqrt();
  return result;
}

}  // namespace gatefly::flight_log
