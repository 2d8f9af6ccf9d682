// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

namespace gatefly::simulated_race {

/// How the error of an estimate came about, told apart while it arises. Earth axes [m].
///
/// The error is the true place from the target gate as it stands less the believed one from the gate
/// on the map. What the map is wrong by comes in when the target changes, what a fix is wrong by with
/// the filter's gain K = P (P + R)⁻¹, which takes as much off everything there was before; the rest
/// has drifted in: IMU, drag, wind. The three always add up to the error.
class ErrorLedger {
 public:
  /// A fix that the filter has taken.
  struct Fix {
    Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();            ///< By the map [m].
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< [m²]
    bool has_height = true;
    bool restarted = false;  ///< The filter has begun anew there.
  };
  /// One tick, after the pilot has stepped.
  struct Entry {
    Eigen::Vector3d true_p_EB = Eigen::Vector3d::Zero(), p_EB = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< Covariance of p_EB [m²].
    /// The target's place on the map less its true one [m].
    Eigen::Vector3d map_shift = Eigen::Vector3d::Zero();
    std::optional<Fix> fix = std::nullopt;  ///< To the target before this tick.
  };

  void add(const Entry& entry);

  [[nodiscard]] const Eigen::Vector3d& map() const { return map_; }
  [[nodiscard]] const Eigen::Vector3d& detection() const { return detection_; }
  [[nodiscard]] const Eigen::Vector3d& estimate() const { return estimate_; }
  /// True place less that of the last fix, each from its gate [m]; nullopt before the first.
  [[nodiscard]] const std::optional<Eigen::Vector3d>& fix_error() const { return fix_error_; }

 private:
  void correct(const Fix& fix, const Eigen::Vector3d& true_p_EB);

  Eigen::Vector3d map_ = Eigen::Vector3d::Zero(), detection_ = Eigen::Vector3d::Zero(),
                  estimate_ = Eigen::Vector3d::Zero(), map_shift_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();  ///< Before this tick's fix.
  std::optional<Eigen::Vector3d> fix_error_;
};

}  // namespace gatefly::simulated_race
