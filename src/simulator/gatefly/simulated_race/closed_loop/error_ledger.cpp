// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/error_ledger.hpp"

#include <Eigen/Cholesky>

namespace gatefly::simulated_race {
namespace {

/// The share of a fix that entered the estimate.
Eigen::Matrix3d gain(const Eigen::Matrix3d& P, const ErrorLedger::Fix& fix) {
  if (!fix.has_height) {
    Eigen::Matrix3d K = Eigen::Matrix3d::Zero();
    if (fix.restarted) {
      K.topLeftCorner<2, 2>().setIdentity();
      return K;
    }
    const Eigen::Matrix2d S = P.topLeftCorner<2, 2>() + fix.covariance.topLeftCorner<2, 2>();
    K.leftCols<2>() = S.ldlt().solve(P.topRows<2>()).transpose();
    return K;
  }
  if (fix.restarted) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d S = P + fix.covariance;
  return S.ldlt().solve(P).transpose();
}

}  // namespace

void ErrorLedger::correct(const Fix& fix, const Eigen::Vector3d& true_p_EB) {
  fix_error_ = true_p_EB - fix.p_EB + map_shift_;
  const Eigen::Matrix3d K = gain(covariance_, fix);
  map_ -= Eigen::Vector3d{K * map_};
  detection_ += K * Eigen::Vector3d{*fix_error_ - detection_};
}

void ErrorLedger::add(const Entry& entry) {
  if (entry.fix) correct(*entry.fix, entry.true_p_EB);
  map_ += entry.map_shift - map_shift_;
  map_shift_ = entry.map_shift;
  covariance_ = entry.covariance;
  estimate_ = entry.true_p_EB - entry.p_EB + map_shift_ - map_ - detection_;
}

}  // namespace gatefly::simulated_race
