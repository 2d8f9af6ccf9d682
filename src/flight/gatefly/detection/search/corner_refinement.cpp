// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/corner_refinement.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "gatefly/detection/search/refined_side.hpp"
#include "gatefly/detection/search/unknown_bend.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

using namespace refinement;

constexpr int kWidest = 31;  // pixels of a line
// Beside a bar [px]; beside a board, whose rough sides are rougher, more of its own width.
constexpr double kMargin = 2.0, kMarginOfBoard = 0.2;
// beside the half of the bar that crosses at either end [px]
constexpr double kEnds = 2.0;
// grey levels between the colours of a bar and of what is beside it
constexpr float kLeastContrast = 4.0f;
constexpr float kLeastShown = 0.35f;  // of a bar's width, on a line that counts
// A pixel counts less the farther it is from where the line is thought to cross: half a pixel beyond
// the end, kEnd from there, nothing.
constexpr int kWholeBits = 7, kWhole = 1 << kWholeBits;  // in the middle
constexpr int kEndBits = 5;
constexpr float kEnd = 64.0f;
static_assert(static_cast<int>(kEnd * kEnd) >> kEndBits == kWhole);
constexpr int kLeastLines = 4;
// of a side that is in view: it does not say how it leans
constexpr double kLittle = 0.3;
constexpr double kRough = 0.5;  // lines that the rough side counts as, at either end
// of a grey level, beside one of chroma: what is behind a gate differs in luma
constexpr float kLuma = 0.4f;
constexpr float kWayUnit = 64.0f;   // of a grey level, on the way from what is beside to the bar
constexpr float kBeyondBar = 1.2f;  // of that way: what is farther on counts no more
constexpr int kBarBits = 7;         // of that way, once it is halved often enough: 64..127
static_assert(kLuma * kLeastContrast * kWayUnit >= 1 << (kBarBits - 1), "is never to be doubled");
constexpr double kLeap = 3.0;       // px
constexpr double kMostCurve = 0.1;  // 1/px
// from a line's middle pixel to where it is thought to cross: not read again [px]
constexpr float kNear = 0.9f;

struct Effort {
  int passes;    // at most
  double still;  // a pass that moves no corner farther is the last [px]
  double eager;  // times the step: it falls short, for pixels near where the line was count more
};
constexpr Effort kQuick{.passes = 3, .still = 0.3, .eager = 1.5},
    kCareful{.passes = 5, .still = 0.2, .eager = 1.0};

/// Pixels across one side, in lines, and where each line crosses the bar.
template <int kLines>
class Strip {
 public:
  using Lines = Eigen::Array<float, kLines, 1>;

