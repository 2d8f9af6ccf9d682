// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/corner_refinement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {
namespace {

constexpr int kMostLines = 32, kWidest = 31;  // lines of pixels; pixels of a line
constexpr double kMargin = 2.0;               // beside a bar [px]
constexpr double kEnds = 2.0;                 // beside the half of the bar that crosses at either end [px]
constexpr int kLeastContrast = 4;             // grey levels between the colours of a bar and of what is beside it
constexpr double kLeastShown = 0.35;          // of a bar's width, on a line that counts
constexpr double kStill = 0.05, kLeap = 3.0;  // px

// A side as x = at_0 + slope y. For a level one x and y are swapped: lines of constant y always cross the bar.
struct Side {
  double at_0 = 0.0, slope = 0.0;
  bool level = false;

  Side(const Eigen::Vector2d& a, const Eigen::Vector2d& b) : level{std::abs(b.x() - a.x()) > std::abs(b.y() - a.y())} {
    const double length = along(b) - along(a);
    slope = (across(b) - across(a)) / (std::abs(length) > 1e-9 ? length : 1e-9);
    at_0 = across(a) - slope * along(a);
  }
  [[nodiscard]] double along(const Eigen::Vector2d& p) const { return level ? p.x() : p.y(); }
  [[nodiscard]] double across(const Eigen::Vector2d& p) const { return level ? p.y() : p.x(); }
  [[nodiscard]] double x(double y) const { return at_0 + slope * y; }
  /// n · p = c, as (n, c).
  [[nodiscard]] Eigen::Vector3d equation() const { return level ? Eigen::Vector3d{-slope, 1.0, at_0} : Eigen::Vector3d{1.0, -slope, at_0}; }
};

std::optional<Eigen::Vector2d> crossing(const Side& before, const Side& after) {
  const Eigen::Vector3d m = before.equation(), n = after.equation();
  const double det = m[0] * n[1] - m[1] * n[0];
  if (!(std::abs(det) > 0.2 * m.head<2>().norm() * n.head<2>().norm())) return std::nullopt;
  return Eigen::Vector2d{(m[2] * n[1] - m[1] * n[2]) / det, (m[0] * n[2] - m[2] * n[0]) / det};
}

struct Color {
  int y = 0, u = 0, v = 0;
  Color& operator+=(const Color& c) { return y += c.y, u += c.u, v += c.v, *this; }
};

/// The middle of a bar where a line of pixels crosses it.
struct Crossing {
  double y, x;
};
using Crossings = FixedList<Crossing, kMostLines>;

/// Pixels across one side, line by line, and what of each is bar.
class Strip {
 public:
  Strip(const Image& image, const Side& side, double from, double to, double bar_px, int lines) {
    const double lean = std::sqrt(1.0 + side.slope * side.slope), half_bar = 0.5 * bar_px * lean;
    const int reach = static_cast<int>(half_bar + kMargin * lean + 0.5), breadth = side.level ? image.height() : image.width();
    step_ = 1 + 2 * reach / kWidest;
    wide_ = 1 + 2 * (reach / step_);
    const int first = std::max(0, static_cast<int>(std::ceil(from))), last = std::min((side.level ? image.width() : image.height()) - 1, static_cast<int>(std::floor(to)));
    lines = std::min({lines, kMostLines, last - first + 1});
    const int core = static_cast<int>(std::max(0.6, 0.5 * half_bar) / step_);
    for (int k = 0; k < lines; ++k) {
      const int y = first + (last - first) * k / std::max(1, lines - 1);
      const int middle = static_cast<int>(std::lround(std::clamp(side.x(y), -1e6, 1e6))), x = middle - step_ * (wide_ / 2);
      if (x < 0 || x + step_ * (wide_ - 1) >= breadth) continue;
      Line& line = lines_[static_cast<std::size_t>(count_++)];
      line.y = y, line.x = x;
      for (int i = 0; i < wide_; ++i) {
        const Yuv c = side.level ? image.at(y, x + i * step_) : image.at(x + i * step_, y);
        line.pixels[static_cast<std::size_t>(i)] = {c.y, c.u, c.v};
      }
      for (int i = wide_ / 2 - core; i <= wide_ / 2 + core; ++i) bar_ += line.pixels[static_cast<std::size_t>(i)], ++bar_count_;
      for (const int i : {0, 1}) {
        before_ += line.pixels[static_cast<std::size_t>(i)];
        behind_ += line.pixels[static_cast<std::size_t>(wide_ - 1 - i)];
      }
    }
  }

