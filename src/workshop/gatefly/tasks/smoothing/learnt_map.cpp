// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/smoothing/learnt_map.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "gatefly/geometry/math.hpp"

namespace gatefly::smoothing {

using namespace eskf;

namespace {

// A gate is no better known than it stands: in a draught, beside somebody who walks by. [estimate]
const GateSigmas& least_sigmas() {
  static const GateSigmas least{{0.01, 0.01, 0.01, 0.3 * kDegree, 0.002}};
  return least;
}

Eigen::VectorXd prior_information(std::span<const Landmark> gates, const Priors& priors) {
  Eigen::VectorXd information(kPerGate * static_cast<Eigen::Index>(gates.size()));
  for (std::size_t i = 0; i < gates.size(); ++i)
    information.segment<kPerGate>(kPerGate * static_cast<Eigen::Index>(i)) =
        prior_of(gates[i], priors).cwiseMax(kLeastPrior).cwiseAbs2().cwiseInverse();
  return information;
}

// The middle of all gates' places on the floor plan.
double worst_of(const FlightMap& flight, const Eigen::VectorXd& fused,
                const Eigen::MatrixXd& keep) {
  const Eigen::VectorXd off = keep * (flight.errors - fused);
  const Eigen::MatrixXd P = keep * flight.P * keep.transpose();
  double worst = 0.0;
  for (std::size_t gate = 0; gate < flight.gates.size(); ++gate)
    for (int axis = 0; axis < 2 && flight.seen[gate]; ++axis) {
      const Eigen::Index i = kPerGate * static_cast<Eigen::Index>(gate) + axis;
      worst =
          std::max(worst, std::abs(off(i)) / std::max(least_sigmas()(axis), std::sqrt(P(i, i))));
    }
  return worst;
}

GateBelief moved(const Landmark& gate, const Eigen::VectorXd& error) {
  return {gate.p_EG + error.segment<3>(kGateP), wrap_angle(gate.yaw_EG + error(kGateYaw)),
          error(kGateSize)};
}

}  // namespace

FlightMap map_of(const Smoothed& smoothed, const Intake& intake) {
  FlightMap map{smoothed.landmarks, {}, smoothed.P_gates, {}};
  map.errors.resize(smoothed.P_gates.rows());
  map.seen.resize(map.gates.size());
  for (std::size_t i = 0; i < map.gates.size(); ++i) {
    const GateBelief& found = smoothed.gates[i];
    map.errors.segment<kPerGate>(kPerGate * static_cast<Eigen::Index>(i))
        << found.p_EG - map.gates[i].p_EG,
        wrap_angle(found.yaw_EG - map.gates[i].yaw_EG), found.size;
  }
  for (const Tick& tick : intake.ticks)
    for (const GateSight& sight : tick.sights)
      map.seen[static_cast<std::size_t>(sight.slot)] = true;
  return map;
}

Eigen::MatrixXd without_common(std::span<const Landmark> gates,
                               const Eigen::VectorXd& information) {
  const auto n = static_cast<Eigen::Index>(gates.size());
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Landmark& gate : gates) middle += gate.p_EG.head<2>() / static_cast<double>(n);
  Eigen::MatrixXd common = Eigen::MatrixXd::Zero(kPerGate * n, 3);  // north, east, heading
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector2d arm = gates[static_cast<std::size_t>(i)].p_EG.head<2>() - middle;
    auto rows = common.middleRows<kPerGate>(kPerGate * i);
    rows(kGateP, 0) = rows(kGateP + 1, 1) = 1.0;
    rows(kGateP, 2) = -arm.y(), rows(kGateP + 1, 2) = arm.x(), rows(kGateYaw, 2) = 1.0;
  }
  const Eigen::MatrixXd weighted = common.transpose() * information.asDiagonal();
  const Eigen::Matrix3d inner = weighted * common;
  return Eigen::MatrixXd::Identity(kPerGate * n, kPerGate * n) -
         common * inner.llt().solve(weighted);
}

LearntMap fused(std::span<const FlightMap> flights, const Priors& priors) {
  const std::vector<Landmark>& gates = flights.front().gates;
  const Eigen::VectorXd prior = prior_information(gates, priors);
  const Eigen::MatrixXd eye = Eigen::MatrixXd::Identity(prior.size(), prior.size());
  Eigen::MatrixXd information = prior.asDiagonal();
  Eigen::VectorXd weighted = Eigen::VectorXd::Zero(prior.size());
  for (const FlightMap& flight : flights) {  // each has the map in it: that counts once
    const Eigen::LLT<Eigen::MatrixXd> llt{flight.P};
    information += llt.solve(eye);
    information.diagonal() -= prior;
    weighted += llt.solve(flight.errors);
  }
  const Eigen::LLT<Eigen::MatrixXd> llt{0.5 * (information + information.transpose())};
  const Eigen::VectorXd errors = llt.solve(weighted);
  const Eigen::MatrixXd keep = without_common(gates, prior);
  const Eigen::VectorXd within = keep * errors;
  const Eigen::MatrixXd P = keep * llt.solve(eye) * keep.transpose();

  LearntMap map;
  for (std::size_t i = 0; i < gates.size(); ++i) {
    const Eigen::Index at = kPerGate * static_cast<Eigen::Index>(i);
    LearntGate& gate = map.gates.emplace_back();
    gate.belief = moved(gates[i], within.segment<kPerGate>(at));
    gate.sigmas = P.diagonal().segment<kPerGate>(at).cwiseMax(0.0).cwiseSqrt();
    gate.sigmas = gate.sigmas.cwiseMax(least_sigmas());
    gate.seen = std::any_of(flights.begin(), flights.end(),
                            [&](const FlightMap& flight) { return flight.seen[i]; });
  }
  for (const FlightMap& flight : flights) map.worst.push_back(worst_of(flight, errors, keep));
  return map;
}

}  // namespace gatefly::smoothing
