// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/gate_templates.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/orange.hpp"
#include "support/worst_corner.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;

constexpr int kMargin = 4, kNeutral = 12, kTop = 31, kOfALevel = 12;

int middle_of(int a, int b) { return (a + b + 1) / 2; }

/// A level of the pyramid: samples of evidence, a margin that says nothing around them.
struct Level {
  Level(int columns, int rows)
      : width{columns + 2 * kMargin},
        height{rows + 2 * kMargin},
        peak(static_cast<std::size_t>(width * height), kNeutral),
        mean{peak} {}
  [[nodiscard]] std::size_t cell(int x, int y) const {
    return static_cast<std::size_t>((y + kMargin) * width + x + kMargin);
  }
  /// Sum of a side's samples around place i.
  [[nodiscard]] int sum(std::ptrdiff_t i, const FrameLattice::Side& side) const {
    int sum = 0;
    for (const CellStep& s : side.samples)
      sum += peak.at(static_cast<std::size_t>(i + s.in(width)));
    return sum;
  }

  int width, height;
  std::vector<int> peak, mean;
};

Level level_of(const EvidenceMap& map) {
  Level level{map.width(), map.height()};
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x)
      level.peak[level.cell(x, y)] = std::clamp(kNeutral + map.at(x, y) / 2, 0, kTop);
  level.mean = level.peak;
  return level;
}

Level halved(const Level& from) {
  const int columns = (from.width - 2 * kMargin) / 2, rows = (from.height - 2 * kMargin) / 2;
  Level to{columns, rows};
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const auto [a, b, c, d] =
          std::tuple{from.cell(2 * x, 2 * y), from.cell(2 * x + 1, 2 * y),
                     from.cell(2 * x, 2 * y + 1), from.cell(2 * x + 1, 2 * y + 1)};
      to.peak[to.cell(x, y)] = std::max({from.peak[a], from.peak[b], from.peak[c], from.peak[d]});
      to.mean[to.cell(x, y)] =
          middle_of(middle_of(from.mean[a], from.mean[b]), middle_of(from.mean[c], from.mean[d]));
    }
  return to;
}

/// GateTemplates as it is described, a place after the other and a sample after the other.
class PlainTemplates {
 public:
  explicit PlainTemplates(double max_roll_deg)
      : small_{std::array{9.0, 11.0, 13.0}, std::min(max_roll_deg, 20.0), 3},
        medium_{std::array{7.5, 9.3, 11.3, 13.4, 15.8}, max_roll_deg, FrameLattice::kShapes},
        large_{std::array{9.0, 11.0, 13.3, 16.0, 19.3}, max_roll_deg, FrameLattice::kShapes} {}

  [[nodiscard]] std::vector<GateCandidate> search(const EvidenceMap& map, int least) const {
    std::vector<GateCandidate> all;
    const int shorter = std::min(map.width(), map.height());
    if (shorter < 2 * kMargin) return all;
    Level level = level_of(map);
    for (int pool = 1; pool <= 4 || 11 * pool <= shorter; pool *= 2) {
      const FrameLattice& lattice = pool == 1 ? small_ : pool == 2 ? medium_ : large_;
      const auto found = best_of(level, lattice, pool * map.step(), least);
      all.insert(all.end(), found.begin(), found.end());
      level = halved(level);
    }
    return all;
  }

 private:
  using Found = std::vector<GateCandidate>;

  static Found::iterator worst(Found& found) {
    return std::min_element(found.begin(), found.end(),
                            [](const auto& a, const auto& b) { return a.score < b.score; });
  }
  static int least_of(Found& found, int least) {
    return found.size() < kOfALevel ? least : std::max(least, worst(found)->score);
  }

  static Found best_of(const Level& level, const FrameLattice& lattice, int pool, int least) {
    Found found;
    for (const FrameLattice::Size& size : lattice.sizes()) {
      std::vector<int> best(level.peak.size(), least_of(found, least));
      std::vector<const FrameLattice::Frame*> which(best.size());
      for (const FrameLattice::Turned& turned : size.turns)
        for (std::size_t k = 0; k < turned.count; ++k)
          judge(level, turned.upright, lattice.frame(turned.first + k), least_of(found, least),
                best, which);
      // The best of every 3 x 3 places.
      for (int cy = kMargin; cy < level.height - kMargin; cy += 3)
        for (int cx = kMargin; cx < level.width - kMargin; cx += 3) {
          int x = 0, y = 0, score = least_of(found, least);
          const int asked = score;
          for (int j = cy; j < std::min(cy + 3, level.height - kMargin); ++j)
            for (int i = cx; i < std::min(cx + 3, level.width - kMargin); ++i)
              if (const int s = best[static_cast<std::size_t>(j * level.width + i)]; s > score)
                score = s, x = i, y = j;
          if (score > asked)
            keep(level, *which[static_cast<std::size_t>(y * level.width + x)], pool, x, y, score,
                 least, found);
        }
    }
    return found;
  }

