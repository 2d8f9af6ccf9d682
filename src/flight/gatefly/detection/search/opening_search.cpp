// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/opening_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search/board_edges.hpp"

namespace gatefly {
namespace {

using Eigen::Vector2d;

// [estimates, from rendered pictures of the tuning seeds]
constexpr int kOfGate = 0;  // evidence from which a cell has the gate's colour
// An opening is so wide or high, of the picture's width: of farther gates the outer corners say more.
constexpr double kLeastSide = 0.1;
constexpr int kLeastCells = 6;  // least width and height of a hole
// Cells of a hole / cells within its four corners: things that stand in an opening take some away.
constexpr double kLeastFilled = 0.75, kMostFilled = 1.15;
constexpr double kLeastFrame = 0.7;  // of a board beside the opening, in the gate's colour
constexpr int kFrameSamples = 24, kLeastInView = 6;
constexpr double kMostTaper = 2.5;  // a side / the one opposite
constexpr double kConfidence = 0.9;
// Part by which the boards' widths may be off, as their cross-ratio: 0.15 m of an opening of 1.5 m.
// Seen 40 degrees from aside, the depth of a board alone makes 0.02.
constexpr double kMostOff = 0.03;

using Seen = std::array<bool, 4>;

double side(const Quad& quad, std::size_t i) { return (quad[(i + 1) % 4] - quad[i]).norm(); }

// An opening's height and width; of one that the border cuts, of what is in view.
double height(const Quad& quad) { return 0.5 * (side(quad, 1) + side(quad, 3)); }
double width(const Quad& quad) { return 0.5 * (side(quad, 0) + side(quad, 2)); }

// Extends an opening that the border cuts: it becomes as long as it is across.
void complete(Quad& quad, const Seen& seen) {
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = (i + 1) % 4, after = (i + 2) % 4, before = (i + 3) % 4;
    if (seen[i] || seen[next]) continue;
    const double in_view = 0.5 * (side(quad, next) + side(quad, before)),
                 longer = side(quad, after) / std::max(1.0, in_view);
    if (longer <= 1.0) return;
    quad[i] = quad[before] + longer * (quad[i] - quad[before]);
    quad[next] = quad[after] + longer * (quad[next] - quad[after]);
    return;
  }
}

// The gate's plane as the picture shows it; (0, 0) to (1, 1) is the opening, which is whole. Seen from
// aside a near board is half as wide again as a far one.
class PlaneInPicture {
 public:
  explicit PlaneInPicture(const Quad& opening) : at_{opening[0]} {
    const Vector2d a = opening[1] - opening[2], b = opening[3] - opening[2],
                   sum = opening[0] - opening[1] + opening[2] - opening[3];
    const double all = cross(a, b);
    if (std::abs(all) > 1e-9) depth_ = Vector2d{cross(sum, b), cross(a, sum)} / all;
    right_ = opening[1] - opening[0] + depth_.x() * opening[1];
    down_ = opening[3] - opening[0] + depth_.y() * opening[3];
  }
  [[nodiscard]] Vector2d operator()(double u, double v) const {
    return (at_ + u * right_ + v * down_) / std::max(0.1, 1.0 + u * depth_.x() + v * depth_.y());
  }

