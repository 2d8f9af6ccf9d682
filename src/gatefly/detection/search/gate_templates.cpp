// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/gate_templates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

constexpr int kMargin = 4;  // cells around the picture: a frame may reach over its border
constexpr int kByte = std::numeric_limits<std::uint8_t>::max();
constexpr int kSamples = 8;   // of a side
constexpr int kTop = 31;      // full evidence of one sample
constexpr int kNeutral = 12;  // no evidence either way
static_assert(kSamples * kTop <= kByte, "a side's sum fits");
constexpr int kLeast = 90;  // of a place
static_assert(kLeast < kSamples * kNeutral, "a frame of neutral sides, 0 inside, is looked at");
constexpr double kRollStep = 10.0;

// How a frame looks from the side: its width, and how far its right bar is shifted down, of its
// height.
struct Shape {
  double width, shift;
};
constexpr std::array kShapes{Shape{1.0, 0.0},  Shape{0.72, 0.0},  Shape{0.5, 0.0},
                             Shape{0.36, 0.0}, Shape{0.36, 0.25}, Shape{0.36, -0.25}};
constexpr int kMostRolls = 18;  // to each side
static_assert((2 * kMostRolls + 1) * static_cast<int>(kShapes.size()) < kByte,
              "a frame's number fits");

std::uint8_t sample_of(int evidence) {
  return static_cast<std::uint8_t>(std::clamp(kNeutral + evidence / 2, 0, kTop));
}

std::uint8_t middle_of(std::uint8_t a, std::uint8_t b) {
  return static_cast<std::uint8_t>((a + b + 1) >> 1);
}

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define GATEFLY_WIDE \
  __attribute__((target_clones("avx2", "default")))  // the same bytes, twice as many at once
#else
#define GATEFLY_WIDE
#endif

// Byte by byte over the whole picture: compilers turn it into sixteen places an instruction.
GATEFLY_WIDE void sum_lines(const std::uint8_t* __restrict cells,
                            const std::array<std::ptrdiff_t, kSamples>& steps, std::ptrdiff_t begin,
                            std::ptrdiff_t end, std::uint8_t* __restrict sums) {
  const std::uint8_t *c0 = cells + steps[0], *c1 = cells + steps[1], *c2 = cells + steps[2],
                     *c3 = cells + steps[3], *c4 = cells + steps[4], *c5 = cells + steps[5],
                     *c6 = cells + steps[6], *c7 = cells + steps[7];
  for (std::ptrdiff_t i = begin; i < end; ++i)
    sums[i] =
        static_cast<std::uint8_t>(c0[i] + c1[i] + c2[i] + c3[i] + c4[i] + c5[i] + c6[i] + c7[i]);
}

// A frame around every place: its sides' sums, and what is in the middle. The right and the lower
// side may be a cell farther off, so that a few sizes fit all.
struct Frame {
  const std::uint8_t *upright, *level, *mean;
  std::ptrdiff_t left, right, right_too, upper, lower, lower_too, in_a, in_b;
};

GATEFLY_WIDE void judge(const Frame& frame, std::uint8_t id, std::ptrdiff_t begin,
                        std::ptrdiff_t end, std::uint8_t* __restrict best,
                        std::uint8_t* __restrict which) {
  const std::uint8_t *left = frame.upright + frame.left, *right = frame.upright + frame.right,
                     *right_too = frame.upright + frame.right_too;
  const std::uint8_t *upper = frame.level + frame.upper, *lower = frame.level + frame.lower,
                     *lower_too = frame.level + frame.lower_too;
  const std::uint8_t *m0 = frame.mean - frame.in_a, *m1 = frame.mean + frame.in_a,
                     *m2 = frame.mean - frame.in_b, *m3 = frame.mean + frame.in_b;
  for (std::ptrdiff_t i = begin; i < end; ++i) {
    const std::uint8_t l = left[i], u = upper[i];
    const std::uint8_t r = right[i] > right_too[i] ? right[i] : right_too[i];
    const std::uint8_t d = lower[i] > lower_too[i] ? lower[i] : lower_too[i];
    const std::uint8_t w1 = l < r ? l : r, w2 = u < d ? u : d, weakest = w1 < w2 ? w1 : w2;
    const std::uint8_t all = middle_of(middle_of(l, r), middle_of(u, d));
    const std::uint8_t good = middle_of(all, middle_of(all, weakest));
    const std::uint8_t inside =
        static_cast<std::uint8_t>(2 * middle_of(middle_of(m0[i], m1[i]), middle_of(m2[i], m3[i])));
    const std::uint8_t score = static_cast<std::uint8_t>((good > inside ? good : inside) - inside);
    const std::uint8_t before = best[i];
    which[i] = score > before ? id : which[i];
    best[i] = score > before ? score : before;
  }
}

Eigen::Vector2d longer_by_one(const Eigen::Vector2d& d) { return d + d / std::max(1.0, d.norm()); }

}  // namespace

