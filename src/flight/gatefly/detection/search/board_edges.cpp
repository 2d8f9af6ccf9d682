// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/board_edges.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "gatefly/detection/search/refined_side.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {
namespace {

using Eigen::Vector2d;

// [estimates, from rendered pictures of seeds 1441-1443]
constexpr int kStations = 32, kMostSamples = 64;
// Widths of a board from its middle line: where an edge is looked for, and what is beyond it.
constexpr double kInnermost = -0.25, kOutermost = 1.1, kBeyondFrom = 0.7;
// Widths, along a side: its outer edge is longer than its middle line, its inner one shorter.
constexpr double kPastCorners = 0.4, kShortOfCorners = 0.6;
constexpr double kLeastContrast = 8.0;  // levels of chroma between a board and what is beyond
constexpr double kLeastStep = 0.5;      // of all that a clear step would show
constexpr int kLeastSteps = 6;
constexpr double kLeastBoard = 0.5;                // of a corner of boards
constexpr std::array kScales{4.0, 2.0, 1.0, 0.7};  // px, of the line's residuals, pass by pass

/// One side of the frame: its middle line, and a way out.
class BoardSide {
 public:
  /// @param ends_px  width of the boards at both its ends.
  BoardSide(const Image& image, const Vector2d& a, const Vector2d& b, double board_px,
            double ends_px, const Vector2d& sag, BoardEdge which)
      : image_{image}, a_{a}, d_{b - a}, sag_{sag}, board_px_{board_px} {
    const double length = std::max(1e-9, d_.norm());
    out_ = Vector2d{d_.y(), -d_.x()} / length;  // corners run clockwise as seen
    past_ = kPastCorners * ends_px / length;
    if (which == BoardEdge::kOuter) return;
    opens_ = true;
    out_ = -out_;
    past_ = -std::min(kShortOfCorners * ends_px / length, 0.4);
  }

  [[nodiscard]] double board() const { return board_px_; }

  [[nodiscard]] Vector2d on(double t) const { return a_ + t * d_ + 4.0 * t * (1.0 - t) * sag_; }
  /// So far beyond the middle line, where the edge is looked for.
  [[nodiscard]] Vector2d at(double t, double off_px) const { return on(t) + off_px * out_; }
  [[nodiscard]] double station(int k) const {
    return -past_ + (1.0 + 2.0 * past_) * (k + 0.5) / kStations;
  }

  /// Mean chroma in view between two distances from the middle line [px]; nullopt: none is.
  [[nodiscard]] std::optional<Vector2d> chroma(double from, double to) const {
    Vector2d sum{0, 0};
    int count = 0;
    for (int k = 0; k < kStations; ++k)
      for (int i = 0; i < 4; ++i) {
        const Vector2d p = at(station(k), from + (to - from) * (i + 0.5) / 4.0);
        if (const auto c = chroma_at(p)) sum += *c, ++count;
      }
    if (count < kStations / 2) return std::nullopt;
    return sum / count;
  }

  /// How much of a board shows in a corner, next to its tip; nullopt: it is not in view.
  /// @param along, back  from the corner along both sides, as far as the boards are wide [px].
  [[nodiscard]] std::optional<double> shown_in(const Vector2d& corner, const Vector2d& along,
                                               const Vector2d& back, const Vector2d& board,
                                               const Vector2d& beyond) const {
    const Vector2d contrast = board - beyond;
    double sum = 0.0;
    int count = 0;
    for (const double a : {0.2, 0.4, 0.6})
      for (const double b : {0.2, 0.4, 0.6})
        if (const auto c = chroma_at(corner + a * along + b * back))
          sum += std::clamp((*c - beyond).dot(contrast) / contrast.squaredNorm(), 0.0, 1.0),
              ++count;
    if (count < 5) return std::nullopt;
    return sum / count;
  }

  /// Offset of the edge at its two ends, t = 0 and 1 [px]; nullopt: too little of it is in view.
  [[nodiscard]] std::optional<Vector2d> edge(const Vector2d& board, const Vector2d& beyond) const {
    const Vector2d contrast = board - beyond;
    const double square = contrast.squaredNorm();
    if (square < kLeastContrast * kLeastContrast) return std::nullopt;
    FixedList<Vector2d, kStations> steps;  // t, offset
    for (int k = 0; k < kStations; ++k)
      if (const auto off = step_at(station(k), beyond, contrast / square))
        (void)steps.push_back({station(k), *off});
    return line_through(steps);
  }

