// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/part_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search/bar_pieces.hpp"
#include "gatefly/detection/search/board_edges.hpp"
#include "gatefly/detection/search/frame_fit.hpp"
#include "gatefly/geometry/exponential.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {
namespace {

using Eigen::Vector2d;

constexpr double kLeastApart = 0.12;  // of two bars / the picture's width: a gate of 1 m at 4 m
constexpr double kLeastShared = 0.5;  // of the rows of both bars / those of either
constexpr double kMostTaper = 2.0;    // distance of the bars at one end / at the other
// bars' length in view / their distance: a gate seen from aside
constexpr double kHighest = 2.0;
// evidence of the weaker bar / of the stronger one: they have one colour
constexpr double kAlike = 0.5;
constexpr int kLevelSamples = 8, kLeastLevelSamples = 3, kBarSamples = 16;
constexpr double kLeastLevel = 0.5;  // of a level bar in view [nats]
constexpr FrameEffort kEffort{.samples = 12, .stations = 8, .middles = 12};

/// Limits that the bars of a gate keep.
struct Shape {
  int widest = 16;             // samples: a bar of 5 cm is 28 px wide at 0.3 m
  int around = 3;              // groups, see BarFinder: 56 px at 315 x 160
  double most_width = 0.2;     // of a bar / the distance of both, blurred
  double least_length = 0.25;  // of a bar in view / the picture's height
  double lowest = 0.3;         // as kHighest, of what is left of a near gate
  double opening_from = 0.2;   // of the way from one bar's middle to the other's
  bool is_board = false;
};

// Bars that are a fifth of their gate's side or more are boards. The rows of a level one show no
// opening: what is found of the upright ones ends at its inner edge.
Shape shape_of(const GateDetectorParams& params) {
  if (!params.has_boards()) return {};
  const double bar = params.bar();
  return {.widest = 48,
          .around = BarFinder::kWholePicture,
          .most_width = 1.9 * bar,
          .least_length = 0.15,
          .lowest = 0.15,
          .opening_from = 0.1 + 0.5 * bar,
          .is_board = true};
}

struct Pair {
  Bar left, right;
  // rows that both show, distance in the middle of them
  double top = 0.0, bottom = 0.0, apart = 0.0;
  double worth = 0.0;
};

std::optional<Pair> pair_of(const Bar& l, const Bar& r, const Image& image, const Shape& shape) {
  Pair p{
      .left = l, .right = r, .top = std::max(l.top, r.top), .bottom = std::min(l.bottom, r.bottom)};
  const double least = shape.least_length * image.height(), shared = p.bottom - p.top;
  if (std::min(l.length(), r.length()) < least ||
      shared < kLeastShared * std::max(l.length(), r.length()))
    return std::nullopt;
  const auto apart = [&](double y) { return r.on_curve(y).x() - l.on_curve(y).x(); };
  const double above = apart(p.top), below = apart(p.bottom);
  p.apart = apart(0.5 * (p.top + p.bottom));
  if (std::min({above, below, p.apart}) < kLeastApart * image.width() ||
      std::max(above, below) > kMostTaper * std::min(above, below))
    return std::nullopt;
  if (std::max(l.width, r.width) > shape.most_width * p.apart || shared > kHighest * p.apart ||
      shared < shape.lowest * p.apart)
    return std::nullopt;
  p.worth = (l.strength + r.strength) * shared / std::max(l.length(), r.length());
  return p;
}

// Which end of the bars: +1 their lower one.
enum class End { kTop = -1, kBottom = 1 };

/// Level bar that joins the bars at one end.
struct Level {
  Vector2d left{0, 0}, right{0, 0};  // where it meets the bars' middle lines
  double sag = 0.0;                  // how far its middle hangs below [px]
  double mean = -9.0;                // evidence of what is in view [nats]
  double positive = 0.0;
  int samples = 0;  // in view
};

template <class Fit>
class Part {
 public:
  Part(const Pair& pair, const Image& image, const Fit& fit, int stride, const Shape& shape)
      : pair_{pair}, image_{image}, fit_{fit}, stride_{stride}, shape_{shape} {}

