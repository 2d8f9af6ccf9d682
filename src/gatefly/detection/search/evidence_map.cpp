// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/evidence_map.hpp"

#include <algorithm>
#include <limits>

namespace gatefly {
namespace {

constexpr int kRadius = 5;  // cells: 22 px at 2 px a cell [a study on labelled pictures]
static_assert((2 * kRadius + 1) * (2 * kRadius + 1) * 255 <=
                  std::numeric_limits<std::uint16_t>::max(),
              "a square's sum fits");
static_assert(EvidenceMap::kLimit <= std::numeric_limits<std::int8_t>::max());

// Means of a row from the sums of its columns, each over `rows` cells; smaller at the border.
void average(const std::vector<std::uint16_t>& columns, int rows, std::uint8_t* __restrict out,
             int width) {
  const auto mean = [rows](std::uint32_t sum, int count) {
    const std::uint32_t scale = (1u << 16) / static_cast<std::uint32_t>(count * rows);
    return static_cast<std::uint8_t>((sum * scale + (1u << 15)) >> 16);
  };
  const auto at_border = [&](int x) {
    std::uint32_t sum = 0;
    const int first = std::max(0, x - kRadius), last = std::min(width - 1, x + kRadius);
    for (int i = first; i <= last; ++i) sum += columns[static_cast<std::size_t>(i)];
    out[x] = mean(sum, last - first + 1);
  };
  for (int x = 0; x < std::min(kRadius, width); ++x) at_border(x);
  // Eleven columns anew for each place: no sum waits for the one before, so that compilers take
  // several at once; a third of the time of a running sum.
  const std::uint32_t scale = (1u << 16) / static_cast<std::uint32_t>((2 * kRadius + 1) * rows);
  const std::uint16_t* const c = columns.data();
  static_assert(kRadius == 5);
  for (std::ptrdiff_t x = kRadius; x < width - kRadius; ++x) {
    const auto sum =
        static_cast<std::uint16_t>(c[x - 5] + c[x - 4] + c[x - 3] + c[x - 2] + c[x - 1] + c[x] +
                                   c[x + 1] + c[x + 2] + c[x + 3] + c[x + 4] + c[x + 5]);
    out[x] = static_cast<std::uint8_t>((sum * scale + (1u << 15)) >> 16);
  }
  for (int x = std::max(kRadius, width - kRadius); x < width; ++x) at_border(x);
}

// Mean over a square of (2 kRadius + 1)² cells, smaller at the border.
void box_mean(const std::vector<std::uint8_t>& from, std::vector<std::uint8_t>& to,
              std::vector<std::uint16_t>& columns, int width, int height) {
  std::fill_n(columns.begin(), width, std::uint16_t{0});
  const auto row = [width](auto& cells, int y) {
    return cells.data() + static_cast<std::ptrdiff_t>(y) * width;
  };
  const auto add_row = [&](int y) {
    const std::uint8_t* cells = row(from, y);
    for (int x = 0; x < width; ++x)
      columns[static_cast<std::size_t>(x)] =
          static_cast<std::uint16_t>(columns[static_cast<std::size_t>(x)] + cells[x]);
  };
  const auto drop_row = [&](int y) {
    const std::uint8_t* cells = row(from, y);
    for (int x = 0; x < width; ++x)
      columns[static_cast<std::size_t>(x)] =
          static_cast<std::uint16_t>(columns[static_cast<std::size_t>(x)] - cells[x]);
  };
  int rows = 0;
  for (int y = 0; y < std::min(height, kRadius); ++y) add_row(y), ++rows;
  for (int y = 0; y < height; ++y) {
    if (y + kRadius < height) add_row(y + kRadius), ++rows;
    if (y - kRadius - 1 >= 0) drop_row(y - kRadius - 1), --rows;
    average(columns, rows, row(to, y), width);
  }
}

}  // namespace

EvidenceMap::EvidenceMap() {
  for (auto* cells : {&y_, &u_, &v_, &around_y_, &around_u_, &around_v_}) cells->resize(kCells);
  columns_.resize(kCells);
  evidence_.resize(kCells);
}

void EvidenceMap::fill(const Image& image, const ColorModel& color) {
  // Two pixels a cell at least, and as many as it takes.
  step_ = 2;
  while ((image.width() / step_) * (image.height() / step_) > kCells) ++step_;
  width_ = image.width() / step_, height_ = image.height() / step_;
  if (width_ == 0 || height_ == 0) {
    width_ = height_ = 0;
    return;
  }
  read(image);
  box_mean(y_, around_y_, columns_, width_, height_);
  box_mean(u_, around_u_, columns_, width_, height_);
  box_mean(v_, around_v_, columns_, width_, height_);
  for (std::size_t k = 0; k < static_cast<std::size_t>(width_ * height_); ++k) {
    const int e = color.evidence({y_[k], u_[k], v_[k]}, {around_y_[k], around_u_[k], around_v_[k]});
    evidence_[k] = static_cast<std::int8_t>(std::clamp(e, -kLimit, kLimit));
  }
}

// Two pixels of each cell, one row of pixels after the other: the layout is asked once a row.
void EvidenceMap::read(const Image& image) {
  const int other = step_ / 2, first = (step_ - 2) / 4;
  for (int y = 0; y < height_; ++y) {
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * width_;
    std::uint8_t *to_y = y_.data() + row, *to_u = u_.data() + row, *to_v = v_.data() + row;
    const int v = y * step_ + first;
    image.visit_row(first, v, step_, width_,
                    [&](Yuv c) { *to_y++ = c.y, *to_u++ = c.u, *to_v++ = c.v; });
    to_y = y_.data() + row, to_u = u_.data() + row, to_v = v_.data() + row;
    const auto mean = [](std::uint8_t& level, std::uint8_t more) {
      level = static_cast<std::uint8_t>((level + more + 1) >> 1);
    };
    image.visit_row(first + other, v + other, step_, width_,
                    [&](Yuv c) { mean(*to_y++, c.y), mean(*to_u++, c.u), mean(*to_v++, c.v); });
  }
}

int EvidenceMap::at_pixel(const Image& image, const ColorModel& color, int u, int v) const {
  if (!image.contains(u, v) || width_ == 0) return kOutside;
  return std::clamp(color.evidence(image.at(u, v), around(u, v)), -kLimit, kLimit);
}

}  // namespace gatefly