  /// Reads the picture across a side from y = `from` to `to`.
  void read(const Image& image, const Side& side, double from, double to, double bar_px,
            double margin) {
    side_ = side, count_ = 0;
    const double lean = std::sqrt(1.0 + side.lean() * side.lean()),
                 half_bar = std::min(0.5 * bar_px * lean, 1e6);
    const int reach = static_cast<int>(half_bar + margin * lean + 0.5),
              breadth = side.level ? image.height() : image.width();
    step_ = 1 + 2 * reach / kWidest;
    half_ = reach / step_;
    const int first = static_cast<int>(std::clamp(from + 1.0, 0.0, 1e6));
    const int last = static_cast<int>(
        std::max(-1.0, std::min((side.level ? image.width() : image.height()) - 1.0, to)));
    const int lines = std::min(kLines, last - first + 1), beyond = step_ * half_,
              starts = breadth - 2 * beyond;
    if (lines < 1 || starts <= 0 || !(std::abs(side.at_0) < 1e6)) return;
    // All in 1/65536 px: what is shifted need not be converted for each line.
    constexpr int kBits = 16;
    constexpr std::int64_t kOne = 1 << kBits;
    const std::int64_t apart = kOne * (last - first) / std::max(1, lines - 1);
    const auto slope = static_cast<std::int64_t>(kOne * side.slope),
               at_0 = static_cast<std::int64_t>(kOne * side.at_0);
    // of a large picture's squares: twice as many bits
    const auto curve = static_cast<std::int64_t>(kOne * static_cast<double>(kOne) *
                                                 std::clamp(side.curve, -kMostCurve, kMostCurve));
    const int n = 2 * half_ + 1;
    std::array<int, static_cast<std::size_t>(kLines)> y, off;
    Levels *const luma = colors_[0].data(), *const u = colors_[1].data(),
                  *const v = colors_[2].data();
    std::int64_t along = kOne * first;
    for (int k = 0; k < lines; ++k, along += apart) {
      const int at = static_cast<int>(along >> kBits);
      const std::int64_t x = at_0 + slope * at + (curve * at * at >> kBits);
      const int middle = static_cast<int>((x + kOne / 2) >> kBits), start = middle - beyond;
      if (static_cast<unsigned>(start) >= static_cast<unsigned>(starts)) continue;
      const auto line = static_cast<std::size_t>(count_);
      std::size_t i = 0;
      const auto take = [&](Yuv c) {
        luma[i][line] = c.y, u[i][line] = c.u, v[i][line] = c.v, ++i;
      };
      if (side.level)
        image.visit_column(at, start, step_, n, take);
      else
        image.visit_row(start, at, step_, n, take);
      y[line] = at, off[line] = static_cast<int>(x - kOne * middle);
      ++count_;
    }
    if (count_ == 0) return;
    // Unused lanes are padded with zeros at the first line's position: they add nothing to sums.
    if (count_ < kLines) {
      std::fill(y.begin() + count_, y.end(), y[0]),
          std::fill(off.begin() + count_, off.end(), off[0]);
      for (auto& color : colors_)
        for (int i = 0; i < n; ++i)
          std::fill(color[static_cast<std::size_t>(i)].begin() + count_,
                    color[static_cast<std::size_t>(i)].end(), std::uint8_t{0});
    }
    y_ = Eigen::Map<const Eigen::Array<int, kLines, 1>>(y.data()).template cast<float>();
    off_ = Eigen::Map<const Eigen::Array<int, kLines, 1>>(off.data()).template cast<float>() /
           static_cast<float>(kOne * step_);
    const int core = static_cast<int>(std::max(0.6, 0.5 * half_bar)) / step_;
    bar_ = mean(half_ - core, 2 * core + 1), before_ = mean(0, 2), behind_ = mean(2 * half_ - 1, 2);
  }

  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// Whether what was read is still across this side, and near enough to its middle.
  [[nodiscard]] bool fits(const Side& side) const {
    return count_ > 0 && side.level == side_.level &&
           off_from(side).abs().maxCoeff() * static_cast<float>(step_) < kNear;
  }
  /// Length of the side in view: from the first line to the last; and its middle.
  [[nodiscard]] double length() const { return y_[count_ - 1] - y_[0]; }
  [[nodiscard]] double middle() const { return 0.5 * (y_[count_ - 1] + y_[0]); }

  /// Colour of the bar less that of what is beside it.
  [[nodiscard]] Eigen::Vector3f contrast() const { return bar_ - 0.5f * (before_ + behind_); }

  /// A line through the bar's middles: least squares, twice, those far off counting less the second
  /// time.
  /// @param contrast  of a bar; how far a pixel is on that way from the colour beside, which
  ///     changes evenly from one flank to the other, says how much of it is bar.
  /// @param curvature  where it is not null and there is such a line: what the crossings say of it.
  [[nodiscard]] Side line(const Side& rough, const Eigen::Vector3f& contrast, double bar_px,
                          double eager, Curvature* curvature) const {
    if (count_ < kLeastLines) return rough;
    const Lines off = off_from(rough);
    const auto [sum, moment] = bar_pixels(off, contrast);
    const float least =
        kLeastShown * std::max(1.0f, static_cast<float>(bar_px)) / static_cast<float>(step_);
    // Lines that are not there show nothing.
    Lines shown;
    for (int k = 0; k < kLines; ++k) shown[k] = sum[k] >= least ? 1.0f : 0.0f;
    if (shown.sum() < kLeastLines) return rough;
    const float y_middle = static_cast<float>(middle()),
                half_length = 0.5f * static_cast<float>(length());
    // The rough line counts as a crossing at either end: a side that shows little of itself must
    // not swing.
    const Lines y = y_ - y_middle,
                x = shown * static_cast<float>(step_) * (moment / sum.max(1e-6f) - off);
    double shift = 0.0, slope = 0.0;  // beside the rough line
    Lines weight;
    for (int pass = 0; pass < 2; ++pass) {
      const Lines left = x - static_cast<float>(shift) - static_cast<float>(slope) * y;
      const Lines w = pass == 0 ? shown : Lines{shown / (1.0f + 0.5f * left * left)};
      const double n = w.sum() + kRough, n_y = (w * y).sum(),
                   n_yy = (w * y * y).sum() + kRough * half_length * half_length,
                   n_x = (w * x).sum(), n_xy = (w * x * y).sum();
      const double det = n * n_yy - n_y * n_y;
      if (!(det > 1e-3)) return rough;
      slope = (n * n_xy - n_x * n_y) / det, shift = (n_x - slope * n_y) / n;
      weight = w;
    }
    if (curvature != nullptr)
      *curvature = curvature_of(y, x - static_cast<float>(shift) - static_cast<float>(slope) * y,
                                weight, y_middle);
    Side line = rough;
    line.slope += eager * slope;
    line.at_0 += eager * (shift - slope * y_middle);
    return line;
  }

