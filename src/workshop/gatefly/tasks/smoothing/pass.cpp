// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/smoothing/pass.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "gatefly/estimation/eskf/correction.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::smoothing {

using namespace eskf;

namespace {

/// λ and Λ of the adjoint: what is measured later says of the errors now.
struct Adjoint {
  Eigen::VectorXd lambda;
  Eigen::MatrixXd Lambda;  ///< Empty where nobody asks for covariances.
};

void add_to(Eigen::VectorXd& v, const std::vector<int>& states, const Eigen::VectorXd& part) {
  for (std::size_t i = 0; i < states.size(); ++i)
    v(states[i]) += part(static_cast<Eigen::Index>(i));
}

// Rows and columns of a symmetric matrix: M = M F, then M = Fᵀ M, or P = F P Fᵀ with F transposed.
void carry(Eigen::MatrixXd& M, const Transition& F, const BaseVector& kept) {
  M.topRows<kMoving>() = (F * M.topRows<kMoving>()).eval();
  M.leftCols<kMoving>() = (M.leftCols<kMoving>() * F.transpose()).eval();
  for (int i = kMoving; i < kGates; ++i)
    if (kept(i) != 1.0) M.row(i) *= kept(i), M.col(i) *= kept(i);
}

// An error of a height, by a floor that is not flat or air that rotors push down, is in the next ones, too:
// so many count as one. Half a second of a sonar; a filter forgets its first heights, a smoother adds up all.
// [ours: tests/closed_loop/smoothed_race_test]
constexpr double kHeightsAlike = 10.0;

void symmetric(Eigen::MatrixXd& M) { M = (0.5 * (M + M.transpose())).eval(); }

}  // namespace

Pass::Pass(const Intake& intake, const Trajectory& trajectory)
    : intake_{intake}, trajectory_{trajectory} {}

void Pass::start() {
  const auto gates = static_cast<Eigen::Index>(intake_.landmarks.size());
  const Eigen::Index n = kGates + kPerGate * gates;
  e_.setZero(n);
  P_.setZero(n, n);
  e_.head<kGates>() = difference(intake_.start.x, trajectory_.x.front());
  P_.topLeftCorner<kGates, kGates>() = intake_.P_start;
  for (Eigen::Index i = 0; i < gates; ++i) {
    const Landmark& map = intake_.landmarks[static_cast<std::size_t>(i)];
    const GateBelief& gate = trajectory_.gates[static_cast<std::size_t>(i)];
    const Eigen::Index at = kGates + kPerGate * i;
    e_.segment<3>(at + kGateP) = map.p_EG - gate.p_EG;
    e_(at + kGateYaw) = wrap_angle(map.yaw_EG - gate.yaw_EG);
    e_(at + kGateSize) = -gate.size;
    P_.diagonal().segment<kPerGate>(at) =
        prior_of(map, intake_.setup.params.priors).cwiseMax(kLeastPrior).cwiseAbs2();
  }
  e_start_ = e_, P_start_ = P_;
  corner_of_ = -1;
}

void Pass::forwards(const std::function<void()>& now_and_then, std::size_t certainty_every) {
  start();
  done_.clear(), kept_.clear();
  done_.reserve(intake_.ticks.size());
  for (std::size_t tick = 0; tick < intake_.ticks.size(); ++tick) {
    if (now_and_then && tick % 64 == 0) now_and_then();
    go_on(tick);
    measure(tick);
    symmetric(P_);
    if (certainty_every > 0 && (tick + 1) % certainty_every == 0) kept_.push_back({tick + 1, P_});
  }
}

void Pass::go_on(std::size_t tick) {
  const Tick& taken = intake_.ticks[tick];
  Nominal x = trajectory_.x[tick];
  x.accel_shaking = taken.accel_shaking, x.gyro_shaking = taken.gyro_shaking;
  Done& now = done_.emplace_back();
  now.step = step_of(x, {taken.samples.begin(), taken.samples.size()}, intake_.setup);
  now.step.drift = difference(x, trajectory_.x[tick + 1]);
  if (tick > 0 && intake_.ticks[tick - 1].doubted) {
    Covariance doubt = Covariance::Zero(kGates, kGates);
    widen(doubt);
    now.step.noise += doubt.diagonal();
  }
  e_.head<kGates>() = now.step.times(e_.head<kGates>()) + now.step.drift;
  carry(P_, now.step.F, now.step.kept);
  P_.diagonal().head<kGates>() += now.step.noise;
}

void Pass::measure(std::size_t tick) {
  const Tick& taken = intake_.ticks[tick];
  const Setup& setup = intake_.setup;
  Nominal x = trajectory_.x[tick + 1];
  x.accel_shaking = taken.accel_shaking, x.gyro_shaking = taken.gyro_shaking;
  const Interval interval = mean_of({taken.samples.begin(), taken.samples.size()});
  for (const int axis : {0, 1}) take(rows_of(drag_measurement(x, interval, axis, setup.params)));
  if (rotors_carry(x, interval, setup.params))
    take(rows_of(thrust_measurement(x, interval, setup.params)));
  if (!taken.sights.empty()) x.rate_B = rate_around(tick);
  for (const HeightSeen& seen : taken.heights) {
    const Rows rows = rows_of(Scalar<1>{.residual = -seen.height - x.p_EB.z(),
                                        .states = {kP + 2},
                                        .jacobian = {1.0},
                                        .variance = kHeightsAlike * seen.sigma * seen.sigma});
    if (is_height(rows)) take(rows);
  }
  for (const GateSight& sight : taken.sights) {
    const auto gate = static_cast<std::size_t>(sight.slot);
    const auto rows = rows_of(x, sight, trajectory_.gates[gate], intake_.landmarks[gate].shape,
                              sight.time - taken.time, setup);
    if (!rows) continue;
    const bool another =
        sight.quality == GateSight::Quality::kWhole && corner_of_ != face_of(sight);
    if (another) corner_of_ = face_of(sight), forget_corner();
    take(*rows, another);
  }
}

