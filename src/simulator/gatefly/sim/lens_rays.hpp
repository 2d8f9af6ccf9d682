// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "gatefly/sim/tile_caster.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// Origin of the rays and the body's attitude, single precision.
struct Eye {
  Eigen::Vector3f p_EC;
  Eigen::Matrix3f R_EB;
};

/// Which pixels of a stored picture are cast, and with how many rays each.
struct RayGrid {
  int step = 1;            ///< One pixel in so many, both ways.
  int samples = 1;         ///< Rays a pixel: 1, through its centre, or 4.
  double footprint = 1.0;  ///< Side of the square that four of them cover [px].
};

/// The directions of a lens's rays in the body frame, in tiles of pixels that lie together.
class LensRays {
 public:
  LensRays(const world::CameraTruth& camera, const RayGrid& grid);

  /// Pixels of one tile: `columns` of each stored line; a group of rays is a line's, then sample by
  /// sample.
  struct Place {
    int x, line, columns, lines;
  };
  static constexpr int kColumns = RayTile::kLanes;

  [[nodiscard]] int tiles() const { return tiles_across_ * tiles_down_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int lines() const { return lines_; }
  [[nodiscard]] int samples() const { return grid_.samples; }
  [[nodiscard]] int step() const { return grid_.step; }
  [[nodiscard]] Place place(int tile) const;

  /// Points a tile's rays into the world.
  /// @param eyes  of every line of the grid, sample by sample.
  void aim(int tile, const std::vector<Eye>& eyes, RayTile& rays) const;

 private:
  void set(const world::CameraTruth& camera, int x, int line);

  RayGrid grid_;
  int width_, lines_, lines_of_tile_, tiles_across_, tiles_down_;
  std::vector<float> x_, y_, z_;  // RayTile::kLanes by group by tile
};

}  // namespace gatefly::sim
