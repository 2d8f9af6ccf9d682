// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/snake_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <optional>

#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/search/corner_refinement.hpp"
#include "gatefly/detection/search/filled_frame.hpp"
#include "gatefly/detection/search/frame_fit.hpp"
#include "gatefly/detection/search/frame_pull.hpp"
#include "gatefly/detection/search/meant_detection.hpp"
#include "gatefly/geometry/exponential.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {
namespace {

// samples; what is wider is no upright bar; groups: 24 px at 315 x 160
constexpr int kWidest = 5, kAround = 1;
constexpr double kLeastShared = 0.2;  // of two bars' heights: either may be broken
constexpr double kStrongBar = 100.0;  // three rows of 2 nats
constexpr double kNoDoubt = 1.5;      // above what is sure [nats]
constexpr int kReach = 3;             // of the middle of a bar from a rough side [px]
constexpr FrameEffort kEffort{.samples = 8, .middles = 8};

// Limits for a gate that is expected: a score so much lower is enough [nats]; no corner is farther
// off, of the side; its area by which factor.
constexpr double kExpectedLacks = 0.7, kExpectedWithin = 0.4, kExpectedLarger = 1.6;
constexpr FrameEffort kNearEffort{.samples = 12, .stations = 8, .middles = 12};

}  // namespace

namespace {

/// How far a bent bar is beside the line that was fitted to it.
struct Bow {
  double top = 0.0, length = 1.0, sag = 0.0;

  Bow() = default;
  Bow(const Bar& bar, const SideCurves& curves)
      : top{bar.top},
        length{bar.length()},
        // along the row
        sag{curves.sag(bar.at(bar.top), bar.at(bar.bottom)).x() * (1.0 + bar.slope * bar.slope)} {}
  /// At a row. The line that fits a parabola best is two thirds of the sag beside its chord.
  [[nodiscard]] double x(double y) const {
    const double t = std::clamp((y - top) / length, -1.0, 2.0);
    return (4.0 * t * (1.0 - t) - 2.0 / 3.0) * sag;
  }
};

}  // namespace

/// Two bars, and the frame that would be square between them: levels drop by `shift` from right to
/// left [px].
struct SnakeSearch::Pair {
  Bar left, right;
  double width = 0.0, shift = 0.0;  ///< Reach of an upright side over rows; see above.
  double top = 0.0, bottom = 0.0;   ///< Ends of the bars, midway between them.
  double worth = 0.0;
  Bow left_bow{}, right_bow{};

  [[nodiscard]] Eigen::Vector2d on_left(double level) const {
    return on(left, left_bow, level + 0.5 * shift);
  }
  [[nodiscard]] Eigen::Vector2d on_right(double level) const {
    return on(right, right_bow, level - 0.5 * shift);
  }
  void bend(const SideCurves& curves) { left_bow = {left, curves}, right_bow = {right, curves}; }

 private:
  [[nodiscard]] static Eigen::Vector2d on(const Bar& bar, const Bow& bow, double y) {
    Eigen::Vector2d p = bar.at(y);
    if (bow.sag != 0.0) p.x() += bow.x(y);
    return p;
  }
};

SnakeSearch::SnakeSearch(const GateDetectorParams& params)
    : params_{params}, finder_{kWidest, kAround}, bend_{params.lens} {}

SnakeSearch::Pairs SnakeSearch::pairs_of(const BarFinder::Bars& bars) const {
  const auto better = [](const Pair& a, const Pair& b) { return a.worth > b.worth; };
  Pairs pairs;
  for (const Bar& l : bars)
    for (const Bar& r : bars) {
      const double middle = 0.25 * (l.top + l.bottom + r.top + r.bottom),
                   apart = r.x(middle) - l.x(middle);
      if (apart < params_.min_side_px || std::abs(l.slope - r.slope) > 0.35) continue;
      const double slope = 0.5 * (l.slope + r.slope);
      Pair p{.left = l, .right = r, .width = apart / (1.0 + slope * slope)};
      p.shift = slope * p.width;
      const double left_top = l.top - 0.5 * p.shift, left_bottom = l.bottom - 0.5 * p.shift;
      const double right_top = r.top + 0.5 * p.shift, right_bottom = r.bottom + 0.5 * p.shift;
      p.top = std::min(left_top, right_top), p.bottom = std::max(left_bottom, right_bottom);
      const double height = p.bottom - p.top + finder_.stride();
      const double shared =
          std::min(left_bottom, right_bottom) - std::max(left_top, right_top) + finder_.stride();
      if (shared < kLeastShared * height || p.width > 2.2 * height || p.width < 0.25 * height)
        continue;
      p.worth = (l.strength + r.strength) * std::max(0.2 * height, shared) /
                (height * (1.0 + std::abs(gatefly::log(p.width / height))));
      if (pairs.push_back(p)) continue;
      Pair& worst = *std::max_element(pairs.begin(), pairs.end(), better);
      if (better(p, worst)) worst = p;
    }
  insertion_sort(pairs, better);
  return pairs;
}

