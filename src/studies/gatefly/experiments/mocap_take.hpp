// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gatefly/experiments/half_circles.hpp"

namespace gatefly::experiments {

/// One recording of one body by motion capture.
struct MocapTake {
  std::string name;  ///< File name without folder and ending.
  std::vector<MotionSample> samples =
      {};  ///< Without those that only repeat a lost body's last pose.
  /// As Motive gives it [m]. It grows to 1 m where a marker is lost, and falls back in one sample
  /// while the pose goes on within a centimetre: no measure of the pose.
  double largest_marker_error = 0.0;
  std::size_t repeated = 0;  ///< Samples that were dropped.
};

/// Reads a take in Motive's frame: t_s, motive_x_m, _y_m (up), _z_m, qx, qy, qz, qw, marker_error_m.
///
/// Frame: E is (x, z, -y) of Motive's, so z is down and nothing is mirrored. The nose is the body's
/// z axis: on every straight of the four takes of 2017 the course lies along it, and course and
/// nose turn to the same side in every arc (both tested on the data).
/// @throws std::runtime_error as files::Csv; also when times do not increase.
[[nodiscard]] MocapTake read_take(const std::filesystem::path& path);

/// All takes of a folder, in the order of their names. @throws std::runtime_error when there is
/// none.
[[nodiscard]] std::vector<MocapTake> read_takes(const std::filesystem::path& folder);

}  // namespace gatefly::experiments
