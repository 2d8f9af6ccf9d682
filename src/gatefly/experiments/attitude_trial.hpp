// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gatefly/estimation/ahrs.hpp"
#include "gatefly/estimation/drag_filter.hpp"
#include "gatefly/estimation/low_pass.hpp"
#include "gatefly/estimation/velocity_observer.hpp"

namespace gatefly::experiments {

/// One IMU sample of a flight whose attitude is known.
struct Moment {
  Imu imu;
  double dt = 0.0;  ///< Since the sample before [s].
  double z = 0.0;   ///< Altitude, NED [m].
  Attitude truth;
  bool rests = false, turns = false;
};

struct TurnCourse {
  double radius = 1.5;  ///< [m]
  double speed = 1.6;   ///< [m/s]
  int turns = 1;  ///< Of 180°, 1.5 s of straight flight between them, left and right in turn.
  /// How far the drone is from the one that is known: none, race, hard.
  std::string level = "race";
};

/// Rest, speeding up, level coordinated turns: exact motion with drag, sensors of the simulator.
///
/// Drag, biases, scales and what appears in flight are drawn for the seed as for a race of that
/// level.
[[nodiscard]] std::vector<Moment> coordinated_turns(const TurnCourse& course, std::uint64_t seed);

/// AHRS, drag filter and velocity as the pilot has them, with an altimeter but without any gate.
class FlownAttitude {
 public:
  explicit FlownAttitude(const AhrsParams& params, double yaw = 0.0) : ahrs_{params} {
    ahrs_.start(yaw);
  }

  void rest(const Imu& imu, double z);
  void step(const Imu& imu, double dt);
  void correct_altitude(double z, double sigma) { (void)filter_.correct_altitude(z, sigma); }
  void correct_heading(double error, double variance) { ahrs_.correct_heading(error, variance); }

  [[nodiscard]] const Ahrs& ahrs() const { return ahrs_; }

 private:
  static constexpr double kAccelCutoffHz = 20.0, kImuHz = 512.0;
  Ahrs ahrs_;
  LowPass low_pass_{kAccelCutoffHz, kImuHz};
  DragFilter filter_{DragFilterParams{}};
  VelocityObserver velocity_{VelocityObserverParams{}};
};

}  // namespace gatefly::experiments
