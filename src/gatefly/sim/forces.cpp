// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/forces.hpp"

#include <algorithm>
#include <cmath>

namespace gatefly::sim {

Forces::Forces(const SimConfig& config)
    : vehicle_{config.vehicle},
      wind_{config.wind},
      wind_stream_{config.seed, "wind"},
      hover_speed_{std::sqrt(vehicle_.mass * kGravity / 4 / vehicle_.thrust_coefficient)} {}

void Forces::advance(const std::array<double, 4>& command, double time, double dt) {
  const VehicleTruth& v = vehicle_;
  // Rotors follow with a lag; thrust and yaw torque go with speed².
  const double sag = 1.0 - v.sag * std::min(1.0, time / v.sag_time);
  const double lag = std::min(1.0, dt / v.rotor_time_constant);
  constexpr std::array<double, 4> kX{1, 1, -1, -1}, kY{-1, 1, 1, -1}, kYaw{-1, 1, -1, 1};
  thrust_ = 0.0, mean_speed_ = 0.0;
  torque_B_.setZero();
  for (std::size_t i = 0; i < 4; ++i) {
    double& speed = rotor_speed_[i];
    const double wanted =
        std::isfinite(command[i]) ? std::clamp(command[i], v.min_speed, v.max_speed) : 0.0;
    speed += lag * (wanted - speed);
    const double thrust = sag * v.thrust_coefficient * speed * speed;
    torque_B_ += Eigen::Vector3d{-kY[i] * v.arm_y * thrust, kX[i] * v.arm_x * thrust,
                                 kYaw[i] * v.torque_coefficient * thrust};
    thrust_ += thrust;
    mean_speed_ += 0.25 * speed;
  }
  if (wind_.gust > 0.0) {
    const double keep = 1.0 - dt;  // 1 s correlation
    const double push = wind_.gust * std::sqrt(2.0 * dt);
    gust_ = keep * gust_ + push * Eigen::Vector2d{wind_stream_.normal(), wind_stream_.normal()};
  }
}

Eigen::Vector3d Forces::force_B(const Eigen::Matrix3d& R_EB, const Eigen::Vector3d& v_E) const {
  // Drag: in the rotor plane proportional to rotor speed, and of the body with speed².
  const Eigen::Vector2d wind = wind_E();
  const Eigen::Vector3d air_B = R_EB.transpose() * (v_E - Eigen::Vector3d{wind.x(), wind.y(), 0});
  const Eigen::Vector3d drag_B =
      vehicle_.mass * ((mean_speed_ / hover_speed_) * vehicle_.rotor_drag.cwiseProduct(air_B) -
                       vehicle_.body_drag * air_B.norm() * air_B);
  return Eigen::Vector3d{0, 0, -thrust_} + drag_B;
}

}  // namespace gatefly::sim
