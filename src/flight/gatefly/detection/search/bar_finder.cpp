// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/bar_finder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "gatefly/detection/search/nearest_snake.hpp"

namespace gatefly {
namespace {

constexpr int kLimit = EvidenceMap::kLimit;
constexpr int kBar = 6;          // evidence of a sample on a bar
constexpr int kStrongest = 60;   // evidence of a crossing that counts
constexpr int kLeast = 3;        // rows of a bar
constexpr int kLeastToBend = 6;  // rows of a bar whose bend is looked at

// Two samples of each group that what is around reaches.
constexpr int samples_around(int reach) { return 2 * (2 * reach + 1) * (2 * reach + 1); }

// A mean by a reciprocal that is rounded up: compilers take eight at once, of divisions none. A
// level too much at most.
constexpr std::uint16_t reciprocal_of(int samples) {
  return static_cast<std::uint16_t>((1 << 16) / samples + 1);
}
constexpr std::uint8_t mean_of(std::uint16_t sum, std::uint16_t reciprocal) {
  return static_cast<std::uint8_t>((std::uint32_t{sum} * reciprocal) >> 16);
}
constexpr bool is_mean_of_all_sums(int most_reach) {
  for (int reach = 1; reach <= most_reach; ++reach) {
    const int samples = samples_around(reach), most = 255 * samples;
    if (most > std::numeric_limits<std::uint16_t>::max()) return false;
    for (int sum = 0; sum <= most; ++sum) {
      const int mean = mean_of(static_cast<std::uint16_t>(sum), reciprocal_of(samples));
      if (mean < sum / samples || mean > std::min(sum / samples + 1, 255)) return false;
    }
  }
  return true;
}

}  // namespace

/// A bar so far, in samples and rows; what a row is compared with, in 1/64 samples.
struct BarFinder::Snake {
  int at = 0, slope = 0;  ///< At the last row; a row.
  int first = 0, last = 0, count = 0, strength = 0;
  float sum_x = 0.0f, sum_xy = 0.0f;  ///< With rows from the first on.
  int sum_y = 0, sum_yy = 0, sum_yyy = 0, sum_yyyy = 0, width = 0;
  double sum_xyy = 0.0;

  static constexpr int kOne = 64;
  static_assert(kOne * kMostColumns <= std::numeric_limits<std::int16_t>::max());
  Snake() = default;
  Snake(float x, int row) : at{static_cast<int>(kOne * x)}, first{row}, last{row - 1} {}

