// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/replay_score.hpp"

#include <Eigen/Cholesky>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::flight_log {

void FrameErrors::add(const Eigen::Vector3d& error) {
  sum += error, squares += error.cwiseAbs2(), ++samples;
}

void FrameErrors::add(const FrameErrors& other) {
  sum += other.sum, squares += other.squares, samples += other.samples;
  nees.samples += other.nees.samples, nees.sum_per_dof += other.nees.sum_per_dof;
  nees.inside += other.nees.inside;
}

Eigen::Vector3d FrameErrors::rms() const {
  return samples > 0 ? (squares / samples).cwiseSqrt().eval() : Eigen::Vector3d::Zero().eval();
}

Eigen::Vector3d FrameErrors::deviation() const {
  if (samples == 0) return Eigen::Vector3d::Zero();
  return (squares / samples - (sum / samples).cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
}

ScoredEstimate scored_estimate(const Pilot& pilot) {
  const Estimate now = pilot.estimate();
  ScoredEstimate e{.t = pilot.navigator().time(),
                   .p_EB = now.p_EB,
                   .p_GB = now.p_GB,
                   .covariance_EB = std::nullopt,
                   .covariance_GB = now.covariance_GB};
  const eskf::ErrorStateFilter* filter = pilot.navigator().error_state();
  if (filter == nullptr || !filter->has_started()) return e;
  e.p_EB = filter->now().p_EB;
  e.covariance_EB = filter->covariance().topLeftCorner<3, 3>();
  return e;
}

void ReplayScorer::add(const ScoredEstimate& estimate, const Eigen::Vector3d& true_p_EB,
                       std::size_t target) {
  constexpr double kPeriod = 0.05;  // of NEES [s]
  const bool due = estimate.t >= next_;
  if (due) next_ = estimate.t + kPeriod;
  const auto put = [due](FrameErrors& to, const Eigen::Vector3d& error,
                         const std::optional<Eigen::Matrix3d>& covariance) {
    to.add(error);
    if (due && covariance) to.nees.add(error.dot(covariance->ldlt().solve(error)), 3);
  };
  put(score_.earth, estimate.p_EB - true_p_EB, estimate.covariance_EB);
  if (target >= gates_.size()) return;
  const MapGate& gate = gates_[target];
  put(score_.gate, estimate.p_GB - rotation_z(-gate.yaw_EG) * (true_p_EB - gate.p_EG),
      estimate.covariance_GB);
}

void ReplayScorer::add_sighting(const Sighting& sighting) {
  if (sighting.source != Sighting::Source::kNone) score_.nis.add(sighting.nis, sighting.nis_dof);
}

}  // namespace gatefly::flight_log