 private:
  Vector2d at_, right_, down_, depth_{0, 0};
};

// The line through a and b crosses the one through c and d here, in parts of the way from a to b.
std::optional<double> crossing_at(const Vector2d& a, const Vector2d& b, const Vector2d& c,
                                  const Vector2d& d) {
  const double along = cross(b - a, d - c);
  if (std::abs(along) < 1e-6 * (b - a).norm() * (d - c).norm()) return std::nullopt;
  return cross(c - a, d - c) / along;
}

// Whether two boards opposite each other are as wide as those of this gate, seen from wherever: across
// parallel edges the cross-ratio is the same in every picture. Something of the gate's colour behind a
// board makes it wider. True also where an edge does not show.
bool are_wide_as(double bar_ratio, std::size_t one, const BoardEdges& inner,
                 const BoardEdges& outer) {
  const std::size_t other = one + 2;
  if (!inner.seen[one] || !inner.seen[other] || !outer.seen[one] || !outer.seen[other]) return true;
  const auto corner = [](const BoardEdges& edges, std::size_t i) { return edges.corners[i % 4]; };
  const auto middle = [&](std::size_t i) -> Vector2d {
    return 0.5 * (corner(inner, i) + corner(inner, i + 1));
  };
  const Vector2d from = middle(one), to = middle(other);
  const auto before = crossing_at(from, to, corner(outer, one), corner(outer, one + 1)),
             after = crossing_at(from, to, corner(outer, other), corner(outer, other + 1));
  if (!before || !after || !(*before < 0.0) || !(*after > 1.0)) return false;
  const double seen = (1.0 - *before) * *after / (*after - *before),
               meant = (1.0 - bar_ratio) * (1.0 - bar_ratio) / (1.0 - 2.0 * bar_ratio);
  return std::abs(seen / meant - 1.0) < kMostOff;
}

}  // namespace

OpeningSearch::OpeningSearch(const GateDetectorParams& params)
    : params_{params}, bend_{params.lens} {}

Openings OpeningSearch::detect(const Image& image, const PictureColor& color) {
  Openings openings;
  if (!params_.has_boards() || image.empty()) return openings;
  mark(image, color);
  label();
  for (const Hole& hole : holes()) {
    const Quad cells = corners_of(hole);
    const double filled = hole.cells / std::max(1.0, std::abs(area(cells)));
    if (filled < kLeastFilled || filled > kMostFilled) continue;
    GateDetection opening{
        .fitness = kConfidence, .method = DetectionMethod::kOpening, .whole = false};
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector2d& c = cells[i];
      const bool in_view = c.x() > 0.0 && c.y() > 0.0 && c.x() < columns_ && c.y() < rows_;
      opening.corner_fitness[i] = in_view ? kConfidence : 0.0;
      opening.corners_px[i] = (c.array() * step_ - 0.5).matrix();
    }
    if (measure(image, opening)) (void)openings.push_back(opening);
  }
  return openings;
}

// Marks the cells that have the gate's colour.
void OpeningSearch::mark(const Image& image, const PictureColor& color) {
  step_ = std::max({1, (image.width() + kMostColumns - 1) / kMostColumns,
                    (image.height() + kMostRows - 1) / kMostRows});
  columns_ = image.width() / step_, rows_ = image.height() / step_;
  constexpr int kEvery = 4;  // rows of cells, and cells of a row, whose mean is what is around
  std::array<std::uint32_t, 3> sum{};
  std::uint32_t count = 0;
  for (int r = 0; r < rows_; r += kEvery)
    image.visit_row(step_ / 2, r * step_ + step_ / 2, kEvery * step_,
                    (columns_ + kEvery - 1) / kEvery,
                    [&](Yuv c) { sum[0] += c.y, sum[1] += c.u, sum[2] += c.v, ++count; });
  const auto mean = [&](std::size_t i) {
    return static_cast<std::uint8_t>(sum[i] / std::max(1u, count));
  };
  const Yuv around{mean(0), mean(1), mean(2)};
  for (int r = 0; r < rows_; ++r) {
    int column = 0;
    image.visit_row(step_ / 2, r * step_ + step_ / 2, step_, columns_, [&](Yuv c) {
      const bool of_gate =
          color.absolute(c) >= ColorModel::kHopeless && color.evidence(c, around) > kOfGate;
      at(column++, r) = of_gate ? kBoard : 1;
    });
  }
}

int OpeningSearch::root_of(int label) const {
  // At most once a label: a parent has a smaller one.
  while (parent_[static_cast<std::size_t>(label)] != label)
    label = parent_[static_cast<std::size_t>(label)];
  return label;
}

