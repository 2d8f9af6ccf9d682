// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/drag_filter.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

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

// N neighbouring states from `kFirst` on are measured: H picks their rows, and is never multiplied by.
template <int N, int kFirst = kX>
struct Measurement {
  Eigen::Matrix<double, N, 1> innovation;
  Eigen::Matrix<double, N, N> R;                   ///< Random errors ...
  Eigen::Matrix<double, N, systematic::kCount> L;  ///< ... and systematic ones.

  template <class Matrix>  // H M
  [[nodiscard]] static auto rows_of(const Matrix& m) {
    return m.template middleRows<N>(kFirst);
  }
  template <class Matrix>  // M Hᵀ
  [[nodiscard]] static auto columns_of(const Matrix& m) {
    return m.template middleCols<N>(kFirst);
  }
};

template <int N, int kFirst>
Eigen::Matrix<double, N, N> covariance_of_innovation(const StateMatrix& P, const Cross& C,
                                                     const Measurement<N, kFirst>& m) {
  const Eigen::Matrix<double, N, systematic::kCount> HC = m.rows_of(C);
  const Eigen::Matrix<double, N, N> HCL = HC * m.L.transpose();
  const Eigen::Matrix<double, N, N> LL = m.L * m.L.transpose();
  return m.columns_of(m.rows_of(P)) + HCL + HCL.transpose() + LL + m.R;
}

// S⁻¹ B for a symmetric S of at most three rows: one decomposition for all sizes.
template <int N, int kColumns>
Eigen::Matrix<double, N, kColumns> solved(const Eigen::Matrix<double, N, N>& S,
                                          const Eigen::Matrix<double, N, kColumns>& B) {
  using UpTo3 = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
  using Right = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, kStates>;
  const Right X = Eigen::LDLT<UpTo3>{UpTo3{S}}.solve(Right{B});
  return X;
}

// EKF update in place. Li18 appendix (4), and (5) in Joseph form, systematic errors considered,
// not estimated [Schmidt 1966].
template <int N, int kFirst>
void update(State& x, StateMatrix& P, Cross& C, const Measurement<N, kFirst>& m) {
  const Eigen::Matrix<double, N, N> S = covariance_of_innovation(P, C, m);
  // K = (P Hᵀ + C Lᵀ) S⁻¹, by solving S Kᵀ = H P + L Cᵀ: S is never inverted.
  const Eigen::Matrix<double, N, kStates> HP_LC = m.rows_of(P) + m.L * C.transpose();
  const Eigen::Matrix<double, kStates, N> K = solved<N, kStates>(S, HP_LC).transpose();
  x += K * m.innovation;
  StateMatrix I_KH = StateMatrix::Identity();
  I_KH.template middleCols<N>(kFirst) -= K;
  const StateMatrix mixed = I_KH * C * m.L.transpose() * K.transpose();
  const StateMatrix joseph = I_KH * P * I_KH.transpose() +
                             K * (m.R + m.L * m.L.transpose()) * K.transpose() - mixed -
                             mixed.transpose();
  P = 0.5 * (joseph + joseph.transpose());
  C = I_KH * C - K * m.L;
}

// A fix as N = 3 or, without height, 2 measurements.
template <int N>
Measurement<N> measured(const Fix& fix, const Eigen::Vector3d& innovation) {
  Measurement<N> m;
  m.innovation = innovation.head<N>();
  m.L = fix.systematic.topRows<N>();
  m.R = (fix.systematic.isZero(0.0) ? fix.covariance : fix.random_covariance).topLeftCorner<N, N>();
  return m;
}

}  // namespace

// Of all states but the position.
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
  const StateMatrix Phi = StateMatrix::Identity() + dt * F + (0.5 * dt * dt) * (F * F);
  // A heading error turns the way flown by the same angle as the fixes.
  const Eigen::Vector3d turned = dt * Eigen::Vector3d{v_G.y(), -v_G.x(), 0.0};
  Cross C = Phi * C_;
  age(C, input.yaw_sigma, dt);
  StateMatrix P = Phi * P_ * Phi.transpose();  // Eq. (33)
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
  const auto squared = [&](const auto& m) {
    return m.innovation.dot(covariance_of_innovation(P_, C_, m).ldlt().solve(m.innovation));
  };
  return fix.has_height ? squared(measured<3>(fix, innovation))
                        : squared(measured<2>(fix, innovation));
}

Fusion DragFilter::correct(const Fix& fix) {
  const double limit = params_.gate_sigma * params_.gate_sigma;
  if (!(nis(fix) < limit)) return Fusion::kRefused;
  const Eigen::Vector3d innovation = fix.p_GB - position();
  if (fix.has_height) {
    update(x_, P_, C_, measured<3>(fix, innovation));
  } else {
    update(x_, P_, C_, measured<2>(fix, innovation));
  }
  return Fusion::kAccepted;
}

void DragFilter::restart(const Fix& fix) {
  const Measurement<3> m = measured<3>(fix, Eigen::Vector3d::Zero());
  const double z = x_(kZ), z_variance = P_(kZ, kZ);
  const Eigen::Matrix<double, 1, systematic::kCount> z_systematic = C_.row(kZ);
  x_.segment<3>(kX) = fix.p_GB;
  C_.setZero();
  C_.topRows<3>() = -m.L;
  P_.setZero();
  P_.topLeftCorner<3, 3>() = m.R + m.L * m.L.transpose();
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
  Measurement<1, kZ> m;
  m.innovation << innovation;
  m.R << sigma * sigma;
  m.L.setZero();
  m.L(systematic::kHeight) = height_sigma;
  if (!std::isfinite(innovation) ||
      !(innovation * innovation < 25.0 * covariance_of_innovation(P_, C_, m)(0, 0))) {
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
  P_ = T * P_ * T.transpose();
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
  return covariance_of_innovation(P_, C_, measured<3>(fix, Eigen::Vector3d::Zero()));
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
