// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/drag_filter.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace gatefly {
namespace {

using drag_model::kStates;
using drag_model::kX;
using drag_model::kZ;
using drag_model::State;
using drag_model::StateMatrix;

using Cross = DragFilter::Cross;

// Correlation times of systematic errors [s]. [ours: fixes of 30 races]
constexpr double kTiltCorrelation = 5.0, kScaleCorrelation = 2.0;

// The position, or some of its rows: H picks them and is never multiplied by.
//
// A row that is not measured is zero in H, L and the innovation, with a noise of its own: it changes
// nothing, and one update serves fixes with and without height, and altitudes.
struct Measurement {
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();  ///< 1, or 0: not.
  Eigen::Vector3d innovation = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< Random errors ...
  Sensitivities L = Sensitivities::Zero();          ///< ... and systematic ones.
};

using Gain = Eigen::Matrix<double, kStates, 3>;
using Rows = Eigen::Matrix<double, 3, kStates>;

// Products by name: what Eigen makes of each is compiled once, and not once an expression.
Eigen::Matrix3d outer(const Sensitivities& A, const Sensitivities& B) { return A * B.transpose(); }
StateMatrix outer(const Gain& A, const Gain& B) { return A * B.transpose(); }
StateMatrix product(const StateMatrix& A, const StateMatrix& B) { return A * B; }
// A P Aᵀ
StateMatrix moved(const StateMatrix& P, const StateMatrix& A) {
  return product(A, P) * A.transpose();
}

Eigen::Matrix3d covariance_of_innovation(const StateMatrix& P, const Cross& C,
                                         const Measurement& m) {
  Sensitivities HC;
  Eigen::Matrix3d HPHt;
  for (int i = 0; i < 3; ++i) {
    HC.row(i) = m.measured(i) * C.row(kX + i);
    for (int j = 0; j < 3; ++j) HPHt(i, j) = m.measured(i) * m.measured(j) * P(kX + i, kX + j);
  }
  const Eigen::Matrix3d HCL = outer(HC, m.L), LL = outer(m.L, m.L);
  return HPHt + HCL + HCL.transpose() + LL + m.R;
}

// EKF update in place. Li18 appendix (4), and (5) in Joseph form, systematic errors considered,
// not estimated [Schmidt 1966].
void update(State& x, StateMatrix& P, Cross& C, const Measurement& m) {
  const Eigen::Matrix3d S = covariance_of_innovation(P, C, m);
  // K = (P Hᵀ + C Lᵀ) S⁻¹, by solving S Kᵀ = H P + L Cᵀ: S is never inverted.
  Rows HP_LC = m.L * C.transpose();
  for (int i = 0; i < 3; ++i) HP_LC.row(i) += m.measured(i) * P.row(kX + i);
  const Eigen::LLT<Eigen::Matrix3d> S_root{S};
  if (S_root.info() != Eigen::Success) return;
  const Rows K_transposed = S_root.solve(HP_LC);
  const Gain K = K_transposed.transpose();
  x += K * m.innovation;
  StateMatrix I_KH = StateMatrix::Identity();
  for (int i = 0; i < 3; ++i) I_KH.col(kX + i) -= m.measured(i) * K.col(i);
  const Cross IC = I_KH * C;
  const Gain ICL = IC * m.L.transpose(), KR = K * (m.R + outer(m.L, m.L)).eval();
  const StateMatrix mixed = outer(ICL, K);
  const StateMatrix joseph = moved(P, I_KH) + outer(KR, K) - mixed - mixed.transpose();
  P = 0.5 * (joseph + joseph.transpose());
  C = IC - K * m.L;
}

// A fix; its height only if it has one.
Measurement measured(const Fix& fix, const Eigen::Vector3d& innovation, bool with_height) {
  Measurement m{.measured = {1.0, 1.0, with_height ? 1.0 : 0.0},
                .innovation = innovation,
                .R = fix.systematic.isZero(0.0) ? fix.covariance : fix.random_covariance,
                .L = fix.systematic};
  if (with_height) return m;
  m.innovation.z() = 0.0;
  m.R.col(2) = Eigen::Vector3d::UnitZ();
  m.R.row(2) = Eigen::RowVector3d::UnitZ();
  m.L.row(2).setZero();
  return m;
}

}  // namespace

// Initial variances of all states but the position.
Eigen::Vector4d DragFilter::start_variance() const {
  const Eigen::Vector3d bias = params_.start_bias_sigma.cwiseAbs2();
  return {0.01, bias.x(), bias.y(), bias.z()};
}

