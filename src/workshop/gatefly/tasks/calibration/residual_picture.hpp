// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/tasks/calibration/calibration.hpp"

namespace gatefly::calibration {

/// Every kept corner with its residual (seen minus drawn), enlarged; scattered arrows are noise,
/// arrows that agree with their neighbours are what the lens model cannot describe. The chosen
/// model's.
[[nodiscard]] drawing::Canvas residual_picture(const Calibration& answer);

}  // namespace gatefly::calibration
