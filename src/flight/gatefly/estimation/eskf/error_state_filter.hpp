// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "gatefly/estimation/eskf/delay_ring.hpp"
#include "gatefly/estimation/eskf/landmarks.hpp"
#include "gatefly/estimation/eskf/look_ahead.hpp"
#include "gatefly/estimation/eskf/slow_imu.hpp"
#include "gatefly/estimation/eskf/vibration.hpp"

namespace gatefly::eskf {

/// How the filter is set up; the map and the camera are the team's, the rest is in Params.
struct Setup {
  Params params;
  std::vector<Landmark> map;
  Eigen::Matrix3d R_BC = Eigen::Matrix3d::Identity();  ///< The mount as told.
  CameraModel camera;
  double imu_hz = 512.0, memory = 0.25;  ///< Rate of the IMU; so late a picture may come [s].
  /// Not 0: the IMU is an autopilot's, about so many samples a second come, without stamps.
  double slow_imu_hz = 0.0;
};

/// The belief on the pad, before take-off.
struct Start {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_EB = Eigen::Matrix3d::Identity();
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  ///< Found at rest [rad/s].
  /// Mean specific force at rest; none: it was not at rest [m/s²].
  std::optional<Eigen::Vector3d> rest_accel_B;
};

/// One error-state Kalman filter for all that is unknown in an ordinary flight: the motion, the IMU's
/// biases, wind and gusts, drag, the camera's mount, lens and delay, and every gate's place.
///
/// Ours; replaces Li18 §3.3. Drag is measured, not integrated: air speed and ground speed are apart.
/// A picture is fused when it was exposed, and what followed is done again (DelayRing). Equations:
/// docs/derivations/error_state_filter.md. No clock, no libm; allocates when it is made, and never
/// after. Cost: docs/paper/results.md#wind.
class ErrorStateFilter {
 public:
  explicit ErrorStateFilter(const Setup& setup);

  void start(const Start& start, double time);
  [[nodiscard]] bool has_started() const { return started_; }

  /// One IMU sample of `dt` that ends at `time` [s].
  /// @param thrust  specific, as commanded, with the rotors' lag [m/s²]; 0: not known.
  void predict(const Imu& imu, double dt, double time, double thrust = 0.0);

  // The same by an IMU that is slow (Setup::slow_imu_hz):
  /// A sample without a stamp, that arrives at `time` [s]. Before the start it sets the clock only.
  /// @param thrust  as for predict(), its mean since the last sample.
  void predict_slow(const Imu& imu, double time, double thrust = 0.0);
  /// Until the next one: now() is carried on to `time` by a fast gyro, the filter is not.
  void look_ahead(const Eigen::Vector3d& gyro_B, double time);

  /// A height above the floor [m]; of now. False: refused.
  bool correct_height(double height, double sigma);

  /// A position in E, one standard deviation of each axis [m]; of now. False: not finite, or no room
  /// for it in this tick.
  bool correct_position(const Eigen::Vector3d& p_EB, const Eigen::Vector3d& sigma);

  /// How far a sighting is from what is expected; its slot and face are a hypothesis.
  [[nodiscard]] std::optional<Innovation> innovation_of(const GateSight& sight) const;

  /// Takes in sightings, each at its own moment. False: none was of a moment that is remembered.
  bool correct(std::span<const GateSight> sights);

  /// Sightings disagree with the position for long: it is less certain than it says.
  void doubt();

  /// The target stands elsewhere than the map says: there, known to `sigma` [m] and `yaw_sigma` [rad]
  /// on the floor plan. What it told of everything else is forgotten.
  void replace_target(const Eigen::Vector3d& p_EG, double yaw_EG, double sigma, double yaw_sigma);

  /// Positions will be asked for relative to this gate: see Landmarks::bring_in.
  void set_target(const Eigen::Vector3d& p_EG, double yaw_EG);

  // Relative to the target:
  [[nodiscard]] int target_slot() const { return landmarks_.slot_of(target_.landmark); }
  [[nodiscard]] bool target_behind() const { return target_.behind; }
  [[nodiscard]] double target_yaw() const;  ///< As believed [rad].
  [[nodiscard]] const GateBelief& target() const;
  [[nodiscard]] Eigen::Vector3d p_GB() const;  ///< [m]
  /// @param of_heading  whether the gate's direction counts: in its plane it does not.
  [[nodiscard]] Eigen::Matrix3d covariance_GB(bool of_heading = true) const;

  [[nodiscard]] const Nominal& now() const { return now_; }
  /// Covariance of now(): at most one tick old.
  [[nodiscard]] const Covariance& covariance() const { return P_; }
  [[nodiscard]] double sigma(int state) const;
  /// Variance of wind plus gust, north (0) or east (1) [m²/s²].
  [[nodiscard]] double variance_of_air(int axis) const;
  [[nodiscard]] const Landmarks& landmarks() const { return landmarks_; }
  [[nodiscard]] const Setup& setup() const { return setup_; }
  /// The measurements of late, by the moment each was taken.
  [[nodiscard]] const DelayRing& recent() const { return ring_; }
  /// What was seen then can still correct the filter, but for the lines of a rolling shutter.
  [[nodiscard]] bool remembers(double time) const {
    return started_ && time >= ring_[ring_.oldest()].time;
  }

 private:
  void advance(const Sample& sample, double time);
  void take_in(std::size_t index);
  [[nodiscard]] std::optional<std::size_t> tick_of(const GateSight& sight) const;
  [[nodiscard]] Eigen::Vector3d rate_around(std::size_t index) const;
  void do_again(std::size_t from);
  void catch_up();

  Setup setup_;
  Landmarks landmarks_;
  DelayRing ring_;
  Vibration vibration_;
  std::optional<SlowImu> slow_;
  LookAhead ahead_;
  std::size_t per_tick_, near_;
  FixedList<Sample, kMaxSamples> pending_;  ///< Since the last tick.
  Covariance P_;
  Nominal now_;
  Landmarks::Face target_;
  bool started_ = false;
};

}  // namespace gatefly::eskf
