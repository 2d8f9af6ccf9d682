// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/shape_changes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "gatefly/files/scoring.hpp"

namespace gatefly::experiments {
namespace {

using Eigen::Vector2d;

/// Which samples of a line make up a sample of the resized one.
struct Tap {
  int from;
  double weight;
};

std::vector<std::vector<Tap>> taps_of(int size, int new_size, double factor) {
  std::vector<std::vector<Tap>> all(static_cast<std::size_t>(new_size));
  for (int i = 0; i < new_size; ++i) {
    // Smaller: the stretch of the line that it covers; larger: one sample long, about its middle.
    const double middle = (i + 0.5) / factor, half = 0.5 * std::max(1.0, 1.0 / factor);
    double sum = 0.0;
    auto& taps = all[static_cast<std::size_t>(i)];
    for (int k = static_cast<int>(std::floor(middle - half)); k < middle + half; ++k) {
      const double covered = std::min(k + 1.0, middle + half) - std::max<double>(k, middle - half);
      if (covered > 0.0) sum += taps.emplace_back(std::clamp(k, 0, size - 1), covered).weight;
    }
    for (Tap& tap : taps) tap.weight /= sum;
  }
  return all;
}

int length_of(int size, double factor) {
  return std::max(1, static_cast<int>(std::lround(size * factor)));
}

template <class Move>
void move_labels(UprightPicture& picture, Move move) {
  for (auto* list : {&picture.gates, &picture.ignored})
    for (Quad& quad : *list)
      for (Vector2d& corner : quad) corner = move(corner);
}

bool contains(const UprightPicture& picture, const Quad& quad) {
  return std::all_of(quad.begin(), quad.end(), [&](const Vector2d& p) {
    return p.x() >= 0.0 && p.y() >= 0.0 && p.x() <= picture.width - 1 &&
           p.y() <= picture.height - 1;
  });
}

bool inside(const Quad& clockwise, const Vector2d& p) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d a = clockwise[i], along = clockwise[(i + 1) % 4] - a;
    if (along.x() * (p - a).y() - along.y() * (p - a).x() < 0.0) return false;
  }
  return true;
}

struct Bounds {
  Vector2d low, high;
};

Bounds bounds_of(const Quad& quad) {
  Bounds bounds{quad[0], quad[0]};
  for (const Vector2d& corner : quad) {
    bounds.low = bounds.low.cwiseMin(corner);
    bounds.high = bounds.high.cwiseMax(corner);
  }
  return bounds;
}

bool apart(const Bounds& a, const Bounds& b) {
  return (a.high.array() < b.low.array()).any() || (b.high.array() < a.low.array()).any();
}

Quad upright(const Quad& label) { return clockwise_from_top_left(files::polygon(label)); }

/// Between four pixels; black outside.
void copy_between(const UprightPicture& from, const Vector2d& p, std::uint8_t* to) {
  std::array<double, 3> sum{};
  const int u = static_cast<int>(std::floor(p.x())), v = static_cast<int>(std::floor(p.y()));
  for (const int dv : {0, 1})
    for (const int du : {0, 1}) {
      if (u + du < 0 || v + dv < 0 || u + du >= from.width || v + dv >= from.height) continue;
      const double weight = (1.0 - std::abs(p.x() - u - du)) * (1.0 - std::abs(p.y() - v - dv));
      for (std::size_t c = 0; c < 3; ++c)
        sum[c] += weight * from.bytes[from.at(u + du, v + dv) + c];
    }
  for (std::size_t c = 0; c < 3; ++c) to[c] = rounded(sum[c]);
}

/// Room for a smaller gate: how far to move it, so that neither it nor any gate is hidden.
std::optional<Vector2d> room_for(const UprightPicture& picture, const Quad& small,
                                 const Quad& large, double margin) {
  const Bounds of_small = bounds_of(scaled(small, margin)),
               of_large = bounds_of(scaled(large, margin));
  const Vector2d size = of_small.high - of_small.low,
                 last = Vector2d{picture.width - 1, picture.height - 1} - size;
  if ((last.array() < 0.0).any()) return {};
  const Vector2d level = (0.5 * (of_large.low + of_large.high - size)).cwiseMax(0).cwiseMin(last);
  const Vector2d before = of_large.low - size - Vector2d::Ones(),
                 behind = of_large.high + Vector2d::Ones();
  for (const Vector2d& low : {Vector2d{behind.x(), level.y()}, Vector2d{before.x(), level.y()},
                              Vector2d{level.x(), behind.y()}, Vector2d{level.x(), before.y()}}) {
    if ((low.array() < 0.0).any() || (low.array() > last.array()).any()) continue;
    const Vector2d by = (low - of_small.low).array().round();
    const Bounds place{of_small.low + by, of_small.high + by};
    const auto is_free = [&](const Quad& gate) {
      return apart(place, bounds_of(scaled(gate, margin)));
    };
    if (std::all_of(picture.gates.begin(), picture.gates.end(), is_free) &&
        std::all_of(picture.ignored.begin(), picture.ignored.end(), is_free))
      return by;
  }
  return {};
}

