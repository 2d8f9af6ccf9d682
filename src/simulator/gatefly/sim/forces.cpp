// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/forces.hpp"

#include <algorithm>
#include <cmath>

namespace gatefly::sim {
namespace {

double open_circuit(const world::Battery& b, double charge) {
  return b.empty + (b.full - b.empty) * charge;
}

/// Voltage at which a constant power is drawn through the resistance; half the open one is the most
/// that a battery can give.
double under_load(const world::Battery& b, double charge, double power) {
  const double open = open_circuit(b, charge);
  return 0.5 * (open + std::sqrt(std::max(0.0, open * open - 4.0 * b.resistance * power)));
}

}  // namespace

double ground_effect(double height, double radius, double side) {
  constexpr double kBody = 2.0;
  const double z = std::max(height, 0.5 * radius), r2 = radius * radius;
  const auto fountain = [&](double d2) {
    const double s = d2 + 4.0 * z * z;
    return z / (s * std::sqrt(s));
  };
  const double less = r2 / (16.0 * z * z) + r2 * fountain(side * side) +
                      0.5 * r2 * fountain(2.0 * side * side) +
                      2.0 * r2 * kBody * fountain(2.0 * side * side);
  return 1.0 / (1.0 - less);
}

Forces::Forces(const world::SimConfig& config)
    : vehicle_{config.vehicle},
      faults_{config.faults},
      air_{config},
      hover_speed_{std::sqrt(vehicle_.mass * kGravity / 4 / vehicle_.thrust_coefficient)} {
  const world::Battery& b = vehicle_.battery;
  const double power = b.hover_power + b.electronics;
  full_voltage_ = voltage_ = under_load(b, 1.0, power);
  const double used = power / full_voltage_ * vehicle_.sag_time / b.capacity;
  sagged_voltage_ = under_load(b, std::max(0.0, 1.0 - used), power);
}

void Forces::drain(double dt) {
  const world::Battery& b = vehicle_.battery;
  double power = b.electronics;
  for (const double speed : rotor_speed_) {  // a propeller's power goes with speed³
    const double x = speed / hover_speed_;
    power += 0.25 * b.hover_power * x * x * x;
  }
  voltage_ = under_load(b, charge_, power);
  charge_ = std::max(0.0, charge_ - power / voltage_ * dt / b.capacity);
}

void Forces::advance(const std::array<double, 4>& command, const BodyState& state, double time,
                     double dt) {
  const world::VehicleTruth& v = vehicle_;
  if (v.sag > 0.0) drain(dt);
  const double spent = (full_voltage_ - voltage_) / (full_voltage_ - sagged_voltage_);
  const double sag = std::max(0.0, 1.0 - v.sag * std::max(0.0, spent));
  // Rotors follow with a lag; thrust and yaw torque go with speed².
  const double lag = std::min(1.0, dt / v.rotor_time_constant);
  const double near_floor =
      ground_effect(-state.p_EB.z(), v.propeller_radius, 2.0 * std::min(v.arm_x, v.arm_y));
  constexpr std::array<double, 4> kX{1, 1, -1, -1}, kY{-1, 1, 1, -1}, kYaw{-1, 1, -1, 1};
  const bool weak = faults_.thrust_loss > 0.0 && world::within(faults_.thrust_loss_during, time);
  thrust_ = 0.0, mean_speed_ = 0.0;
  torque_B_.setZero();
  for (std::size_t i = 0; i < 4; ++i) {
    double& speed = rotor_speed_[i];
    const double wanted =
        std::isfinite(command[i]) ? std::clamp(command[i], v.min_speed, v.max_speed) : 0.0;
    speed += lag * (wanted - speed);
    double thrust = sag * v.thrust_coefficient * speed * speed;
    if (weak && (faults_.weak_rotor == 0 || faults_.weak_rotor == static_cast<int>(i) + 1))
      thrust *= 1.0 - faults_.thrust_loss;
    torque_B_ += Eigen::Vector3d{-kY[i] * v.arm_y * thrust, kX[i] * v.arm_x * thrust,
                                 kYaw[i] * v.torque_coefficient * thrust};
    thrust_ += near_floor * thrust;
    mean_speed_ += 0.25 * speed;
  }
  air_.advance(state, mean_speed_ / hover_speed_, time, dt);
  // The air pushes on rotors and frame away from where the body goes.
  const Eigen::Vector3d air_B = R_EB_of(state.q_EB).transpose() * (state.v_E - wind_E());
  torque_B_ += mean_speed_ / hover_speed_ *
               Eigen::Vector3d{-v.air_moment.x() * air_B.y(), v.air_moment.y() * air_B.x(), 0.0};
}

Eigen::Vector3d Forces::force_B(const Eigen::Matrix3d& R_EB, const Eigen::Vector3d& v_E) const {
  // Drag: in the rotor plane proportional to rotor speed, and of the body with speed².
  const Eigen::Vector3d air_B = R_EB.transpose() * (v_E - wind_E());
  const Eigen::Vector3d drag_B =
      vehicle_.mass * ((mean_speed_ / hover_speed_) * vehicle_.rotor_drag.cwiseProduct(air_B) -
                       vehicle_.body_drag * air_B.norm() * air_B);
  return Eigen::Vector3d{0, 0, -thrust_} + drag_B;
}

}  // namespace gatefly::sim
