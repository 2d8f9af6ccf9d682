// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/sensing/camera.hpp"
#include "gatefly/tasks/calibration/lens_fit.hpp"

namespace gatefly::calibration {

/// Contents of a calibration file, in any of the formats.
struct CameraFile {
  AnyCamera lens;                 ///< Lens of the upright picture.
  Eigen::Vector2i size_px{0, 0};  ///< Size of the upright picture.
  /// Our own files only; others describe the picture as it is stored.
  int stored_rotation_deg = 0;
  std::optional<double> tilt_down;  ///< [rad] Our own files only.
};

enum class CameraFormat { kToml, kKalibr, kRos };

/// "kalibr", "ros", "toml"; anything else is our own.
[[nodiscard]] CameraFormat camera_format(const std::string& name);

/// Reads a Kalibr camchain (radtan, equidistant, none) or a ROS camera_info file (plumb_bob,
/// equidistant), told apart by what is in them, or a configuration with a [camera] (.toml).
///
/// radtan and plumb_bob are Brown-Conrady, equidistant is Kannala-Brandt; all zeros of them a
/// pinhole.
/// @param camera  which of a camchain, "cam0"; "": the only one.
/// @throws std::runtime_error one line: file, key, value, what is allowed; also for a lens that we
///     do not have (rational polynomials, omni, fov, skewed pixels, ...).
[[nodiscard]] CameraFile read_camera(const std::filesystem::path& path,
                                     const std::string& camera = "");

/// Refuses a camera that no command would take: a size, focal length or distortion out of bounds.
/// @param where  it comes from, in the message. @throws std::runtime_error one line.
void expect_usable(const CameraFile& camera, const std::string& where);

/// The file's text. @param comments  lines that are put above.
/// @throws std::runtime_error when the format has no such lens: Dhane's is in none but our own, a
///     k3 not in Kalibr's.
[[nodiscard]] std::string camera_text(const CameraFile& camera, CameraFormat format,
                                      const std::vector<std::string>& comments = {});

/// The fitted lens with as many digits as anybody can measure.
[[nodiscard]] AnyCamera short_lens(const LensFit& fit);

}  // namespace gatefly::calibration
