// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/twin_body.hpp"

#include <algorithm>

#include <Eigen/Geometry>

namespace gatefly::sim {
namespace {

/// Position, velocity, attitude and rate; as a vector they can be added.
struct Motion {
  Eigen::Vector3d p_E, v_E;
  Eigen::Vector4d q_EB;
  Eigen::Vector3d rate_B;
};

Motion operator+(const Motion& a, const Motion& b) {
  return {a.p_E + b.p_E, a.v_E + b.v_E, a.q_EB + b.q_EB, a.rate_B + b.rate_B};
}
Motion operator*(double s, const Motion& m) {
  return {s * m.p_E, s * m.v_E, s * m.q_EB, s * m.rate_B};
}

/// d/dt of a motion. Newton and Euler; q̇ = ½ q ⊗ (0, ω).
Motion rate_of(const Motion& m, const Forces& forces, const world::VehicleTruth& vehicle) {
  const Eigen::Matrix3d R_EB = R_EB_of(m.q_EB.normalized());
  const Eigen::Vector3d accel_E =
      Eigen::Vector3d{0, 0, kGravity} + R_EB * forces.force_B(R_EB, m.v_E) / vehicle.mass;
  const Eigen::Vector3d& w = m.rate_B;
  const Eigen::Vector3d spin = vehicle.inertia.cwiseProduct(w);
  const Eigen::Vector3d turn_B = (forces.torque_B() - w.cross(spin)).cwiseQuotient(vehicle.inertia);
  const Eigen::Vector3d axis = m.q_EB.tail<3>();
  Eigen::Vector4d q_dot;
  q_dot << -0.5 * axis.dot(w), 0.5 * (m.q_EB(0) * w + axis.cross(w));
  return {m.v_E, accel_E, q_dot, turn_B};
}

}  // namespace

TwinBody::TwinBody(const world::SimConfig& config)
    : vehicle_{config.vehicle},
      forces_{config},
      collisions_{config.world, config.vehicle},
      sight_{config.world},
      corners_B_{corners_of(config.vehicle)} {
  state_.p_EB << config.start.position, -0.5 * config.vehicle.size.z();
  state_.q_EB = q_EB_of({0, 0, config.start.heading});
}

void TwinBody::step(const std::array<double, 4>& command, double dt) {
  forces_.advance(command, state_, time_, dt);
  const Motion now{state_.p_EB, state_.v_E, state_.q_EB, state_.rate_B};
  const auto slope = [&](const Motion& m) { return rate_of(m, forces_, vehicle_); };
  const Motion k1 = slope(now), k2 = slope(now + 0.5 * dt * k1), k3 = slope(now + 0.5 * dt * k2),
               k4 = slope(now + dt * k3);
  const Motion next = now + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  state_.p_EB = next.p_E, state_.v_E = next.v_E, state_.q_EB = next.q_EB.normalized(),
  state_.rate_B = next.rate_B;
  state_.rotor_speed = forces_.rotor_speed();
  state_.wind_E = forces_.wind_E();
  stand_on_floor();
  time_ += dt;
  // Specific force from what the body really did, the floor included.
  state_.specific_force_B = R_EB_of(now.q_EB).transpose() *
                            ((state_.v_E - now.v_E) / dt - Eigen::Vector3d{0, 0, kGravity});
}

void TwinBody::stand_on_floor() {
  const Eigen::Matrix3d R_EB = R_EB_of(state_.q_EB);
  double lowest = -1e9;
  for (const Eigen::Vector3d& corner : corners_B_)
    lowest = std::max(lowest, state_.p_EB.z() + R_EB.row(2).dot(corner));
  on_floor_ = lowest >= 0.0;
  if (!on_floor_) return;
  // Carried, and held by friction.
  state_.p_EB.z() -= lowest;
  state_.v_E = {0.0, 0.0, std::min(0.0, state_.v_E.z())};
  state_.rate_B.setZero();
}

std::optional<std::string> TwinBody::contact() const {
  if (on_floor_) return "floor";
  if (const std::string* name = collisions_.touched(state_)) return *name;
  return std::nullopt;
}

}  // namespace gatefly::sim
