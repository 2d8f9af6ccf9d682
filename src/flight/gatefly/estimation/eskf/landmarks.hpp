// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "gatefly/estimation/eskf/gate_sight.hpp"
#include "gatefly/estimation/eskf/params.hpp"
#include "gatefly/estimation/eskf/state.hpp"

namespace gatefly::eskf {

using GateSigmas = Eigen::Matrix<double, kPerGate, 1>;

/// A gate as the map has it.
struct Landmark {
  Eigen::Vector3d p_EG = Eigen::Vector3d::Zero();  ///< Centre of the opening [m].
  double yaw_EG = 0.0;                             ///< [rad]
  GateShape shape;
  std::optional<GateSigmas> sigmas = {};  ///< How well it is known; nullopt: as the priors say.
};

/// How well a gate of the map is known before take-off, one standard deviation each.
[[nodiscard]] GateSigmas prior_of(const Landmark& gate, const Priors& priors);

/// The gates of the map: what is believed of each, and which of them are states of the filter.
///
/// Those that are flown next and were flown last have a slot, and those nearest to the target, which
/// show beside it; the others keep what was found of them, with their last sigmas. A gate that the map
/// has twice (flown both ways, or twice a lap) is one.
class Landmarks {
 public:
  Landmarks(std::span<const Landmark> map, const Priors& priors);

  /// A gate by its frame: which landmark, and whether it is flown through from behind.
  struct Face {
    std::size_t landmark = 0;
    bool behind = false;
  };
  [[nodiscard]] Face face_of(const Eigen::Vector3d& p_EG, double yaw_EG) const;

  [[nodiscard]] std::size_t size() const { return known_.size(); }
  [[nodiscard]] int slots() const { return slots_; }
  [[nodiscard]] const Landmark& map(std::size_t landmark) const { return known_[landmark].map; }
  /// The first of the map's gates that stands there.
  [[nodiscard]] std::size_t first_of(std::size_t landmark) const { return known_[landmark].first; }
  [[nodiscard]] int slot_of(std::size_t landmark) const { return known_[landmark].slot; }
  [[nodiscard]] std::size_t in_slot(int slot) const {
    return in_slot_[static_cast<std::size_t>(slot)];
  }
  [[nodiscard]] const GateShape& shape(int slot) const { return map(in_slot(slot)).shape; }

  /// As the map has them: the first ones in their slots.
  void reset(Nominal& x, Covariance& P);

  /// Gives slots to the gates around `target`. True when one has changed: what was before no longer
  /// fits.
  bool bring_in(std::size_t target, Nominal& x, Covariance& P);

 private:
  struct Known {
    Landmark map;
    GateBelief belief;
    GateSigmas sigmas = GateSigmas::Zero();
    int slot = -1;
    std::size_t first = 0;  ///< Index on the map.
    bool wanted = false;    ///< Has a slot, or is to get one.
  };
  void choose(std::size_t target);
  void put_in(std::size_t landmark, int slot, Nominal& x, Covariance& P);
  void take_out(int slot, const Nominal& x, const Covariance& P);

  Priors priors_;
  std::vector<Known> known_;
  std::array<std::size_t, kMaxGates> in_slot_{};
  int slots_ = 0;
};

}  // namespace gatefly::eskf