  // A frame around every place whose samples are all in the buffer, 32 neighbours at a time: they
  // are passed over when no pair of upright sides among them is good enough.
  static void judge(const Level& level, const FrameLattice::Side& upright,
                    const FrameLattice::Frame& f, int least, std::vector<int>& best,
                    std::vector<const FrameLattice::Frame*>& which) {
    constexpr std::ptrdiff_t kTogether = 32;
    const std::ptrdiff_t w = level.width, cells = w * level.height, left = f.left.in(w),
                         right = left + f.right.in(w), right_too = left + f.right_too.in(w),
                         upper = f.upper.in(w), lower = upper + f.lower.in(w),
                         lower_too = upper + f.lower_too.in(w), reach = upright.reach.in(w);
    const std::ptrdiff_t begin =
        1 + std::max(reach + std::max({std::abs(left), std::abs(right), std::abs(right_too)}),
                     f.level.reach.in(w) +
                         std::max({std::abs(upper), std::abs(lower), std::abs(lower_too)}));
    const std::ptrdiff_t end = cells - begin;
    if (end - begin < kTogether) return;
    struct Place {
      int pair, score;
    };
    const auto look = [&](std::ptrdiff_t i) -> Place {
      const int l = level.sum(i + left, upright),
                r = std::max(level.sum(i + right, upright), level.sum(i + right_too, upright)),
                u = level.sum(i + upper, f.level),
                d = std::max(level.sum(i + lower, f.level), level.sum(i + lower_too, f.level));
      const int pair = middle_of(middle_of(l, r), std::min(l, r)),
                all = middle_of(middle_of(l, r), middle_of(u, d));
      const auto mean = [&](std::ptrdiff_t step) {
        return level.mean.at(static_cast<std::size_t>(i + step));
      };
      const std::ptrdiff_t a = f.in_a.in(w), b = f.in_b.in(w);
      const int inside = 2 * middle_of(middle_of(mean(-a), mean(a)), middle_of(mean(-b), mean(b)));
      return {pair, middle_of(all, middle_of(all, std::min({l, r, u, d}))) - inside};
    };
    // Blocks are counted from the first place of a left bar on.
    for (std::ptrdiff_t block = reach - left; block < end; block += kTogether) {
      if (block + kTogether <= begin) continue;
      const std::ptrdiff_t first = std::clamp(block, begin, end - kTogether);
      std::vector<Place> places;
      for (std::ptrdiff_t i = first; i < first + kTogether; ++i) places.push_back(look(i));
      if (std::none_of(places.begin(), places.end(),
                       [&](const Place& p) { return p.pair > std::max(0, least - 26); }))
        continue;
      for (std::size_t k = 0; k < places.size(); ++k)
        if (int& now = best[static_cast<std::size_t>(first) + k]; places[k].score > now)
          now = places[k].score, which[static_cast<std::size_t>(first) + k] = &f;
    }
  }

  static void keep(const Level& level, const FrameLattice::Frame& f, int pool, int x, int y,
                   int score, int least, Found& found) {
    const Vector2d across = f.across.cast<double>(), down = f.down.cast<double>();
    int beyond = 0;
    for (const auto& [a, d] : {std::pair{-0.5, -0.7},
                               {0.0, -0.7},
                               {0.5, -0.7},
                               {-0.5, 0.7},
                               {0.0, 0.7},
                               {0.5, 0.7},
                               {-0.7, -0.5},
                               {-0.7, 0.0},
                               {-0.7, 0.5},
                               {0.7, -0.5},
                               {0.7, 0.0},
                               {0.7, 0.5}}) {
      const Vector2d p = Vector2d{x, y} + a * across + d * down;
      const int u = static_cast<int>(std::floor(p.x() + 0.5)),
                v = static_cast<int>(std::floor(p.y() + 0.5));
      if (u >= 0 && v >= 0 && u < level.width && v < level.height)
        beyond += std::max(0, level.mean[static_cast<std::size_t>(v * level.width + u)] - kNeutral);
    }
    score -= 5 * beyond / 12;
    if (score <= least_of(found, least)) return;
    GateCandidate candidate{.score = score};
    const Vector2d middle =
        Vector2d{x - kMargin, y - kMargin} + 0.25 * (across / across.norm() + down / down.norm());
    const std::array<Vector2d, 4> corners{
        middle - 0.5 * across - 0.5 * down, middle + 0.5 * across - 0.5 * down,
        middle + 0.5 * across + 0.5 * down, middle - 0.5 * across + 0.5 * down};
    for (std::size_t c = 0; c < 4; ++c) {
      const Vector2d& p = corners[c];
      if (p.x() <= -kMargin || p.y() <= -kMargin || p.x() >= level.width - kMargin ||
          p.y() >= level.height - kMargin)
        return;
      candidate.corners_px[c] = {pool * (p.x() + 0.5) - 0.5, pool * (p.y() + 0.5) - 0.5};
    }
    if (found.size() < kOfALevel)
      found.push_back(candidate);
    else
      *worst(found) = candidate;
  }

