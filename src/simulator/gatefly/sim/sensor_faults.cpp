// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/sensor_faults.hpp"

#include <cmath>
#include <limits>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::sim {

std::chrono::nanoseconds SensorFaults::stamp(double time) const {
  const double jump = faults_.time_jump.y(), shown = time >= faults_.time_jump.x() ? jump : 0.0;
  return std::chrono::nanoseconds{std::llround((time + shown) * 1e9)};
}

Imu SensorFaults::broken(const Imu& imu, double time) {
  if (world::within(faults_.imu_stuck, time)) return last_;
  Imu sample = imu;
  if (!faults_.imu_tilt.isZero()) {
    const Eigen::Matrix3d R_BS =
        rotation_EB(Attitude{faults_.imu_tilt.x(), faults_.imu_tilt.y(), 0.0}).matrix;
    sample.accel_B = R_BS.transpose() * imu.accel_B;
    sample.gyro_B = R_BS.transpose() * imu.gyro_B;
  }
  if (time >= faults_.bias_step_at) {
    sample.accel_B += faults_.accel_bias_step;
    sample.gyro_B += faults_.gyro_bias_step;
  }
  sample.accel_B = sample.accel_B.cwiseMax(-faults_.accel_range).cwiseMin(faults_.accel_range);
  sample.gyro_B = sample.gyro_B.cwiseMax(-faults_.gyro_range).cwiseMin(faults_.gyro_range);
  last_ = sample;
  if (world::within(faults_.imu_nan, time)) {
    sample.accel_B.setConstant(std::numeric_limits<double>::quiet_NaN());
    sample.gyro_B = sample.accel_B;
  }
  return sample;
}

std::optional<double> SensorFaults::broken(std::optional<double> sonar, double time) const {
  return world::within(faults_.sonar_out, time) ? std::nullopt : sonar;
}

}  // namespace gatefly::sim
