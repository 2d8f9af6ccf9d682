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

// EKF update in place. Li18 appendix (4), and (5) in Joseph form. H picks N of the position states.
template <int N>
void update(State& x, StateMatrix& P, const Eigen::Matrix<double, N, 1>& innovation,
            const Eigen::Matrix<double, N, kStates>& H, const Eigen::Matrix<double, N, N>& R) {
  const Eigen::Matrix<double, N, N> S = H * P * H.transpose() + R;
  // K = P Hᵀ S⁻¹, by solving S Kᵀ = H P: S is never inverted.
  const Eigen::Matrix<double, kStates, N> K = S.ldlt().solve(H * P).transpose();
  x += K * innovation;
  const StateMatrix I_KH = StateMatrix::Identity() - K * H;
  const StateMatrix joseph = I_KH * P * I_KH.transpose() + K * R * K.transpose();
  P = 0.5 * (joseph + joseph.transpose());
}

}  // namespace

void DragFilter::start(const Eigen::Vector3d& p_G, const Eigen::Vector3d& accel_bias) {
  x_.setZero();
  x_.segment<3>(kX) = p_G;
  x_.segment<3>(drag_model::kBiasX) = accel_bias;
  P_.setZero();
  P_.diagonal().segment<3>(kX) = params_.start_sigma.cwiseAbs2();
  P_(drag_model::kVz, drag_model::kVz) = 0.01;
  P_.diagonal().segment<3>(drag_model::kBiasX) = params_.start_bias_sigma.cwiseAbs2();
}

void DragFilter::predict(const drag_model::Input& input, double dt) {
  if (!(dt > 0.0) || dt > 1.0 || !input.accel_B.allFinite() || !input.gyro_B.allFinite()) return;
  const StateMatrix F = drag_model::jacobian(x_, input, params_.model);
  x_ += dt * drag_model::derivative(x_, input, params_.model);  // Eq. (31)
  // Eq. (32) to second order; the flight code has dt where dt² belongs.
  const StateMatrix Phi = StateMatrix::Identity() + dt * F + (0.5 * dt * dt) * (F * F);
  StateMatrix P = Phi * P_ * Phi.transpose();  // Eq. (33)
  P.diagonal().segment<3>(kX).array() += params_.position_noise * dt;
  P(drag_model::kVz, drag_model::kVz) += params_.vertical_noise * dt;
  P.diagonal().segment<3>(drag_model::kBiasX).array() += params_.bias_noise * dt;
  P_ = 0.5 * (P + P.transpose());
}

double DragFilter::distance2(const Fix& fix, const Eigen::Vector3d& moved) const {
  const Eigen::Vector3d innovation = fix.p_GB + moved - position();
  if (!innovation.allFinite()) return 1e12;
  if (!fix.has_height) {
    const Eigen::Matrix2d S = P_.topLeftCorner<2, 2>() + fix.covariance.topLeftCorner<2, 2>();
    return innovation.head<2>().dot(S.ldlt().solve(innovation.head<2>()));
  }
  const Eigen::Matrix3d S = P_.topLeftCorner<3, 3>() + fix.covariance;
  return innovation.dot(S.ldlt().solve(innovation));
}

Fusion DragFilter::correct(const Fix& fix, const Eigen::Vector3d& moved) {
  const double limit = params_.gate_sigma * params_.gate_sigma;
  if (!(distance2(fix, moved) < limit)) return Fusion::kRefused;
  const Eigen::Vector3d innovation = fix.p_GB + moved - position();
  if (fix.has_height) {
    Eigen::Matrix<double, 3, kStates> H = Eigen::Matrix<double, 3, kStates>::Zero();
    H.leftCols<3>().setIdentity();
    update<3>(x_, P_, innovation, H, fix.covariance);
  } else {
    Eigen::Matrix<double, 2, kStates> H = Eigen::Matrix<double, 2, kStates>::Zero();
    H.leftCols<2>().setIdentity();
    update<2>(x_, P_, innovation.head<2>(), H, fix.covariance.topLeftCorner<2, 2>());
  }
  return Fusion::kAccepted;
}

void DragFilter::restart(const Fix& fix) {
  x_.segment<3>(kX) = fix.p_GB;
  P_.topRows<3>().setZero();
  P_.leftCols<3>().setZero();
  P_.topLeftCorner<3, 3>() = fix.covariance;
}

Fusion DragFilter::correct_altitude(double z_G, double sigma, double height_sigma) {
  const double innovation = z_G - x_(kZ);
  const double S = P_(kZ, kZ) + sigma * sigma;
  if (!std::isfinite(innovation) || !(innovation * innovation < 25.0 * S)) {
    // The filter is too sure of itself: doubt, but do not jump.
    if (std::isfinite(innovation)) P_(kZ, kZ) += 0.01;
    return Fusion::kRefused;
  }
  Eigen::Matrix<double, 1, kStates> H = Eigen::Matrix<double, 1, kStates>::Zero();
  H(kZ) = 1.0;
  update<1>(x_, P_, Eigen::Matrix<double, 1, 1>{innovation}, H, Eigen::Matrix<double, 1, 1>{sigma * sigma});
  P_(kZ, kZ) = std::max(P_(kZ, kZ), height_sigma * height_sigma);
  return Fusion::kAccepted;
}

void DragFilter::change_frame(const Eigen::Matrix3d& R, const Eigen::Vector3d& offset, const MapDoubt& doubt) {
  x_.segment<3>(kX) = R * position() + offset;
  StateMatrix T = StateMatrix::Identity();
  T.topLeftCorner<3, 3>() = R;
  P_ = T * P_ * T.transpose();
  const Eigen::Vector3d sigma{doubt.position, doubt.position, doubt.height};
  P_.diagonal().segment<3>(kX) += sigma.cwiseAbs2();
  const Eigen::Vector2d turned = doubt.yaw * Eigen::Vector2d{-x_(drag_model::kY), x_(kX)};
  P_.topLeftCorner<2, 2>() += turned * turned.transpose();
}

}  // namespace gatefly