// Frames of one size, on cells of `pool` cells of evidence.
struct GateTemplates::Level {
  int pool;
  std::span<const double> sizes;  // [cells]
  double max_roll_deg;
  std::size_t shapes;  // the first so many of kShapes

  [[nodiscard]] int rolls() const {
    return std::min(static_cast<int>(max_roll_deg / kRollStep), kMostRolls);
  }
};

GateTemplates::GateTemplates() {
  for (auto* bytes : {&peak_, &mean_, &upright_, &level_, &best_, &which_})
    bytes->resize(std::size_t{3} * EvidenceMap::kCells);
}

// Evidence as bytes, a margin without evidence around it.
void GateTemplates::start(const EvidenceMap& map) {
  width_ = map.width() + 2 * kMargin, height_ = map.height() + 2 * kMargin;
  std::fill_n(peak_.begin(), width_ * height_, static_cast<std::uint8_t>(kNeutral));
  for (int y = 0; y < map.height(); ++y) {
    const std::int8_t* const row = map.cells() + static_cast<std::ptrdiff_t>(y) * map.width();
    std::uint8_t* const out =
        peak_.data() + static_cast<std::ptrdiff_t>(y + kMargin) * width_ + kMargin;
    for (int x = 0; x < map.width(); ++x) out[x] = sample_of(row[x]);
  }
  std::copy_n(peak_.begin(), width_ * height_, mean_.begin());
}

// Two cells become one, of their maximum; the margin keeps its number of cells.
void GateTemplates::halve() {
  const int w = (width_ - 2 * kMargin) / 2, h = (height_ - 2 * kMargin) / 2;
  const int new_width = w + 2 * kMargin, new_height = h + 2 * kMargin;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t i = static_cast<std::size_t>((2 * y + kMargin) * width_ + 2 * x + kMargin);
      const std::size_t below = i + static_cast<std::size_t>(width_),
                        o = static_cast<std::size_t>(y * w + x);
      upright_[o] =
          std::max(std::max(peak_[i], peak_[i + 1]), std::max(peak_[below], peak_[below + 1]));
      level_[o] =
          middle_of(middle_of(mean_[i], mean_[i + 1]), middle_of(mean_[below], mean_[below + 1]));
    }
  width_ = new_width, height_ = new_height;
  for (auto* cells : {&peak_, &mean_})
    std::fill_n(cells->begin(), width_ * height_, static_cast<std::uint8_t>(kNeutral));
  for (int y = 0; y < h; ++y) {
    const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(y) * w,
                         to = static_cast<std::ptrdiff_t>(y + kMargin) * width_ + kMargin;
    std::copy_n(upright_.begin() + from, w, peak_.begin() + to);
    std::copy_n(level_.begin() + from, w, mean_.begin() + to);
  }
}

void GateTemplates::search(const EvidenceMap& map, double max_roll_deg, GateCandidates& found) {
  static constexpr std::array kSmall{9.0, 11.0, 13.0};
  static constexpr std::array kMedium{7.5, 9.3, 11.3, 13.4, 15.8};
  static constexpr std::array kLarge{9.0, 11.0, 13.3, 16.0, 19.3};
  if (std::min(map.width(), map.height()) < 2 * kMargin) return;
  start(map);
  // small gates are far: many places, few turns
  const double small_roll = std::min(max_roll_deg, 20.0);
  search_level({1 * map.step(), kSmall, small_roll, 3}, found);
  halve();
  search_level({2 * map.step(), kMedium, max_roll_deg, kShapes.size()}, found);
  // A gate is not much larger than the picture.
  const int shorter = std::min(map.width(), map.height());
  for (int pool = 4; pool == 4 || pool * kLarge[1] <= shorter; pool *= 2) {
    halve();
    search_level({pool * map.step(), kLarge, max_roll_deg, kShapes.size()}, found);
  }
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.score > b.score; });
}