// Gives all cells that hang together, side by side, labels of one root. A picture with more of them
// than there are labels is no near gate: what comes last is left out.
void OpeningSearch::label() {
  int next = 1;
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      if (at(c, r) == kBoard) continue;
      const int above = r > 0 ? at(c, r - 1) : kBoard, before = c > 0 ? at(c - 1, r) : kBoard;
      if (above == kBoard && before == kBoard) {
        if (next == kMostLabels) {
          at(c, r) = kBoard;
          continue;
        }
        parent_[static_cast<std::size_t>(next)] = static_cast<std::uint8_t>(next);
        at(c, r) = static_cast<std::uint8_t>(next++);
        continue;
      }
      const int a = root_of(above == kBoard ? before : above),
                b = root_of(before == kBoard ? above : before), low = std::min(a, b);
      parent_[static_cast<std::size_t>(std::max(a, b))] = static_cast<std::uint8_t>(low);
      at(c, r) = static_cast<std::uint8_t>(low);
    }
  parent_[kBoard] = kBoard;
}

// The largest that could be openings.
OpeningSearch::Holes OpeningSearch::holes() {
  std::array<Hole, kMostLabels> all{};
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      if (at(c, r) == kBoard) continue;
      const int root = root_of(at(c, r));
      at(c, r) = static_cast<std::uint8_t>(root);
      Hole& hole = all[static_cast<std::size_t>(root)];
      hole.label = root, ++hole.cells;
      hole.left = std::min(hole.left, c), hole.right = std::max(hole.right, c);
      hole.top = std::min(hole.top, r), hole.bottom = std::max(hole.bottom, r);
    }
  const auto larger = [](const Hole& a, const Hole& b) { return a.cells > b.cells; };
  Holes largest;
  for (const Hole& hole : all) {
    if (hole.right - hole.left < kLeastCells || hole.bottom - hole.top < kLeastCells ||
        touches_more_than_one_border(hole))
      continue;
    if (largest.push_back(hole)) continue;
    Hole& smallest = *std::max_element(largest.begin(), largest.end(), larger);
    if (larger(hole, smallest)) smallest = hole;
  }
  insertion_sort(largest, larger);
  return largest;
}

bool OpeningSearch::touches_more_than_one_border(const Hole& hole) const {
  return (hole.left == 0) + (hole.top == 0) + (hole.right == columns_ - 1) +
             (hole.bottom == rows_ - 1) >
         1;
}

// Its four corners, in cells from the first one's corner on: the outermost cell in each diagonal
// direction.
Quad OpeningSearch::corners_of(const Hole& hole) const {
  constexpr std::array<std::array<int, 2>, 4> kWays{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  std::array<int, 4> best;
  best.fill(std::numeric_limits<int>::min());
  Quad corners;
  const int across = hole.right - hole.left + 1, down = hole.bottom - hole.top + 1;
  for (int r = hole.top; r <= hole.bottom; ++r)
    for (int c = hole.left; c <= hole.right; ++c) {
      if (at(c, r) != hole.label) continue;
      for (std::size_t i = 0; i < 4; ++i) {
        const int out = kWays[i][0] * c * down + kWays[i][1] * r * across;
        if (out <= best[i]) continue;
        best[i] = out;
        corners[i] = Vector2d{c + (kWays[i][0] > 0), r + (kWays[i][1] > 0)};
      }
    }
  return corners;
}

// Whether the gate's colour is where its boards should be, and ends beyond them: a dark place on a
// board has it all around.
bool OpeningSearch::is_framed(const Quad& corners_px, const Seen& seen) const {
  const double board = params_.bar_ratio / (1.0 - 2.0 * params_.bar_ratio);
  const bool is_whole = std::all_of(seen.begin(), seen.end(), [](bool s) { return s; });
  const PlaneInPicture plane{corners_px};
  // A side of the opening, moved out by so many boards.
  const auto moved = [&](std::size_t i, double boards) -> Line {
    if (is_whole) {
      const double off = boards * board, before = -off, after = 1.0 + off;
      const std::array<Line, 4> lines{
          Line{plane(0, before), plane(1, before)}, Line{plane(after, 0), plane(after, 1)},
          Line{plane(1, after), plane(0, after)}, Line{plane(before, 1), plane(before, 0)}};
      return lines[i];
    }
    const Vector2d &a = corners_px[i], &b = corners_px[(i + 1) % 4];
    const Vector2d out = Vector2d{(b - a).y(), -(b - a).x()}.normalized() * boards * board *
                         (i % 2 == 0 ? height(corners_px) : width(corners_px));
    return {a + out, b + out};
  };
  int framed = 0, ended = 0, beyond_in_view = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (!seen[i] && !seen[(i + 1) % 4]) continue;  // along the border
    const Shown on_board = shown(moved(i, 0.35), moved(i, 0.65));
    if (on_board.in_view < kLeastInView) continue;
    if (on_board.of_gate < kLeastFrame * on_board.in_view) return false;
    ++framed;
    const Shown beyond = shown(moved(i, 1.5), moved(i, 1.7));
    if (beyond.in_view < kLeastInView) continue;
    ++beyond_in_view;
    const bool ends = 2 * beyond.of_gate < beyond.in_view;
    // Gates stand upon one another, but none beside another without a gap.
    if (!ends && i % 2 == 1) return false;
    ended += ends;
  }
  return framed >= 3 && (beyond_in_view == 0 || ended > 0);
}

