// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "gatefly/tasks/calibration/board_view.hpp"

namespace gatefly::calibration {

/// Reads corners that somebody else found: one row for each.
///
/// Columns: `image` or `view`; on the board `X_m,Y_m` or `X_mm,Y_mm`; in the picture `u_px,v_px`
/// (pixel centres count from 0) or `u_px_1based,v_px_1based` (Matlab). Other columns do not matter.
/// @throws std::runtime_error "file:line:column: ..." for what is missing or no number.
[[nodiscard]] BoardViews read_corner_list(const std::filesystem::path& path);

/// Corners of pictures that are stored turned, as in the upright picture.
/// @param stored_size_px  of the stored picture; @param rotation_deg  counter-clockwise: 0, 90,
///     180, 270.
void turn_upright(BoardViews& views, const Eigen::Vector2i& stored_size_px, int rotation_deg);

}  // namespace gatefly::calibration