  [[nodiscard]] bool in_view(const Vector2d& p) const {
    return p.x() >= 1.0 && p.y() >= 1.0 && p.x() <= image_.width() - 2.0 &&
           p.y() <= image_.height() - 2.0;
  }
  /// Whether a bar ends within so many rows of the border, or leaves at the side.
  [[nodiscard]] bool is_cut(const Bar& bar, End end, double within_rows = 1.9) const {
    const double near = within_rows * stride_, y = end == End::kTop ? bar.top : bar.bottom,
                 x = bar.on_curve(y).x();
    return (end == End::kTop ? y < near : y > image_.height() - 1.0 - near) || x < 0.75 * stride_ ||
           x > image_.width() - 1.0 - 0.75 * stride_;
  }
  /// Whether both end where too little of a level bar may be in view.
  [[nodiscard]] bool both_are_cut(End end) const {
    const double rows = shape_.is_board ? 1.9 + wider() / stride_ : 4.9;
    return is_cut(pair_.left, end, rows) && is_cut(pair_.right, end, rows);
  }
  [[nodiscard]] double wider() const { return std::max(pair_.left.width, pair_.right.width); }

  [[nodiscard]] Level along(const Vector2d& left, const Vector2d& right, double sag) const {
    Level level{.left = left, .right = right, .sag = sag};
    const auto at = [&](int k) -> Vector2d {
      const double t = (k + 0.5) / kLevelSamples;
      return left + t * (right - left) + Vector2d{0.0, 4.0 * t * (1.0 - t) * sag};
    };
    int from = 0, to = kLevelSamples - 1;
    // At most kLevelSamples times, both together.
    while (from <= to && !in_view(at(from))) ++from;
    while (to >= from && !in_view(at(to))) --to;
    const int samples = to - from + 1;
    if (samples < kLeastLevelSamples) return level;
    // It joins the bars: both its ends are on it.
    const int first = fit_.at(at(from)), last = first < 0 ? first : fit_.at(at(to));
    if (last < 0) return level;
    int sum = first + last, positive = (first > 0) + (last > 0);
    for (int k = from + 1; k < to; ++k) {
      const int e = fit_.at(at(k));
      sum += e, positive += e > 0;
    }
    level.samples = samples;
    level.mean = sum / (16.0 * samples);
    level.positive = static_cast<double>(positive) / samples;
    return level;
  }

  /// The level bar at an end, the one with the most evidence.
  [[nodiscard]] std::optional<Level> level_at(End end) const {
    const double outwards = end == End::kTop ? -1.0 : 1.0;
    // the other end of the level bar is beyond the border
    const bool one_is_cut = is_cut(pair_.left, end) != is_cut(pair_.right, end);
    const auto rows = [&](const Bar& bar) {
      FixedList<double, 32> y;
      const double last = end == End::kTop ? bar.top : bar.bottom;
      const int wide = shape_.is_board ? std::min(10, static_cast<int>(wider() / stride_)) : 0;
      // A board's middle is half a board beyond where the upright ones end, or a row more.
      if (shape_.is_board)
        for (const int k : {1, 0, 2})
          y.push_back(last + outwards * 0.5 * (bar.width + k * stride_));
      for (int k = -1; k <= 5 + wide; ++k) y.push_back(last + outwards * 0.5 * k * stride_);
      if (one_is_cut && is_cut(bar, end))
        for (int k = 1; k <= 6; ++k)
          y.push_back(last + outwards * (2.5 * stride_ + 0.13 * k * pair_.apart));
      return y;
    };
    const auto worth = [](const Level& l) { return l.mean * l.samples; };
    Level best;
    const auto lefts = rows(pair_.left), rights = rows(pair_.right);
    for (const double yl : lefts)
      for (const double yr : rights) {
        if (std::abs(yl - yr) > 0.8 * pair_.apart) continue;
        for (const double part : {0.0, 0.05}) {  // lenses bend it outwards
          const Level level =
              along(beyond(pair_.left, yl), beyond(pair_.right, yr), outwards * part * pair_.apart);
          if (worth(level) > worth(best)) best = level;
        }
      }
    if (best.mean < 0.0) return std::nullopt;
    for (const double part : {-0.03, 0.02, 0.08}) {
      const Level level = along(best.left, best.right, outwards * part * pair_.apart);
      if (worth(level) > worth(best)) best = level;
    }
    if (best.mean < kLeastLevel || best.positive < 0.7) return std::nullopt;
    return best;
  }

  /// Mean evidence of a bar in view [nats].
  [[nodiscard]] double along(const Bar& bar) const {
    int sum = 0;
    for (int k = 0; k < kBarSamples; ++k)
      sum += fit_.at(bar.on_curve(bar.top + bar.length() * (k + 0.5) / kBarSamples));
    return sum / (16.0 * kBarSamples);
  }

