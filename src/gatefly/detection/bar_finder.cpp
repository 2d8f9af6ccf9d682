// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/bar_finder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gatefly {
namespace {

constexpr int kLimit = EvidenceMap::kLimit;
constexpr int kBar = 6;           // evidence of a sample on a bar
constexpr int kStrongest = 60;    // evidence of a crossing that counts
constexpr int kLeast = 3;         // rows of a bar
constexpr int kLeastToBend = 6;   // rows of a bar whose bend is looked at

}  // namespace

/// A bar so far, in samples and rows.
struct BarFinder::Snake {
  float x = 0.0f, slope = 0.0f;  ///< At the last row; samples a row.
  int first = 0, last = 0, count = 0, strength = 0;
  float sum_x = 0.0f, sum_xy = 0.0f;  ///< With rows from the first on.
  int sum_y = 0, sum_yy = 0, sum_yyy = 0, sum_yyyy = 0, width = 0;
  double sum_xyy = 0.0;

  void cross(float at, int row, int evidence, int wide) {
    const int rows = row - last;
    if (count == 1) slope = (at - x) / static_cast<float>(rows);
    if (count > 1) slope += 0.5f * ((at - x) / static_cast<float>(rows) - slope);
    const int y = row - first;
    sum_x += at, sum_xy += at * static_cast<float>(y), sum_y += y, sum_yy += y * y;
    sum_xyy += static_cast<double>(at) * (y * y), sum_yyy += y * y * y, sum_yyyy += y * y * y * y, width += wide;
    x = at, last = row, ++count, strength += evidence;
  }
};

// The sums of groups, and which of them may hold a bar.
void BarFinder::read(const Image& image, const ColorModel& color) {
  step_ = std::max({1, (image.width() + kMostColumns - 1) / kMostColumns, (image.height() + kGroup * kMostRows - 1) / (kGroup * kMostRows)});
  stride_ = kGroup * step_;
  per_stride_ = (std::uint64_t{1} << 32) / static_cast<std::uint64_t>(stride_) + 1;
  groups_ = image.width() / stride_, rows_ = image.height() / stride_;
  for (int r = 0; r < rows_; ++r) {
    const auto row = static_cast<std::size_t>(r * kMostGroups);
    std::uint16_t *const y = sums_[0].data() + row, *const u = sums_[1].data() + row, *const v = sums_[2].data() + row;
    std::uint64_t hopeless = 0;
    int g = 0;
    image.visit_row_packed<kGroup>(first_column(), row_px(r), step_, groups_, [&](const std::array<PackedYuv, kGroup>& c) {
      // Two samples say what a group's mean is.
      const std::uint32_t uv = c[0].uv + c[2].uv;
      y[g] = static_cast<std::uint16_t>(c[0].y + c[2].y);
      u[g] = static_cast<std::uint16_t>(uv), v[g] = static_cast<std::uint16_t>(uv >> 16);
      const auto is_hopeless = [&](std::size_t k) { return color.hopeless[ColorModel::chroma_bin(c[k])]; };
      hopeless |= std::uint64_t{static_cast<std::uint8_t>(is_hopeless(0) & is_hopeless(1) & is_hopeless(2) & is_hopeless(3))} << g++;
    });
    hopeful_[static_cast<std::size_t>(r)] = ~hopeless & ((std::uint64_t{1} << groups_) - 1);
  }
}

// Mean of the groups around each; what is beyond the border is as at the border. One group more to the right and below:
// pixels that make no whole group are asked for, too.
void BarFinder::average_around() {
  constexpr int kMostReach = 4;
  const int groups = groups_, rows = rows_, reach = reach_, side = 2 * reach + 1;
  const auto per_sum = static_cast<std::uint16_t>(65536 / (side * side * 2) + 1);
  // Sums down each column, and what is beyond the border on either side. Loops of one length, which the compiler takes
  // eight at a time; what is right of the picture does no harm.
  alignas(16) std::array<std::uint16_t, kMostGroups + 2 * kMostReach + 1> column{};
  std::array<std::uint16_t, kMostGroups> around;
  std::uint16_t* const inner = column.data() + kMostReach;
  const auto each = [](const auto& visit) {
    for (std::size_t g = 0; g < kMostGroups; ++g) visit(g);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const auto row_at = [&](int i) { return sums_[k].data() + std::clamp(i, 0, rows - 1) * kMostGroups; };
    each([&](std::size_t g) { inner[g] = 0; });
    for (int i = -reach - 1; i < reach; ++i) {
      const std::uint16_t* const row = row_at(i);
      each([&](std::size_t g) { inner[g] = static_cast<std::uint16_t>(inner[g] + row[g]); });
    }
    for (int r = 0; r < std::min(rows + 1, kMostRows); ++r) {
      const std::uint16_t *const enters = row_at(r + reach), *const leaves = row_at(r - reach - 1);
      each([&](std::size_t g) { inner[g] = static_cast<std::uint16_t>(inner[g] + enters[g] - leaves[g]); });
      for (int i = 1; i <= reach; ++i) inner[-i] = inner[0];
      for (int i = 0; i <= reach; ++i) inner[groups + i] = inner[groups - 1];
      const std::uint16_t *left = inner - 1, *right = inner + 1;
      each([&](std::size_t g) { around[g] = static_cast<std::uint16_t>(inner[g] + left[g] + right[g]); });
      for (int i = 1; i < reach; ++i) {
        --left, ++right;
        each([&](std::size_t g) { around[g] = static_cast<std::uint16_t>(around[g] + left[g] + right[g]); });
      }
      std::uint8_t* const out = around_[k].data() + r * kMostGroups;
      each([&](std::size_t g) { out[g] = static_cast<std::uint8_t>((std::uint32_t{around[g]} * per_sum) >> 16); });
    }
  }
}