// Samples along a side, near and far from it in turns.
OpeningSearch::Shown OpeningSearch::shown(const Line& near, const Line& far) const {
  Shown shown;
  for (int k = 0; k < kFrameSamples; ++k) {
    const auto& [a, b] = k % 2 == 0 ? near : far;
    const Vector2d p = a + (k + 0.5) / kFrameSamples * (b - a),
                   cell = ((p.array() + 0.5) / step_).floor();
    if (!(cell.x() >= 0.0 && cell.y() >= 0.0 && cell.x() < columns_ && cell.y() < rows_)) continue;
    ++shown.in_view;
    shown.of_gate += at(static_cast<int>(cell.x()), static_cast<int>(cell.y())) == kBoard;
  }
  return shown;
}

// Its corners from the boards' inner edges; false where it is no opening of a gate.
bool OpeningSearch::measure(const Image& image, GateDetection& opening) const {
  Seen seen;
  for (std::size_t i = 0; i < 4; ++i) seen[i] = opening.corner_fitness[i] > 0.0;
  Quad rough = opening.corners_px;
  complete(rough, seen);
  const auto tapers = [&](std::size_t i) {
    const auto [less, more] = std::minmax({side(rough, i), side(rough, i + 2)});
    return !(more < kMostTaper * less);
  };
  if (tapers(0) || tapers(1) || !is_framed(rough, seen)) return false;
  const bool is_whole = std::all_of(seen.begin(), seen.end(), [](bool s) { return s; });
  const auto [less, more] = std::minmax({height(rough), width(rough)});
  if (more < kLeastSide * image.width()) return false;
  if (is_whole && more > params_.max_aspect * less) return false;

  const double inner = 1.0 - 2.0 * params_.bar_ratio, board = params_.bar_ratio / inner;
  const Quad middles = scaled(rough, (1.0 - params_.bar_ratio) / inner);
  const BoardWidths widths{board * height(rough), board * width(rough)};
  const SideCurves curves{bend_, image};
  const BoardEdges edges = board_edges(image, middles, widths, curves, BoardEdge::kInner),
                   outer = board_edges(image, middles, widths, curves, BoardEdge::kOuter);
  for (const std::size_t one : {0u, 1u})
    if (!are_wide_as(params_.bar_ratio, one, edges, outer)) return false;
  int corners = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    // The grid and the edges have to agree.
    const bool good = seen[i] && edges.has(i) && (edges.corners[i] - rough[i]).norm() < 3.0 * step_;
    opening.corner_fitness[i] = good ? kConfidence : 0.0;
    if (good) opening.corners_px[i] = edges.corners[i], ++corners;
  }
  return corners >= 2;
}

}  // namespace gatefly
