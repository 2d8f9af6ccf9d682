// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace gatefly {

/// From one cell to another.
struct CellStep {
  std::int8_t x = 0, y = 0;

  /// In a picture of so many cells a row, row after row.
  [[nodiscard]] std::ptrdiff_t in(std::ptrdiff_t width) const { return y * width + x; }
};

/// The square frames that are tried around every place, as steps in cells: every size, turn and
/// foreshortening. A list is made once, for rounding and sines took a tenth of the careful search.
class FrameLattice {
 public:
  static constexpr int kSamples = 8;  ///< Samples of a side.

  /// Samples of a side, from its middle, and how far they reach.
  struct Side {
    std::array<CellStep, kSamples> samples;
    CellStep reach;
  };
  /// Steps from the place to the middles of the sides; from the left one to the right one. The
  /// right and the lower side may be a cell farther off, so that a few sizes fit all.
  struct Frame {
    Side level;
    CellStep left, right, right_too, upper, lower, lower_too;
    CellStep in_a, in_b;           ///< Two of the four places that are empty; the others opposite.
    Eigen::Vector2f across, down;  ///< Along the level and along the upright sides.
  };
  /// Frames that share their upright sides.
  struct Turned {
    double roll;  ///< [rad]
    Side upright;
    std::size_t first, count;  ///< Range of its frames.
  };
  struct Size {
    double upright;  ///< [cells]
    std::vector<Turned> turns;
  };

  /// @param sizes  of the upright sides [cells].
  /// @param max_roll_deg  largest turn; steps of 10°, 180° at most.
  /// @param shapes  the first so many foreshortenings; kShapes at most.
  FrameLattice(std::span<const double> sizes, double max_roll_deg, std::size_t shapes);

  static constexpr std::size_t kShapes = 6;

  /// Level by upright sides of the k-th frame of those that share theirs.
  [[nodiscard]] static double width_of(std::size_t k);

  [[nodiscard]] const std::vector<Size>& sizes() const { return sizes_; }
  [[nodiscard]] const Frame& frame(std::size_t i) const { return frames_[i]; }
  /// Number of the first frame of a size.
  [[nodiscard]] static std::size_t first_of(const Size& size) { return size.turns.front().first; }

 private:
  std::vector<Size> sizes_;
  std::vector<Frame> frames_;
};

}  // namespace gatefly