namespace {

/// The level bars of a pair: of all level lines near its upper end, a little tilted or not, the one
/// with the most evidence; and near its lower end. A level is six samples from bar to bar.
template <class Pair, class Fit>
class LevelBars {
 public:
  /// @param curves  in pixels.
  LevelBars(const Pair& pair, int step, int stride, int cell, const Fit& fit,
            const SideCurves& curves)
      : pair_{pair},
        fit_{fit},
        curves_{curves},
        cell_{cell},
        beyond_{std::max(0.9 * stride, 0.15 * pair.width)},
        next_row_{static_cast<double>(stride)} {
    const double range = beyond_ + 0.4 * (pair.bottom - pair.top);
    levels_ = std::clamp(1 + static_cast<int>(range / step), 2, kMostLevels);
    apart_ = range / (levels_ - 1);
  }

  /// The frame, roughly, in cells; nullopt where none shows.
  [[nodiscard]] std::optional<Quad> frame() const {
    End upper{pair_.top, -1.0}, lower{pair_.bottom, +1.0};
    if (curves_.bent()) bend(upper), bend(lower);
    // Most pairs are no gate: two samples of six show it.
    if (look(upper, 1) + look(upper, 4) + look(lower, 1) + look(lower, 4) < kLeastShown)
      return std::nullopt;
    const Level above = best_level(upper), below = best_level(lower);
    if (above.sum + below.sum < 0) return std::nullopt;
    return to_cells(Quad{pair_.on_left(above.left), pair_.on_right(above.right),
                         pair_.on_right(below.right), pair_.on_left(below.left)},
                    cell_);
  }

 private:
  static constexpr int kAcross = 6, kMostLevels = 24, kLimit = EvidenceMap::kLimit;
  static constexpr int kClear = 15 * kAcross;  // evidence of a bar that leaves no doubt
  static constexpr int kLeastShown = -20;      // of the best sample in each of four columns
  static constexpr double kTilt = 0.25;
  // a nat a pixel of both bars, beside a level of six samples
  static constexpr double kLeftOver = 192.0;

  struct Level {
    double left, right;  // where it meets the bars
    int sum;
  };
  struct End {
    double at, outwards;
    // of the outermost level, and how it changes with the levels inwards
    Eigen::Vector2d sag{0, 0}, sag_change{0, 0};
    // of the samples looked at so far, from the outermost level on
    std::array<int, kMostLevels> sums{};
  };

  [[nodiscard]] double level(const End& end, int k) const {
    return end.at + end.outwards * (beyond_ - k * apart_);
  }
  void bend(End& end) const {
    const auto sag = [&](int k) {
      return curves_.sag(pair_.on_left(level(end, k)), pair_.on_right(level(end, k)));
    };
    end.sag = sag(0), end.sag_change = (sag(levels_ - 1) - end.sag) / (levels_ - 1);
  }
  [[nodiscard]] Eigen::Vector2d sample(const End& end, double left, double right, int j) const {
    const Eigen::Vector2d a = pair_.on_left(left), b = pair_.on_right(right);
    const double t = (j + 0.5) / kAcross;
    Eigen::Vector2d p = a + t * (b - a);
    if (curves_.bent()) {
      const double k = (beyond_ - end.outwards * (0.5 * (left + right) - end.at)) / apart_;
      p += 4.0 * t * (1.0 - t) * (end.sag + k * end.sag_change);
    }
    return to_cells(p, cell_);
  }

  // Adds one sample of each level; the most that any shows.
  int look(End& end, int j) const {
    const double first = level(end, 0), last = level(end, levels_ - 1);
    const Eigen::Vector2d start = sample(end, first, first, j);
    int most = -kLimit;
    fit_.each_along(start, (sample(end, last, last, j) - start) / (levels_ - 1), levels_,
                    [&](int k, int evidence) {
                      most = std::max(most, evidence),
                      end.sums[static_cast<std::size_t>(k)] += evidence;
                    });
    return most;
  }

