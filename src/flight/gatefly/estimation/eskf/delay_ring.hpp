// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "gatefly/estimation/eskf/gate_sight.hpp"
#include "gatefly/estimation/eskf/process.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly::eskf {

inline constexpr double kTickHz = 128.0;  ///< Covariance and drag: 4 samples of 512 Hz. [estimate]
inline constexpr std::size_t kMaxSamples = 16;  ///< That one tick may combine.

/// A height as it was measured.
struct HeightSeen {
  double height = 0.0, sigma = 0.0;  ///< [m]
};

/// A position as it was measured.
struct PositionSeen {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero(), sigma = Eigen::Vector3d::Ones();  ///< [m]
};

/// One step of the filter: what came in, and what was believed at its end.
struct Tick {
  double time = 0.0;  ///< End of the tick [s].
  FixedList<Sample, kMaxSamples> samples;
  FixedList<HeightSeen, 4> heights;
  FixedList<PositionSeen, 2> positions;
  FixedList<GateSight, 6> sights;
  bool doubted = false;                            ///< See ErrorStateFilter::doubt.
  double accel_shaking = 1.0, gyro_shaking = 1.0;  ///< See Nominal.
  Nominal x;
};

/// The last ticks, and the covariance at the end of some of them: from there what followed can be done
/// again.
///
/// Covariances are large, so that at most kMost are kept, evenly spaced: less than 1 MB.
/// Allocates when it is made, and never after.
class DelayRing {
 public:
  static constexpr std::size_t kMost = 20;

  /// @param ticks  that are kept, at least 2.
  explicit DelayRing(std::size_t ticks);

  /// Forgets everything; `tick` is the first that is kept.
  void restart(const Tick& tick, const Covariance& P);
  /// The next tick, empty; its belief is the one before's.
  Tick& push();
  /// P at the end of tick `index`, for later, if that one is kept.
  void keep(std::size_t index, const Covariance& P);

  [[nodiscard]] std::size_t newest() const { return count_ - 1; }
  [[nodiscard]] std::size_t oldest() const;
  /// Ticks that are kept; the content of one stays until so many later another takes its place.
  [[nodiscard]] std::size_t capacity() const { return ticks_.size(); }
  Tick& operator[](std::size_t index) { return ticks_[index % ticks_.size()]; }
  const Tick& operator[](std::size_t index) const { return ticks_[index % ticks_.size()]; }
  /// The last tick not after `index` whose covariance is kept.
  [[nodiscard]] std::size_t kept_before(std::size_t index) const;
  [[nodiscard]] const Covariance& covariance(std::size_t index) const {
    return kept_[(index / spacing_) % kept_.size()];
  }

  /// The tick nearest to `time`; one that can be done again.
  /// @param beyond  so much younger than the newest it may be, if a tick is shorter [s].
  [[nodiscard]] std::optional<std::size_t> at(double time, double beyond = 0.0) const;

 private:
  [[nodiscard]] bool is_kept(std::size_t index) const { return index % spacing_ == 0; }

  std::vector<Tick> ticks_;
  std::vector<Covariance> kept_;
  std::size_t spacing_ = 1, count_ = 0, first_ = 0;
};

}  // namespace gatefly::eskf
