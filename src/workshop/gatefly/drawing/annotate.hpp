// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Core>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/drawing/canvas.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::drawing {

/// How much annotated() enlarges: whole steps up to 3; pictures with a side above 1600 px are made
/// smaller.
[[nodiscard]] double annotation_scale(const Image& image);

/// A picture drawn at `at`, enlarged by `scale`, with a gate found in it: outline, rings around the
/// corners, the first corner (top-left) with a dot. Corners are in upright pixels, pixel centres at
/// integers.
void draw_detection(Canvas& canvas, const GateDetection& gate, const Eigen::Vector2d& at,
                    double scale, const Stroke& stroke);

/// The upright picture, enlarged, with every gate's outline, corners, rank (0 is the best) and
/// fitness. @throws std::runtime_error when the picture is empty.
[[nodiscard]] Canvas annotated(const Image& image, std::span<const GateDetection> gates);

}  // namespace gatefly::drawing