 private:
  // @param y  of the lines, from `middle` on; @param left  of their crossings, beside a line
  [[nodiscard]] static Curvature curvature_of(const Lines& y, const Lines& left,
                                              const Lines& weight, double middle) {
    const Lines yy = y * y, wy = weight * y;
    const double n = weight.sum(), n_y = wy.sum(), n_yy = (weight * yy).sum(),
                 n_yyy = (wy * yy).sum(), det = n * n_yy - n_y * n_y;
    if (!(det > 1e-3)) return {};
    const double b = (n * n_yyy - n_y * n_yy) / det, a = (n_yy - b * n_y) / n;
    const Lines bent = yy - static_cast<float>(b) * y - static_cast<float>(a);
    // y is the side's own less the middle
    return {.moment = (weight * left * bent).sum(),
            .weight = (weight * bent * bent).sum(),
            .part = a - (b + middle) * middle,
            .y_part = b + 2.0 * middle};
  }

  using Levels = std::array<std::uint8_t, static_cast<std::size_t>(kLines)>;  // one of each line
  // Color by color, pixel by pixel of a line, line by line.
  std::array<std::array<Levels, kWidest>, 3> colors_;
  // of a line; from its middle pixel to the side it was read along [steps]
  Lines y_, off_;
  Eigen::Vector3f bar_, before_, behind_;  // mean colours
  int step_ = 1, half_ = 0, count_ = 0;
  Side side_;  // along which it was read

  [[nodiscard]] Lines off_from(const Side& side) const {
    Lines off = static_cast<float>(side.at_0 - side_.at_0) +
                static_cast<float>(side.slope - side_.slope) * y_;
    if (side.curve != side_.curve) off += static_cast<float>(side.curve - side_.curve) * y_ * y_;
    return off_ + off / static_cast<float>(step_);
  }

  // Counts the pixels of each line that are bar, those at its ends counting less; and the same
  // times where they are. In whole numbers, line beside line: compilers take several at once.
  [[nodiscard]] std::pair<Lines, Lines> bar_pixels(const Lines& off_middle,
                                                   const Eigen::Vector3f& contrast) const {
    // How far each colour is on the way from what is beside, 0, to the bar, `full`.
    const Eigen::Vector3f weighted = contrast.cwiseProduct(Eigen::Vector3f{kLuma, 1.0f, 1.0f}),
                          unit = kWayUnit / weighted.norm() * weighted;
    const Eigen::Vector3i way = unit.cast<int>();
    const Eigen::Vector3f way_f = way.cast<float>();
    const float full = contrast.dot(unit), beside = way_f.dot(before_),
                change = way_f.dot(behind_ - before_) / static_cast<float>(2 * half_);
    const int most = static_cast<int>(kBeyondBar * full),
              halvings = static_cast<int>(std::bit_width(static_cast<unsigned>(full))) - kBarBits;
    const float per_pixel = kEnd / (static_cast<float>(half_) + 0.5f);
    using Numbers = Eigen::Array<int, kLines, 1>;
    const Numbers middle = (per_pixel * off_middle).template cast<int>();
    Numbers sum = Numbers::Zero(), moment = Numbers::Zero();
    for (int i = -half_; i <= half_; ++i) {
      const auto pixel = static_cast<std::size_t>(i + half_);
      const Levels &y = colors_[0][pixel], &u = colors_[1][pixel], &v = colors_[2][pixel];
      const int here = static_cast<int>(per_pixel * static_cast<float>(i)),
                none = static_cast<int>(beside + change * static_cast<float>(i + half_));
      for (int k = 0; k < kLines; ++k) {
        const auto line = static_cast<std::size_t>(k);
        const int on_way = way[0] * y[line] + way[1] * u[line] + way[2] * v[line] - none,
                  shown = std::clamp(on_way, 0, most) >> halvings;
        const int off = here - middle[k], weight = std::max(0, kWhole - (off * off >> kEndBits)),
                  part = shown * (weight * weight >> kWholeBits) >> (kWholeBits - 1);
        sum[k] += part, moment[k] += part * i;
      }
    }
    const float pixel = 0.5f * static_cast<float>(1 << halvings) / full;  // a part is half as much
    return {pixel * sum.template cast<float>(), pixel * moment.template cast<float>()};
  }

