// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/gate_templates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

#include "gatefly/detection/search/frame_fit.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

constexpr int kMargin = 4;  // cells around the picture: a frame may reach over its border
constexpr int kByte = std::numeric_limits<std::uint8_t>::max();
constexpr int kSamples = FrameLattice::kSamples;
constexpr int kTop = 31;      // full evidence of one sample
constexpr int kNeutral = 12;  // no evidence either way
constexpr int kFull = kSamples * kTop;
static_assert(kFull <= kByte, "a side's sum fits");
// The upright sides may be so much worse than all of a frame. [of the frames that lead to a gate, on
// all labelled sets, washed-out, blurred and halved ones too, one in 200 has worse ones]
constexpr int kWorsePair = 26;
// A frame that is farther than this from what is wanted has a neighbour in the lattice that is nearer.
constexpr double kNarrowest = 0.36;  // of the frames that are tried
constexpr double kSizeSpacing = 1.25, kWidthSpacing = 1.2, kRollSpacing = 6.0 * kDegree;

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

using Steps = std::array<std::ptrdiff_t, kSamples>;

// Byte by byte over the whole picture: compilers turn it into sixteen places an instruction.
GATEFLY_WIDE void sum_lines(const std::uint8_t* __restrict cells, const Steps& steps,
                            std::ptrdiff_t begin, std::ptrdiff_t end,
                            std::uint8_t* __restrict sums) {
  const std::uint8_t *c0 = cells + steps[0], *c1 = cells + steps[1], *c2 = cells + steps[2],
                     *c3 = cells + steps[3], *c4 = cells + steps[4], *c5 = cells + steps[5],
                     *c6 = cells + steps[6], *c7 = cells + steps[7];
  for (std::ptrdiff_t i = begin; i < end; ++i)
    sums[i] =
        static_cast<std::uint8_t>(c0[i] + c1[i] + c2[i] + c3[i] + c4[i] + c5[i] + c6[i] + c7[i]);
}

// Places beside each other: what is done to them is one or two instructions.
constexpr std::size_t kBlock = 32;
constexpr auto kPlaces = static_cast<std::ptrdiff_t>(kBlock);
using Block = std::array<std::uint8_t, kBlock>;

bool any(const Block& block) {
  std::array<std::uint64_t, kBlock / 8> words;
  std::memcpy(words.data(), block.data(), kBlock);
  return (words[0] | words[1] | words[2] | words[3]) != 0;
}

// Places side by side, as in sum_lines().
[[gnu::always_inline]] inline void sum_of(const std::uint8_t* cells, const Steps& steps,
                                          Block& sums) {
  const std::uint8_t *c0 = cells + steps[0], *c1 = cells + steps[1], *c2 = cells + steps[2],
                     *c3 = cells + steps[3], *c4 = cells + steps[4], *c5 = cells + steps[5],
                     *c6 = cells + steps[6], *c7 = cells + steps[7];
  for (std::size_t i = 0; i < kBlock; ++i)
    sums[i] =
        static_cast<std::uint8_t>(c0[i] + c1[i] + c2[i] + c3[i] + c4[i] + c5[i] + c6[i] + c7[i]);
}

// A frame around every place: its sides' sums, and what is in the middle. All from the left bar.
struct Frame {
  const std::uint8_t *upright, *peak, *mean;
  Steps level;
  std::ptrdiff_t right, right_too, middle, upper, lower, lower_too, in_a, in_b;
  std::uint8_t id, least, least_pair;
};

