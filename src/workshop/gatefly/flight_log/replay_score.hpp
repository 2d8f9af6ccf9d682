// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "gatefly/flight_log/chi_square_count.hpp"
#include "gatefly/race/pilot.hpp"

namespace gatefly::flight_log {

/// Errors in one frame, against a log's truth.
struct FrameErrors {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  int samples = 0;
  ChiSquareCount nees;  ///< 3 degrees of freedom, 20 Hz; none where the filter has no covariance.

  void add(const Eigen::Vector3d& error);
  void add(const FrameErrors& other);
  [[nodiscard]] Eigen::Vector3d rms() const;
  [[nodiscard]] Eigen::Vector3d deviation() const;
};

/// Errors of a replay's estimates, and whether the filter knows of them.
struct ReplayScore {
  FrameErrors gate;  ///< From the gate as believed, against from the gate as it stands: what flies.
  FrameErrors earth;   ///< In the frame of the map and of the truth.
  ChiSquareCount nis;  ///< Every taken sighting counts.
};

/// An estimate of one moment, as far as it is scored.
struct ScoredEstimate {
  double t = 0.0;                                                                  ///< [s]
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero(), p_GB = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<Eigen::Matrix3d> covariance_EB, covariance_GB;                     ///< [m²]
};

/// The pilot's present belief.
[[nodiscard]] ScoredEstimate scored_estimate(const Pilot& pilot);

/// Fills a score while a flight is flown again.
class ReplayScorer {
 public:
  /// @param gates  as they stand, in the order of the pilot's map; empty: nobody knows.
  explicit ReplayScorer(std::vector<MapGate> gates) : gates_{std::move(gates)} {}

  void add(const ScoredEstimate& estimate, const Eigen::Vector3d& true_p_EB, std::size_t target);
  void add_sighting(const Sighting& sighting);
  [[nodiscard]] const ReplayScore& score() const { return score_; }

 private:
  std::vector<MapGate> gates_;
  ReplayScore score_;
  double next_ = 0.0;
};

}  // namespace gatefly::flight_log