  // A level inside the bars' ends leaves bar over, one beyond the next row lacks it.
  [[nodiscard]] int left_over(int k) const {
    const double off = beyond_ - k * apart_;
    return static_cast<int>(kLeftOver * (std::max(0.0, -off) + std::max(0.0, off - next_row_)) /
                            pair_.width);
  }

  // Adds samples to a level, if it becomes better than the best: no further than it still can.
  void improve(Level& best, const End& end, double left, double right, int sum,
               std::initializer_list<int> samples) const {
    int most = sum + static_cast<int>(samples.size()) * kLimit;
    if (most <= best.sum) return;
    const Eigen::Vector2d first = sample(end, left, right, 0),
                          apart = (sample(end, left, right, kAcross - 1) - first) / (kAcross - 1);
    for (const int j : samples) {
      if (most <= best.sum) return;
      most += fit_.at(curves_.bent() ? sample(end, left, right, j) : first + j * apart) - kLimit;
    }
    if (most > best.sum) best = {left, right, most};
  }

  [[nodiscard]] Level best_level(const End& end) const {
    std::array<int, kMostLevels> so_far;
    for (int k = 0; k < levels_; ++k)
      so_far[static_cast<std::size_t>(k)] = end.sums[static_cast<std::size_t>(k)] - left_over(k);
    Level best{end.at, end.at, -1 << 20};
    int best_k = 0;
    const auto try_level = [&](int k) {
      const int before = best.sum;
      improve(best, end, level(end, k), level(end, k), so_far[static_cast<std::size_t>(k)],
              {0, 2, 3, 5});
      if (best.sum > before) best_k = k;
    };
    // The most likely one first: few others need all their samples then.
    try_level(static_cast<int>(std::max_element(so_far.begin(), so_far.begin() + levels_) -
                               so_far.begin()));
    for (int k = 0; k < levels_; ++k) try_level(k);
    for (const double tilt : {-kTilt, kTilt}) {
      if (best.sum >= kClear) break;
      const double half = 0.5 * tilt * pair_.width;
      for (int k = std::max(0, best_k - 3); k < std::min(levels_, best_k + 4); ++k)
        improve(best, end, level(end, k) - half, level(end, k) + half, -left_over(k),
                {0, 1, 2, 3, 4, 5});
    }
    return best;
  }

  const Pair& pair_;
  const Fit& fit_;
  const SideCurves& curves_;
  int cell_, levels_ = 0;
  // of the bars' ends: how far outwards; a bar may end anywhere before the next row [px]
  double beyond_, next_row_, apart_ = 0.0;
};

// A frame from where its sides are, roughly, to where they are; nullopt when it is no gate. In
// cells.
template <class Fit>
std::optional<Frame> fitted(const Fit& fit, const Quad& rough, int cell,
                            const GateDetectorParams& params) {
  const auto has_shape = [&](const Quad& q) {
    return is_frame_shaped(q, params.min_side_px / cell, params.max_aspect);
  };
  if (!has_shape(rough)) return std::nullopt;
  const auto centered = fit.centered(rough, kReach);
  const Quad& quad = centered && has_shape(*centered) ? *centered : rough;
  const Frame frame{quad, fit.score(quad)};
  if (frame.score.total < params.min_score || frame.score.inside > params.max_inside)
    return std::nullopt;
  return frame;
}

}  // namespace