void DragFilter::start(const Eigen::Vector3d& p_G, const Eigen::Vector3d& accel_bias,
                       const MapUncertainty& uncertainty) {
  x_.setZero();
  x_.segment<3>(kX) = p_G;
  x_.segment<3>(drag_model::kBiasX) = accel_bias;
  P_.setZero();
  P_.diagonal().segment<3>(kX) = params_.start_sigma.cwiseAbs2();
  P_.diagonal().tail<4>() = start_variance();
  C_.setZero();
  add(uncertainty);
}

void DragFilter::predict(const drag_model::Input& input, double dt) {
  const Eigen::Vector4d angles{input.roll, input.pitch, input.yaw, input.yaw_sigma};
  if (!(dt > 0.0) || dt > 1.0 || !input.accel_B.allFinite() || !input.gyro_B.allFinite() ||
      !angles.allFinite())
    return;
  const StateMatrix F = drag_model::jacobian(x_, input, params_.model);
  const State derivative = drag_model::derivative(x_, input, params_.model);
  const Eigen::Vector3d v_G = derivative.segment<3>(kX);
  x_ += dt * derivative;  // Eq. (31)
  // Eq. (32) to second order; the flight code has dt where dt² belongs.
  const StateMatrix Phi = StateMatrix::Identity() + dt * F + (0.5 * dt * dt) * product(F, F);
  // A heading error turns the way flown by the same angle as the fixes.
  const Eigen::Vector3d turned = dt * Eigen::Vector3d{v_G.y(), -v_G.x(), 0.0};
  Cross C = Phi * C_;
  age(C, input.yaw_sigma, dt);
  StateMatrix P = moved(P_, Phi);  // Eq. (33)
  const Eigen::Matrix<double, kStates, 1> with =
      input.yaw_sigma * C.col(systematic::kHeading) + gate_yaw_sigma_ * C.col(systematic::kGateYaw);
  P.leftCols<3>() += with * turned.transpose();
  P.topRows<3>() += turned * with.transpose();
  P.topLeftCorner<3, 3>() +=
      (input.yaw_sigma * input.yaw_sigma + gate_yaw_sigma_ * gate_yaw_sigma_) * turned *
      turned.transpose();
  C.col(systematic::kHeading).head<3>() += input.yaw_sigma * turned;
  C.col(systematic::kGateYaw).head<3>() += gate_yaw_sigma_ * turned;
  C_ = C;
  P.diagonal().segment<2>(kX).array() += params_.position_noise * dt;
  P(kZ, kZ) += params_.height_noise * dt;
  P(drag_model::kVz, drag_model::kVz) += params_.vertical_noise * dt;
  P.diagonal().segment<3>(drag_model::kBiasX).array() += params_.bias_noise * dt;
  P_ = 0.5 * (P + P.transpose());
}

// Systematic errors decorrelate: what is new of them has no correlation with the state.
void DragFilter::age(Cross& C, double yaw_sigma, double dt) {
  for (const auto column : {systematic::kTiltX, systematic::kTiltY})
    C.col(column) *= 1.0 - dt / kTiltCorrelation;
  C.col(systematic::kScale) *= 1.0 - dt / kScaleCorrelation;
  // A heading's variance grows by new errors and shrinks by what a gate corrects.
  if (yaw_sigma_ > 0.0 && yaw_sigma > 0.0)
    C.col(systematic::kHeading) *= std::min(yaw_sigma / yaw_sigma_, yaw_sigma_ / yaw_sigma);
  yaw_sigma_ = yaw_sigma;
}

double DragFilter::nis(const Fix& fix) const {
  const Eigen::Vector3d innovation = fix.p_GB - position();
  if (!innovation.allFinite()) return 1e12;
  const Measurement m = measured(fix, innovation, fix.has_height);
  const Eigen::Matrix3d S = covariance_of_innovation(P_, C_, m);
  const Eigen::LLT<Eigen::Matrix3d> factor{S};
  if (factor.info() != Eigen::Success) return 1e12;
  return m.innovation.dot(factor.solve(m.innovation));
}

Fusion DragFilter::correct(const Fix& fix) {
  const double limit = params_.gate_sigma * params_.gate_sigma;
  if (!(nis(fix) < limit)) return Fusion::kRefused;
  const Eigen::Vector3d innovation = fix.p_GB - position();
  update(x_, P_, C_, measured(fix, innovation, fix.has_height));
  return Fusion::kAccepted;
}