// As ErrorStateFilter has it: how the drone turned around the end of a tick, without its shaking.
Eigen::Vector3d Pass::rate_around(std::size_t tick) const {
  constexpr double kHalf = 0.02;  // [s]
  const auto& ticks = intake_.ticks;
  const auto near = std::min({static_cast<std::size_t>(std::max(1.0, std::round(kHalf * kTickHz))),
                              tick + 1, ticks.size() - 1 - tick});
  Eigen::Vector3d turned = Eigen::Vector3d::Zero();
  double time = 0.0;
  for (std::size_t i = tick + 1 - near; i <= tick + near; ++i) {
    const Interval one = mean_of({ticks[i].samples.begin(), ticks[i].samples.size()});
    turned += one.dt * one.mean.gyro_B, time += one.dt;
  }
  const Nominal& x = trajectory_.x[tick + 1];
  return time > 0.0 ? Eigen::Vector3d{turned / time - x.gyro_bias} : x.rate_B;
}

// As eskf::correct_by_height has it.
bool Pass::is_height(const Rows& rows) const {
  constexpr double kFarthest = 5.0;  // sigmas
  const int state = rows.states.front();
  const double y = rows.residual(0) - e_(state), S = P_(state, state) + rows.noise(0, 0);
  return y * y < kFarthest * kFarthest * S;
}

void Pass::forget_corner() {
  const SightNoise& noise = intake_.setup.params.sight;
  const double px = intake_.setup.camera.radians_per_px;
  e_.segment<3>(kCorner).setZero();
  P_.middleRows<3>(kCorner).setZero();
  P_.middleCols<3>(kCorner).setZero();
  for (int i = 0; i < 3; ++i)
    P_(kCorner + i, kCorner + i) = std::pow(px * (i < 2 ? noise.lasting : noise.lasting_size), 2);
}

void Pass::take(const Rows& rows, bool forgets) {
  Update update{rows.states, rows.H, {}, {}, {}, forgets};
  const Eigen::MatrixXd PHt = P_(Eigen::all, rows.states) * rows.H.transpose();
  Eigen::MatrixXd S = rows.H * PHt(rows.states, Eigen::all) + rows.noise;
  symmetric(S);
  update.S_inverse = S.llt().solve(Eigen::MatrixXd::Identity(S.rows(), S.cols()));
  update.K = PHt * update.S_inverse;
  update.weighted = update.S_inverse * (rows.residual - rows.H * e_(rows.states));
  e_ += PHt * update.weighted;
  P_.noalias() -= update.K * PHt.transpose();
  done_.back().updates.push_back(std::move(update));
}

Correction Pass::backwards(std::vector<Certainty>* certainties) {
  const Eigen::Index n = e_.size();
  const std::size_t ticks = done_.size();
  Adjoint a{Eigen::VectorXd::Zero(n), {}};
  if (certainties) a.Lambda.setZero(n, n);
  std::vector<BaseVector> after_step(ticks);  // λ once the tick has begun, before its measurements
  auto kept = kept_.rbegin();
  for (std::size_t tick = ticks; tick-- > 0;) {
    if (certainties && kept != kept_.rend() && kept->moment == tick + 1) {
      kept->P -= (kept->P * a.Lambda * kept->P).eval();
      symmetric(kept->P);
      ++kept;
    }
    const Done& done = done_[tick];
    for (auto u = done.updates.rbegin(); u != done.updates.rend(); ++u) {
      const Eigen::VectorXd back = u->K.transpose() * a.lambda + u->weighted;
      if (certainties) {  // Λ = (1 - K H)ᵀ Λ (1 - K H) + Hᵀ S⁻¹ H
        const Eigen::MatrixXd LK = a.Lambda * u->K;
        const Eigen::MatrixXd LKH = LK * u->H;
        const Eigen::MatrixXd inner =
            u->H.transpose() * (u->K.transpose() * LK + u->S_inverse) * u->H;
        a.Lambda(Eigen::all, u->states) -= LKH;
        a.Lambda(u->states, Eigen::all) -= LKH.transpose();
        a.Lambda(u->states, u->states) += inner;
      }
      add_to(a.lambda, u->states, -(u->H.transpose() * back));
      if (!u->forgets) continue;
      a.lambda.segment<3>(kCorner).setZero();
      if (!certainties) continue;
      a.Lambda.middleRows<3>(kCorner).setZero();
      a.Lambda.middleCols<3>(kCorner).setZero();
    }
    after_step[tick] = a.lambda.head<kGates>();
    a.lambda.head<kGates>() = done.step.transposed_times(a.lambda.head<kGates>());
    if (certainties) carry(a.Lambda, done.step.F.transpose(), done.step.kept);
    if (certainties && tick % 16 == 0) symmetric(a.Lambda);
  }
  // Forwards again, along what is now known of the noise: - Q λ.
  Correction found;
  const Eigen::VectorXd e = e_start_ - P_start_ * a.lambda;
  found.base.push_back(e.head<kGates>());
  found.gates = e.tail(n - kGates);
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const Step& step = done_[tick].step;
    found.base.push_back(step.times(found.base.back()) + step.drift -
                         step.noise.cwiseProduct(after_step[tick]));
  }
  if (certainties) *certainties = std::move(kept_);
  return found;
}

Eigen::MatrixXd Pass::gates_covariance() const {
  const Eigen::Index n = P_.rows() - kGates;
  return P_.bottomRightCorner(n, n);
}

}  // namespace gatefly::smoothing
