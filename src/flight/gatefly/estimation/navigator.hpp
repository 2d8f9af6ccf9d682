// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "gatefly/estimation/ahrs.hpp"
#include "gatefly/estimation/altimeter.hpp"
#include "gatefly/estimation/delayed_filter.hpp"
#include "gatefly/estimation/drag_filter_use.hpp"
#include "gatefly/estimation/eskf/error_state_filter.hpp"
#include "gatefly/estimation/low_pass.hpp"
#include "gatefly/estimation/velocity_observer.hpp"

namespace gatefly {

/// Place and flight direction of a gate: the frame that positions are relative to.
struct GateFrame {
  Eigen::Vector3d p_EG = Eigen::Vector3d::Zero();  ///< [m]
  double yaw_EG = 0.0;                             ///< [rad]
};

struct NavigatorParams {
  DragFilterUse use;
  /// The error-state filter flies instead; rate and memory are those below.
  std::optional<eskf::Setup> ours;
  AhrsParams ahrs;
  DragFilterParams filter;
  VelocityObserverParams velocity;
  AltimeterParams altimeter;
  double imu_hz = 512.0;  ///< Nominal rate of the IMU. [Li18 flight code]
  /// Not 0: the error-state filter gets an autopilot's IMU, without stamps, about so often [Hz].
  double slow_imu_hz = 0.0;
  double accel_cutoff_hz = 20.0;  ///< Low-pass before the drag model. [Li18 flight code]
  double filter_memory = 0.25;    ///< Fixes may be this late [s]. [ours: twice what a Bebop needs]
};

/// Estimated motion of the drone at one moment; plain values.
struct NavigationState {
  double time = 0.0;  ///< [s]
  double dt = 0.0;    ///< Since the sample before; 0 when no time has passed [s].
  Attitude attitude;
  RotationEB R_EB;
  Eigen::Vector3d rate_B = Eigen::Vector3d::Zero();  ///< Bias removed [rad/s].
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();    ///< [m]
  Eigen::Vector3d v_E = Eigen::Vector3d::Zero();     ///< [m/s]
  Eigen::Vector3d v_B = Eigen::Vector3d::Zero();     ///< [m/s]
  Eigen::Vector3d p_GB = Eigen::Vector3d::Zero();    ///< In the frame of the target gate [m] ...
  Eigen::Vector3d v_GB = Eigen::Vector3d::Zero();    ///< ... and the velocity [m/s].
  double lateral_sigma =
      0.0;  ///< Error of p_GB.y, without the part that vanishes in the gate's plane [m].
  /// Standard deviation of p_EB on the floor plan, the larger one; 0 where the filter has no map [m].
  double place_sigma = 0.0;
  double since_fix = 1e3;  ///< Since a fix was accepted [s].
  // Only the filter with a map knows:
  double since_gate = 1e3;   ///< Since any gate was taken in [s].
  double since_doubt = 1e3;  ///< Since doubt() made the place less certain [s].
  double since_imu = 0.0;    ///< Since a usable IMU sample [s].
  /// Air over ground, where the filter knows it [m/s].
  Eigen::Vector2d wind_E = Eigen::Vector2d::Zero();
  double wind_variance = 0.0;  ///< Sum of the variances of its two components [m²/s²].
  double thrust_found = 0.0;   ///< Rotors give so much more than commanded, relative.
  int rest_samples = 0;        ///< Samples of the rest calibration so far.
};

/// The estimation ring: attitude, low pass, drag filter with its memory, velocity and heights, wired
/// once.
///
/// Source: Li18 §2 and §3.3. What flies and what experiments measure is this very object. The
/// attitude needs the velocity, the velocity the filter's biases, the filter the attitude: here is
/// the one place that says in which order. No clock; allocates at construction only.
class Navigator {
 public:
  using Past = DelayedFilter::Moment;

  explicit Navigator(const NavigatorParams& params);

  /// On the ground at `p_EB` [m], heading `yaw` [rad]; positions are relative to `gate`.
  void start(const Eigen::Vector3d& p_EB, double yaw, const GateFrame& gate = {},
             const MapUncertainty& uncertainty = {});

  /// One IMU sample while the drone stands still: biases are estimated. Unusable samples are ignored.
  /// @param slow  of an autopilot, where one arrives (NavigatorParams::slow_imu_hz): it teaches alone.
  void rest(const Imu& imu, double time, const std::optional<Imu>& slow = std::nullopt);

  /// One IMU sample in flight. An unusable sample repeats the previous input; a repeated or older stamp
  /// advances nothing.
  /// @param slow  as for rest(). Only the filter uses it; `imu` serves the control.
  /// @param thrust  specific, that the rotors should give by now [m/s²]; 0: not known. Only the
  /// error-state filter asks.
  void predict(const Imu& imu, double time, const std::optional<Imu>& slow = std::nullopt,
               double thrust = 0.0);

  /// The same for an IMU that hangs on no multirotor: without drag no velocity is known, and only
  /// the attitude goes on.
  void predict_attitude(const Imu& imu, double time);

  /// Sonar range along body z, barometric height above the pad [m]: fused when they are the floor's.
  void measure_heights(const std::optional<double>& sonar, const std::optional<double>& baro);

  /// A height above the floor that needs no judging, one standard deviation `sigma` [m].
  void correct_height(double height, double sigma);

  /// The filter at the moment that a fix of `time` [s] is taken for: the nearest one, or now
  /// (DragFilterUse::looks_back). nullptr when that is no longer remembered.
  [[nodiscard]] const Past* at(double time) const { return filter_.at(counted_at(time)); }

