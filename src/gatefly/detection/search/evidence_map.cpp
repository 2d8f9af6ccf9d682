// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/evidence_map.hpp"

#include <algorithm>
#include <limits>

namespace gatefly {
namespace {

// What is around a cell, to each side, of the picture's shorter side: 22 px in all at 315 x 160 [a
// study on labelled pictures]
constexpr int kShorterPerRadius = 16;
constexpr int kLeastRadius = 5, kMostRadius = 100;  // cells
static_assert((2 * kMostRadius + 1) * 255 <= std::numeric_limits<std::uint16_t>::max(),
              "a column's sum fits");
static_assert(EvidenceMap::kLimit <= std::numeric_limits<std::int8_t>::max());

// Mean over a square of (2 radius + 1)² cells, smaller at the border.
void box_mean(const std::vector<std::uint8_t>& from, std::vector<std::uint8_t>& to,
              std::vector<std::uint16_t>& columns, int width, int height, int radius) {
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
  for (int y = 0; y < std::min(height, radius); ++y) add_row(y), ++rows;
  for (int y = 0; y < height; ++y) {
    if (y + radius < height) add_row(y + radius), ++rows;
    if (y - radius - 1 >= 0) drop_row(y - radius - 1), --rows;
    std::uint32_t sum = 0;
    int count = 0;
    for (int x = 0; x < std::min(width, radius); ++x)
      sum += columns[static_cast<std::size_t>(x)], ++count;
    std::uint8_t* out = row(to, y);
    constexpr int kBits = 24;
    std::uint64_t scale = 0;
    int scale_of = -1;
    for (int x = 0; x < width; ++x) {
      if (x + radius < width) sum += columns[static_cast<std::size_t>(x + radius)], ++count;
      if (x - radius - 1 >= 0) sum -= columns[static_cast<std::size_t>(x - radius - 1)], --count;
      if (count != scale_of)
        scale_of = count, scale = (1u << kBits) / static_cast<std::uint32_t>(count * rows);
      out[x] = static_cast<std::uint8_t>((sum * scale + (1u << (kBits - 1))) >> kBits);
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
  const int radius =
      std::clamp(std::min(width_, height_) / kShorterPerRadius, kLeastRadius, kMostRadius);
  box_mean(y_, around_y_, columns_, width_, height_, radius);
  box_mean(u_, around_u_, columns_, width_, height_, radius);
  box_mean(v_, around_v_, columns_, width_, height_, radius);
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
