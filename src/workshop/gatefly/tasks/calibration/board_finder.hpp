// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "gatefly/sensing/image.hpp"
#include "gatefly/tasks/calibration/board_view.hpp"

namespace gatefly::calibration {

/// Outcome of looking for a checkerboard in a picture.
struct BoardSearch {
  std::optional<BoardView> view;      ///< All its inner corners, row by row.
  std::string reason;                 ///< Why there is none.
  std::optional<BoardPattern> other;  ///< The board that is there instead.
};

/// Finds a checkerboard's inner corners to some hundredths of a pixel: OpenCV's sector-based finder
/// [Duda and Frese 2018], else its classic one, both refined by cornerSubPix. All of the pattern's
/// corners, or none; blur alone does not matter as long as squares can be told apart.
[[nodiscard]] BoardSearch find_board(const Image& picture, const std::string& name,
                                     const BoardPattern& pattern);

}  // namespace gatefly::calibration