// Blocks of places begin where `blocks` says, but all within begin..end.
GATEFLY_WIDE void judge(const Frame& frame, std::span<const std::int32_t> blocks,
                        std::ptrdiff_t begin, std::ptrdiff_t end, std::uint8_t* __restrict best,
                        std::uint8_t* __restrict which) {
  const Steps level = frame.level;
  const std::uint8_t id = frame.id, least = frame.least_pair, enough = frame.least;
  alignas(kBlock) Block pair, above, below, too, score;
  for (const std::int32_t block : blocks) {
    if (block + kPlaces <= begin || block >= end) continue;
    const std::ptrdiff_t at = std::clamp<std::ptrdiff_t>(block, begin, end - kPlaces);
    const std::uint8_t *left = frame.upright + at, *right = left + frame.right,
                       *right_too = left + frame.right_too;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const std::uint8_t l = left[i], r = right[i] > right_too[i] ? right[i] : right_too[i];
      const std::uint8_t both = middle_of(middle_of(l, r), l < r ? l : r);
      pair[i] = static_cast<std::uint8_t>((both > least ? both : least) - least);
    }
    if (!any(pair)) continue;
    const std::ptrdiff_t middle = at + frame.middle;
    const std::uint8_t *upper = frame.peak + middle + frame.upper,
                       *lower = frame.peak + middle + frame.lower,
                       *lower_too = frame.peak + middle + frame.lower_too;
    sum_of(upper, level, above);
    // As good as it would be with the best of lower sides.
    for (std::size_t i = 0; i < kBlock; ++i) {
      const std::uint8_t l = left[i], r = right[i] > right_too[i] ? right[i] : right_too[i];
      const std::uint8_t u = above[i], w1 = l < r ? l : r, weakest = w1 < u ? w1 : u;
      const std::uint8_t all = middle_of(middle_of(l, r), middle_of(u, kFull));
      const std::uint8_t good = middle_of(all, middle_of(all, weakest));
      score[i] = static_cast<std::uint8_t>((good > enough ? good : enough) - enough);
    }
    if (!any(score)) continue;
    sum_of(lower, level, below), sum_of(lower_too, level, too);
    const std::uint8_t *m0 = frame.mean + middle - frame.in_a,
                       *m1 = frame.mean + middle + frame.in_a,
                       *m2 = frame.mean + middle - frame.in_b,
                       *m3 = frame.mean + middle + frame.in_b;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const std::uint8_t l = left[i], r = right[i] > right_too[i] ? right[i] : right_too[i];
      const std::uint8_t u = above[i], d = below[i] > too[i] ? below[i] : too[i];
      const std::uint8_t w1 = l < r ? l : r, w2 = u < d ? u : d, weakest = w1 < w2 ? w1 : w2;
      const std::uint8_t all = middle_of(middle_of(l, r), middle_of(u, d));
      const std::uint8_t good = middle_of(all, middle_of(all, weakest));
      const std::uint8_t inside = static_cast<std::uint8_t>(
          2 * middle_of(middle_of(m0[i], m1[i]), middle_of(m2[i], m3[i])));
      score[i] = static_cast<std::uint8_t>((good > inside ? good : inside) - inside);
    }
    std::uint8_t* const __restrict best_here = best + middle, * const __restrict which_here =
                                                                  which + middle;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const std::uint8_t now = score[i], before = best_here[i], id_before = which_here[i];
      which_here[i] = now > before ? id : id_before;
      best_here[i] = now > before ? now : before;
    }
  }
}

GATEFLY_WIDE bool any_above(const std::uint8_t* begin, const std::uint8_t* end, int least) {
  std::uint8_t most = 0;
  for (const std::uint8_t* s = begin; s < end; ++s) most = *s > most ? *s : most;
  return most > least;
}

// Counts blocks with a larger sum.
GATEFLY_WIDE std::size_t blocks_with_a_bar(const std::uint8_t* sums, std::ptrdiff_t begin,
                                           std::ptrdiff_t end, std::uint8_t least,
                                           std::int32_t* __restrict blocks) {
  std::size_t count = 0;
  alignas(kBlock) Block block;
  for (std::ptrdiff_t at = begin; at < end; at += kPlaces) {
    const std::uint8_t* const here = sums + at;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const std::uint8_t s = here[i];
      block[i] = static_cast<std::uint8_t>((s > least ? s : least) - least);
    }
    blocks[count] = static_cast<std::int32_t>(at);
    count += any(block);
  }
  return count;
}

}  // namespace

GateTemplates::GateTemplates(double max_roll_deg)
    // small gates are far: many places, few turns
    : small_{std::array{9.0, 11.0, 13.0}, std::min(max_roll_deg, 20.0), 3},
      medium_{std::array{7.5, 9.3, 11.3, 13.4, 15.8}, max_roll_deg, FrameLattice::kShapes},
      large_{std::array{9.0, 11.0, 13.3, 16.0, 19.3}, max_roll_deg, FrameLattice::kShapes} {
  for (auto* bytes : {&peak_, &mean_, &upright_, &best_, &which_})
    bytes->resize(std::size_t{3} * EvidenceMap::kCells);
  blocks_.resize(best_.size() / kBlock + 1);
}