/// The mean of the darkest tenth of the pixels in and around a quad.
std::array<std::uint8_t, 3> dark_around(const UprightPicture& picture, const Quad& quad) {
  const auto [low, high] = bounds_of(scaled(quad, 1.3));
  std::vector<std::pair<double, std::size_t>> by_luma;
  for (int v = std::max(0, static_cast<int>(low.y()));
       v < std::min<double>(picture.height, high.y()); ++v)
    for (int u = std::max(0, static_cast<int>(low.x()));
         u < std::min<double>(picture.width, high.x()); ++u) {
      const std::uint8_t* p = &picture.bytes[picture.at(u, v)];
      by_luma.emplace_back(ycc_of({double(p[0]), double(p[1]), double(p[2])})[0], picture.at(u, v));
    }
  if (by_luma.empty()) return {};
  std::sort(by_luma.begin(), by_luma.end());
  const std::size_t count = std::max<std::size_t>(1, by_luma.size() / 10);
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t c = 0; c < 3; ++c) sum[c] += picture.bytes[by_luma[i].second + c];
  std::array<std::uint8_t, 3> mean{};
  for (std::size_t c = 0; c < 3; ++c) mean[c] = rounded(sum[c] / static_cast<double>(count));
  return mean;
}

}  // namespace

UprightPicture resized(const UprightPicture& picture, double factor) {
  UprightPicture changed = picture;
  changed.width = length_of(picture.width, factor);
  changed.height = length_of(picture.height, factor);
  changed.bytes.resize(image_bytes(picture.format, changed.width, changed.height));
  const auto across = taps_of(picture.width, changed.width, factor),
             down = taps_of(picture.height, changed.height, factor);
  for (int v = 0; v < changed.height; ++v)
    for (int u = 0; u < changed.width; ++u) {
      std::array<double, 3> sum{};
      for (const Tap& row : down[static_cast<std::size_t>(v)])
        for (const Tap& column : across[static_cast<std::size_t>(u)])
          for (std::size_t c = 0; c < 3; ++c)
            sum[c] +=
                row.weight * column.weight * picture.bytes[picture.at(column.from, row.from) + c];
      for (std::size_t c = 0; c < 3; ++c) changed.bytes[changed.at(u, v) + c] = rounded(sum[c]);
    }
  move_labels(changed,
              [&](const Vector2d& p) -> Vector2d { return (p.array() + 0.5) * factor - 0.5; });
  return changed;
}

UprightPicture rotated(const UprightPicture& picture, double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  const Eigen::Matrix2d turn{{std::cos(angle), -std::sin(angle)},
                             {std::sin(angle), std::cos(angle)}};
  const Vector2d middle = 0.5 * Vector2d{picture.width - 1, picture.height - 1};
  UprightPicture changed = picture;
  for (int v = 0; v < changed.height; ++v)
    for (int u = 0; u < changed.width; ++u)
      copy_between(picture, middle + turn.transpose() * (Vector2d{u, v} - middle),
                   &changed.bytes[changed.at(u, v)]);
  move_labels(changed, [&](const Vector2d& p) -> Vector2d { return middle + turn * (p - middle); });
  const auto cut = std::stable_partition(changed.gates.begin(), changed.gates.end(),
                                         [&](const Quad& gate) { return contains(changed, gate); });
  changed.ignored.insert(changed.ignored.end(), cut, changed.gates.end());
  changed.gates.erase(cut, changed.gates.end());
  return changed;
}

UprightPicture flipped(const UprightPicture& picture) {
  UprightPicture changed = picture;
  for (int v = 0; v < picture.height; ++v)
    for (int u = 0; u < picture.width; ++u)
      std::copy_n(&picture.bytes[picture.at(picture.width - 1 - u, v)], 3,
                  &changed.bytes[changed.at(u, v)]);
  move_labels(changed, [&](const Vector2d& p) {
    return Vector2d{picture.width - 1 - p.x(), p.y()};
  });
  return changed;
}

std::optional<UprightPicture> with_second_gate(const UprightPicture& picture, double factor) {
  constexpr double kMargin = 1.15, kBars = 1.06;  // what is copied; what a whole gate's bars need
  if (picture.gates.empty()) return {};
  const Quad large = upright(picture.gates.front());
  if (!contains(picture, scaled(large, kBars))) return {};
  UprightPicture only = picture;
  only.gates = {large};
  const UprightPicture smaller = resized(only, factor);
  const auto by = room_for(picture, smaller.gates.front(), large, kMargin);
  if (!by) return {};
  UprightPicture changed = picture;
  const Quad copied = scaled(smaller.gates.front(), kMargin);
  for (int v = 0; v < smaller.height; ++v)
    for (int u = 0; u < smaller.width; ++u)
      if (inside(copied, {u, v}))
        std::copy_n(
            &smaller.bytes[smaller.at(u, v)], 3,
            &changed
                 .bytes[changed.at(u + static_cast<int>(by->x()), v + static_cast<int>(by->y()))]);
  Quad second = smaller.gates.front();
  for (Vector2d& corner : second) corner += *by;
  changed.gates.push_back(second);
  return changed;
}

UprightPicture with_band(const UprightPicture& picture, Bar bar, double part, double bar_width) {
  UprightPicture changed = picture;
  for (const Quad& label : picture.gates) {
    const Quad gate = upright(label);
    const auto first = static_cast<std::size_t>(bar);
    const Vector2d a = gate[first], b = gate[(first + 1) % 4];
    const double side = (b - a).norm();
    if (!(side > 0.0)) continue;
    const Vector2d along = (b - a) / side;
    const auto dark = dark_around(picture, gate);
    // The bar's width is of the gate's mean side: seen from beside, a side is short, not thin.
    const double across = 1.5 * bar_width * std::sqrt(std::abs(area(gate)));
    for (int v = 0; v < picture.height; ++v)
      for (int u = 0; u < picture.width; ++u) {
        const Vector2d p = Vector2d{u, v} - 0.5 * (a + b);
        if (std::abs(p.dot(along)) <= 0.5 * part * side &&
            std::abs(p.x() * along.y() - p.y() * along.x()) <= across)
          std::copy_n(dark.data(), 3, &changed.bytes[changed.at(u, v)]);
      }
  }
  return changed;
}

}  // namespace gatefly::experiments
