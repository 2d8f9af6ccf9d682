// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>

#include <Eigen/Core>

#include "gatefly/geometry/math.hpp"

namespace gatefly::sim {

/// First-order low-pass; 0 Hz: none. The first value starts it at rest.
template <int N>
class LowPass1 {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  explicit LowPass1(double cutoff_hz) : cutoff_hz_{cutoff_hz} {}

  const Vector& update(const Vector& x, double dt) {
    const double gain = 2.0 * kPi * cutoff_hz_ * dt;
    const double part = started_ && cutoff_hz_ > 0.0 ? gain / (1.0 + gain) : 1.0;
    started_ = true;
    return y_ += part * (x - y_);
  }
  void reset() { started_ = false, y_.setZero(); }

 private:
  double cutoff_hz_;
  Vector y_ = Vector::Zero();
  bool started_ = false;
};

/// Three first-order low-passes in a row, together 3 dB down at `cutoff_hz`.
template <int N>
class Smoothing {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  /// 1 / √(2^(1/3) − 1)
  static constexpr double kEach = 1.961459176700620;
  explicit Smoothing(double cutoff_hz)
      : stages_{LowPass1<N>{kEach * cutoff_hz}, LowPass1<N>{kEach * cutoff_hz},
                LowPass1<N>{kEach * cutoff_hz}} {}

  Vector update(Vector x, double dt) {
    for (auto& stage : stages_) x = stage.update(x, dt);
    return x;
  }
  void reset() {
    for (auto& stage : stages_) stage.reset();
  }

 private:
  std::array<LowPass1<N>, 3> stages_;
};

}  // namespace gatefly::sim