  // Mean colour of so many pixels of each line.
  [[nodiscard]] Eigen::Vector3f mean(int first, int pixels) const {
    Eigen::Vector3f mean;
    for (std::size_t color = 0; color < 3; ++color) {
      int sum = 0;
      for (int i = first; i < first + pixels; ++i)
        for (const int level : colors_[color][static_cast<std::size_t>(i)]) sum += level;
      mean[static_cast<Eigen::Index>(color)] =
          static_cast<float>(sum) / static_cast<float>(std::max(1, count_ * pixels));
    }
    return mean;
  }
};

// Crossing of bent sides near `corner`.
std::optional<Eigen::Vector2d> crossing_near(Eigen::Vector2d corner, const Side& before,
                                             const Side& after) {
  for (int step = 0; step < 2; ++step) {
    const auto met =
        crossing(before.tangent(before.along(corner)), after.tangent(after.along(corner)));
    if (!met) return std::nullopt;
    corner = *met;
  }
  return corner;
}

template <int kLines>
Quad refined(const Image& image, const Quad& frame, double bar_px, double margin,
             const Effort& effort, const SideCurves& curves) {
  Quad corners = frame;
  std::array<Strip<kLines>, 4> strips;
  UnknownBend unknown{image, frame, curves};
  const bool guess = !curves.known() && unknown.shows();
  std::array<Curvature, 4> curvatures;
  for (int pass = 0; pass < effort.passes; ++pass) {
    const auto side = [&](std::size_t i) {
      const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % 4];
      Side between{a, b};
      if (guess)
        between.bend(a, b, unknown.sag(a, b));
      else if (curves.bent())
        between.bend(a, b, curves.sag(a, b));
      return between;
    };
    std::array<Side, 4> sides{side(0), side(1), side(2), side(3)};
    for (std::size_t i = 0; i < 4; ++i) {
      if (pass > 0 && strips[i].fits(sides[i])) continue;
      const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % 4];
      const double end = std::min(0.25, (0.5 * bar_px + kEnds) / std::max(1e-9, (b - a).norm()));
      const double from = sides[i].along(a + end * (b - a)), to = sides[i].along(b - end * (b - a));
      strips[i].read(image, sides[i], std::min(from, to), std::max(from, to), bar_px, margin);
    }
    // One colour for all bars: a side that is off by its bar's width takes the bar for what is
    // beside it.
    Eigen::Vector3f contrast = Eigen::Vector3f::Zero();
    int shown = 0;
    for (const auto& s : strips)
      if (!s.empty()) contrast += s.contrast(), ++shown;
    contrast /= static_cast<float>(std::max(1, shown));
    if (!(contrast.squaredNorm() >= kLeastContrast * kLeastContrast)) return corners;
    for (std::size_t i = 0; i < 4; ++i) {
      curvatures[i] = {};
      sides[i] = strips[i].line(sides[i], contrast, bar_px, effort.eager,
                                guess ? &curvatures[i] : nullptr);
    }
    if (guess) unknown.adapt(corners, curvatures, effort.eager, sides);
    // A side of which the border leaves little says where it is, the opposite one how it leans.
    for (std::size_t i = 0; i < 4; ++i) {
      const Side& opposite = sides[(i + 2) % 4];
      const double length =
          std::abs(sides[i].along(corners[(i + 1) % 4]) - sides[i].along(corners[i]));
      if (!strips[i].empty() && strips[i].length() < kLittle * length &&
          opposite.level == sides[i].level)
        sides[i].lean_like(opposite, strips[i].middle());
    }
    Quad now;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t before = (i + 3) % 4, next = (i + 1) % 4;
      const auto on = [&](std::size_t k, std::size_t end) {
        return sides[k].at(sides[k].along(corners[end]));
      };
      const auto corner = guess           ? crossing_near(corners[i], sides[before], sides[i])
                          : curves.bent() ? curves.crossing(on(before, before), on(before, i),
                                                            on(i, i), on(i, next))
                                          : crossing(sides[before], sides[i]);
      if (!corner) return frame;
      now[i] = *corner;
    }
    if (!(largest_move(now, frame) < bar_px + kLeap)) return frame;
    const double moved = largest_move(now, corners);
    corners = now;
    if (moved < effort.still) break;
  }
  return corners;
}

}  // namespace

Quad refined_corners(const Image& image, const Quad& frame, double bar, RefinementEffort effort,
                     const SideCurves& curves) {
  const double bar_px = bar * std::sqrt(std::abs(area(frame)));
  const double margin =
      bar / (1.0 + bar) < kLeastBoard ? kMargin : std::max(kMargin, kMarginOfBoard * bar_px);
  if (effort == RefinementEffort::kCareful)
    return refined<32>(image, frame, bar_px, margin, kCareful, curves);
  return refined<16>(image, frame, bar_px, margin, kQuick, curves);
}

}  // namespace gatefly