  FrameLattice small_, medium_, large_;
};

/// Evidence of a picture of the given size, for orange.
void fill(EvidenceMap& map, const Canvas& canvas) {
  const auto bytes = canvas.yuv444();
  map.fill({bytes.data(), PixelFormat::kYuv444, canvas.width(), canvas.height()}, kOrange);
}

/// Noise from none to wild, bars and fields of pale and of full colour, frames.
Canvas any_picture(Rng& rng) {
  Canvas canvas{16 + rng.uniform_index(170), 16 + rng.uniform_index(130)};
  const auto color = [&]() -> std::array<double, 3> {
    const double part = rng.uniform(0.0, 1.0);
    return {120, 128 - 38 * part, 128 + 62 * part};
  };
  const auto bar = [&](int u, int v, int width, int height) {
    canvas.paint(u, u + width, v, v + height, color());
  };
  for (int k = rng.uniform_index(4); k > 0; --k)
    bar(rng.uniform_index(canvas.width()), rng.uniform_index(canvas.height()),
        2 + rng.uniform_index(40), 2 + rng.uniform_index(40));
  for (int k = rng.uniform_index(5); k > 0; --k) {
    const int u = rng.uniform_index(canvas.width()), v = rng.uniform_index(canvas.height()),
              side = 14 + rng.uniform_index(80), thick = 2 + rng.uniform_index(3);
    bar(u, v, side, thick), bar(u, v + side - thick, side, thick);
    bar(u, v, thick, side), bar(u + side - thick, v, thick, side);
  }
  canvas.add_noise(rng, rng.uniform(0.0, 60.0), rng.uniform(0.0, 60.0));
  return canvas;
}

/// In an order of their own: candidates of one score may come in any.
template <class List>
std::vector<GateCandidate> in_order(const List& list) {
  std::vector<GateCandidate> sorted(list.begin(), list.end());
  const auto key = [](const GateCandidate& c) {
    return std::tuple{-c.score, c.corners_px[0].x(), c.corners_px[0].y(), c.corners_px[2].x(),
                      c.corners_px[2].y()};
  };
  std::sort(sorted.begin(), sorted.end(),
            [&](const auto& a, const auto& b) { return key(a) < key(b); });
  return sorted;
}

// One searcher for all pictures: what it read before must leave no trace.
class GateTemplatesTo : public ::testing::TestWithParam<double> {};

TEST_P(GateTemplatesTo, FindWhatAPlainSearchFinds) {
  GateTemplates templates{GetParam()};
  const PlainTemplates plain{GetParam()};
  EvidenceMap map;
  int all = 0, large = 0, many = 0;
  for_all(24, [&](Rng& rng) {
    fill(map, any_picture(rng));
    const int least = 76 + rng.uniform_index(60);
    GateCandidates found;
    templates.search(map, least, found);
    ASSERT_TRUE(std::is_sorted(found.begin(), found.end(),
                               [](const auto& a, const auto& b) { return a.score > b.score; }));
    const auto is = in_order(found), should = in_order(plain.search(map, least));
    ASSERT_EQ(is.size(), should.size()) << map.width() << " x " << map.height() << ", " << least;
    for (std::size_t i = 0; i < is.size(); ++i) {
      EXPECT_EQ(is[i].score, should[i].score) << i;
      EXPECT_LT(largest_move(is[i].corners_px, should[i].corners_px), 1e-9) << i;
      EXPECT_GT(is[i].score, least);
      large += area(is[i].corners_px) > 40.0 * 40.0;
    }
    all += static_cast<int>(is.size()), many += is.size() > kOfALevel;
  });
  EXPECT_GT(all, 100);
  EXPECT_GT(large, 20) << "of the larger levels";
  EXPECT_GT(many, 4) << "more than a level has room for";
}

