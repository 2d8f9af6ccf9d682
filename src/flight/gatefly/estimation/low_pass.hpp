// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/geometry/math.hpp"

namespace gatefly {

/// Second-order low-pass with fixed sampling, in transposed direct form II.
class LowPass {
 public:
  /// @param damping  1/√2 is Butterworth.
  LowPass(double cutoff_hz, double sample_hz, double damping = 0.70710678118654752) {
    const double w = tan(kPi * cutoff_hz / sample_hz);  // bilinear, warped to meet the cut-off
    const double norm = 1.0 / (1.0 + 2.0 * damping * w + w * w);
    b0_ = w * w * norm;
    a1_ = 2.0 * (w * w - 1.0) * norm;
    a2_ = (1.0 - 2.0 * damping * w + w * w) * norm;
  }

  /// The filtered value after one more sample; the first sample starts it at rest.
  Eigen::Vector3d update(const Eigen::Vector3d& x) {
    if (!started_) {
      started_ = true;
      s1_ = x * (1.0 - b0_);
      s2_ = x * (b0_ - a2_);
    }
    const Eigen::Vector3d y = b0_ * x + s1_;
    s1_ = 2.0 * b0_ * x - a1_ * y + s2_;
    s2_ = b0_ * x - a2_ * y;
    return y;
  }

 private:
  double b0_, a1_, a2_;
  Eigen::Vector3d s1_ = Eigen::Vector3d::Zero(), s2_ = Eigen::Vector3d::Zero();
  bool started_ = false;
};

}  // namespace gatefly
