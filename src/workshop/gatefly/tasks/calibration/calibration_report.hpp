// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/tasks/calibration/boards.hpp"
#include "gatefly/tasks/calibration/calibration.hpp"

namespace gatefly::calibration {

/// Tables of models and pictures, which model is recommended, what to beware of; ends in a newline.
[[nodiscard]] std::string text_of(const Calibration& answer, const Boards& boards);

/// {"size_px", "pictures", "models": [{"model", "rms_px", "held_out_px", "parameters", ...}],
/// "recommended", "chosen", "coverage", ...}.
/// @param doubt  about stored_rotation_deg: stored_rotation_doubt(), or "".
[[nodiscard]] nlohmann::ordered_json as_json(const Calibration& answer, const Boards& boards,
                                             int stored_rotation_deg, const std::string& doubt);

/// Lines of a camera's file about its own making.
[[nodiscard]] std::vector<std::string> provenance(const Calibration& answer);

}  // namespace gatefly::calibration
