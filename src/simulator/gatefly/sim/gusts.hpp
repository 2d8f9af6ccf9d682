// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/sim/random.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// Dryden's gusts: white noise through the forms of MIL-F-8785C, one length for all axes.
///
/// Along the wind Φ(ω) ~ 1 / (1 + (Lω/V)²), across and up ~ (1 + 3 (Lω/V)²) / (1 + (Lω/V)²)². V is
/// the speed through the air mass, at least 0.5 m/s: also for who hovers the air changes. Lengths
/// are ours (a hall, not an atmosphere).
class Gusts {
 public:
  Gusts(const world::Wind& wind, std::uint64_t seed) : wind_{wind}, noise_{seed, "wind"} {}

  /// After another `dt` [s] at `airspeed` [m/s] through the mean wind.
  void advance(double airspeed, double dt);
  /// Earth frame [m/s].
  [[nodiscard]] const Eigen::Vector3d& velocity_E() const { return velocity_E_; }

 private:
  /// White noise through 1 / (1 + τs), and through (1 + √3 τs) / (1 + τs)², unit variance each.
  struct Along {
    double x = 0.0;
  };
  struct Across {
    double x = 0.0, y = 0.0;
    [[nodiscard]] double value() const;
  };

  world::Wind wind_;
  Stream noise_;
  Along along_;
  Across across_, up_;
  Eigen::Vector3d velocity_E_ = Eigen::Vector3d::Zero();
};

}  // namespace gatefly::sim