void DragFilter::restart(const Fix& fix) {
  const Measurement m = measured(fix, Eigen::Vector3d::Zero(), true);
  const double z = x_(kZ), z_variance = P_(kZ, kZ);
  const Eigen::Matrix<double, 1, systematic::kCount> z_systematic = C_.row(kZ);
  x_.segment<3>(kX) = fix.p_GB;
  C_.setZero();
  C_.topRows<3>() = -m.L;
  P_.setZero();
  P_.topLeftCorner<3, 3>() = m.R + outer(m.L, m.L);
  P_.diagonal().tail<4>() = start_variance();
  if (fix.has_height) return;
  x_(kZ) = z;
  C_.row(kZ) = z_systematic;
  P_.col(kZ).head<2>() = C_.topRows<2>() * z_systematic.transpose();
  P_.row(kZ).head<2>() = P_.col(kZ).head<2>().transpose();
  P_(kZ, kZ) = z_variance;
}

Fusion DragFilter::correct_altitude(double z_G, double sigma, double height_sigma) {
  const double innovation = z_G - x_(kZ);
  Measurement m;
  m.measured.z() = 1.0;
  m.innovation.z() = innovation;
  m.R(2, 2) = sigma * sigma;
  m.L(2, systematic::kHeight) = height_sigma;
  if (!std::isfinite(innovation) ||
      !(innovation * innovation < 25.0 * covariance_of_innovation(P_, C_, m)(2, 2))) {
    // The filter is overconfident: inflate its variance, but do not jump.
    if (std::isfinite(innovation)) P_(kZ, kZ) += 0.01;
    return Fusion::kRefused;
  }
  update(x_, P_, C_, m);
  return Fusion::kAccepted;
}

void DragFilter::reset_position(const Eigen::Vector2d& p_G, double sigma) {
  x_.head<2>() = p_G;
  for (const int i : {kX, drag_model::kY, drag_model::kBiasX, drag_model::kBiasY}) {
    P_.row(i).setZero();
    P_.col(i).setZero();
  }
  P_.diagonal().head<2>().setConstant(sigma * sigma);
  C_.setZero();
}

void DragFilter::change_frame(const Eigen::Matrix3d& R, const Eigen::Vector3d& offset,
                              const MapUncertainty& uncertainty) {
  x_.segment<3>(kX) = R * position() + offset;
  StateMatrix T = StateMatrix::Identity();
  T.topLeftCorner<3, 3>() = R;
  P_ = moved(P_, T);
  // The heading error stays; the other systematic errors are new with the gate.
  const Eigen::Matrix<double, kStates, 1> heading = T * C_.col(systematic::kHeading);
  C_.setZero();
  C_.col(systematic::kHeading) = heading;
  add(uncertainty);
}

// Errors of a gate's heading and height are in the position as they will be in its fixes and
// heights: no innovation shows them.
void DragFilter::add(const MapUncertainty& uncertainty) {
  P_.diagonal().head<2>().array() += uncertainty.position * uncertainty.position;
  gate_yaw_sigma_ = uncertainty.yaw;
  const Eigen::Vector3d turned =
      uncertainty.yaw * Eigen::Vector3d{x_(drag_model::kY), -x_(kX), 0.0};
  const Eigen::Vector3d lifted = -uncertainty.height * Eigen::Vector3d::UnitZ();
  C_.col(systematic::kGateYaw).head<3>() = turned;
  C_.col(systematic::kHeight).head<3>() = lifted;
  P_.topLeftCorner<3, 3>() += turned * turned.transpose() + lifted * lifted.transpose();
}

Eigen::Matrix3d DragFilter::innovation_covariance(const Fix& fix) const {
  return covariance_of_innovation(P_, C_, measured(fix, Eigen::Vector3d::Zero(), true));
}

double DragFilter::lateral_sigma() const {
  const double by_gate = C_(drag_model::kY, systematic::kGateYaw);
  return std::sqrt(std::max(0.0, P_(drag_model::kY, drag_model::kY) - by_gate * by_gate));
}

Eigen::Vector2d DragFilter::heading_sensitivity(const Fix& fix) const {
  return C_.col(systematic::kHeading).head<2>() +
         fix.systematic.col(systematic::kHeading).head<2>();
}

}  // namespace gatefly
