// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/snake_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <optional>

#include "gatefly/detection/corner_refinement.hpp"
#include "gatefly/detection/frame_fit.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {
namespace {

constexpr int kWidest = 5, kAround = 1;           // samples; what is wider is no upright bar; groups: 24 px at 315 x 160
constexpr double kLeastShared = 0.2;             // of two bars' heights: either may be broken
constexpr double kStrongBar = 100.0;             // three rows of 2 nats
constexpr int kReach = 3;                       // of the middle of a bar from a rough side [px]
constexpr double kSettled = 1.5;                // of a corner that was centred [cells]
constexpr FrameEffort kEffort{.samples = 9, .middles = 8};

}  // namespace

/// Two bars, and the frame that would be square between them: levels drop by `shift` from right to left [px].
struct SnakeSearch::Pair {
  Bar left, right;
  double width = 0.0, shift = 0.0;   ///< Reach of an upright side over rows; see above.
  double top = 0.0, bottom = 0.0;    ///< Of the bars, at the middle between them.
  double worth = 0.0;

  [[nodiscard]] Eigen::Vector2d on_left(double level) const { return left.at(level + 0.5 * shift); }
  [[nodiscard]] Eigen::Vector2d on_right(double level) const { return right.at(level - 0.5 * shift); }
};

SnakeSearch::SnakeSearch(const GateSearchParams& params) : params_{params}, finder_{kWidest, kAround} {}

SnakeSearch::Pairs SnakeSearch::pairs_of(const BarFinder::Bars& bars) const {
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
      const double height = p.bottom - p.top + finder_.stride();
      const double shared = std::min(left_bottom, right_bottom) - std::max(left_top, right_top) + finder_.stride();
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
  constexpr int kLimit = EvidenceMap::kLimit, kLeastShown = -20;
  constexpr double kTilt = 0.25, kLeftOver = 192.0;  // a nat a pixel of both bars, beside a level of six samples
  const double beyond = std::max(0.6 * stride, 0.15 * p.width), within = 0.4 * (p.bottom - p.top);
  const int levels = std::clamp(1 + static_cast<int>((beyond + within) / step), 2, kMostLevels);
  const double apart = (beyond + within) / (levels - 1);
  struct Level {
    double left, right;
    int sum;
  };
  const auto sample = [&](double left, double right, int j) {
    const Eigen::Vector2d a = p.on_left(left), b = p.on_right(right);
    return to_cells(a + (j + 0.5) / kAcross * (b - a), cell);
  };
  struct End {
    double at, outwards;
    std::array<int, kMostLevels> sums{};
    int shown = 0;
  };
  // Adds one sample of each level.
  const auto look = [&](End& end, int j) {
    const double first = end.at + end.outwards * beyond, last = end.at - end.outwards * within;
    const Eigen::Vector2d start = sample(first, first, j);
    int most = -kLimit;
    fit.each_along(start, (sample(last, last, j) - start) / (levels - 1), levels, [&](int k, int evidence) {
      most = std::max(most, evidence), end.sums[static_cast<std::size_t>(k)] += evidence;
    });
    return most;
  };
  End upper_end{p.top, -1.0}, lower_end{p.bottom, +1.0};
  if (look(upper_end, 1) + look(upper_end, 4) + look(lower_end, 1) + look(lower_end, 4) < kLeastShown) return std::nullopt;
  // The evidence of a level with what further samples add to it, no further than it can still be more than `least`.
  const auto with_samples = [&](std::initializer_list<int> samples, double left, double right, int sum, int least) {
    int most = sum + static_cast<int>(samples.size()) * kLimit;
    for (const int j : samples) {
      if (most <= least) break;
      const int e = fit.at(sample(left, right, j));
      sum += e, most += e - kLimit;
    }
    return sum;
  };
  const auto best_level = [&](const End& end) {
    const auto off = [&](int k) { return beyond - k * apart; };
    // A level inside the bars' ends leaves bar over, one beyond them lacks it.
    std::array<int, kMostLevels> sums;
    for (int k = 0; k < levels; ++k)
      sums[static_cast<std::size_t>(k)] = end.sums[static_cast<std::size_t>(k)] - static_cast<int>(kLeftOver * (std::max(0.0, -off(k)) + std::max(0.0, off(k) - 0.5 * stride)) / p.width);
    Level best{end.at, end.at, -1 << 20};
    int best_k = 0;
    const auto try_level = [&](int k) {
      const double level = end.at + end.outwards * off(k);
      const int sum = with_samples({0, 2, 3, 5}, level, level, sums[static_cast<std::size_t>(k)], best.sum);
      if (sum > best.sum) best = {level, level, sum}, best_k = k;
    };
    // The most likely one first: most others need not be looked at to the end.
    try_level(static_cast<int>(std::max_element(sums.begin(), sums.begin() + levels) - sums.begin()));
    for (int k = 0; k < levels; ++k) try_level(k);
    for (const double tilt : {-kTilt, kTilt}) {
      if (best.sum >= kClear) break;
      const double half = 0.5 * tilt * p.width;
      for (int k = std::max(0, best_k - 3); k < std::min(levels, best_k + 4); ++k) {
        const double level = end.at + end.outwards * off(k);
        const int left_over = sums[static_cast<std::size_t>(k)] - end.sums[static_cast<std::size_t>(k)];
        const int sum = with_samples({0, 1, 2, 3, 4, 5}, level - half, level + half, left_over, best.sum);
        if (sum > best.sum) best = {level - half, level + half, sum};
      }
    }
    return best;
  };
  const Level upper = best_level(upper_end), lower = best_level(lower_end);
  if (upper.sum + lower.sum < 0) return std::nullopt;
  return to_cells(Quad{p.on_left(upper.left), p.on_right(upper.right), p.on_right(lower.right), p.on_left(lower.left)}, cell);
}

