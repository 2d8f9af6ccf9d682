// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "gatefly/calibration/board_view.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::calibration {

/// What was found of a checkerboard in a picture.
struct BoardSearch {
  std::optional<BoardView> view;      ///< All its inner corners, row by row.
  std::string reason;                 ///< Why there is none.
  std::optional<BoardPattern> other;  ///< The board that is there instead.
};

/// Finds a checkerboard's inner corners to about 0.1 px: OpenCV's sector-based finder [Duda and Frese 2018],
/// then its classic one.
///
/// A picture whose board shows only when it is made smaller is blurred, and refused as such.
[[nodiscard]] BoardSearch find_board(const Image& picture, const std::string& name, const BoardPattern& pattern);

}  // namespace gatefly::calibration
