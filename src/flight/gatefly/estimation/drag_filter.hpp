// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/estimation/drag_model.hpp"
#include "gatefly/pose/gate_fix.hpp"

namespace gatefly {

struct DragFilterParams {
  drag_model::Params model;
  /// Spectral densities of x and y, z, v_z and bias [unit²/s]. [Li18 code: .2 .2 .1 4.2 per 68 ms
  /// update; ours: errors of drag's velocity last for seconds, so most of it is the bias's]
  double position_noise = 0.004;
  double height_noise = 0.004;
  double vertical_noise = 0.03;
  double bias_noise = 4e-4;
  Eigen::Vector3d start_sigma{0.15, 0.15, 0.05};  ///< On the pad [m]. [estimate]
  /// After the rest calibration [m/s²]. [estimate]
  Eigen::Vector3d start_bias_sigma{0.15, 0.15, 0.30};
  /// Fixes farther off than this many σ are refused: 1 in 150 of the right ones. [estimate]
  double gate_sigma = 3.5;
};

/// Result of offering a measurement to the filter.
enum class Fusion {
  kAccepted,
  kRefused,    ///< Outside the innovation gate, or not a number.
  kTooLate,    ///< Older than the filter remembers.
  kRestarted,  ///< Refused, but several agree: the position was reset to them.
};

/// How well the map knows one gate relative to another: standard deviations.
struct MapUncertainty {
  /// On the floor plan, and of the centre above the floor [m].
  double position = 0.0, height = 0.0;
  double yaw = 0.0;  ///< [rad]
};

/// The 7-state extended Kalman filter of Li18 §3.3 and appendix, in the frame of the target gate.
///
/// Differs: Φ to second order in dt, Q scaled by time, covariance propagated at every step, Joseph
/// form, innovation gate; systematic errors of the fixes are considered, as by Schmidt 1966
/// (docs/paper/deviations.md#eq-31).
class DragFilter {
 public:
  /// Cross-covariance of the state's error with the systematic errors (unit variance each), which are
  /// considered, never estimated.
  using Cross = Eigen::Matrix<double, drag_model::kStates, systematic::kCount>;

  explicit DragFilter(const DragFilterParams& params) : params_{params} {}

  /// @param p_G      position in the first frame [m].
  /// @param accel_bias  as found at rest [m/s²].
  /// @param uncertainty  of the first gate; its position is in start_sigma.
  void start(const Eigen::Vector3d& p_G, const Eigen::Vector3d& accel_bias,
             const MapUncertainty& uncertainty);
  void start(const Eigen::Vector3d& p_G, const Eigen::Vector3d& accel_bias) {
    start(p_G, accel_bias, {});
  }

  /// Eq. (31)-(33). dt <= 0 changes nothing; non-finite input changes nothing.
  void predict(const drag_model::Input& input, double dt);

  /// Eq. (34)-(35).
  Fusion correct(const Fix& fix);

  /// Height as a z coordinate of the frame [m]; what to believe is the altimeter's business.
  /// `height_sigma` of the gate above the floor, which no altitude can tell [m].
  Fusion correct_altitude(double z_G, double sigma, double height_sigma = 0.0);

  /// Normalised innovation squared of a fix: its squared Mahalanobis distance.
  [[nodiscard]] double nis(const Fix& fix) const;

  /// Resets the position to a fix. Velocity and biases stay, with the covariance of the start: what
  /// corrupted the position was in them, too.
  void restart(const Fix& fix);

  /// Resets x and y, one standard deviation `sigma` [m]; the biases are taken as known: so the
  /// paper's filter begins a leg. [Li18 flight code]
  void reset_position(const Eigen::Vector2d& p_G, double sigma);

  /// Changes to another gate's frame: p' = R p + offset. Errors of the new gate's place, height and
  /// heading become errors of the position.
  void change_frame(const Eigen::Matrix3d& R, const Eigen::Vector3d& offset,
                    const MapUncertainty& uncertainty);

  /// Covariance that the innovation of `fix` should have [m²].
  [[nodiscard]] Eigen::Matrix3d innovation_covariance(const Fix& fix) const;
  /// Change of a fix's innovation by one standard deviation of heading [m].
  [[nodiscard]] Eigen::Vector2d heading_sensitivity(const Fix& fix) const;

  /// Standard deviation of y in the gate's plane, where the error of the gate's heading has vanished
  /// [m].
  [[nodiscard]] double lateral_sigma() const;

  [[nodiscard]] const drag_model::State& state() const { return x_; }
  [[nodiscard]] const drag_model::StateMatrix& covariance() const { return P_; }
  [[nodiscard]] Eigen::Vector3d position() const { return x_.segment<3>(drag_model::kX); }
  [[nodiscard]] const DragFilterParams& params() const { return params_; }

 private:
  [[nodiscard]] Eigen::Vector4d start_variance() const;
  void add(const MapUncertainty& uncertainty);
  void age(Cross& C, double yaw_sigma, double dt);

  DragFilterParams params_;
  drag_model::State x_ = drag_model::State::Zero();
  drag_model::StateMatrix P_ = drag_model::StateMatrix::Identity();
  Cross C_ = Cross::Zero();
  double gate_yaw_sigma_ = 0.0, yaw_sigma_ = 0.0;  // [rad]
};

}  // namespace gatefly
