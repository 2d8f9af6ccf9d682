// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/lens_bend.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/detection/search/frame.hpp"
#include "gatefly/geometry/divisor.hpp"
#include "gatefly/geometry/exponential.hpp"

namespace gatefly {

/// How closely a frame is looked at.
struct FrameEffort {
  int samples = 24;   ///< Samples of a side for its score, at most.
  int stations = 12;  ///< Stations of a side for moving it.
  int middles = 32;   ///< Samples of a side for centring it.
};

/// How far beside a bar it has to be empty, of the side.
inline constexpr double kBesideBar = 0.0637;

/// The cell nearest to x, which is more than -2^14: floor(x + 1/2), a call on older processors; so
/// the fast search takes 5 % less.
[[nodiscard]] inline int nearest_cell(double x) {
  constexpr int kAbove = 1 << 14;
  return static_cast<int>(x + (kAbove + 0.5)) - kAbove;
}

/// Fits frames to evidence: any function (x, y) of whole cells or pixels, in 1/16 nats. One that
/// knows a faster way for places along a line or a row has `along` and `across`, as
/// BarFinder::Evidence has.
template <class Evidence, FrameEffort kEffort = FrameEffort{}>
class FrameFit {
 public:
  /// @param bar  bar width / side of the bars' middle lines.
  explicit FrameFit(const Evidence& evidence, const FrameWeights& weights = {},
                    double bar = kThinBar)
      : evidence_{evidence}, weights_{weights}, half_bar_{0.5 * bar} {}

  [[nodiscard]] const FrameWeights& weights() const { return weights_; }

  [[nodiscard]] FrameScore score(const Quad& q) const {
    FrameScore s;
    double length = 0.0;
    int unseen = 0;
    for (std::size_t i = 0; i < 4; ++i) length += 0.25 * (q[(i + 1) % 4] - q[i]).norm();
    const double off = std::max(off_min_, (half_bar_ + kBesideBar) * length);
    const int lines = lines_beside(length);
    s.weakest = 1e9;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d a = q[i], d = q[(i + 1) % 4] - a, sag = curves_.sag(a, a + d);
      const Eigen::Vector2d in = Eigen::Vector2d{-d.y(), d.x()} / std::max(1e-9, d.norm());
      s.side[i] = along(a, d, sag);
      for (int k = 1; k <= lines; ++k) {
        const Eigen::Vector2d beside = 0.6 * half_bar_ * length * k / lines * in;
        s.side[i] += along(a + beside, d, sag) + along(a - beside, d, sag);
      }
      s.side[i] /= 1 + 2 * lines;
      s.mean += 0.25 * s.side[i];
      s.weakest = std::min(s.weakest, s.side[i]);
      s.inside += 0.25 * std::max(-1.0, along(a + off * in, d, sag, {0.12, 0.76}));
      // Samples outside of the picture count neither for nor against.
      if (shows(a + 0.5 * d - off * in))
        s.outside += 0.25 * std::max(-1.0, along(a - off * in, d, sag));
      s.beyond += 0.125 * (beyond(a, -d, sag) + beyond(a + d, d, sag));
      unseen += !shows(a + 0.5 * d);
    }
    s.inside = std::max(s.inside, middle(q));
    s.total = s.mean + weights_.weakest * s.weakest - weights_.inside * s.inside -
              weights_.outside * s.outside - weights_.beyond * (s.beyond - kUndecidedBeyond) +
              weights_.size * gatefly::log2(std::max(1.0, length * cell_px_) / 50.0) +
              weights_.added - kUnseenSide * unseen;
    return s;
  }

  /// Every side moved to the best line within `reach` of it at either end; the new corners.
  [[nodiscard]] std::optional<Quad> moved(const Quad& q, int reach) const {
    std::array<Line, 4> lines;
    for (std::size_t i = 0; i < 4; ++i) lines[i] = best_line(q[i], q[(i + 1) % 4], reach);
    return corners(lines);
  }

  /// Every side through the middle of the bar, sub-pixel, within `reach` of it.
  [[nodiscard]] std::optional<Quad> centered(const Quad& q, int reach) const {
    std::array<Line, 4> lines;
    for (std::size_t i = 0; i < 4; ++i) lines[i] = middle_line(q[i], q[(i + 1) % 4], reach);
    return corners(lines);
  }

