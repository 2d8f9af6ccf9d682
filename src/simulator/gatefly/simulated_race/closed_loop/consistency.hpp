// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "gatefly/flight_log/chi_square_count.hpp"
#include "gatefly/race/pilot.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::simulated_race {

using flight_log::ChiSquareCount;

/// Whether the pilot's covariance is consistent: NEES of its position, NIS of its fixes. Bar-Shalom
/// et al. 2001, §5.4.
struct Consistency {
  /// 3 degrees of freedom, 20 Hz, in the frame of the target gate as it stands.
  ChiSquareCount nees;
  ChiSquareCount nis;  ///< Every used fix counts.
  /// Farther off than 1 m for more than 1 s, from where the gate stands and in earth axes, although
  /// a fix was offered in that time: far from a gate that faces elsewhere than the map says, its
  /// own frame tells of the gate, not of the drone.
  int divergences = 0;
};

/// The pilot's belief in one tick, as far as the watch asks.
struct Belief {
  bool on_course = false;  ///< Flying gate by gate: on a straight, in a turn, or searching.
  int target = 0;          ///< Index of the gate it flies to.
  Eigen::Vector3d p_GB = Eigen::Vector3d::Zero();               ///< In that gate's frame [m] ...
  Eigen::Matrix3d covariance_GB = Eigen::Matrix3d::Identity();  ///< ... and how sure it is [m²].
  const Sighting* sighting = nullptr;  ///< From the picture it has just looked at, if any.
};

/// @param picture  whether the pilot has just looked. The sighting stays the pilot's.
[[nodiscard]] Belief belief_of(const Pilot& pilot, bool picture);

/// Fills it while a race goes on.
class ConsistencyWatch {
 public:
  ConsistencyWatch(std::vector<world::WorldGate> gates, const Track& map)
      : gates_{std::move(gates)}, map_{map} {}

  /// One tick.
  void update(const Belief& belief, const Eigen::Vector3d& true_p_EB, double time);
  [[nodiscard]] const Consistency& result() const { return result_; }

 private:
  std::vector<world::WorldGate> gates_;
  Track map_;
  Consistency result_;
  double next_ = 0.0, far_since_ = -1.0;
  bool seen_while_far_ = false, counted_ = false;
};

}  // namespace gatefly::simulated_race