 private:
  [[nodiscard]] std::optional<Vector2d> chroma_at(const Vector2d& p) const {
    // Written so that what is no number is outside, too.
    if (!(p.x() > -0.5 && p.y() > -0.5 && p.x() < image_.width() - 0.5 &&
          p.y() < image_.height() - 0.5))
      return std::nullopt;
    const Yuv c = image_.at(static_cast<int>(p.x() + 0.5), static_cast<int>(p.y() + 0.5));
    return Vector2d{c.u, c.v};
  }

  // How much of the board shows at a place, between the four pixels around it: 1 all, 0 none.
  [[nodiscard]] double shown_at(double t, double off_px, const Vector2d& beyond,
                                const Vector2d& per_contrast) const {
    const Vector2d p = at(t, off_px), corner{std::floor(p.x()), std::floor(p.y())},
                   part = p - corner;
    double sum = 0.0;
    for (const int i : {0, 1})
      for (const int j : {0, 1}) {
        const auto c = chroma_at(corner + Vector2d{i, j});
        if (!c) return 0.0;
        sum += std::abs(1.0 - i - part.x()) * std::abs(1.0 - j - part.y()) *
               (*c - beyond).dot(per_contrast);
      }
    return sum;
  }

  // The best step from board to no board along one line across the side.
  [[nodiscard]] std::optional<double> step_at(double t, const Vector2d& beyond,
                                              const Vector2d& per_contrast) const {
    const double length = (kOutermost - kInnermost) * board_px_;
    const int samples = std::clamp(static_cast<int>(length), 8, kMostSamples);
    const double apart = length / samples;
    double from = kInnermost * board_px_;
    // The border may cut a board around an opening: the part next to the opening is left.
    int skipped = 0;
    // At most kMostSamples times, with the loop below.
    if (opens_)
      while (skipped < samples && !chroma_at(at(t, from + apart * 0.5))) from += apart, ++skipped;
    std::array<double, static_cast<std::size_t>(kMostSamples)> shown;
    int n = 0;  // at most kMostSamples
    for (; n < samples - skipped; ++n) {
      const auto c = chroma_at(at(t, from + apart * (n + 0.5)));
      if (!c) break;  // the border
      shown[static_cast<std::size_t>(n)] = std::clamp((*c - beyond).dot(per_contrast), 0.0, 1.0);
    }
    double sum = 0.0, best = 0.0;
    int after = 0;
    for (int i = 0; i < n; ++i) {
      sum += shown[static_cast<std::size_t>(i)] - 0.5;
      if (sum > best) best = sum, after = i + 1;
    }
    if (after < 2 || after > n - 1) return std::nullopt;
    double all = best;
    for (int i = after; i < n; ++i) all += 0.5 - shown[static_cast<std::size_t>(i)];
    if (all < kLeastStep * 0.5 * n) return std::nullopt;
    // The edge is where half of the board shows, between pixels.
    const double edge = from + apart * after;
    double before = edge - 1.0, left = shown_at(t, before, beyond, per_contrast);
    for (const double next : {edge, edge + 1.0}) {
      const double right = shown_at(t, next, beyond, per_contrast);
      if (left >= 0.5 && right < 0.5) return before + (left - 0.5) / (left - right);
      before = next, left = right;
    }
    return edge;
  }

  [[nodiscard]] static std::optional<Vector2d> line_through(
      const FixedList<Vector2d, kStations>& steps) {
    if (steps.size() < static_cast<std::size_t>(kLeastSteps)) return std::nullopt;
    FixedList<double, kStations> offs;
    for (const Vector2d& step : steps) (void)offs.push_back(step.y());
    std::nth_element(offs.begin(), offs.begin() + offs.size() / 2, offs.end());
    Vector2d line{offs[offs.size() / 2], offs[offs.size() / 2]};
    for (const double scale : kScales) {
      // off = line[0] (1 - t) + line[1] t
      Eigen::Matrix2d A = 1e-3 * Eigen::Matrix2d::Identity();
      Vector2d y = A * line;
      for (const Vector2d& step : steps) {
        const Vector2d part{1.0 - step.x(), step.x()};
        const double left = (step.y() - part.dot(line)) / scale, w = 1.0 / (1.0 + left * left);
        A += w * part * part.transpose(), y += w * step.y() * part;
      }
      line = A.inverse() * y;
    }
    return line;
  }