// Evidence as bytes, a margin without evidence around it.
void GateTemplates::start(const EvidenceMap& map) {
  const CellBox& cells = map.filled();
  width_ = cells.width() + 2 * kMargin, height_ = cells.height() + 2 * kMargin;
  std::fill_n(peak_.begin(), width_ * height_, static_cast<std::uint8_t>(kNeutral));
  for (int y = 0; y < cells.height(); ++y) {
    const std::int8_t* const row = map.row(cells.top + y);
    std::uint8_t* const out =
        peak_.data() + static_cast<std::ptrdiff_t>(y + kMargin) * width_ + kMargin;
    for (int x = 0; x < cells.width(); ++x) out[x] = sample_of(row[x]);
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
      best_[o] =
          std::max(std::max(peak_[i], peak_[i + 1]), std::max(peak_[below], peak_[below + 1]));
      which_[o] =
          middle_of(middle_of(mean_[i], mean_[i + 1]), middle_of(mean_[below], mean_[below + 1]));
    }
  width_ = new_width, height_ = new_height;
  for (auto* cells : {&peak_, &mean_})
    std::fill_n(cells->begin(), width_ * height_, static_cast<std::uint8_t>(kNeutral));
  for (int y = 0; y < h; ++y) {
    const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(y) * w,
                         to = static_cast<std::ptrdiff_t>(y + kMargin) * width_ + kMargin;
    std::copy_n(best_.begin() + from, w, peak_.begin() + to);
    std::copy_n(which_.begin() + from, w, mean_.begin() + to);
  }
}

void GateTemplates::search(const EvidenceMap& map, int least, GateCandidates& found,
                           const SearchWindow* within) {
  const CellBox& cells = map.filled();
  if (std::min(cells.width(), cells.height()) < 2 * kMargin) return;
  least_ = least;
  wanted_ = within != nullptr ? *within : SearchWindow{};
  origin_px_ = map.step() * Eigen::Vector2d{cells.left, cells.top};
  start(map);
  search_level(small_, 1 * map.step(), found);
  halve();
  search_level(medium_, 2 * map.step(), found);
  // A gate is not much larger than what is searched.
  constexpr double kLargeSide = 11.0;
  const int shorter = std::min(cells.width(), cells.height());
  // At most as often as the shorter side of what is searched can be halved.
  for (int pool = 4; pool == 4 || pool * kLargeSide <= shorter; pool *= 2) {
    halve();
    search_level(large_, pool * map.step(), found);
  }
  // As a heap: std::sort() calls itself.
  std::partial_sort(found.begin(), found.end(), found.end(),
                    [](const auto& a, const auto& b) { return a.score > b.score; });
}

// All places whose samples are in the buffer; beyond left and right they run into the next row's
// margin.
void GateTemplates::search_level(const FrameLattice& lattice, int pool, GateCandidates& all) {
  LevelCandidates found;
  const std::ptrdiff_t width = width_, cells = width * height_;
  const auto in = [width](const FrameLattice::Side& side) {
    Steps steps;
    for (std::size_t k = 0; k < kSamples; ++k) steps[k] = side.samples[k].in(width);
    return steps;
  };
  const auto widest = [width](CellStep a, CellStep b, CellStep c) {
    return std::max({std::abs(a.in(width)), std::abs(b.in(width)), std::abs(c.in(width))});
  };
  for (const FrameLattice::Size& size : lattice.sizes()) {
    const double side = pool * size.upright;
    if (side * kSizeSpacing < wanted_.least_side || side > wanted_.most_side * kSizeSpacing)
      continue;
    // Beyond the largest turn, of which small frames have a smaller one, that one is tried.
    const double most_roll = size.turns.back().roll;
    const std::size_t first = FrameLattice::first_of(size);
    const auto least = static_cast<std::uint8_t>(least_to_keep(found));
    const auto least_pair = static_cast<std::uint8_t>(std::max(0, least - kWorsePair));
    // Lower bound of one side: below it no partner can bring the pair to least_pair.
    const auto least_side = static_cast<std::uint8_t>(std::max(0, (4 * least_pair - kByte) / 3));
    std::fill_n(best_.begin(), cells, least);
    for (const FrameLattice::Turned& turned : size.turns) {
      if (turned.roll < std::min(wanted_.least_roll, most_roll) - kRollSpacing ||
          turned.roll > std::max(wanted_.most_roll, -most_roll) + kRollSpacing)
        continue;
      const std::ptrdiff_t upright_reach = turned.upright.reach.in(width);
      if (2 * upright_reach + kPlaces > cells) continue;
      sum_lines(peak_.data(), in(turned.upright), upright_reach, cells - upright_reach,
                upright_.data());
      const std::size_t count = blocks_with_a_bar(
          upright_.data(), upright_reach, cells - upright_reach, least_side, blocks_.data());
      const std::span<const std::int32_t> blocks{blocks_.data(), count};
      for (std::size_t k = 0; k < turned.count; ++k) {
        if (const double shape = FrameLattice::width_of(k);
            shape * kWidthSpacing < std::min(wanted_.least_width, 1.0) ||
            shape > std::max(wanted_.most_width, kNarrowest) * kWidthSpacing)
          continue;
        const FrameLattice::Frame& f = lattice.frame(turned.first + k);
        const std::ptrdiff_t left = f.left.in(width), upper = f.upper.in(width);
        const auto sum = [](CellStep a, CellStep b) {
          return CellStep{static_cast<std::int8_t>(a.x + b.x), static_cast<std::int8_t>(a.y + b.y)};
        };
        const std::ptrdiff_t begin =
            std::max(upright_reach + widest(f.left, sum(f.left, f.right), sum(f.left, f.right_too)),
                     f.level.reach.in(width) +
                         widest(f.upper, sum(f.upper, f.lower), sum(f.upper, f.lower_too))) +
            1;
        if (2 * begin + kPlaces > cells) continue;
        judge({.upright = upright_.data(),
               .peak = peak_.data(),
               .mean = mean_.data(),
               .level = in(f.level),
               .right = f.right.in(width),
               .right_too = f.right_too.in(width),
               .middle = -left,
               .upper = upper,
               .lower = upper + f.lower.in(width),
               .lower_too = upper + f.lower_too.in(width),
               .in_a = f.in_a.in(width),
               .in_b = f.in_b.in(width),
               .id = static_cast<std::uint8_t>(1 + turned.first + k - first),
               .least = least,
               .least_pair = least_pair},
              blocks, begin + left, cells - begin + left, best_.data(), which_.data());
      }
    }
    collect(lattice, first, pool, found);
  }
  for (const GateCandidate& candidate : found) (void)all.push_back(candidate);
}

