// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/evidence_map.hpp"

#include <algorithm>
#include <limits>

namespace gatefly {
namespace {

constexpr int kRadius = 5;  // cells: 22 px at 2 px a cell [a study on labelled pictures]
static_assert((2 * kRadius + 1) * 255 <= std::numeric_limits<std::uint16_t>::max(),
              "a column's sum fits");
static_assert(EvidenceMap::kLimit <= std::numeric_limits<std::int8_t>::max());

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
    std::uint32_t sum = 0;
    int count = 0;
    for (int x = 0; x < std::min(width, kRadius); ++x)
      sum += columns[static_cast<std::size_t>(x)], ++count;
    std::uint8_t* out = row(to, y);
    std::uint32_t scale = 0;
    int scale_of = -1;
    for (int x = 0; x < width; ++x) {
      if (x + kRadius < width) sum += columns[static_cast<std::size_t>(x + kRadius)], ++count;
      if (x - kRadius - 1 >= 0) sum -= columns[static_cast<std::size_t>(x - kRadius - 1)], --count;
      if (count != scale_of)
        scale_of = count, scale = (1u << 16) / static_cast<std::uint32_t>(count * rows);
      out[x] = static_cast<std::uint8_t>((sum * scale + (1u << 15)) >> 16);
    }
  }
}

}  // namespace

EvidenceMap::EvidenceMap() {
  for (auto* cells : {&y_, &u_, &v_, &around_y_, &around_u_, &around_v_}) cells->resize(kCells);
  columns_.resize(kCells);
  evidence_.resize(kCells);
}

void EvidenceMap::fill(const Image& image, const PictureColor& color) {
  // Two pixels a cell at least, and as many as it takes.
  step_ = 2;
  while ((image.width() / step_) * (image.height() / step_) > kCells) ++step_;
  width_ = image.width() / step_, height_ = image.height() / step_;
  if (width_ == 0 || height_ == 0) {
    width_ = height_ = 0;
    return;
  }
  const int other = step_ / 2, first = (step_ - 2) / 4;
  std::size_t i = 0;
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x, ++i) {
      const int u = x * step_ + first, v = y * step_ + first;
      const Yuv a = image.at(u, v), b = image.at(u + other, v + other);
      y_[i] = static_cast<std::uint8_t>((a.y + b.y + 1) >> 1);
      u_[i] = static_cast<std::uint8_t>((a.u + b.u + 1) >> 1);
      v_[i] = static_cast<std::uint8_t>((a.v + b.v + 1) >> 1);
    }
  box_mean(y_, around_y_, columns_, width_, height_);
  box_mean(u_, around_u_, columns_, width_, height_);
  box_mean(v_, around_v_, columns_, width_, height_);
  for (std::size_t k = 0; k < i; ++k) {
    const int e = color.evidence({y_[k], u_[k], v_[k]}, {around_y_[k], around_u_[k], around_v_[k]});
    evidence_[k] = static_cast<std::int8_t>(std::clamp(e, -kLimit, kLimit));
  }
}

int EvidenceMap::at_pixel(const Image& image, const PictureColor& color, int u, int v) const {
  if (!image.contains(u, v) || width_ == 0) return kOutside;
  return std::clamp(color.evidence(image.at(u, v), around(u, v)), -kLimit, kLimit);
}

}  // namespace gatefly
