// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/look_ahead.hpp"

#include <algorithm>

#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly::eskf {

void LookAhead::restart(const Eigen::Vector3d& accel_B, double time) {
  *this = LookAhead{};
  accel_B_ = accel_B, time_ = time;
}

void LookAhead::turn(const Eigen::Vector3d& rate_B, double time) {
  constexpr double kLongest = 0.1;  // a jump of the clock counts as no more than this [s]
  rate_B_ = rate_B;
  const double dt = std::min(time - time_, kLongest);
  if (!(dt > 0.0)) return;
  time_ = time, passed_ += dt;
  const Eigen::Matrix3d half = rotation_of(0.5 * dt * rate_B), middle = turned_ * half;
  const Eigen::Vector3d a = middle * accel_B_;
  way_ += dt * speed_ + 0.5 * dt * dt * a;
  speed_ += dt * a;
  turned_ = middle * half;
}

void LookAhead::carry(Nominal& x, double gravity) const {
  const Eigen::Vector3d g_E{0, 0, gravity};
  x.p_EB += passed_ * x.v_E + 0.5 * passed_ * passed_ * g_E + x.R_EB * way_;
  x.v_E += passed_ * g_E + x.R_EB * speed_;
  x.R_EB = x.R_EB * turned_;
  x.rate_B = rate_B_;
}

}  // namespace gatefly::eskf
