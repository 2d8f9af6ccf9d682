// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/estimation/drag_model.hpp"

namespace gatefly {

struct VelocityObserverParams {
  double pull = 3.0;  ///< How fast drag's velocity wins over the integrated one [1/s]. [estimate]
};

/// Body velocity smooth enough to differentiate with: Newton carries it, drag pulls it back.
///
/// Li18 Eq. (16) has three lines and the filter keeps the third. Its first two, integrated and
/// pulled towards Eq. (14) with a time constant of 1/pull, give a velocity without the
/// accelerometer's vibration (0.3 m/s after k) and without lag; the derivative term of Eq. (22)
/// needs it.
class VelocityObserver {
 public:
  explicit VelocityObserver(const VelocityObserverParams& params) : params_{params} {}
  void start(const Eigen::Vector3d& v_B) { v_B_ = v_B; }
  void update(const drag_model::State& x, const drag_model::Input& u,
              const drag_model::Params& model, double dt);
  [[nodiscard]] const Eigen::Vector3d& v_B() const { return v_B_; }

 private:
  VelocityObserverParams params_;
  Eigen::Vector3d v_B_ = Eigen::Vector3d::Zero();
};

}  // namespace gatefly