GateDetections SnakeSearch::detect(const Image& image, const PictureColor& color) {
  GateDetections found;
  const BarFinder::Bars& bars = finder_.find(image, color);
  if (bars.empty()) return found;
  const int cell = std::max(1, finder_.step() / 2);
  const BarFinder::Evidence evidence = finder_.evidence(image, color, cell);
  FrameFit<BarFinder::Evidence, kEffort> fit{evidence, params_.weights_with(color.faintness()),
                                             params_.bar()};
  fit.set_least_offset(3.0);
  fit.set_cell_size(cell);
  fit.set_bounds(static_cast<double>(image.width()) / cell,
                 static_cast<double>(image.height()) / cell);
  const SideCurves curves{bend_, image};
  fit.set_curves({bend_, image, static_cast<double>(cell)});
  FixedList<Frame, Pairs::kCapacity> frames;
  const auto in_place_of = [&](const Quad& q) {
    return std::find_if(frames.begin(), frames.end(),
                        [&](const Frame& f) { return same_place(f.quad, q); });
  };
  Pairs pairs = pairs_of(bars);
  if (curves.bent())
    for (Pair& pair : pairs) pair.bend(curves);
  for (const Pair& pair : pairs) {
    // Once more a frame that leaves no doubt, from other pieces of its bars: not worth the time.
    const auto known =
        in_place_of(to_cells(Quad{pair.on_left(pair.top), pair.on_right(pair.top),
                                  pair.on_right(pair.bottom), pair.on_left(pair.bottom)},
                             cell));
    if (known != frames.end() && known->score.total > params_.sure_score + kNoDoubt) continue;
    const auto rough = LevelBars{pair, finder_.step(), finder_.stride(), cell, fit, curves}.frame();
    if (!rough) continue;
    auto frame = fitted(fit, *rough, cell, params_);
    if (!frame) continue;
    frame->score.take_off(
        lost_as_filled(image, to_pixels(frame->quad, cell), params_.bar(), curves));
    if (frame->score.total < params_.min_score) continue;
    const auto same = in_place_of(frame->quad);
    if (same == frames.end())
      (void)frames.push_back(*frame);
    else if (frame->score.total > same->score.total)
      *same = *frame;
  }
  insertion_sort(frames,
                 [](const Frame& a, const Frame& b) { return a.score.total > b.score.total; });
  for (const Frame& frame : frames) {
    const Quad corners = refined_corners(image, to_pixels(frame.quad, cell), params_.bar(),
                                         RefinementEffort::kQuick, curves);
    (void)found.push_back(
        meant_detection({corners, frame.score}, DetectionMethod::kSnake, image, params_, curves));
  }
  return found;
}

std::optional<GateDetection> SnakeSearch::detect_near(const Quad& bars_px, const Image& image,
                                                      const PictureColor& color) const {
  const double side = params_.min_side_px;
  if (!finder_.has_evidence() || !is_frame_shaped(bars_px, side, params_.max_aspect))
    return std::nullopt;
  const int cell = std::max(1, finder_.step() / 2), wide = 2 * cell;
  const auto fit_of = [&](const BarFinder::Evidence& evidence, int of_cell) {
    FrameFit<BarFinder::Evidence, kNearEffort> fit{
        evidence, params_.weights_with(color.faintness()), params_.bar()};
    fit.set_cell_size(of_cell);
    fit.set_bounds(static_cast<double>(image.width()) / of_cell,
                   static_cast<double>(image.height()) / of_cell);
    fit.set_curves({bend_, image, static_cast<double>(of_cell)});
    return fit;
  };
  const BarFinder::Evidence coarse = finder_.evidence(image, color, wide),
                            fine = finder_.evidence(image, color, cell);
  const auto rough_fit = fit_of(coarse, wide);
  auto fine_fit = fit_of(fine, cell);
  fine_fit.set_least_offset(3.0);
  const Quad start = to_cells(bars_px, wide);
  const Frame rough =
      pulled(rough_fit, {start, rough_fit.score(start)}, side / wide, params_.max_aspect);
  Frame frame =
      finished(fine_fit, to_cells(to_pixels(rough.quad, wide), cell), side / cell, params_);
  const SideCurves curves{bend_, image};
  frame.quad = to_pixels(frame.quad, cell);
  frame.score.take_off(lost_as_filled(image, frame.quad, params_.bar(), curves));
  if (frame.score.total < params_.min_score - kExpectedLacks ||
      frame.score.inside > params_.max_inside)
    return std::nullopt;
  frame.quad = refined_corners(image, frame.quad, params_.bar(), RefinementEffort::kQuick, curves);
  const double larger = std::abs(area(frame.quad)) / std::abs(area(bars_px));
  if (largest_move(frame.quad, bars_px) > kExpectedWithin * std::sqrt(std::abs(area(bars_px))) ||
      larger > kExpectedLarger || larger * kExpectedLarger < 1.0)
    return std::nullopt;
  return meant_detection(frame, DetectionMethod::kSnake, image, params_, curves);
}

bool SnakeSearch::shows_bars_beside(const GateDetections& gates) const {
  const BarFinder::Bars& bars = finder_.bars();
  return std::any_of(bars.begin(), bars.end(), [&](const Bar& bar) {
    if (bar.strength < kStrongBar) return false;
    const double u = bar.x(0.5 * (bar.top + bar.bottom));
    return std::none_of(gates.begin(), gates.end(), [&](const GateDetection& gate) {
      const auto [first, last] =
          std::minmax_element(gate.corners_px.begin(), gate.corners_px.end(),
                              [](const auto& a, const auto& b) { return a.x() < b.x(); });
      return u > first->x() - finder_.stride() && u < last->x() + finder_.stride();
    });
  });
}

}  // namespace gatefly
