// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "gatefly/tasks/calibration/mount.hpp"

namespace gatefly::calibration {

/// Given facts about the gate and the drone that saw it.
struct MountArguments {
  double gate_side = 1.0;                          ///< [m]
  Eigen::Vector3d p_BC = Eigen::Vector3d::Zero();  ///< The camera's place in the body frame [m].
  /// For a labels.csv: the gates' middle above the camera [m].
  std::optional<double> gate_height;
};

/// A mount and what it was found from.
struct FoundMount {
  Mount mount;
  std::string from;     ///< The file's or folder's name.
  bool flight = false;  ///< From a flight, else from pictures that a level drone took.
};

/// A labels.csv, or that of a flight folder.
[[nodiscard]] files::Labels gate_labels(const std::filesystem::path& path);

/// mount_from_flight() where `path` is a flight folder, else mount_from_level().
/// @throws std::runtime_error as these do, and for a flight that cannot be read.
[[nodiscard]] FoundMount mount_from(const std::filesystem::path& path, const files::Labels& labels,
                                    const AnyCamera& lens, const MountArguments& arguments);

/// The angles with their uncertainty and what they rest on: one sentence.
[[nodiscard]] std::string text_of(const FoundMount& found);

}  // namespace gatefly::calibration
