// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace gatefly::calibration {

/// A corner of a flat board, and where a picture shows it.
struct BoardCorner {
  Eigen::Vector2d p_W;  ///< In the board's plane [m].
  Eigen::Vector2d px;   ///< Upright picture, pixel centres at integers.
};

/// Corners that one picture shows of the board.
struct BoardView {
  std::string image;
  std::vector<BoardCorner> corners;
};

using BoardViews = std::vector<BoardView>;

/// Inner corners of a checkerboard, in either orientation.
struct BoardPattern {
  int columns = 0, rows = 0;
  double square = 1.0;  ///< [m]

  [[nodiscard]] std::string text() const {
    return std::to_string(columns) + "x" + std::to_string(rows);
  }
};

}  // namespace gatefly::calibration
