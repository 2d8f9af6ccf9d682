// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/experiments/twin_pictures.hpp"

namespace gatefly::experiments {

/// Real pictures beside rendered ones whose gates look as large; labels dashed.
[[nodiscard]] drawing::Canvas twin_sheet(std::span<const TwinPicture> real,
                                         std::span<const TwinPicture> rendered);

}  // namespace gatefly::experiments