  /// None where the bar does not differ from what is beside it.
  [[nodiscard]] Crossings crossings(double bar_px) const {
    Crossings found;
    if (count_ == 0) return found;
    // How far a pixel is on the way from the colour beside, which changes evenly from one flank to the other, to the bar's.
    using Vector = Eigen::Vector3f;
    const auto mean = [](const Color& sum, int n) -> Vector { return Vector{static_cast<float>(sum.y), static_cast<float>(sum.u), static_cast<float>(sum.v)} / static_cast<float>(n); };
    const Vector before = mean(before_, 2 * count_), behind = mean(behind_, 2 * count_);
    const Vector contrast = mean(bar_, bar_count_) - 0.5f * (before + behind);
    if (contrast.squaredNorm() < kLeastContrast * kLeastContrast) return found;
    const Vector scale = contrast / contrast.squaredNorm();
    const float beside = scale.dot(before), change = scale.dot(behind - before) / static_cast<float>(wide_ - 1);
    for (int k = 0; k < count_; ++k) {
      const Line& line = lines_[static_cast<std::size_t>(k)];
      float sum = 0.0f, moment = 0.0f;
      for (int i = 0; i < wide_; ++i) {
        const Color& c = line.pixels[static_cast<std::size_t>(i)];
        const float on = scale.x() * static_cast<float>(c.y) + scale.y() * static_cast<float>(c.u) + scale.z() * static_cast<float>(c.v) - beside - change * static_cast<float>(i);
        const float part = std::clamp(on, 0.0f, 1.2f);
        sum += part, moment += part * static_cast<float>(i);
      }
      if (sum * static_cast<float>(step_) < kLeastShown * std::max(1.0, bar_px)) continue;
      (void)found.push_back({static_cast<double>(line.y), line.x + step_ * static_cast<double>(moment / sum)});
    }
    return found;
  }

 private:
  struct Line {
    int y, x;  ///< Of the first pixel.
    std::array<Color, kWidest> pixels;
  };
  std::array<Line, kMostLines> lines_;
  Color bar_, before_, behind_;  // sums
  int step_ = 1, wide_ = 0, count_ = 0, bar_count_ = 0;
};

// Least squares, three times, those far off counting ever less.
Side line_through(const Crossings& crossings, const Side& rough) {
  Side line = rough;
  if (crossings.size() < 4) return line;
  const double middle = 0.5 * (crossings[0].y + crossings.back().y);
  for (int pass = 0; pass < 3; ++pass) {
    double n = 0, n_y = 0, n_yy = 0, n_x = 0, n_xy = 0;
    const auto count = [&](const Crossing& c, double w) {
      const double y = c.y - middle;
      n += w, n_y += w * y, n_yy += w * y * y, n_x += w * c.x, n_xy += w * c.x * y;
    };
    // The rough line counts as a crossing at either end: a side that shows little of itself must not swing.
    for (const Crossing& end : {crossings[0], crossings.back()}) count({end.y, rough.x(end.y)}, 1.0);
    for (const Crossing& c : crossings) {
      const double off = c.x - line.x(c.y);
      count(c, pass == 0 ? 1.0 : 1.0 / (1.0 + off * off));
    }
    const double det = n * n_yy - n_y * n_y;
    if (!(det > 1e-3)) return rough;
    line.slope = (n * n_xy - n_x * n_y) / det;
    line.at_0 = (n_x - line.slope * n_y) / n - line.slope * middle;
  }
  return line;
}

Side refined_side(const Image& image, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double bar_px, int lines) {
  const Side rough{a, b};
  const double end = std::min(0.25, (0.5 * bar_px + kEnds) / std::max(1e-9, (b - a).norm()));
  const double from = rough.along(a + end * (b - a)), to = rough.along(b - end * (b - a));
  const Strip strip{image, rough, std::min(from, to), std::max(from, to), bar_px, lines};
  return line_through(strip.crossings(bar_px), rough);
}

double largest_move(const Quad& a, const Quad& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < 4; ++i) most = std::max(most, (a[i] - b[i]).squaredNorm());
  return std::sqrt(most);
}

}  // namespace

Quad refined_corners(const Image& image, const Quad& frame, double bar_px, RefinementEffort effort) {
  Quad corners = frame;
  for (int pass = 0; pass < effort.passes; ++pass) {
    const auto side = [&](std::size_t i) { return refined_side(image, corners[i], corners[(i + 1) % 4], bar_px, effort.lines); };
    const std::array<Side, 4> sides{side(0), side(1), side(2), side(3)};
    Quad now;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto corner = crossing(sides[(i + 3) % 4], sides[i]);
      if (!corner) return frame;
      now[i] = *corner;
    }
    if (!(largest_move(now, frame) < bar_px + kLeap)) return frame;
    const double moved = largest_move(now, corners);
    corners = now;
    if (moved < kStill) break;
  }
  return corners;
}

}  // namespace gatefly