  void cross(float x, int row, int evidence, int wide) {
    const int now = static_cast<int>(kOne * x), moved = (now - at) >> (row - last - 1);
    slope += (moved - slope) >> static_cast<int>(count > 1);
    const int y = row - first;
    sum_x += x, sum_xy += x * static_cast<float>(y), sum_y += y, sum_yy += y * y;
    sum_xyy += static_cast<double>(x) * (y * y), sum_yyy += y * y * y, sum_yyyy += y * y * y * y,
        width += wide;
    at = now, last = row, ++count, strength += evidence;
  }
  /// Predicted place at a row.
  [[nodiscard]] std::int16_t expected(int row) const {
    return static_cast<std::int16_t>(at + slope * (row - last));
  }
  /// How far beside it may be: 45 deg at first.
  [[nodiscard]] std::int16_t reach(int row) const {
    constexpr std::array<std::array<std::int16_t, 2>, 2> kReach{
        {{4 * kOne, 8 * kOne}, {2 * kOne, 5 * kOne / 2}}};
    static_assert(8 * kOne <= kMostSnakeReach);
    return kReach[static_cast<std::size_t>(count > 1)][static_cast<std::size_t>(row - last - 1)];
  }
};

// The sums of groups, and which of them may hold a bar.
void BarFinder::read(const Image& image, const PictureColor& color) {
  step_ = std::max({1, (image.width() + kMostColumns - 1) / kMostColumns,
                    (image.height() + kGroup * kMostRows - 1) / (kGroup * kMostRows)});
  stride_ = kGroup * step_, groups_of_ = Divisor{stride_};
  groups_ = image.width() / stride_, rows_ = image.height() / stride_;
  for (int r = 0; r < rows_; ++r) {
    const auto row = static_cast<std::size_t>(r);
    std::uint16_t* const y = sums_y_[row].data() + kBeyond;
    std::uint32_t* const uv = sums_uv_[row].data() + kBeyond;
    std::uint64_t hopeless = 0;
    int g = 0;
    image.visit_row_packed<kGroup>(
        first_column(), row_px(r), step_, groups_, [&](const std::array<PackedYuv, kGroup>& c) {
          // Two samples say what a group's mean is.
          y[g] = static_cast<std::uint16_t>(c[0].y + c[2].y), uv[g] = c[0].uv + c[2].uv;
          // All four are asked: to leave off at the first is an unpredictable branch, 5 % slower.
          const auto is_hopeless = [&](std::size_t k) { return color.is_hopeless(c[k]); };
          hopeless |= std::uint64_t{static_cast<std::uint8_t>(is_hopeless(0) & is_hopeless(1) &
                                                              is_hopeless(2) & is_hopeless(3))}
                      << g++;
        });
    std::fill_n(y - kBeyond, kBeyond, y[0]), std::fill_n(y + groups_, kBeyond, y[groups_ - 1]);
    std::fill_n(uv - kBeyond, kBeyond, uv[0]), std::fill_n(uv + groups_, kBeyond, uv[groups_ - 1]);
    hopeful_[row] = ~hopeless & ((std::uint64_t{1} << groups_) - 1);
  }
}

// Mean of the groups around each; what is beyond the border is as at the border. One group more to
// the right and below: pixels that make no whole group are asked for, too. Loops of one length,
// which the compiler takes eight at a time.
template <class T>
void BarFinder::average_around(const Sums<T>& sums, std::uint8_t* around) const {
  using Row = std::array<T, kMostGroups>;
  const int rows = rows_, reach = reach_;
  static_assert(is_mean_of_all_sums(kMostReach));
  const std::uint16_t per_sum = reciprocal_of(samples_around(reach));
  const auto each = [](const auto& visit) {
    for (std::size_t g = 0; g < kMostGroups; ++g) visit(g);
  };
  std::array<Row, kMostRows> across;
  for (std::size_t r = 0; r < static_cast<std::size_t>(rows); ++r) {
    Row& sum = across[r];
    const T* const row = sums[r].data() + kBeyond;
    each([&](std::size_t g) { sum[g] = static_cast<T>((row - 1)[g] + row[g] + (row + 1)[g]); });
    for (int i = 2; i <= reach; ++i)
      each([&](std::size_t g) { sum[g] = static_cast<T>(sum[g] + (row - i)[g] + (row + i)[g]); });
  }
  const auto row_at = [&](int r) -> const Row& {
    return across[static_cast<std::size_t>(std::clamp(r, 0, rows - 1))];
  };
  Row sum{};
  for (int i = -reach - 1; i < reach; ++i) {
    const Row& row = row_at(i);
    each([&](std::size_t g) { sum[g] = static_cast<T>(sum[g] + row[g]); });
  }
  // both chromas of a group in one sum
  constexpr std::size_t kNumbers = sizeof(Row) / sizeof(std::uint16_t);
  std::array<std::uint16_t, kNumbers> numbers;
  for (int r = 0; r < std::min(rows + 1, kMostRows); ++r, around += kNumbers) {
    const Row &enters = row_at(r + reach), &leaves = row_at(r - reach - 1);
    each([&](std::size_t g) { sum[g] = static_cast<T>(sum[g] + enters[g] - leaves[g]); });
    std::memcpy(numbers.data(), sum.data(), sizeof sum);
    for (std::size_t k = 0; k < kNumbers; ++k) around[k] = mean_of(numbers[k], per_sum);
  }
}

// The mean of all groups, around each.
void BarFinder::average_everywhere() {
  std::array<std::uint64_t, 3> sum{};
  for (std::size_t r = 0; r < static_cast<std::size_t>(rows_); ++r)
    for (std::size_t g = kBeyond; g < kBeyond + static_cast<std::size_t>(groups_); ++g)
      sum[0] += sums_y_[r][g], sum[1] += sums_uv_[r][g] & 0xffff, sum[2] += sums_uv_[r][g] >> 16;
  const auto mean = [&](std::size_t color) {
    return static_cast<std::uint8_t>(sum[color] /
                                     (2 * static_cast<std::uint64_t>(rows_ * groups_)));
  };
  around_y_.fill(mean(0));
  for (std::size_t k = 0; k < around_uv_.size(); k += 2)
    around_uv_[k] = mean(1), around_uv_[k + 1] = mean(2);
}

Bar BarFinder::bar_of(const Snake& s) const {
  // three rows or more: not zero
  const double n = s.count, n_y = s.sum_y, spread = n * s.sum_yy - n_y * n_y;
  const double slope = (n * s.sum_xy - s.sum_x * n_y) / spread, x = (s.sum_x - slope * n_y) / n;
  // Samples and rows to pixels.
  Bar bar{.slope = slope / kGroup,
          .top = s.first * stride_ + 0.5 * (stride_ - 1),
          .bottom = s.last * stride_ + 0.5 * (stride_ - 1),
          .strength = static_cast<double>(s.strength)};
  bar.at_0 = (x + 0.5) * step_ - 0.5 - bar.slope * bar.top;
  bar.width = static_cast<double>(s.width) / n * step_;
  bar.curve = {bar.at_0, bar.slope, 0.0};
  if (s.count < kLeastToBend) return bar;
  // The rest of y² beside a line, a + b y, shows the bend.
  const double n_yy = s.sum_yy, n_yyy = s.sum_yyy;
  const double b = (n * n_yyy - n_y * n_yy) / spread, a = (n_yy - b * n_y) / n;
  // px / row²
  const double bend =
      (s.sum_xyy - a * s.sum_x - b * s.sum_xy) / (s.sum_yyyy - a * n_yy - b * n_yyy) * step_;
  const double row = stride_, top = bar.top;
  bar.curve += bend * Eigen::Vector3d{top * top / (row * row) + b * top / row - a,
                                      -2.0 * top / (row * row) - b / row, 1.0 / (row * row)};
  return bar;
}

// Finds crossings of a row with something of a bar's colour and width. A branch for each sample
// would be an unpredictable one: edges are written without (8 % of the fast search).
template <class Visit>
void BarFinder::each_crossing(const Image& image, const PictureColor& color, int row,
                              const Visit& visit) {
  const int v = row_px(row), first = first_column(), step = step_;
  // samples where what shows a bar begins or has ended, in turns
  std::array<std::uint8_t, kMostColumns + 2> edges;
  static_assert(kMostColumns <= std::numeric_limits<std::uint8_t>::max());
  std::size_t count = 0;
  unsigned before = 0;  // whether the sample before shows one
  const auto edge = [&](int c, unsigned shows) {
    edges[count] = static_cast<std::uint8_t>(c), count += shows ^ before, before = shows;
  };
  int next = 0;
  // At most 64 times, once a bit.
  for (std::uint64_t hopeful = hopeful_[static_cast<std::size_t>(row)]; hopeful != 0;
       hopeful &= hopeful - 1) {
    const int g = std::countr_zero(hopeful);
    int c = g * kGroup;
    edge(next, before & static_cast<unsigned>(c == next));
    const Yuv mean = around(static_cast<std::size_t>(row * kMostGroups + g));
    image.visit_row(c * step + first, v, step, kGroup, [&](Yuv sample) {
      const int alone = color.absolute(sample), both = alone + color.relative(sample, mean);
      twice_[static_cast<std::size_t>(c)] = static_cast<std::int16_t>(both);
      edge(c++, static_cast<unsigned>(both >= 2 * kBar) &
                    static_cast<unsigned>(alone >= ColorModel::kHopeless));
    });
    next = c;
  }
  edge(next, 0);
  for (std::size_t i = 0; i < count; i += 2) {
    const int start = edges[i], end = edges[i + 1];
    if (end - start > widest_) continue;
    int sum = 0, moment = 0;
    for (int k = 0; k < end - start; ++k) {
      const int e = std::min(twice_[static_cast<std::size_t>(start + k)] / 2, kLimit);
      sum += e, moment += e * k;
    }
    visit(static_cast<float>(start) + static_cast<float>(moment) / static_cast<float>(sum),
          std::min(sum, kStrongest), end - start);
  }
}

const BarFinder::Bars& BarFinder::find(const Image& image, const PictureColor& color) {
  const auto weaker = [](const Bar& a, const Bar& b) { return a.strength < b.strength; };
  bars_.clear();
  rows_ = groups_ = 0;
  if (image.width() < 2 * kGroup || image.height() < 2 * kGroup) return bars_;
  read(image, color);
  if (rows_ == 0 || groups_ == 0) return bars_;  // long and thin
  if (reach_ == kWholePicture) {
    average_everywhere();
  } else {
    average_around(sums_y_, around_y_.data());
    average_around(sums_uv_, around_uv_.data());
  }
  FixedList<Snake, kMostSnakes> snakes;
  // of each in the present row; where there is no snake, no reach
  std::array<std::int16_t, kMostSnakes> expected{}, reach{};
  const auto finish = [&](const Snake& snake) {
    if (snake.count < kLeast) return;
    const Bar bar = bar_of(snake);
    if (bars_.push_back(bar)) return;
    Bar& weakest = *std::min_element(bars_.begin(), bars_.end(), weaker);
    if (weaker(weakest, bar)) weakest = bar;
  };
  const auto cross = [&](float x, int row, int strength, int width) {
    const std::size_t nearest =
        nearest_snake(expected, reach, static_cast<std::int16_t>(Snake::kOne * x));
    const std::size_t mine = std::min(nearest, snakes.size());
    if (mine == snakes.size() && !snakes.push_back(Snake{x, row})) return;
    snakes[mine].cross(x, row, strength, width);
    reach[mine] = 0;  // once a row
  };
  for (int r = 0; r < rows_; ++r) {
    each_crossing(image, color, r,
                  [&](float x, int strength, int width) { cross(x, r, strength, width); });
    for (std::size_t i = 0; i < snakes.size(); ++i) {
      // At most once a snake: each time one of them is done.
      while (i < snakes.size() && r - snakes[i].last >= 2) {
        finish(snakes[i]);
        snakes[i] = snakes.back();
        snakes.pop_back();
        reach[snakes.size()] = 0;
      }
      if (i == snakes.size()) break;
      expected[i] = snakes[i].expected(r + 1), reach[i] = snakes[i].reach(r + 1);
    }
  }
  for (const Snake& snake : snakes) finish(snake);
  return bars_;
}

}  // namespace gatefly