int GateTemplates::least_to_keep(const LevelCandidates& found) const {
  return found.full() ? std::max(least_, found[worst_].score) : least_;
}

// The best place of every neighbourhood.
void GateTemplates::collect(const FrameLattice& lattice, std::size_t first, int pool,
                            LevelCandidates& found) {
  constexpr int kCell = 3;
  for (int cy = kMargin; cy < height_ - kMargin; cy += kCell) {
    const int beyond = std::min(cy + kCell, height_ - kMargin);
    const std::uint8_t* const row = best_.data() + static_cast<std::ptrdiff_t>(cy) * width_;
    if (!any_above(row, row + static_cast<std::ptrdiff_t>(beyond - cy) * width_,
                   least_to_keep(found)))
      continue;
    for (int cx = kMargin; cx < width_ - kMargin; cx += kCell) {
      int x = 0, y = 0, score = least_to_keep(found);
      const int least = score;
      for (int j = cy; j < beyond; ++j)
        for (int i = cx; i < std::min(cx + kCell, width_ - kMargin); ++i)
          if (const int s = best_[static_cast<std::size_t>(j * width_ + i)]; s > score)
            score = s, x = i, y = j;
      if (score <= least) continue;
      const std::size_t id = which_[static_cast<std::size_t>(y * width_ + x)];
      keep(lattice.frame(first + id - 1), pool, x, y, score, found);
    }
  }
}

// Loss of a score by evidence outside of the sides' middles and where they would go on: on a wide
// bar, a screen or a banner there is a small frame at every place.
int GateTemplates::lost_beyond(const FrameLattice::Frame& frame, int x, int y) const {
  constexpr double kPast = 0.2;  // of a side
  constexpr int kWeight = 5;     // of the mean evidence there [of 0, 4, 5, 8]
  const Eigen::Vector2d across = frame.across.cast<double>(), down = frame.down.cast<double>();
  int sum = 0;
  const auto look = [&](double a, double d) {
    const Eigen::Vector2d p = Eigen::Vector2d{x, y} + a * across + d * down;
    const int u = nearest_cell(p.x()), v = nearest_cell(p.y());
    if (u < 0 || v < 0 || u >= width_ || v >= height_) return;
    sum += std::max(0, mean_[static_cast<std::size_t>(v * width_ + u)] - kNeutral);
  };
  for (const double one : {-0.5, 0.5})
    for (const double past : {-0.5 - kPast, 0.5 + kPast}) look(one, past), look(past, one);
  for (const double past : {-0.5 - kPast, 0.5 + kPast}) look(0.0, past), look(past, 0.0);
  constexpr int kLooks = 12;
  return kWeight * sum / kLooks;
}

void GateTemplates::keep(const FrameLattice::Frame& frame, int pool, int x, int y, int score,
                         LevelCandidates& found) {
  score -= lost_beyond(frame, x, y);
  if (score <= least_to_keep(found)) return;
  const Eigen::Vector2d across = frame.across.cast<double>(), down = frame.down.cast<double>();
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
    candidate.corners_px[c++] = origin_px_ + ((p.array() + 0.5) * pool - 0.5).matrix();
  }
  if (!found.push_back(candidate)) found[worst_] = candidate;
  if (found.full())
    worst_ = static_cast<std::size_t>(
        std::min_element(found.begin(), found.end(),
                         [](const auto& a, const auto& b) { return a.score < b.score; }) -
        found.begin());
}

}  // namespace gatefly