INSTANTIATE_TEST_SUITE_P(Roll, GateTemplatesTo, ::testing::Values(0.0, 30.0));

TEST(GateTemplates, TheBestOfADrawnFrameLiesOnIt) {
  GateTemplates templates{60.0};
  EvidenceMap map;
  for (const int side : {20, 30, 45, 60, 90}) {
    Canvas canvas{200, 140};
    const int u = 60, v = 24, thick = std::max(2, side / 18);
    const std::array<double, 3> orange{120, 90, 190};
    canvas.paint(u, u + side, v, v + thick, orange);
    canvas.paint(u, u + side, v + side - thick, v + side, orange);
    canvas.paint(u, u + thick, v, v + side, orange);
    canvas.paint(u + side - thick, u + side, v, v + side, orange);
    fill(map, canvas);
    GateCandidates found;
    templates.search(map, 80, found);
    ASSERT_FALSE(found.empty()) << side;
    const double from = 0.5 * (thick - 1), to = side - 1 - from;
    const Quad truth{
        {{u + from, v + from}, {u + to, v + from}, {u + to, v + to}, {u + from, v + to}}};
    EXPECT_LT(worst_corner(found[0].corners_px, truth), 4.0 + 0.1 * side) << side;
  }
}

TEST(GateTemplates, TryOnlyTheSizesTurnsAndWidthsThatAreAskedFor) {
  GateTemplates templates{30.0};
  EvidenceMap map;
  int found_all = 0, found_some = 0;
  for_all(40, [&](Rng& rng) {
    fill(map, any_picture(rng));
    const double side = rng.uniform(16.0, 80.0), roll = rng.uniform(-0.5, 0.5),
                 width = rng.uniform(0.35, 1.0);
    const SearchWindow window{.left = 0.0,
                              .top = 0.0,
                              .right = 200.0,
                              .bottom = 200.0,
                              .least_side = side,
                              .most_side = 1.2 * side,
                              .least_width = width,
                              .most_width = width,
                              .least_roll = roll,
                              .most_roll = roll};
    GateCandidates all, some;
    templates.search(map, 76, all), templates.search(map, 76, some, &window);
    for (const GateCandidate& c : some) {
      const Vector2d down = c.corners_px[3] - c.corners_px[0],
                     across = c.corners_px[1] - c.corners_px[0];
      EXPECT_GT(down.norm(), side / 1.3);
      EXPECT_LT(down.norm(), 1.2 * side * 1.3);
      EXPECT_NEAR(std::atan2(-down.x(), down.y()), roll, 0.11);
      EXPECT_GT(across.norm() / down.norm(), width / 1.25);
      EXPECT_LT(across.norm() / down.norm(), 1.25 * width + 0.1);
    }
    found_all += static_cast<int>(all.size()), found_some += static_cast<int>(some.size());
  });
  EXPECT_GT(found_some, 20);
  EXPECT_GT(2 * found_all, 3 * found_some);
}

// Small frames are tried with turns of 20 degrees at most: a gate that leans more is looked for with those.
TEST(GateTemplates, TryTheLargestTurnsWhereMoreAreAskedFor) {
  GateTemplates templates{60.0};
  EvidenceMap map;
  for (const double roll : {0.6, -0.6, 1.4}) {
    int found = 0;
    for_all(40, [&](Rng& rng) {
      fill(map, any_picture(rng));
      SearchWindow window{.right = 200.0, .bottom = 200.0};
      window.least_side = 18.0, window.most_side = 22.0;
      window.least_roll = window.most_roll = roll;
      GateCandidates some;
      templates.search(map, 76, some, &window);
      found += static_cast<int>(some.size());
    });
    EXPECT_GT(found, 10) << roll;
  }
}

TEST(GateTemplates, FindNothingWhereNothingShowsOrNothingFits) {
  GateTemplates templates{60.0};
  EvidenceMap map;
  for (const auto& [width, height] : {std::pair{315, 160}, {14, 200}, {200, 15}, {1, 1}}) {
    fill(map, Canvas{width, height});
    GateCandidates found;
    templates.search(map, 80, found);
    EXPECT_TRUE(found.empty()) << width << " x " << height;
  }
}

}  // namespace
}  // namespace gatefly