Bar BarFinder::bar_of(const Snake& s) const {
  const double n = s.count, n_y = s.sum_y, spread = n * s.sum_yy - n_y * n_y;  // three rows or more: not zero
  const double slope = (n * s.sum_xy - s.sum_x * n_y) / spread, x = (s.sum_x - slope * n_y) / n;
  // Samples and rows to pixels.
  Bar bar{.slope = slope / kGroup, .top = s.first * stride_ + 0.5 * (stride_ - 1), .bottom = s.last * stride_ + 0.5 * (stride_ - 1),
          .strength = static_cast<double>(s.strength)};
  bar.at_0 = (x + 0.5) * step_ - 0.5 - bar.slope * bar.top;
  bar.width = static_cast<double>(s.width) / n * step_;
  bar.curve = {bar.at_0, bar.slope, 0.0};
  if (s.count < kLeastToBend) return bar;
  // What is left of y² beside a line, a + b y, is what a bend looks like.
  const double n_yy = s.sum_yy, n_yyy = s.sum_yyy;
  const double b = (n * n_yyy - n_y * n_yy) / spread, a = (n_yy - b * n_y) / n;
  const double bend = (s.sum_xyy - a * s.sum_x - b * s.sum_xy) / (s.sum_yyyy - a * n_yy - b * n_yyy) * step_;  // px / row²
  const double row = stride_, top = bar.top;
  bar.curve += bend * Eigen::Vector3d{top * top / (row * row) + b * top / row - a, -2.0 * top / (row * row) - b / row, 1.0 / (row * row)};
  return bar;
}

// Where a row crosses something of a bar's colour and width.
template <class Visit>
void BarFinder::each_crossing(const Image& image, const ColorModel& color, int row, const Visit& visit) const {
  const int v = row_px(row), first = first_column(), step = step_;
  int start = 0, sum = 0, moment = 0, end = 0;  // of the present crossing; none while sum is 0
  const auto finish = [&] {
    if (sum == 0) return;
    if (end - start <= widest_) visit(static_cast<float>(start) + static_cast<float>(moment) / static_cast<float>(sum), std::min(sum, kStrongest), end - start);
    sum = moment = 0;
  };
  int next = 0;
  for (std::uint64_t hopeful = hopeful_[static_cast<std::size_t>(row)]; hopeful != 0; hopeful &= hopeful - 1) {
    const int g = std::countr_zero(hopeful);
    if (g != next) finish();
    next = g + 1;
    const Yuv mean = around(static_cast<std::size_t>(row * kMostGroups + g));
    image.visit_row_packed<kGroup>(g * kGroup * step + first, v, step, 1, [&](const std::array<PackedYuv, kGroup>& samples) {
      // Without branches, which nobody could foretell; a hopeless colour, a sample in two here, makes 0.
      std::array<int, kGroup> evidence;
      for (std::size_t k = 0; k < kGroup; ++k) {
        const Yuv sample = samples[k].unpacked();
        evidence[k] = std::min(color.evidence(sample, mean), kLimit) & -static_cast<int>(color.absolute[ColorModel::bin(sample)] >= ColorModel::kHopeless);
      }
      for (int k = 0; k < kGroup; ++k) {
        const int e = evidence[static_cast<std::size_t>(k)], c = g * kGroup + k;
        if (e < kBar) {
          finish();
          continue;
        }
        if (sum == 0) start = c;
        end = c + 1, sum += e, moment += e * (c - start);
      }
    });
  }
  finish();
}

BarFinder::Bars BarFinder::find(const Image& image, const ColorModel& color) {
  const auto weaker = [](const Bar& a, const Bar& b) { return a.strength < b.strength; };
  Bars bars;
  rows_ = groups_ = 0;
  if (image.width() < 2 * kGroup || image.height() < 2 * kGroup) return bars;
  read(image, color);
  if (rows_ == 0 || groups_ == 0) return bars;  // long and thin
  average_around();
  FixedList<Snake, 24> snakes;
  const auto finish = [&](const Snake& snake) {
    if (snake.count < kLeast) return;
    const Bar bar = bar_of(snake);
    if (bars.push_back(bar)) return;
    Bar& weakest = *std::min_element(bars.begin(), bars.end(), weaker);
    if (weaker(weakest, bar)) weakest = bar;
  };
  const auto cross = [&](float x, int row, int strength, int width) {
    Snake* mine = nullptr;
    float nearest = 1e9f;
    for (Snake& s : snakes) {
      const int rows = row - s.last;
      if (rows == 0) continue;
      const float off = std::abs(x - s.x - s.slope * static_cast<float>(rows));
      const float reach = s.count == 1 ? 4.0f * static_cast<float>(rows) : 1.5f + 0.5f * static_cast<float>(rows);  // 45 deg at first
      if (off < reach && off < nearest) nearest = off, mine = &s;
    }
    if (mine == nullptr) {
      if (!snakes.push_back({.first = row, .last = row})) return;
      mine = &snakes.back();
    }
    mine->cross(x, row, strength, width);
  };
  for (int r = 0; r < rows_; ++r) {
    each_crossing(image, color, r, [&](float x, int strength, int width) { cross(x, r, strength, width); });
    std::size_t left = 0;
    for (std::size_t i = 0; i < snakes.size(); ++i) {
      if (r - snakes[i].last < 2) snakes[left++] = snakes[i];
      else finish(snakes[i]);
    }
    while (snakes.size() > left) snakes.pop_back();
  }
  for (const Snake& snake : snakes) finish(snake);
  return bars;
}

}  // namespace gatefly