// A frame from where its sides are, roughly, to where they are; nullopt when it is no gate. In cells.
template <class Fit>
std::optional<Frame> fitted(const Fit& fit, const Quad& rough, int cell, const GateSearchParams& params) {
  const auto has_shape = [&](const Quad& q) { return is_frame_shaped(q, params.min_side_px / cell, params.max_aspect); };
  if (!has_shape(rough)) return std::nullopt;
  Quad quad = rough;
  // Once more where that moves it far: what was out of reach may be in reach now.
  for (int pass = 0; pass < 2; ++pass) {
    const auto centered = fit.centered(quad, kReach);
    if (!centered || !has_shape(*centered)) break;
    const double moved = largest_move(quad, *centered);
    quad = *centered;
    if (moved < kSettled) break;
  }
  const Frame frame{quad, fit.score(quad)};
  if (frame.score.total < params.min_score || frame.score.inside > params.max_inside) return std::nullopt;
  return frame;
}

}  // namespace

GateDetections SnakeSearch::detect(const Image& image, const ColorModel& color) {
  GateDetections found;
  bars_ = finder_.find(image, color);
  if (bars_.empty()) return found;
  const int cell = std::max(1, finder_.step() / 2);
  const auto at = [&](int x, int y) { return finder_.evidence(image, color, x * cell + cell / 2, y * cell + cell / 2); };
  FrameFit<decltype(at), kEffort> fit{at, params_.weights, params_.bar()};
  fit.set_least_offset(3.0);
  fit.set_cell_size(cell);
  FixedList<Frame, Pairs::kCapacity> frames;
  const auto in_place_of = [&](const Quad& q) { return std::find_if(frames.begin(), frames.end(), [&](const Frame& f) { return same_place(f.quad, q); }); };
  for (const Pair& pair : pairs_of(bars_)) {
    // Once more a frame that leaves no doubt, from other pieces of its bars: not worth the time.
    const auto known = in_place_of(to_cells(Quad{pair.on_left(pair.top), pair.on_right(pair.top), pair.on_right(pair.bottom), pair.on_left(pair.bottom)}, cell));
    if (known != frames.end() && known->score.total > params_.sure_score) continue;
    const auto rough = with_level_bars(pair, finder_.step(), finder_.stride(), cell, fit);
    if (!rough) continue;
    const auto frame = fitted(fit, *rough, cell, params_);
    if (!frame) continue;
    const auto same = in_place_of(frame->quad);
    if (same == frames.end()) (void)frames.push_back(*frame);
    else if (frame->score.total > same->score.total) *same = *frame;
  }
  insertion_sort(frames, [](const Frame& a, const Frame& b) { return a.score.total > b.score.total; });
  for (const Frame& frame : frames) {
    const Quad corners = refined_corners(image, to_pixels(frame.quad, cell), params_.bar(), RefinementEffort::kQuick);
    (void)found.push_back(detection_of({corners, frame.score}, DetectionMethod::kSnake, image, params_.corner_scale));
  }
  return found;
}

bool SnakeSearch::shows_bars_beside(const GateDetections& gates) const {
  return std::any_of(bars_.begin(), bars_.end(), [&](const Bar& bar) {
    if (bar.strength < kStrongBar) return false;
    const double u = bar.x(0.5 * (bar.top + bar.bottom));
    return std::none_of(gates.begin(), gates.end(), [&](const GateDetection& gate) {
      const auto [first, last] = std::minmax_element(gate.corners_px.begin(), gate.corners_px.end(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
      return u > first->x() - finder_.stride() && u < last->x() + finder_.stride();
    });
  });
}

}  // namespace gatefly
