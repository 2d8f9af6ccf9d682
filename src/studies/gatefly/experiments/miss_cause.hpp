// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gatefly/detection/color_model.hpp"
#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::experiments {

/// How far the careful search came with a gate that it missed: "no place tried", "pulled elsewhere",
/// "rough score", "score", "opening not empty", "corners off".
/// @param corners_px  the gate's outer ones.
[[nodiscard]] std::string cause_of_miss(const Image& image, const Quad& corners_px,
                                        const ColorModel& color, const GateDetectorParams& params);

}  // namespace gatefly::experiments