  /// Mean evidence between the bars [nats].
  [[nodiscard]] double inside() const {
    constexpr int kGrid = 6;
    int sum = 0;
    for (int i = 0; i < kGrid; ++i)
      for (int j = 0; j < kGrid; ++j) {
        const double from = shape_.opening_from, t = from + (1.0 - 2.0 * from) * i / (kGrid - 1),
                     y = pair_.top + (pair_.bottom - pair_.top) * (0.1 + 0.8 * j / (kGrid - 1));
        sum +=
            std::max(-16, fit_.at((1.0 - t) * beyond(pair_.left, y) + t * beyond(pair_.right, y)));
      }
    return sum / (16.0 * kGrid * kGrid);
  }

  /// The corner between a side bar and a level one, sub-pixel: near it both are straight, whatever
  /// the lens does.
  [[nodiscard]] Vector2d corner(const Bar& bar, const Level& level, bool is_left, End end) const {
    const Vector2d rough = is_left ? level.left : level.right,
                   other = is_left ? level.right : level.left;
    const double inwards = end == End::kTop ? 1.0 : -1.0,
                 reach = 0.4 * std::min(bar.length(), pair_.apart);
    const int around = std::clamp(static_cast<int>(0.6 * bar.width + 3.5), 3, 12);
    const Vector2d middle = 0.5 * (rough + other) + Vector2d{0.0, level.sag};
    const auto side = fit_.centered_line(beyond(bar, rough.y() + inwards * 0.15 * reach),
                                         beyond(bar, rough.y() + inwards * reach), around);
    const auto across =
        fit_.centered_line(rough + 0.1 * (middle - rough), rough + 0.9 * (middle - rough), around);
    const auto met = Fit::crossing(side, across);
    return met && (*met - rough).norm() < 2.0 * around ? *met : rough;
  }

 private:
  const Pair& pair_;
  const Image& image_;
  const Fit& fit_;
  int stride_;
  const Shape& shape_;
};

constexpr std::array kEnds{End::kTop, End::kBottom};

/// A pair and what joins it.
struct Candidate {
  const Pair* pair = nullptr;
  std::array<double, 2> evidence{};  // of the left and the right bar
  std::array<std::optional<Level>, 2> levels{};
  double score = 0.0;
  bool whole = true;  // all is in view, and not near to the border
};

// The pair with its level bars; nullopt when it is part of no gate.
template <class Fit>
std::optional<Candidate> candidate_of(const Pair& pair, const Image& image, const Fit& fit,
                                      int stride, const Shape& shape,
                                      const GateDetectorParams& params) {
  const Part<Fit> part{pair, image, fit, stride, shape};
  Candidate found{.pair = &pair, .evidence = {part.along(pair.left), part.along(pair.right)}};
  const auto [weaker, stronger] = std::minmax(found.evidence[0], found.evidence[1]);
  const double inside = part.inside();
  if (inside > params.max_inside || weaker < kAlike * stronger) return std::nullopt;
  double sum = weaker + stronger, weakest = weaker;
  int sides = 2;
  for (std::size_t e = 0; e < 2; ++e) {
    const auto level = found.levels[e] = part.level_at(kEnds[e]);
    if (!level && !part.both_are_cut(kEnds[e])) return std::nullopt;
    if (level) sum += level->mean, ++sides, weakest = std::min(weakest, level->mean);
    found.whole = found.whole && level && !part.is_cut(pair.left, kEnds[e]) &&
                  !part.is_cut(pair.right, kEnds[e]);
  }
  // As FrameFit::score, of what is in view.
  // What is beside the bars and beyond their ends is as of a gate.
  constexpr double kNotLookedAt = 0.9;
  const FrameWeights& weights = fit.weights();
  found.score = sum / sides + weights.weakest * weakest - weights.inside * inside + kNotLookedAt +
                weights.size * gatefly::log2(std::max(1.0, pair.apart) / 50.0) + weights.added;
  return found.score < params.min_score ? std::nullopt : std::optional{found};
}

template <class Fit>
GatePart part_of(const Candidate& candidate, const Image& image, const Fit& fit, int stride,
                 const Shape& shape, const SideCurves& curves, const GateDetectorParams& params) {
  const Part<Fit> part{*candidate.pair, image, fit, stride, shape};
  const std::array<const Bar*, 2> bars{&candidate.pair->left, &candidate.pair->right};
  const auto middle = [](const Bar& bar) { return bar.on_curve(0.5 * (bar.top + bar.bottom)); };
  GatePart found{.gate = {.fitness = confidence_of(candidate.score),
                          .corner_fitness = {0.0, 0.0, 0.0, 0.0},
                          .method = DetectionMethod::kBars,
                          .whole = false},
                 .bars = {middle(*bars[0]), middle(*bars[1])}};
  // Corners of the bars' middle lines; without a level bar in view these end at the border.
  Quad corners, border;
  std::array<const Level*, 4> levels{};
  for (std::size_t e = 0; e < 2; ++e)
    for (std::size_t i = 0; i < 2; ++i) {
      const std::size_t k = e == 0 ? i : 3 - i;  // TL TR BR BL
      corners[k] = border[k] = beyond(*bars[i], e == 0 ? 0.0 : image.height() - 1.0);
      if (!candidate.levels[e]) continue;
      levels[k] = &*candidate.levels[e];
      corners[k] = shape.is_board ? (i == 0 ? levels[k]->left : levels[k]->right)
                                  : part.corner(*bars[i], *levels[k], i == 0, kEnds[e]);
    }
  double scale = params.corner_scale;
  if (shape.is_board) {
    const BoardEdges edges =
        board_edges(image, corners, 0.5 * (bars[0]->width + bars[1]->width), curves);
    corners = edges.corners;
    for (std::size_t k = 0; k < 4; ++k)
      if (!edges.has(k) || !edges.filled[k]) levels[k] = nullptr;
    scale *= 1.0 - params.bar_ratio;
  }
  found.gate.corners_px = border;
  for (std::size_t k = 0; k < 4; ++k) {
    if (levels[k] == nullptr) continue;
    // From the middle lines out to the corners that are meant.
    const bool is_left = k == 0 || k == 3, is_top = k < 2;
    const Vector2d sideways = 0.5 * (scale - 1.0) * (levels[k]->right - levels[k]->left),
                   down{-sideways.y(), sideways.x()};
    const Vector2d corner = corners[k] + (is_left ? -sideways : sideways) + (is_top ? -down : down);
    if (!part.in_view(corner)) continue;
    found.gate.corners_px[k] = corner;
    found.gate.corner_fitness[k] =
        corner_confidence_of(std::min(candidate.evidence[is_left ? 0 : 1], levels[k]->mean));
  }
  return found;
}

}  // namespace