  /// A fix as the filter takes it (DragFilterUse::fix_sigma).
  [[nodiscard]] Fix as_fused(const Fix& fix) const;

  /// A fix of `time` [s]. @param may_restart  see DelayedFilter::correct.
  Fusion correct(const Fix& fix, double time, bool may_restart = false);

  /// Corrects the heading, present and remembered, by a measured error [rad].
  void correct_heading(double error, double variance);

  /// Corrects the heading by the first fix after a blind leg: the sideways miss, as far as the
  /// filter's covariance attributes it to a heading error. A short leg says nothing.
  void learn_heading(const Fix& fix, const Past& then);

  /// From now on positions are relative to `gate`.
  void change_gate(const GateFrame& gate, const MapUncertainty& uncertainty);

  /// A leg begins, at the end of a blind turn. With DragFilterUse::leg_sigma x and y are reset to
  /// where the plan has it, the biases are frozen; without, the estimate goes on.
  void begin_leg(const Eigen::Vector2d& p_EB);

  /// Attitude, or the accelerometer's bias, from outside (a log, other flights), instead of what rest
  /// has taught. At the end of the rest only.
  void set_attitude(const Attitude& attitude);
  void set_accel_bias(const Eigen::Vector3d& bias);

  [[nodiscard]] NavigationState state() const;
  [[nodiscard]] Eigen::Vector3d p_EB() const;
  [[nodiscard]] const GateFrame& gate() const { return gate_; }

  /// The filter whose wind and gates are states; nullptr where the drag filter flies.
  [[nodiscard]] const eskf::ErrorStateFilter* error_state() const {
    return ours_ ? &*ours_ : nullptr;
  }
  /// Sightings of one picture, for the error-state filter. False: none was taken in.
  bool correct(std::span<const eskf::GateSight> sights, bool of_target);
  /// See ErrorStateFilter::replace_target.
  void replace_target(const GateFrame& place, double sigma, double yaw_sigma);
  /// See ErrorStateFilter::doubt.
  void doubt();

  // Uncertainty and biases, of whichever filter flies:
  [[nodiscard]] Eigen::Matrix3d covariance_GB() const;     ///< Covariance of the position [m²].
  [[nodiscard]] Eigen::Vector3d accel_bias() const;        ///< [m/s²]
  [[nodiscard]] Eigen::Vector3d gyro_bias() const;         ///< [rad/s]
  [[nodiscard]] Eigen::Vector3d velocity_sigma() const;    ///< Body axes [m/s].
  [[nodiscard]] Eigen::Vector3d accel_bias_sigma() const;  ///< [m/s²]
  /// True once the sensor has contradicted the gates for long: it is not used any more.
  [[nodiscard]] bool has_left_sonar() const { return sonar_.left; }
  [[nodiscard]] bool has_left_baro() const { return baro_.left; }
  [[nodiscard]] double tilt_sigma() const;     ///< [rad]
  [[nodiscard]] double heading_sigma() const;  ///< [rad]
  [[nodiscard]] const Ahrs& ahrs() const { return ahrs_; }
  [[nodiscard]] const DragFilter& filter() const { return filter_.now(); }
  [[nodiscard]] double time() const { return time_; }  ///< Stamp of the last sample [s].
  [[nodiscard]] bool has_fix() const { return last_fix_ >= 0.0; }
  [[nodiscard]] double since_fix() const { return time_ - last_fix_; }

 private:
  [[nodiscard]] bool flies_ours() const { return ours_ && ours_->has_started(); }
  [[nodiscard]] bool is_slow() const { return ours_ && params_.slow_imu_hz > 0.0; }
  bool take_slow(const std::optional<Imu>& slow);
  void start_ours();
  void predict_ours(const Imu& imu, bool usable, const std::optional<Imu>& slow, double thrust);
  void describe_ours(NavigationState& now) const;
  [[nodiscard]] double nearness() const;
  [[nodiscard]] double counted_at(double time) const {
    return params_.use.looks_back ? time : time_;
  }
  [[nodiscard]] Eigen::Vector3d v_B() const;
  /// How far a height sensor agrees with the gates.
  struct Trust {
    int refused = 0;    ///< In a row.
    bool left = false;  ///< Contradicted the gates for too long: not used any more.
  };
  void take_height(const Height& height, Trust& trust);
  bool advance(const Imu& imu, double time);
  void restart_filter(const Eigen::Vector3d& accel_bias);
  [[nodiscard]] Eigen::Vector3d relative(const Eigen::Vector3d& p_EB) const;

  NavigatorParams params_;
  Ahrs ahrs_;
  LowPass accel_filter_;
  DelayedFilter filter_;
  VelocityObserver velocity_;
  std::optional<eskf::ErrorStateFilter> ours_;
  Imu last_imu_sample_;
  /// Since the last slow sample: thrust commanded [m/s²], and how long that is [s].
  double mean_thrust_ = 0.0, thrust_time_ = 0.0;
  Trust sonar_, baro_;
  double last_gate_ = -1e3;   ///< When any gate was taken in [s].
  double last_doubt_ = -1e3;  ///< [s]
  Altimeter altimeter_;
  drag_model::Input input_;
  GateFrame gate_;
  MapUncertainty uncertainty_;
  Eigen::Vector3d start_p_EB_ = Eigen::Vector3d::Zero();
  double time_ = 0.0, dt_ = 0.0, last_imu_ = 0.0, last_slow_ = 0.0, last_fix_ = -1e3;
  bool started_ = false;
};

}  // namespace gatefly
