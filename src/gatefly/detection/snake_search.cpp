// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/snake_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "gatefly/detection/evidence_map.hpp"
#include "gatefly/detection/frame_fit.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {
namespace {

constexpr int kGroup = 4;                        // samples of a row whose mean is taken; rows are as many samples apart
constexpr int kMostColumns = 160, kMostRows = 40;
constexpr int kLimit = EvidenceMap::kLimit, kOutside = EvidenceMap::kOutside;
constexpr int kBar = 6;                          // evidence of a sample on a bar
constexpr int kHopeless = -16;                   // of a colour alone: no bar, whatever is around
constexpr int kWidest = 5;                       // samples; what is wider is no upright bar
constexpr double kLeastShared = 0.2;             // of two bars' heights: either may be broken
constexpr int kStrongest = 60;                   // evidence of a crossing that counts
constexpr double kGain = 1.0;                    // of score when a frame is centred, at most
constexpr FrameEffort kEffort{.samples = 12, .stations = 8, .middles = 12};

}  // namespace

/// A bar so far, in samples and rows.
struct SnakeSearch::Snake {
  float x = 0.0f, slope = 0.0f;  ///< At the last row; samples a row.
  int first = 0, last = 0, count = 0, strength = 0;
  float sum_x = 0.0f, sum_xy = 0.0f;  ///< With rows from the first on.
  int sum_y = 0, sum_yy = 0;

  void cross(float at, int row, int evidence) {
    const int rows = row - last;
    if (count == 1) slope = (at - x) / static_cast<float>(rows);
    if (count > 1) slope += 0.5f * ((at - x) / static_cast<float>(rows) - slope);
    const int y = row - first;
    sum_x += at, sum_xy += at * static_cast<float>(y), sum_y += y, sum_yy += y * y;
    x = at, last = row, ++count, strength += evidence;
  }
};

/// Two bars, and the frame that would be square between them: levels drop by `shift` from right to left [px].
struct SnakeSearch::Pair {
  Bar left, right;
  double width = 0.0, shift = 0.0;   ///< Reach of an upright side over rows; see above.
  double top = 0.0, bottom = 0.0;    ///< Of the bars, at the middle between them.
  double worth = 0.0;

  [[nodiscard]] Eigen::Vector2d on_left(double level) const { return left.at(level + 0.5 * shift); }
  [[nodiscard]] Eigen::Vector2d on_right(double level) const { return right.at(level - 0.5 * shift); }
};

SnakeSearch::SnakeSearch(const GateSearchParams& params) : params_{params} {
  absolute_.resize(kMostColumns * kMostRows);
  for (auto& sums : sums_) sums.resize((kMostColumns / kGroup + 2) * kMostRows);
  for (auto& around : around_) around.resize(kMostColumns / kGroup * kMostRows);
}

// What each sample's colour alone says, and the sums of groups.
void SnakeSearch::read(const Image& image, const ColorModel& color) {
  step_ = std::max({1, (image.width() + kMostColumns - 1) / kMostColumns, (image.height() + kGroup * kMostRows - 1) / (kGroup * kMostRows)});
  stride_ = kGroup * step_;
  per_stride_ = 65536u / static_cast<std::uint32_t>(stride_) + 1;
  groups_ = image.width() / stride_, rows_ = image.height() / stride_;
  const int groups = groups_, width = groups + 2;  // bytes are written below: members would be read again each time
  for (int r = 0; r < rows_; ++r) {
    std::int8_t* out = absolute_.data() + r * groups * kGroup;
    std::array<std::uint16_t*, 3> sums;
    for (std::size_t k = 0; k < 3; ++k) sums[k] = sums_[k].data() + r * width;
    std::array<Yuv, kMostColumns> row;
    Yuv* next = row.data();
    image.visit_row(first_column(), row_px(r), step_, groups * kGroup, [&](Yuv c) {
      *out++ = color.absolute[ColorModel::bin(c)];
      *next++ = c;
    });
    for (int g = 0; g < groups; ++g) {
      const Yuv* const s = row.data() + g * kGroup;
      sums[0][g + 1] = static_cast<std::uint16_t>(s[0].y + s[2].y);
      sums[1][g + 1] = static_cast<std::uint16_t>(s[0].u + s[2].u);
      sums[2][g + 1] = static_cast<std::uint16_t>(s[0].v + s[2].v);
    }
    for (std::uint16_t* s : sums) s[0] = s[1], s[width - 1] = s[width - 2];
  }
}