void GateTemplates::search_level(const Level& level, GateCandidates& found) {
  const std::ptrdiff_t cells = static_cast<std::ptrdiff_t>(width_) * height_;
  // All places whose samples are in the buffer; beyond left and right they run into the next row's
  // margin.
  const auto rows = [this](double dx, double dy) {
    return static_cast<std::ptrdiff_t>(std::abs(dy) + 1.0) * width_ +
           static_cast<std::ptrdiff_t>(std::abs(dx) + 1.0);
  };
  const auto step_of = [this](double dx, double dy) {
    return static_cast<std::ptrdiff_t>(std::lround(dy)) * width_ + std::lround(dx);
  };
  const auto line = [&](double dx, double dy, std::vector<std::uint8_t>& sums) {
    std::array<std::ptrdiff_t, kSamples> steps{};
    for (std::size_t k = 0; k < kSamples; ++k) {
      const double t = (static_cast<double>(k) + 0.5) / kSamples - 0.5;
      steps[k] = step_of(t * dx, t * dy);
    }
    const std::ptrdiff_t reach = rows(0.5 * dx, 0.5 * dy);
    if (2 * reach < cells) sum_lines(peak_.data(), steps, reach, cells - reach, sums.data());
    return reach;
  };
  for (const double size : level.sizes) {
    std::fill_n(best_.begin(), cells, std::uint8_t{0});
    for (int r = -level.rolls(); r <= level.rolls(); ++r) {
      const auto [sine, cosine] = sincos(r * kRollStep * kPi / 180.0);
      const Eigen::Vector2d down{-sine * size, cosine * size};  // along the upright bars
      const std::ptrdiff_t upright_reach = line(down.x(), down.y(), upright_);
      for (std::size_t k = 0; k < level.shapes; ++k) {
        const Eigen::Vector2d across =
            kShapes[k].width * size * Eigen::Vector2d{cosine, sine} + kShapes[k].shift * down;
        const std::ptrdiff_t level_reach = line(across.x(), across.y(), level_);
        const auto step = [&](const Eigen::Vector2d& d) { return step_of(d.x(), d.y()); };
        const std::ptrdiff_t left = step(-0.5 * across), upper = step(-0.5 * down);
        const Frame frame{.upright = upright_.data(),
                          .level = level_.data(),
                          .mean = mean_.data(),
                          .left = left,
                          .right = left + step(across),
                          .right_too = left + step(longer_by_one(across)),
                          .upper = upper,
                          .lower = upper + step(down),
                          .lower_too = upper + step(longer_by_one(down)),
                          .in_a = step(0.2 * (across + down)),
                          .in_b = step(0.2 * (across - down))};
        const auto widest = [](std::ptrdiff_t a, std::ptrdiff_t b, std::ptrdiff_t c) {
          return std::max({std::abs(a), std::abs(b), std::abs(c)});
        };
        const std::ptrdiff_t begin =
            std::max(upright_reach + widest(frame.left, frame.right, frame.right_too),
                     level_reach + widest(frame.upper, frame.lower, frame.lower_too)) +
            1;
        const auto id = static_cast<std::uint8_t>(
            1 + (r + level.rolls()) * static_cast<int>(kShapes.size()) + static_cast<int>(k));
        if (2 * begin < cells) judge(frame, id, begin, cells - begin, best_.data(), which_.data());
      }
    }
    collect(level, size, found);
  }
}

// The best place of every neighbourhood.
void GateTemplates::collect(const Level& level, double size, GateCandidates& found) {
  constexpr int kCell = 3;
  for (int cy = kMargin; cy < height_ - kMargin; cy += kCell)
    for (int cx = kMargin; cx < width_ - kMargin; cx += kCell) {
      int x = 0, y = 0, score = found.full() ? std::max(kLeast, found[worst_].score) : kLeast;
      const int least = score;
      for (int j = cy; j < std::min(cy + kCell, height_ - kMargin); ++j)
        for (int i = cx; i < std::min(cx + kCell, width_ - kMargin); ++i)
          if (const int s = best_[static_cast<std::size_t>(j * width_ + i)]; s > score)
            score = s, x = i, y = j;
      if (score > least) keep(level, size, x, y, score, found);
    }
}

void GateTemplates::keep(const Level& level, double size, int x, int y, int score,
                         GateCandidates& found) {
  const int id = which_[static_cast<std::size_t>(y * width_ + x)] - 1,
            shapes = static_cast<int>(kShapes.size()), roll = id / shapes - level.rolls();
  const Shape shape = kShapes[static_cast<std::size_t>(id % shapes)];
  const auto [sine, cosine] = sincos(roll * kRollStep * kPi / 180.0);
  const Eigen::Vector2d down{-sine * size, cosine * size};
  const Eigen::Vector2d across =
      shape.width * size * Eigen::Vector2d{cosine, sine} + shape.shift * down;
  // The middle between the two places of the right and of the lower side.
  const Eigen::Vector2d middle =
      Eigen::Vector2d{x - kMargin, y - kMargin} + 0.25 * (across.normalized() + down.normalized());
  GateCandidate candidate{.score = score};
  std::size_t c = 0;
  for (const auto& [sx, sy] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    const Eigen::Vector2d p = middle + sx * across + sy * down;
    // Beyond the margin samples came from the next row.
    if (!(p.x() > -kMargin && p.x() < width_ - kMargin && p.y() > -kMargin &&
          p.y() < height_ - kMargin))
      return;
    candidate.corners_px[c++] = ((p.array() + 0.5) * level.pool - 0.5).matrix();
  }
  if (!found.push_back(candidate)) found[worst_] = candidate;
  if (found.full())
    worst_ = static_cast<std::size_t>(
        std::min_element(found.begin(), found.end(),
                         [](const auto& a, const auto& b) { return a.score < b.score; }) -
        found.begin());
}

}  // namespace gatefly