  struct Line {
    Eigen::Vector2d a, b;
  };
  /// A line through the middle of the bar, sub-pixel, within `reach` of a and b.
  [[nodiscard]] Line centered_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                                   int reach) const {
    return middle_line(a, b, reach);
  }

  /// Crossing of two lines; nullopt when they are nearly parallel.
  [[nodiscard]] static std::optional<Eigen::Vector2d> crossing(const Line& before,
                                                               const Line& after) {
    const Eigen::Vector2d d = before.b - before.a, e = after.b - after.a, to = after.a - before.a;
    const double cross = d.x() * e.y() - d.y() * e.x();
    if (!(std::abs(cross) > 0.2 * d.norm() * e.norm())) return std::nullopt;
    return before.a + (to.x() * e.y() - to.y() * e.x()) / cross * d;
  }

  /// Evidence at the nearest cell.
  [[nodiscard]] int at(const Eigen::Vector2d& p) const {
    return evidence_(nearest_cell(p.x()), nearest_cell(p.y()));
  }

  /// Evidence at `count` places from `a` on, `step` apart: visit(k, evidence).
  template <class Visit>
  void each_along(const Eigen::Vector2d& a, const Eigen::Vector2d& step, int count,
                  const Visit& visit) const {
    // In 1/2^16 cells: what is shifted need not be converted each time, and is rounded down.
    constexpr double kOne = 1 << 16;
    auto x = static_cast<std::int64_t>((a.x() + 0.5) * kOne),
         y = static_cast<std::int64_t>((a.y() + 0.5) * kOne);
    const auto dx = static_cast<std::int64_t>(step.x() * kOne),
               dy = static_cast<std::int64_t>(step.y() * kOne);
    if constexpr (requires { evidence_.along(x, y, dx, dy, count, visit); })
      evidence_.along(x, y, dx, dy, count, visit);
    else
      for (int k = 0; k < count; ++k, x += dx, y += dy)
        visit(k, evidence_(static_cast<int>(x >> 16), static_cast<int>(y >> 16)));
  }

  /// Evidence at `count` cells from the one nearest to p on, to the right or down: visit(evidence).
  template <class Visit>
  void each_across(const Eigen::Vector2d& p, bool down, int count, const Visit& visit) const {
    const int x = nearest_cell(p.x()), y = nearest_cell(p.y());
    if constexpr (requires { evidence_.across(x, y, down, count, visit); })
      evidence_.across(x, y, down, count, visit);
    else
      for (int k = 0; k < count; ++k) visit(down ? evidence_(x, y + k) : evidence_(x + k, y));
  }

  void set_least_offset(double cells) { off_min_ = cells; }
  void set_cell_size(double px) { cell_px_ = px; }
  /// Limits frames to the picture; else all is in it [cells].
  void set_bounds(double width, double height) { width_ = width, height_ = height; }
  /// Sides are the images of straight bars, from corner to corner. @param curves  in cells.
  void set_curves(const SideCurves& curves) { curves_ = curves; }

 private:
  static constexpr int kStations = kEffort.stations, kMiddles = kEffort.middles, kMostReach = 12,
                       kMostLines = 3, kLanes = 8,  // places that are summed at once
      kRow = 2 * kMostReach + 1 + kLanes;           // of a strip, from station to station
  // Bar over side of the Bebop's gates.
  static constexpr double kThinBar = 0.05 / 0.95, kUndecidedBeyond = -0.6, kUnseenSide = 0.75;

  // A wide bar is looked at along several lines, so that letters and patterns on it do not matter:
  // so many on either side of the middle one.
  [[nodiscard]] int lines_beside(double length) const {
    return std::min(static_cast<int>(0.3 * half_bar_ * length), kMostLines);
  }

  [[nodiscard]] bool shows(const Eigen::Vector2d& p) const {
    return p.x() > -0.5 && p.y() > -0.5 && p.x() < width_ - 0.5 && p.y() < height_ - 0.5;
  }

  // How far beside its chord a bar is at t = 0..1.
  [[nodiscard]] static Eigen::Vector2d bow(const Eigen::Vector2d& sag, double t) {
    return 4.0 * t * (1.0 - t) * sag;
  }

  struct Piece {
    double from = 0.0, length = 1.0;
  };
  // Mean evidence along a piece of a side, or beside one as bent.
  [[nodiscard]] double along(const Eigen::Vector2d& a, const Eigen::Vector2d& side,
                             const Eigen::Vector2d& sag, const Piece& piece = {}) const {
    const Eigen::Vector2d d = piece.length * side, first = a + piece.from * side;
    const int n = std::clamp(static_cast<int>(d.norm() * 0.6), 8, kEffort.samples);
    const Eigen::Vector2d step = d / n;
    int sum = 0;
    if (curves_.bent())
      for (int k = 0; k < n; ++k) {
        const double part = (k + 0.5) / n;
        sum += at(first + part * d + bow(sag, piece.from + part * piece.length));
      }
    else
      each_along(first + 0.5 * step, step, n, [&](int, int evidence) { sum += evidence; });
    return sum / (16.0 * n);
  }

  // Past a corner: what a bar goes on to is the bar of something larger.
  [[nodiscard]] double beyond(const Eigen::Vector2d& corner, const Eigen::Vector2d& d,
                              const Eigen::Vector2d& sag) const {
    constexpr double kFirst = 0.10, kApart = 0.06;
    constexpr int kCount = 4, kLeast = -24;
    if (!shows(corner + (kFirst + kApart) * d)) return kUndecidedBeyond;
    int sum = 0;
    if (curves_.bent())
      for (int k = 0; k < kCount; ++k) {
        const double t = kFirst + kApart * k;
        sum += std::max(kLeast, at(corner + t * d + bow(sag, -t)));
      }
    else
      each_along(corner + kFirst * d, kApart * d, kCount,
                 [&](int, int evidence) { sum += std::max(kLeast, evidence); });
    return sum / (16.0 * kCount);
  }

  [[nodiscard]] double middle(const Quad& q) const {
    constexpr int kGrid = 5;
    constexpr double kFirst = 0.22, kApart = 0.14;
    int sum = 0;
    for (int i = 0; i < kGrid; ++i) {
      const double v = kFirst + kApart * i;
      const Eigen::Vector2d left = q[0] + v * (q[3] - q[0]),
                            across = q[1] + v * (q[2] - q[1]) - left;
      each_along(left + kFirst * across, kApart * across, kGrid,
                 [&](int, int evidence) { sum += std::max(-16, evidence); });
    }
    return sum / (16.0 * kGrid * kGrid);
  }

  // The strip beside a side, station by station.
  template <int kCount>
  struct Strip {
    // a row is read in whole lanes: there is more of it than is filled
    std::array<std::int16_t, static_cast<std::size_t>(kCount* kRow)> value{};
    Eigen::Vector2d normal;
  };
  [[nodiscard]] static constexpr double station(int j, int count) {
    return 0.06 + 0.88 * j / (count - 1);
  }
  template <int kCount>
  [[nodiscard]] Strip<kCount> strip(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                                    int reach) const {
    Strip<kCount> s;
    const Eigen::Vector2d d = b - a, sag = curves_.sag(a, b);
    s.normal = Eigen::Vector2d{-d.y(), d.x()} / std::max(1e-9, d.norm());
    for (int j = 0; j < kCount; ++j) {
      std::int16_t* const first = s.value.data() + j * kRow + kMostReach - reach;
      Eigen::Vector2d middle = a + station(j, kCount) * d;
      if (curves_.bent()) middle += bow(sag, station(j, kCount));
      each_along(middle - reach * s.normal, s.normal, 2 * reach + 1,
                 [&](int o, int evidence) { first[o] = static_cast<std::int16_t>(evidence); });
    }
    return s;
  }

  [[nodiscard]] Line best_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                               int reach) const {
    const int half = std::min(static_cast<int>(0.6 * half_bar_ * (b - a).norm()), kMostReach / 2);
    reach = std::min(reach, kMostReach - half);
    Strip<kStations> s = strip<kStations>(a, b, half > 1 ? reach + half : reach);
    if (half > 1) widen(s, reach, half);
    // Ends `slope` apart: what a station adds is the same row, farther on, for all of them.
    int best = -1 << 30, best_from = 0, best_to = 0;
    for (int slope = -2 * reach; slope <= 2 * reach; ++slope) {
      const auto& rows = kRowsOfSlope[static_cast<std::size_t>(slope + 2 * kMostReach)];
      const int last = std::min(reach, reach - slope);
      for (int first = std::max(-reach, -reach - slope); first <= last; first += kLanes) {
        std::array<std::int16_t, kLanes> sums{};
        const std::int16_t* const from_first = s.value.data() + kMostReach + first;
        for (std::size_t j = 0; j < rows.size(); ++j) {
          const std::int16_t* const row = from_first + rows[j];
          for (std::size_t k = 0; k < kLanes; ++k)
            sums[k] = static_cast<std::int16_t>(sums[k] + row[k]);
        }
        for (int from = first; from <= std::min(last, first + kLanes - 1); ++from) {
          const int to = from + slope;
          // Among equals the nearest, then the first.
          const int worth = 1024 * (sums[static_cast<std::size_t>(from - first)] -
                                    2 * (std::abs(from) + std::abs(to))) -
                            32 * from - to;
          if (worth > best) best = worth, best_from = from, best_to = to;
        }
      }
    }
    return {a + best_from * s.normal, b + best_to * s.normal};
  }

  // Every value becomes the mean of those within `half` of it: of a bar's width instead of a line.
  template <int kCount>
  static void widen(Strip<kCount>& s, int reach, int half) {
    const Divisor mean{2 * half + 1};
    for (int j = 0; j < kCount; ++j) {
      std::int16_t* const value = s.value.data() + j * kRow;
      std::array<std::int16_t, kRow> narrow;
      std::copy_n(value, kRow, narrow.begin());
      const auto at = [&narrow](int o) { return int{narrow[static_cast<std::size_t>(o)]}; };
      int sum = 0;
      for (int o = kMostReach - reach - half; o < kMostReach - reach + half; ++o) sum += at(o);
      for (int o = kMostReach - reach; o <= kMostReach + reach; ++o) {
        sum += at(o + half);
        value[o] = static_cast<std::int16_t>(sum < 0 ? -mean(-sum) : mean(sum));
        sum -= at(o - half);
      }
    }
  }

  [[nodiscard]] Line middle_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                                 int reach) const {
    // Along rows or columns, whichever cross the side more steeply.
    const Eigen::Vector2d d = b - a, sag = curves_.sag(a, b);
    const bool down = std::abs(d.x()) > std::abs(d.y());
    const Eigen::Vector2d axis{down ? 0.0 : 1.0, down ? 1.0 : 0.0};
    // Weighted least squares of the bar's middle at every station that shows it: from (1 - t) + to
    // t.
    using Stations = Eigen::Array<float, kMiddles, 1>;
    const Eigen::Map<const Stations> t{kMiddleT.data()};
    const Stations s = 1.0f - t;
    Stations middle, shown;
    for (int j = 0; j < kMiddles; ++j) {
      int sum = 0, moment = 0, o = -reach;
      Eigen::Vector2d on_side = a + station(j, kMiddles) * d;
      if (curves_.bent()) on_side += bow(sag, station(j, kMiddles));
      each_across(on_side - reach * axis, down, 2 * reach + 1, [&](int evidence) {
        const int w = std::max(0, evidence);
        sum += w, moment += w * o++;
      });
      middle[j] = static_cast<float>(moment) / static_cast<float>(std::max(1, sum)),
      shown[j] = sum > 8 ? 1.0f : 0.0f;
    }
    float from = 0.0f, to = 0.0f;
    for (int pass = 0; pass < 2; ++pass) {
      const Stations left = middle - from * s - to * t,
                     w = pass == 0 ? shown : Stations{shown / (1.0f + left * left)}, ws = w * s,
                     wt = w * t;
      const float aa = 1e-3f + (ws * s).sum(), ab = (ws * t).sum(), bb = 1e-3f + (wt * t).sum(),
                  ya = (ws * middle).sum(), yb = (wt * middle).sum();
      const float det = aa * bb - ab * ab;
      if (!(det > 1e-6f)) return {a, b};
      from = (bb * ya - ab * yb) / det, to = (aa * yb - ab * ya) / det;
    }
    const auto moved = [&](const Eigen::Vector2d& p, float by) -> Eigen::Vector2d {
      return p + std::clamp<double>(by, -reach, reach) * axis;
    };
    return {moved(a, from), moved(b, to)};
  }

  [[nodiscard]] std::optional<Quad> corners(const std::array<Line, 4>& lines) const {
    Quad q;
    for (std::size_t i = 0; i < 4; ++i) {
      const Line &before = lines[(i + 3) % 4], &after = lines[i];
      const auto corner = curves_.bent() ? curves_.crossing(before.a, before.b, after.a, after.b)
                                         : crossing(before, after);
      if (!corner) return std::nullopt;
      q[i] = *corner;
    }
    return q;
  }

  // A line whose ends are `slope` apart, in a strip from where it begins: slope t at every station,
  // rounded, in its row.
  using RowsOfSlope = std::array<std::int16_t, static_cast<std::size_t>(kStations)>;
  static constexpr std::array<RowsOfSlope, 4 * kMostReach + 1> kRowsOfSlope = [] {
    std::array<RowsOfSlope, 4 * kMostReach + 1> rows{};
    for (int slope = -2 * kMostReach; slope <= 2 * kMostReach; ++slope)
      for (int j = 0; j < kStations; ++j) {
        const int t = static_cast<int>(1024 * station(j, kStations));
        rows[static_cast<std::size_t>(slope + 2 * kMostReach)][static_cast<std::size_t>(j)] =
            static_cast<std::int16_t>(j * kRow + ((slope * t + 512 + 1024 * 64) >> 10) - 64);
      }
    return rows;
  }();

  static constexpr std::array<float, static_cast<std::size_t>(kMiddles)> kMiddleT = [] {
    std::array<float, static_cast<std::size_t>(kMiddles)> t{};
    for (int j = 0; j < kMiddles; ++j)
      t[static_cast<std::size_t>(j)] = static_cast<float>(station(j, kMiddles));
    return t;
  }();

  const Evidence& evidence_;
  FrameWeights weights_;
  double half_bar_, off_min_ = 1.5, width_ = 1e9, height_ = 1e9, cell_px_ = 1.0;
  SideCurves curves_;
};

}  // namespace gatefly
