// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "gatefly/tasks/calibration/board_view.hpp"

namespace gatefly::calibration {

/// The user's description of the board and its pictures, as written.
struct BoardArguments {
  std::string pattern = {};  ///< --pattern, "9x6": inner corners of the checkerboard.
  double square = 0.0;       ///< --square-m: the side of one square [m].
  std::string size = {};  ///< --size, "640x480": of the stored pictures behind corner lists [px].
  int rotate_deg = 0;  ///< Stored pictures are turned by this, counter-clockwise: 0, 90, 180, 270.
};

/// A corner list, not a picture.
[[nodiscard]] bool is_corner_list(const std::filesystem::path& path);

/// @throws std::runtime_error naming the flag that is missing or wrong.
[[nodiscard]] BoardPattern pattern_of(const BoardArguments& arguments);

/// All that pictures and corner lists show of boards.
struct Boards {
  BoardViews views;
  Eigen::Vector2i size_px{0, 0};  ///< Upright.
  int pictures = 0, unusable = 0;
  bool listed = false;                                       ///< Some are from a corner list.
  std::vector<std::pair<std::string, std::string>> without;  ///< Picture, why it shows no board.
  std::map<std::string, int> other_patterns;                 ///< Other patterns seen, how often.

  /// Looks for the board in a picture; that there is none is no error.
  /// @throws std::runtime_error when it cannot be read or has another size than those before it.
  void add_picture(const std::filesystem::path& path, const BoardPattern& pattern, int rotate_deg);
  /// @throws std::runtime_error when the list cannot be read or contradicts what was said of it.
  void add_list(const std::filesystem::path& path, const BoardArguments& arguments);
};

/// @throws std::runtime_error when there are too few boards to start with, saying what the pictures
///     show instead.
void expect_enough(const Boards& boards, const BoardArguments& arguments);

}  // namespace gatefly::calibration