// Mean of three by three groups; what is beyond the border is as at the border.
void SnakeSearch::average_around() {
  constexpr std::uint32_t kPerSum = 65536 / (9 * 2) + 1;
  const int groups = groups_, width = groups + 2;  // bytes are written below: members would be read again each time
  std::array<std::uint16_t, kMostColumns / kGroup + 2> three{};
  for (std::size_t k = 0; k < 3; ++k)
    for (int r = 0; r < rows_; ++r) {
      const std::uint16_t* const above = sums_[k].data() + std::max(0, r - 1) * width;
      const std::uint16_t* const here = sums_[k].data() + r * width;
      const std::uint16_t* const below = sums_[k].data() + std::min(rows_ - 1, r + 1) * width;
      for (int g = 0; g < width; ++g) three[static_cast<std::size_t>(g)] = static_cast<std::uint16_t>(above[g] + here[g] + below[g]);
      std::uint8_t* const out = around_[k].data() + r * groups;
      for (int g = 0; g < groups; ++g) {
        const auto i = static_cast<std::size_t>(g);
        const auto sum = static_cast<std::uint16_t>(three[i] + three[i + 1] + three[i + 2]);
        out[g] = static_cast<std::uint8_t>((sum * kPerSum) >> 16);
      }
    }
}

int SnakeSearch::evidence(const Image& image, const ColorModel& color, int u, int v) const {
  if (!image.contains(u, v)) return kOutside;
  const int g = std::min(static_cast<int>((static_cast<std::uint32_t>(u) * per_stride_) >> 16), groups_ - 1);
  const int r = std::min(static_cast<int>((static_cast<std::uint32_t>(v) * per_stride_) >> 16), rows_ - 1);
  return std::clamp(color.evidence(image.at(u, v), around(r * groups_ + g)), -kLimit, kLimit);
}

SnakeSearch::Bar SnakeSearch::bar_of(const Snake& s) const {
  const double n = s.count, n_y = s.sum_y, spread = n * s.sum_yy - n_y * n_y;  // three rows or more: not zero
  const double slope = (n * s.sum_xy - s.sum_x * n_y) / spread, x = (s.sum_x - slope * n_y) / n;
  // Samples and rows to pixels.
  Bar bar{.slope = slope / kGroup, .top = s.first * stride_ + 0.5 * (stride_ - 1), .bottom = s.last * stride_ + 0.5 * (stride_ - 1),
          .strength = static_cast<double>(s.strength)};
  bar.at_0 = (x + 0.5) * step_ - 0.5 - bar.slope * bar.top;
  return bar;
}

// Where a row crosses something of a bar's colour and width.
template <class Visit>
void SnakeSearch::each_crossing(const Image& image, const ColorModel& color, int row, const Visit& visit) const {
  int start = 0, sum = 0, moment = 0, end = 0;  // of the present crossing; none while sum is 0
  const auto finish = [&] {
    if (sum > 0 && end - start <= kWidest)
      visit(static_cast<float>(start) + static_cast<float>(moment) / static_cast<float>(sum), std::min(sum, kStrongest));
    sum = moment = 0;
  };
  const std::int8_t* absolute = absolute_.data() + row * groups_ * kGroup;
  for (int g = 0; g < groups_; ++g, absolute += kGroup) {
    if (std::max(std::max(absolute[0], absolute[1]), std::max(absolute[2], absolute[3])) < kHopeless) {
      finish();
      continue;
    }
    const Yuv mean = around(row * groups_ + g);
    for (int k = 0; k < kGroup; ++k) {
      const int c = g * kGroup + k;
      int e = -kLimit;
      if (absolute[k] >= kHopeless)
        e = (absolute[k] + color.relative[ColorModel::difference_bin(image.at(c * step_ + first_column(), row_px(row)), mean)]) / 2;
      if (e < kBar) {
        finish();
        continue;
      }
      if (sum == 0) start = c;
      e = std::min(e, kLimit);
      end = c + 1, sum += e, moment += e * (c - start);
    }
  }
  finish();
}