PartSearch::PartSearch(const GateDetectorParams& params)
    : params_{params},
      bend_{params.lens},
      bars_{shape_of(params).widest, shape_of(params).around} {}

std::optional<GatePart> PartSearch::detect(const Image& image, const PictureColor& color) {
  const Shape shape = shape_of(params_);
  BarFinder::Bars bars = bars_.find(image, color);
  if (shape.is_board)
    for (Bar& bar : bars) bar.curve = {bar.at_0, bar.slope, 0.0};
  join_pieces(bars, bars_.stride());
  FixedList<Pair, 3> pairs;
  const auto better = [](const Pair& a, const Pair& b) { return a.worth > b.worth; };
  for (const Bar& l : bars)
    for (const Bar& r : bars) {
      const auto pair = pair_of(l, r, image, shape);
      if (!pair || pairs.push_back(*pair)) continue;
      Pair& worst = *std::max_element(pairs.begin(), pairs.end(), better);
      if (better(*pair, worst)) worst = *pair;
    }
  const BarFinder::Evidence evidence = bars_.evidence(image, color, 1);
  const FrameFit<BarFinder::Evidence, kEffort> fit{
      evidence, params_.weights_with(color.faintness()), params_.bar()};
  std::optional<Candidate> best;
  for (const Pair& pair : pairs) {
    const auto candidate = candidate_of(pair, image, fit, bars_.stride(), shape, params_);
    if (candidate && (!best || candidate->score > best->score)) best = candidate;
  }
  if (!best || (best->whole && !shape.is_board)) return std::nullopt;
  const GatePart part =
      part_of(*best, image, fit, bars_.stride(), shape, SideCurves{bend_, image}, params_);
  // Two upright things of the gate's colour are no gate of boards: it shows corners, too.
  const auto seen = std::count_if(part.gate.corner_fitness.begin(), part.gate.corner_fitness.end(),
                                  [](double fitness) { return fitness > 0.0; });
  if (shape.is_board && seen < 2) return std::nullopt;
  return part;
}

}  // namespace gatefly
