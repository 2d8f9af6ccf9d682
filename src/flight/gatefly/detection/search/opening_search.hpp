// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/picture_color.hpp"
#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// Finds the openings of gates made of boards: close up, all of the opening is in the picture long
/// after the gate's outer corners have left it. [ours]
///
/// On a grid of the picture: what is not of the gate's colour and has that colour around it. Its
/// corners follow from the boards' inner edges, sub-pixel.
class OpeningSearch {
 public:
  static constexpr int kMostColumns = 160, kMostRows = 120;  ///< Of the grid.

  explicit OpeningSearch(const GateDetectorParams& params = {});

  /// The largest openings, largest first, with the corners of the opening as `corners_px`; those of
  /// fitness 0 are not in view: two at one border at most. None of gates whose bars are no boards.
  /// Allocates nothing.
  [[nodiscard]] Openings detect(const Image& image, const PictureColor& color);

 private:
  /// Cells that hang together and are not of the gate's colour.
  struct Hole {
    int label = 0, cells = 0;
    int left = kMostColumns, right = -1, top = kMostRows, bottom = -1;
  };
  static constexpr int kMostLabels = 256, kBoard = 0;  ///< A cell's label: the gate's colour.
  using Holes = FixedList<Hole, Openings::kCapacity>;

  void mark(const Image& image, const PictureColor& color);
  void label();
  [[nodiscard]] int root_of(int label) const;
  [[nodiscard]] Holes holes();
  [[nodiscard]] bool touches_more_than_one_border(const Hole& hole) const;
  [[nodiscard]] Quad corners_of(const Hole& hole) const;
  [[nodiscard]] bool is_framed(const Quad& corners_px, const std::array<bool, 4>& seen) const;
  /// A count of places along a line: those in the picture, those of the gate's colour.
  struct Shown {
    int in_view = 0, of_gate = 0;
  };
  using Line = std::array<Eigen::Vector2d, 2>;  // from, to
  [[nodiscard]] Shown shown(const Line& near, const Line& far) const;
  [[nodiscard]] bool measure(const Image& image, GateDetection& opening) const;

  [[nodiscard]] std::uint8_t& at(int column, int row) {
    return cells_[static_cast<std::size_t>(row * kMostColumns + column)];
  }
  [[nodiscard]] std::uint8_t at(int column, int row) const {
    return cells_[static_cast<std::size_t>(row * kMostColumns + column)];
  }

  GateDetectorParams params_;
  LensBend bend_;
  int columns_ = 0, rows_ = 0, step_ = 1;  // of the grid; pixels from cell to cell
  std::array<std::uint8_t, std::size_t{kMostColumns} * kMostRows> cells_{};
  std::array<std::uint8_t, kMostLabels> parent_{};
};

}  // namespace gatefly
