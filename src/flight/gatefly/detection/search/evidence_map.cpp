// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/evidence_map.hpp"

#include <algorithm>
#include <limits>

namespace gatefly {
namespace {

// Surroundings of a cell, to each side, by the picture's shorter side: 22 px in all at 315 x 160 [a
// study on labelled pictures]
constexpr int kShorterPerRadius = 16;
constexpr int kLeastRadius = 5, kMostRadius = 100;  // cells
static_assert((2 * kMostRadius + 1) * 255 <= std::numeric_limits<std::uint16_t>::max(),
              "a column's sum fits");
static_assert(EvidenceMap::kLimit <= std::numeric_limits<std::int8_t>::max());

/// Sums of a row's columns, each over `rows` cells, and of all columns before each.
struct ColumnSums {
  std::vector<std::uint16_t>& of;
  std::vector<std::uint32_t>& before;
  int rows = 0;
};

/// The means wanted, of a picture of `width` by `height`; and the cells that they are of, which are
/// those and the ones around them.
struct Box {
  CellBox wanted, read;
  int width, height, radius;
};

// Means of a row; smaller squares at the border. Differences of sums: compilers take several at
// once, of a running sum none.
void average(const ColumnSums& sums, std::uint8_t* __restrict out, const Box& box) {
  const int first = box.read.left, radius = box.radius;
  std::uint32_t* const before = sums.before.data();
  before[first] = 0;
  for (int x = first; x < box.read.right; ++x)
    before[x + 1] = before[x] + sums.of[static_cast<std::size_t>(x)];
  const auto mean = [&](int from, int to, float share) {
    return static_cast<std::uint8_t>(
        static_cast<float>(static_cast<int>(before[to] - before[from])) * share + 0.5f);
  };
  const auto share_of = [&](int columns) { return 1.0f / static_cast<float>(columns * sums.rows); };
  const auto at_border = [&](int x) {
    const int from = std::max(0, x - radius), to = std::min(box.width, x + radius + 1);
    out[x] = mean(from, to, share_of(to - from));
  };
  const float share = share_of(2 * radius + 1);
  const int left = box.wanted.left, right = box.wanted.right,
            inner = std::clamp(radius, left, right),
            outer = std::clamp(box.width - radius, inner, right);
  for (int x = left; x < inner; ++x) at_border(x);
  for (int x = inner; x < outer; ++x) out[x] = mean(x - radius, x + radius + 1, share);
  for (int x = outer; x < right; ++x) at_border(x);
}

// Mean over a square of (2 radius + 1)² cells, smaller at the border.
void box_mean(const std::vector<std::uint8_t>& from, std::vector<std::uint8_t>& to, ColumnSums sums,
              const Box& box) {
  std::vector<std::uint16_t>& columns = sums.of;
  std::fill(columns.begin() + box.read.left, columns.begin() + box.read.right, std::uint16_t{0});
  const auto row = [&](auto& cells, int y) {
    return cells.data() + static_cast<std::ptrdiff_t>(y) * box.width;
  };
  const auto add_row = [&](int y) {
    const std::uint8_t* cells = row(from, y);
    for (int x = box.read.left; x < box.read.right; ++x)
      columns[static_cast<std::size_t>(x)] =
          static_cast<std::uint16_t>(columns[static_cast<std::size_t>(x)] + cells[x]);
  };
  const auto drop_row = [&](int y) {
    const std::uint8_t* cells = row(from, y);
    for (int x = box.read.left; x < box.read.right; ++x)
      columns[static_cast<std::size_t>(x)] =
          static_cast<std::uint16_t>(columns[static_cast<std::size_t>(x)] - cells[x]);
  };
  const int top = box.wanted.top, radius = box.radius;
  for (int y = box.read.top; y < std::min(box.height, top + radius); ++y) add_row(y), ++sums.rows;
  for (int y = top; y < box.wanted.bottom; ++y) {
    if (y + radius < box.height) add_row(y + radius), ++sums.rows;
    if (y > top && y - radius - 1 >= 0) drop_row(y - radius - 1), --sums.rows;
    average(sums, row(to, y), box);
  }
}

// Cells that a window covers, whole or in part.
CellBox cells_of(const SearchWindow* window, int width, int height, int step) {
  if (window == nullptr) return {0, 0, width, height};
  // A number that is none counts as 0, like one beyond the left or upper border.
  const auto cell = [step](double px, int end) {
    return px > 0.0 ? static_cast<int>(std::min(px / step, static_cast<double>(end))) : 0;
  };
  return {cell(window->left, width), cell(window->top, height), cell(window->right + step, width),
          cell(window->bottom + step, height)};
}

}  // namespace

EvidenceMap::EvidenceMap() {
  for (auto* cells : {&y_, &u_, &v_, &around_y_, &around_u_, &around_v_}) cells->resize(kCells);
  columns_.resize(kCells), columns_before_.resize(kCells + 1);
  evidence_.resize(kCells);
}

void EvidenceMap::fill(const Image& image, const PictureColor& color, const SearchWindow* within) {
  // Two pixels a cell at least, and as many as it takes.
  step_ = 2;
  // At most as often as the picture's larger side has pixels.
  while ((image.width() / step_) * (image.height() / step_) > kCells) ++step_;
  cells_ = Divisor{step_};
  width_ = image.width() / step_, height_ = image.height() / step_;
  if (width_ == 0 || height_ == 0) {
    width_ = height_ = 0, filled_ = {};
    return;
  }
  filled_ = cells_of(within, width_, height_, step_);
  if (filled_.empty()) return;
  const int radius =
      std::clamp(std::min(width_, height_) / kShorterPerRadius, kLeastRadius, kMostRadius);
  const CellBox around{std::max(0, filled_.left - radius), std::max(0, filled_.top - radius),
                       std::min(width_, filled_.right + radius),
                       std::min(height_, filled_.bottom + radius)};
  read(image, around);
  const Box box{filled_, around, width_, height_, radius};
  box_mean(y_, around_y_, {columns_, columns_before_}, box);
  box_mean(u_, around_u_, {columns_, columns_before_}, box);
  box_mean(v_, around_v_, {columns_, columns_before_}, box);
  for (int y = filled_.top; y < filled_.bottom; ++y) {
    const auto first = static_cast<std::size_t>(y * width_);
    for (std::size_t k = first + static_cast<std::size_t>(filled_.left);
         k < first + static_cast<std::size_t>(filled_.right); ++k) {
      const int e =
          color.evidence({y_[k], u_[k], v_[k]}, {around_y_[k], around_u_[k], around_v_[k]});
      evidence_[k] = static_cast<std::int8_t>(std::clamp(e, -kLimit, kLimit));
    }
  }
}

// Two pixels of each cell, one row of pixels after the other: the layout is asked once a row.
void EvidenceMap::read(const Image& image, const CellBox& cells) {
  const int other = step_ / 2, first = (step_ - 2) / 4, u = cells.left * step_ + first;
  for (int y = cells.top; y < cells.bottom; ++y) {
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * width_ + cells.left;
    std::uint8_t *to_y = y_.data() + row, *to_u = u_.data() + row, *to_v = v_.data() + row;
    const int v = y * step_ + first;
    image.visit_row(u, v, step_, cells.width(),
                    [&](Yuv c) { *to_y++ = c.y, *to_u++ = c.u, *to_v++ = c.v; });
    to_y = y_.data() + row, to_u = u_.data() + row, to_v = v_.data() + row;
    const auto mean = [](std::uint8_t& level, std::uint8_t more) {
      level = static_cast<std::uint8_t>((level + more + 1) >> 1);
    };
    image.visit_row(u + other, v + other, step_, cells.width(),
                    [&](Yuv c) { mean(*to_y++, c.y), mean(*to_u++, c.u), mean(*to_v++, c.v); });
  }
}

}  // namespace gatefly
