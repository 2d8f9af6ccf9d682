// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gatefly/detection/picture_color.hpp"
#include "gatefly/detection/search_window.hpp"
#include "gatefly/geometry/divisor.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// Cells from `left` and `top` up to, not including, `right` and `bottom`.
struct CellBox {
  int left = 0, top = 0, right = 0, bottom = 0;

  [[nodiscard]] int width() const { return right - left; }
  [[nodiscard]] int height() const { return bottom - top; }
  [[nodiscard]] bool empty() const { return right <= left || bottom <= top; }
  [[nodiscard]] bool contains(int x, int y) const {
    return x >= left && x < right && y >= top && y < bottom;
  }
};

/// A picture as evidence for the gate, on a grid of at most kCells cells whatever the picture's
/// size: two pixels a cell up to 640 x 480.
class EvidenceMap {
 public:
  static constexpr int kCells = 80'000, kMargin = 1;

  EvidenceMap();  ///< Allocates once; fill() never does.

  /// Reads two pixels a cell. An empty image makes an empty map.
  /// @param within  of the picture, or null for all of it; what is there is the same as in a map of all.
  void fill(const Image& image, const PictureColor& color, const SearchWindow* within = nullptr);

  [[nodiscard]] int width() const { return width_; }    ///< The whole picture's [cells].
  [[nodiscard]] int height() const { return height_; }  ///< The whole picture's [cells].
  [[nodiscard]] int step() const { return step_; }      ///< Pixels a cell.
  [[nodiscard]] const CellBox& filled() const { return filled_; }

  /// Evidence of a cell, within ±kLimit; outside of what was filled there is none of a gate.
  [[nodiscard]] int at(int x, int y) const {
    if (!filled_.contains(x, y)) return kOutside;
    return evidence_[static_cast<std::size_t>(y * width_ + x)];
  }
  /// Visits `count` cells from (x, y) on, (dx, dy) apart, in 1/65536 cells: visit(k, evidence).
  template <class Visit>
  void along(std::int64_t x, std::int64_t y, std::int64_t dx, std::int64_t dy, int count,
             const Visit& visit) const {
    const auto contains = [this](std::int64_t cx, std::int64_t cy) {
      return filled_.contains(static_cast<int>(cx >> 16), static_cast<int>(cy >> 16));
    };
    // If both ends are inside, all is.
    if (contains(x, y) && contains(x + (count - 1) * dx, y + (count - 1) * dy)) {
      const std::int8_t* const cells = evidence_.data();
      for (int k = 0; k < count; ++k, x += dx, y += dy)
        visit(k, int{cells[(y >> 16) * width_ + (x >> 16)]});
      return;
    }
    for (int k = 0; k < count; ++k, x += dx, y += dy)
      visit(k, at(static_cast<int>(x >> 16), static_cast<int>(y >> 16)));
  }
  /// Evidence from column `filled().left` of a row on. @param y  within filled().
  [[nodiscard]] const std::int8_t* row(int y) const {
    return evidence_.data() + static_cast<std::ptrdiff_t>(y) * width_ + filled_.left;
  }

  /// Mean colour of the cells around a pixel. @param u,v  inside what was filled.
  [[nodiscard]] Yuv around(int u, int v) const {
    return around_cell(cell_of(u, width_), cell_of(v, height_));
  }

  /// Evidence of one pixel, from its colour and the cells around it.
  [[nodiscard]] int at_pixel(const Image& image, const PictureColor& color, int u, int v) const {
    if (!image.contains(u, v)) return kOutside;
    const int x = cell_of(u, width_), y = cell_of(v, height_);
    if (!filled_.contains(x, y)) return kOutside;
    return std::clamp(color.evidence(image.at(u, v), around_cell(x, y)), -kLimit, kLimit);
  }

  static constexpr int kLimit = 40, kOutside = -16;  ///< 2.5 and -1 nats.

 private:
  void read(const Image& image, const CellBox& cells);
  // The last pixels of a picture may be less than a cell.
  [[nodiscard]] int cell_of(int px, int cells) const { return std::min(cells_(px), cells - 1); }
  [[nodiscard]] Yuv around_cell(int x, int y) const {
    const auto k = static_cast<std::size_t>(y * width_ + x);
    return {around_y_[k], around_u_[k], around_v_[k]};
  }

  int width_ = 0, height_ = 0, step_ = 2;
  Divisor cells_{2};  // pixels to cells
  CellBox filled_;
  std::vector<std::uint8_t> y_, u_, v_;  // mean colour of each cell
  std::vector<std::uint8_t> around_y_, around_u_, around_v_;
  std::vector<std::uint16_t> columns_;         // sums of the box filter
  std::vector<std::uint32_t> columns_before_;  // of all columns before each
  std::vector<std::int8_t> evidence_;
};

}  // namespace gatefly
