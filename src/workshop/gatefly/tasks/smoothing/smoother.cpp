// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/smoothing/smoother.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"
#include "gatefly/tasks/smoothing/pass.hpp"

namespace gatefly::smoothing {

using namespace eskf;

namespace {

// The filter's beliefs; of the gates those in the end.
Trajectory by_filter(const Intake& intake) {
  Trajectory trajectory{{intake.start.x}, intake.gates};
  for (const Tick& tick : intake.ticks) trajectory.x.push_back(tick.x);
  for (Nominal& x : trajectory.x) x.corner.setZero();
  return trajectory;
}

void add(GateBelief& gate, const Eigen::VectorXd& error) {
  Nominal x;
  x.gates[0] = gate;
  ErrorVector all = ErrorVector::Zero(gate_at(1));
  all.tail<kPerGate>() = error;
  eskf::add(x, all);
  gate = x.gates[0];
}

/// How far a correction reaches, in its largest error [m], [rad].
struct Reach {
  double place = 0.0, turn = 0.0;
};

Reach take_in(Trajectory& trajectory, const Correction& found) {
  Reach reach;
  for (std::size_t i = 0; i < trajectory.x.size(); ++i) {
    ErrorVector error = found.base[i];
    error.segment<3>(kCorner).setZero();
    eskf::add(trajectory.x[i], error);
    trajectory.x[i].rate_B -= error.segment<3>(kGyroBias);
    reach.place = std::max(reach.place, error.segment<3>(kP).norm());
    reach.turn = std::max(reach.turn, error.segment<3>(kTheta).norm());
  }
  for (std::size_t i = 0; i < trajectory.gates.size(); ++i)
    add(trajectory.gates[i],
        found.gates.segment<kPerGate>(kPerGate * static_cast<Eigen::Index>(i)));
  return reach;
}

std::size_t certainty_every(const Intake& intake, double period) {
  const auto& ticks = intake.ticks;
  if (ticks.size() < 2) return 1;
  const double tick =
      (ticks.back().time - ticks.front().time) / static_cast<double>(ticks.size() - 1);
  return static_cast<std::size_t>(std::max(1.0, std::round(period / std::max(tick, 1e-4))));
}

}  // namespace

Smoothed smooth(const Intake& intake, const SmootherParams& params,
                const std::function<void()>& now_and_then) {
  constexpr double kSettledPlace = 1e-3, kSettledTurn = 0.01 * kDegree;  // [m], [rad]
  Trajectory trajectory = by_filter(intake);
  Smoothed smoothed;
  while (!smoothed.settled && smoothed.passes < params.most_passes) {
    Pass pass{intake, trajectory};
    pass.forwards(now_and_then);
    const Reach reach = take_in(trajectory, pass.backwards());
    ++smoothed.passes;
    smoothed.settled = reach.place < kSettledPlace && reach.turn < kSettledTurn;
  }
  Pass last{intake, trajectory};
  last.forwards(now_and_then, certainty_every(intake, params.certainty_period));
  (void)take_in(trajectory, last.backwards(&smoothed.certainties));
  smoothed.P_gates = last.gates_covariance();
  smoothed.landmarks = intake.landmarks;
  smoothed.gates = trajectory.gates;
  smoothed.path.push_back({intake.start.time, trajectory.x.front()});
  for (std::size_t i = 0; i < intake.ticks.size(); ++i)
    smoothed.path.push_back({intake.ticks[i].time, trajectory.x[i + 1]});
  return smoothed;
}

Nominal at(const Smoothed& smoothed, double time) {
  const auto& path = smoothed.path;
  const auto after = std::lower_bound(path.begin(), path.end(), time,
                                      [](const Moment& m, double t) { return m.time < t; });
  if (after == path.begin()) return path.front().x;
  if (after == path.end()) return path.back().x;
  const Moment &a = *(after - 1), &b = *after;
  const double part = b.time > a.time ? (time - a.time) / (b.time - a.time) : 1.0;
  Nominal x = b.x;
  x.p_EB = a.x.p_EB + part * (b.x.p_EB - a.x.p_EB);
  x.v_E = a.x.v_E + part * (b.x.v_E - a.x.v_E);
  x.R_EB = rotation_of(part * turn_of(b.x.R_EB * a.x.R_EB.transpose())) * a.x.R_EB;
  return x;
}

}  // namespace gatefly::smoothing
