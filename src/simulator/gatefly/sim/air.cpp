// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/air.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"

namespace gatefly::sim {
namespace {

constexpr double kWash = 0.5;         // at a wall [m/s; estimate: air.hpp]
constexpr double kWashReach = 1.0;    // [m; estimate]
constexpr double kFlickerTime = 0.5;  // [s; estimate: 1 m at 2 m/s]

Eigen::Vector2d along(double heading) {
  const auto [s, c] = sincos(heading);
  return {c, s};
}

/// How far a place is to the right of a line with that direction [m].
double aside(const Eigen::Vector2d& ahead, const Eigen::Vector2d& from_line) {
  return ahead.x() * from_line.y() - ahead.y() * from_line.x();
}

/// Away from a wall that far away [m/s].
double back_from(double distance) {
  const double near = std::clamp(1.0 - distance / kWashReach, 0.0, 1.0);
  return kWash * near * near;
}

}  // namespace

Eigen::Vector2d jet_at(const world::Jet& jet, const Eigen::Vector2d& p_E) {
  if (jet.speed == 0.0) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d ahead = along(jet.heading);
  const double y = aside(ahead, p_E - jet.through) / jet.width;
  if (std::abs(y) >= 1.0) return Eigen::Vector2d::Zero();
  const double c = gatefly::cos(0.5 * kPi * y);
  return jet.speed * c * c * ahead;
}

Eigen::Vector2d shear_at(const world::Shear& shear, const Eigen::Vector2d& p_E) {
  if (shear.rate == 0.0) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d ahead = along(shear.heading);
  return shear.rate * aside(ahead, p_E - shear.middle) * ahead;
}

Eigen::Vector2d wash_at(const Eigen::AlignedBox2d& room, const Eigen::Vector2d& p_E) {
  const Eigen::Vector2d low = p_E - room.min(), high = room.max() - p_E;
  return low.unaryExpr(&back_from) - high.unaryExpr(&back_from);
}

Air::Air(const world::SimConfig& config)
    : wind_{config.wind},
      faults_{config.faults},
      room_{config.world.room_center - 0.5 * config.world.room_size.head<2>(),
            config.world.room_center + 0.5 * config.world.room_size.head<2>()},
      gusts_{config.wind, config.seed},
      flicker_{config.seed, "wash"} {}

Eigen::Vector2d Air::wash(const Eigen::Vector2d& p_E, double dt) {
  const double keep = std::max(0.0, 1.0 - dt / kFlickerTime);
  flickering_ = keep * flickering_ + std::sqrt(1.0 - keep * keep) * flicker_.normal();
  return wind_.wash * (1.0 + flickering_) * wash_at(room_, p_E);
}

void Air::advance(const BodyState& state, double rotors, double time, double dt) {
  const Eigen::Vector2d p_E = state.p_EB.head<2>();
  Eigen::Vector2d steady = wind_.mean + jet_at(wind_.jet, p_E) + shear_at(wind_.shear, p_E);
  if (world::within(faults_.wind_during, time)) steady += faults_.wind;
  gusts_.advance((state.v_E.head<2>() - steady).norm(), dt);
  velocity_E_ = Eigen::Vector3d{steady.x(), steady.y(), 0.0} + gusts_.velocity_E();
  if (wind_.wash > 0.0) velocity_E_.head<2>() += rotors * wash(p_E, dt);
}

}  // namespace gatefly::sim