SnakeSearch::Bars SnakeSearch::follow_bars(const Image& image, const ColorModel& color) const {
  constexpr int kLeast = 3;  // rows
  const auto weaker = [](const Bar& a, const Bar& b) { return a.strength < b.strength; };
  Bars bars;
  FixedList<Snake, 24> snakes;
  const auto finish = [&](const Snake& snake) {
    if (snake.count < kLeast) return;
    const Bar bar = bar_of(snake);
    if (bars.push_back(bar)) return;
    Bar& weakest = *std::min_element(bars.begin(), bars.end(), weaker);
    if (weaker(weakest, bar)) weakest = bar;
  };
  const auto cross = [&](float x, int row, int strength) {
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
    mine->cross(x, row, strength);
  };
  for (int r = 0; r < rows_; ++r) {
    each_crossing(image, color, r, [&](float x, int strength) { cross(x, r, strength); });
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

SnakeSearch::Pairs SnakeSearch::pairs_of(const Bars& bars) const {
  const auto better = [](const Pair& a, const Pair& b) { return a.worth > b.worth; };
  Pairs pairs;
  for (const Bar& l : bars)
    for (const Bar& r : bars) {
      const double middle = 0.25 * (l.top + l.bottom + r.top + r.bottom), apart = r.x(middle) - l.x(middle);
      if (apart < params_.min_side_px || std::abs(l.slope - r.slope) > 0.35) continue;
      const double slope = 0.5 * (l.slope + r.slope);
      Pair p{.left = l, .right = r, .width = apart / (1.0 + slope * slope)};
      p.shift = slope * p.width;
      const double left_top = l.top - 0.5 * p.shift, left_bottom = l.bottom - 0.5 * p.shift;
      const double right_top = r.top + 0.5 * p.shift, right_bottom = r.bottom + 0.5 * p.shift;
      p.top = std::min(left_top, right_top), p.bottom = std::max(left_bottom, right_bottom);
      const double height = p.bottom - p.top + stride_;
      const double shared = std::min(left_bottom, right_bottom) - std::max(left_top, right_top) + stride_;
      if (shared < kLeastShared * height || p.width > 2.2 * height || p.width < 0.25 * height) continue;
      p.worth = (l.strength + r.strength) * std::max(0.2 * height, shared) / (height * (1.0 + std::abs(std::log(p.width / height))));
      if (pairs.push_back(p)) continue;
      Pair& worst = *std::max_element(pairs.begin(), pairs.end(), better);
      if (better(p, worst)) worst = p;
    }
  insertion_sort(pairs, better);
  return pairs;
}

namespace {

// The level bars of a pair: of all level lines near its upper end, a little tilted or not, the one with the most
// evidence; and near its lower end. In cells.
template <class Pair, class Fit>
std::optional<Quad> with_level_bars(const Pair& p, int step, int stride, int cell, const Fit& fit) {
  constexpr int kAcross = 6, kMostLevels = 24, kClear = 15 * kAcross;  // samples of a level; levels; evidence of a bar that leaves no doubt
  constexpr double kTilt = 0.25, kLeftOver = 192.0;  // a nat a pixel of both bars, beside a level of six samples
  const double beyond = std::max(0.6 * stride, 0.15 * p.width), within = 0.4 * (p.bottom - p.top);
  const int levels = std::min(kMostLevels, 1 + static_cast<int>((beyond + within) / step));
  struct Level {
    double left, right;
    int sum;
  };
  const auto best_level = [&](double end, double outwards) {
    Level best{end, end, -1 << 20};
    int from = 0, to = levels, best_k = 0;
    for (const double tilt : {0.0, -kTilt, kTilt}) {
      for (int k = from; k < to; ++k) {
        const double off = beyond - (beyond + within) * k / (levels - 1), level = end + outwards * off, half = 0.5 * tilt * p.width;
        // A level inside the bars' ends leaves bar over, one beyond them lacks it.
        const double gap = std::max(0.0, -off) + std::max(0.0, off - 0.5 * stride);
        const Eigen::Vector2d a = p.on_left(level - half), d = (p.on_right(level + half) - a) / kAcross;
        int sum = -static_cast<int>(kLeftOver * gap / p.width);
        for (int j = 0; j < kAcross; ++j) sum += fit.at(to_cells(a + (j + 0.5) * d, cell));
        if (sum > best.sum) best = {level - half, level + half, sum}, best_k = k;
      }
      if (best.sum >= kClear) break;
      if (tilt == 0.0) from = std::max(0, best_k - 3), to = std::min(levels, best_k + 4);
    }
    return best;
  };
  const Level upper = best_level(p.top, -1.0), lower = best_level(p.bottom, +1.0);
  if (upper.sum + lower.sum < 0) return std::nullopt;
  return to_cells(Quad{p.on_left(upper.left), p.on_right(upper.right), p.on_right(lower.right), p.on_left(lower.left)}, cell);
}

// A frame from where its sides are, roughly, to where they are; nullopt when it is no gate. In cells.
template <class Fit>
std::optional<Frame> fitted(const Fit& fit, const Quad& rough, int cell, const GateSearchParams& params) {
  const auto has_shape = [&](const std::optional<Quad>& q) { return q && is_frame_shaped(*q, params.min_side_px / cell, params.max_aspect); };
  const auto moved = fit.moved(rough, 3);
  if (!has_shape(moved)) return std::nullopt;
  Frame frame{*moved, fit.score(*moved)};
  if (frame.score.total < params.min_score - kGain) return std::nullopt;
  const double size = std::sqrt(std::abs(area(*moved)));
  const auto centered = fit.centered(*moved, std::clamp(static_cast<int>(0.07 * size + 0.5), 2, 3));
  if (has_shape(centered)) frame = {*centered, fit.score(*centered)};
  if (frame.score.total < params.min_score || frame.score.inside > params.max_inside) return std::nullopt;
  return frame;
}

}  // namespace

GateDetections SnakeSearch::detect(const Image& image, const ColorModel& color) {
  GateDetections found;
  if (image.width() < 2 * kGroup || image.height() < 2 * kGroup) return found;
  read(image, color);
  average_around();
  const int cell = std::max(1, step_ / 2);
  const auto at = [&](int x, int y) { return evidence(image, color, x * cell + cell / 2, y * cell + cell / 2); };
  FrameFit<decltype(at), kEffort> fit{at, params_.weights, params_.bar()};
  fit.set_least_offset(3.0);
  fit.set_cell_size(cell);
  FixedList<Frame, Pairs::kCapacity> frames;
  const auto in_place_of = [&](const Quad& q) { return std::find_if(frames.begin(), frames.end(), [&](const Frame& f) { return same_place(f.quad, q); }); };
  for (const Pair& pair : pairs_of(follow_bars(image, color))) {
    // Once more a frame that leaves no doubt, from other pieces of its bars: not worth the time.
    const auto known = in_place_of(to_cells(Quad{pair.on_left(pair.top), pair.on_right(pair.top), pair.on_right(pair.bottom), pair.on_left(pair.bottom)}, cell));
    if (known != frames.end() && known->score.total > params_.sure_score) continue;
    const auto rough = with_level_bars(pair, step_, stride_, cell, fit);
    if (!rough) continue;
    const auto frame = fitted(fit, *rough, cell, params_);
    if (!frame) continue;
    const auto same = in_place_of(frame->quad);
    if (same == frames.end()) (void)frames.push_back(*frame);
    else if (frame->score.total > same->score.total) *same = *frame;
  }
  insertion_sort(frames, [](const Frame& a, const Frame& b) { return a.score.total > b.score.total; });
  for (const Frame& frame : frames) (void)found.push_back(detection_of({to_pixels(frame.quad, cell), frame.score}, DetectionMethod::kSnake, image, params_.corner_scale));
  return found;
}

}  // namespace gatefly
