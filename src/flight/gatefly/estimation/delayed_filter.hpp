// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "gatefly/estimation/drag_filter.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {

struct RestartParams {
  int fixes = 4;          ///< So many more that agree with the first of them than do not ...
  double duration = 0.3;  ///< ... over at least this long [s] ...
  double longest = 2.0;   ///< ... and at most this [s]. [estimate]
  /// Drift of dead reckoning: what corrupted the position is in it, too [m/s]. [estimate]
  double odometry = 0.6;
};

/// The drag filter with a memory: a fix is fused at the moment of its picture, however late it
/// comes.
///
/// The last moments are kept, tick by tick. A fix takes its place among them and everything after it
/// is done again, so that the order of arrival does not matter. Fixes that the filter refuses but
/// that agree with each other restart its position: it is never locked out, and never thrown by
/// one or two wrong gates. Cost: a prediction and a copy of 1 KiB per tick; a fix costs a prediction
/// per tick of its age. Allocates when it is made, and never after.
class DelayedFilter {
 public:
  /// The filter at the end of one tick, and what led there.
  struct Moment {
    double time = 0.0;  ///< [s]
    double dt = 0.0;
    drag_model::Input input;
    Eigen::Vector3d odometry = Eigen::Vector3d::Zero();  ///< Dead reckoning, never corrected [m].
    struct Height {
      double z = 0.0, sigma = 0.0, systematic = 0.0;
    };
    FixedList<Height, 2> heights;
    DragFilter filter;
  };

  /// @param moments  how many are kept, at least 2: see moments_for().
  explicit DelayedFilter(const DragFilterParams& params, std::size_t moments,
                         const RestartParams& restart = {});

  /// See DragFilter. The memory begins here.
  void start(const Eigen::Vector3d& p_G, const Eigen::Vector3d& accel_bias,
             const MapUncertainty& uncertainty, double time);

  /// One tick, which ends at `time` [s].
  void predict(const drag_model::Input& input, double dt, double time);

  /// A height of now; see DragFilter.
  Fusion correct_altitude(double z_G, double sigma, double height_sigma);

  /// A fix of `time` [s]. @param may_restart  whether it counts when fixes are refused in a row.
  Fusion correct(const Fix& fix, double time, bool may_restart = false);

  /// The drone is said to be at x, y, `sigma` [m] uncertain; the biases are known from now on. What
  /// was before can no longer be corrected.
  void reset_position(const Eigen::Vector2d& p_G, double sigma);

  /// Goes over to another gate's frame; what was before can no longer be corrected.
  void change_frame(const Eigen::Matrix3d& R, const Eigen::Vector3d& offset, double turn,
                    const MapUncertainty& uncertainty);

  /// The heading was found to be off: so it was in the past.
  void turn_past(double angle);

  /// The moment nearest to `time`; nullptr when that is older than the memory.
  [[nodiscard]] const Moment* at(double time) const;

  [[nodiscard]] const DragFilter& now() const { return newest().filter; }

 private:
  struct Dated {
    double time = 0.0;
    Fix fix;
  };
  struct Run {      ///< Refused fixes that agree with the first of them.
    int count = 0;  ///< Fixes that agree minus fixes that do not.
    double since = 0.0, last = 0.0;
    /// Origin of dead reckoning according to the first fix [m].
    Eigen::Vector3d start = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  };

  [[nodiscard]] const Moment& moment(std::size_t i) const { return moments_[i % moments_.size()]; }
  Moment& moment(std::size_t i) { return moments_[i % moments_.size()]; }
  [[nodiscard]] const Moment& newest() const { return moment(count_ - 1); }
  Moment& newest() { return moment(count_ - 1); }
  [[nodiscard]] std::size_t oldest() const {
    return count_ - first_ < moments_.size() ? first_ : count_ - moments_.size();
  }
  [[nodiscard]] std::optional<std::size_t> index_at(double time) const;
  void forget_past();
  Fusion redo_from(std::size_t index, double time);
  [[nodiscard]] bool agreed(const Fix& fix, double time, const Eigen::Vector3d& odometry);

  RestartParams restart_;
  std::vector<Moment> moments_;
  std::size_t count_ = 1, first_ = 0;  ///< Moments so far, and the first that still holds.
  FixedList<Dated, 32> fixes_;         ///< Fixes of the moments kept, in order of time.
  Run run_;
};

/// How many moments last for `seconds` at `imu_hz` samples a second.
[[nodiscard]] std::size_t moments_for(double seconds, double imu_hz);

}  // namespace gatefly