  const Image& image_;
  Vector2d a_, d_, sag_, out_;
  double board_px_, past_;
  bool opens_ = false;  // the edge is that of the opening
};

// From middle lines that are known to a third of a board's width.
BoardEdges edges_beyond(const Image& image, const Quad& bars_px, const BoardWidths& board_px,
                        const SideCurves& curves, BoardEdge which) {
  const auto side = [&](std::size_t i) {
    const Vector2d &a = bars_px[i], &b = bars_px[(i + 1) % 4];
    const bool level = i % 2 == 0;
    return BoardSide{image,
                     a,
                     b,
                     level ? board_px.level : board_px.upright,
                     level ? board_px.upright : board_px.level,
                     curves.sag(a, b),
                     which};
  };
  const std::array<BoardSide, 4> sides{side(0), side(1), side(2), side(3)};
  // One colour for all boards; that of the opening where what is beyond them is not in view.
  const auto mean_of = [&](double from, double to) {
    Vector2d sum{0, 0};
    int shown = 0;
    for (const BoardSide& s : sides)
      if (const auto mean = s.chroma(from * s.board(), to * s.board())) sum += *mean, ++shown;
    return shown > 0 ? std::optional<Vector2d>{sum / shown} : std::nullopt;
  };
  const auto paint = mean_of(-0.25, 0.25), opening = mean_of(-1.2, -0.8);

  BoardEdges edges{.corners = bars_px, .middles = bars_px};
  std::array<Vector2d, 4> offs;
  std::array<std::optional<Vector2d>, 4> beyond;
  for (std::size_t i = 0; i < 4; ++i) {
    const double board = sides[i].board();
    offs[i] = Vector2d::Constant(0.5 * board);
    beyond[i] = sides[i].chroma(kBeyondFrom * board, kOutermost * board);
    const auto& other = beyond[i] ? beyond[i] : opening;
    const auto edge = paint && other ? sides[i].edge(*paint, *other) : std::nullopt;
    if (edge) offs[i] = *edge, edges.seen[i] = true;
  }
  // Neighbouring lines that run so many widths of a board back from their edges cross here.
  const auto crossings = [&](double back) {
    Quad corners = bars_px;
    edges.crossed = {};
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t before = (i + 3) % 4;
      const auto point = [&](std::size_t of, double t) {
        return sides[of].at(t,
                            (1.0 - t) * offs[of][0] + t * offs[of][1] - back * sides[of].board());
      };
      const Vector2d a = point(before, 0.5), b = point(before, 1.0), c = point(i, 0.0),
                     d = point(i, 0.5);
      const auto corner = curves.bent() ? curves.crossing(a, b, c, d)
                                        : crossing(refinement::Side{a, b}, refinement::Side{c, d});
      if (corner) corners[i] = *corner, edges.crossed[i] = true;
    }
    return corners;
  };
  edges.middles = crossings(0.5), edges.corners = crossings(0.0);
  for (std::size_t i = 0; i < 4; ++i) {
    const BoardSide &after = sides[i], &before = sides[(i + 3) % 4];
    if (!paint || !beyond[i]) continue;
    const Vector2d along = (bars_px[(i + 1) % 4] - bars_px[i]).normalized() * before.board(),
                   back = (bars_px[(i + 3) % 4] - bars_px[i]).normalized() * after.board();
    const auto shown = after.shown_in(edges.corners[i], along, back, *paint, *beyond[i]);
    edges.filled[i] = !shown || *shown > kLeastBoard;
  }
  return edges;
}

}  // namespace

BoardEdges board_edges(const Image& image, const Quad& bars_px, const BoardWidths& board_px,
                       const SideCurves& curves, BoardEdge which) {
  // The second time along lines that are nearly parallel to the edges.
  const BoardEdges rough = edges_beyond(image, bars_px, board_px, curves, which);
  return edges_beyond(image, rough.middles, board_px, curves, which);
}

}  // namespace gatefly
