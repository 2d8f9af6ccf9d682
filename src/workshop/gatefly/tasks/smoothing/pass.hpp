// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "gatefly/tasks/smoothing/linear_model.hpp"
#include "gatefly/tasks/smoothing/smoother.hpp"

namespace gatefly::smoothing {

/// A flight as assumed, around which a pass linearises.
struct Trajectory {
  std::vector<eskf::Nominal>
      x;  ///< At the start, then at the end of every tick; corners' errors zero.
  std::vector<eskf::GateBelief> gates;
};

/// The errors of a trajectory, found from all that was measured.
struct Correction {
  std::vector<BaseVector> base;  ///< Base state of each of its moments.
  Eigen::VectorXd gates;         ///< kPerGate of each.
};

/// One Kalman filter forwards over errors of a trajectory, and what its adjoint needs to go back.
class Pass {
 public:
  Pass(const Intake& intake, const Trajectory& trajectory);

  /// @param now_and_then  called often; may throw; may be empty.
  /// @param certainty_every  so many ticks apart covariances are kept; 0: none.
  void forwards(const std::function<void()>& now_and_then, std::size_t certainty_every = 0);
  /// Fills the covariances that were kept with what came after.
  [[nodiscard]] Correction backwards(std::vector<Certainty>* certainties = nullptr);

  /// The gates' beliefs, in the end.
  [[nodiscard]] Eigen::MatrixXd gates_covariance() const;

 private:
  struct Update {
    std::vector<int> states;
    Eigen::MatrixXd H, K, S_inverse;
    Eigen::VectorXd weighted;  ///< S⁻¹ y
    bool forgets = false;      ///< Before it, the corners' errors became another gate's.
  };
  struct Done {
    Step step;
    std::vector<Update> updates;
  };
  void start();
  void go_on(std::size_t tick);
  void measure(std::size_t tick);
  void take(const Rows& rows, bool forgets = false);
  [[nodiscard]] Eigen::Vector3d rate_around(std::size_t tick) const;
  [[nodiscard]] bool is_height(const Rows& rows) const;
  void forget_corner();

  const Intake& intake_;
  const Trajectory& trajectory_;
  Eigen::VectorXd e_;
  Eigen::MatrixXd P_;
  Eigen::VectorXd e_start_;
  Eigen::MatrixXd P_start_;
  std::vector<Done> done_;
  std::vector<Certainty> kept_;
  int corner_of_ = -1;
};

}  // namespace gatefly::smoothing
