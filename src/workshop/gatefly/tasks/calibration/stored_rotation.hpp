// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "gatefly/detection/color_model.hpp"
#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/tasks/calibration/boards.hpp"

namespace gatefly::calibration {

/// How a flight's pictures must be turned, counter-clockwise [deg], for its gates to be found where
/// its labels.csv (upright) has them; nullopt when no way stands out.
///
/// @param upright_px  size of the upright picture: a turn that gives another one is none.
/// @throws std::runtime_error one line, for labels or pictures that cannot be read.
[[nodiscard]] std::optional<int> stored_rotation_of(const std::filesystem::path& flight,
                                                    const Eigen::Vector2i& upright_px,
                                                    const GateDetectorParams& params,
                                                    const ColorModel& color);

/// Doubts that boards alone leave about how the camera stores pictures; "" when there are none.
[[nodiscard]] std::string stored_rotation_doubt(const Boards& boards);

}  // namespace gatefly::calibration
