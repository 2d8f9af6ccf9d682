// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/frame_lattice.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"

namespace gatefly {
namespace {

constexpr double kRollStep = 10.0;
constexpr int kMostRolls = 18;  // to each side

// How a frame looks from the side: its width, and how far its right bar is shifted down, of its
// height.
struct Shape {
  double width, shift;
};
constexpr std::array<Shape, FrameLattice::kShapes> kForeshortened{
    {{1.0, 0.0}, {0.72, 0.0}, {0.5, 0.0}, {0.36, 0.0}, {0.36, 0.25}, {0.36, -0.25}}};

CellStep step(const Eigen::Vector2d& d) {
  return {static_cast<std::int8_t>(std::lround(d.x())),
          static_cast<std::int8_t>(std::lround(d.y()))};
}

FrameLattice::Side side(const Eigen::Vector2d& d) {
  FrameLattice::Side side;
  for (std::size_t k = 0; k < side.samples.size(); ++k)
    side.samples[k] = step(((static_cast<double>(k) + 0.5) / FrameLattice::kSamples - 0.5) * d);
  side.reach = {static_cast<std::int8_t>(std::abs(0.5 * d.x()) + 1.0),
                static_cast<std::int8_t>(std::abs(0.5 * d.y()) + 1.0)};
  return side;
}

Eigen::Vector2d longer_by_one(const Eigen::Vector2d& d) { return d + d / std::max(1.0, d.norm()); }

FrameLattice::Frame frame_of(const Eigen::Vector2d& across, const Eigen::Vector2d& down) {
  return {.level = side(across),
          .left = step(-0.5 * across),
          .right = step(across),
          .right_too = step(longer_by_one(across)),
          .upper = step(-0.5 * down),
          .lower = step(down),
          .lower_too = step(longer_by_one(down)),
          .in_a = step(0.2 * (across + down)),
          .in_b = step(0.2 * (across - down)),
          .across = across.cast<float>(),
          .down = down.cast<float>()};
}

}  // namespace

double FrameLattice::width_of(std::size_t k) { return kForeshortened[k].width; }

FrameLattice::FrameLattice(std::span<const double> sizes, double max_roll_deg, std::size_t shapes) {
  const int rolls = std::clamp(static_cast<int>(max_roll_deg / kRollStep), 0, kMostRolls);
  for (const double size : sizes) {
    sizes_.push_back({.upright = size, .turns = {}});
    for (int r = -rolls; r <= rolls; ++r) {
      const double roll = r * kRollStep * kDegree;
      const auto [sine, cosine] = sincos(roll);
      const Eigen::Vector2d right{cosine, sine}, down = size * Eigen::Vector2d{-sine, cosine};
      sizes_.back().turns.push_back({roll, side(down), frames_.size(), shapes});
      for (std::size_t k = 0; k < shapes; ++k)
        frames_.push_back(frame_of(
            kForeshortened[k].width * size * right + kForeshortened[k].shift * down, down));
    }
  }
}

}  // namespace gatefly
