// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/lens_rays.hpp"

#include <algorithm>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sensing/camera.hpp"

namespace gatefly::sim {
namespace {

constexpr int kLinesOfTile = 8, kLinesOfFastTile = 16;  // so that a tile is many rays
constexpr double kJitter = 0.5;                         // of a sample in its cell, 0..1

/// Number in [0, 1) by position.
double ray_jitter(std::uint32_t a, std::uint32_t b) {
  std::uint32_t x = a * 0x9E3779B9u ^ (b + 0x7F4A7C15u) * 0x85EBCA6Bu;
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return (x ^ (x >> 16)) * 0x1p-32;
}

/// Place of a sample in its pixel: the centre, or in a jittered 2 x 2 grid.
Eigen::Vector2d offset(const RayGrid& grid, std::uint32_t pixel, int sample) {
  if (grid.samples == 1) return {0, 0};
  const auto place = [&](int cell, int key) {
    const double jitter = kJitter * (ray_jitter(pixel, static_cast<std::uint32_t>(key)) - 0.5);
    return ((cell + 0.5 + jitter) / 2 - 0.5) * grid.footprint;
  };
  return {place(sample % 2, 2 * sample), place(sample / 2, 2 * sample + 1)};
}

static_assert(kLinesOfTile * 4 <= RayTile::kMostGroups && kLinesOfFastTile <= RayTile::kMostGroups);

}  // namespace

LensRays::LensRays(const world::CameraTruth& camera, const RayGrid& grid)
    : grid_{grid},
      width_{(camera.stored_width + grid.step - 1) / grid.step},
      lines_{(camera.stored_height + grid.step - 1) / grid.step},
      lines_of_tile_{grid.samples == 1 ? kLinesOfFastTile : kLinesOfTile},
      tiles_across_{(width_ + kColumns - 1) / kColumns},
      tiles_down_{(lines_ + lines_of_tile_ - 1) / lines_of_tile_} {
  const auto rays = static_cast<std::size_t>(tiles() * lines_of_tile_ * grid.samples * kColumns);
  for (auto* values : {&x_, &y_, &z_}) values->assign(rays, 0.0f);
  for (int line = 0; line < lines_; ++line)
    for (int x = 0; x < width_; ++x) set(camera, x, line);
}

void LensRays::set(const world::CameraTruth& camera, int x, int line) {
  const Eigen::Matrix3d R_BC = camera_mount(camera.tilt_down).matrix;
  const int tile = line / lines_of_tile_ * tiles_across_ + x / kColumns;
  const int stored_x = x * grid_.step, stored_line = line * grid_.step;
  const auto pixel = static_cast<std::uint32_t>(stored_line * camera.stored_width + stored_x);
  for (int sample = 0; sample < grid_.samples; ++sample) {
    const Eigen::Vector2d upright = camera.upright(stored_x, stored_line);
    const auto bearing_C = camera.lens.bearing(upright + offset(grid_, pixel, sample));
    if (!bearing_C) continue;
    const Eigen::Vector3f bearing_B = (R_BC * *bearing_C).cast<float>();
    const int group = (tile * lines_of_tile_ + line % lines_of_tile_) * grid_.samples + sample;
    const auto ray = static_cast<std::size_t>(group * kColumns + x % kColumns);
    x_[ray] = bearing_B.x(), y_[ray] = bearing_B.y(), z_[ray] = bearing_B.z();
  }
}

LensRays::Place LensRays::place(int tile) const {
  const int x = tile % tiles_across_ * kColumns, line = tile / tiles_across_ * lines_of_tile_;
  return {x, line, std::min(kColumns, width_ - x), std::min(lines_of_tile_, lines_ - line)};
}

void LensRays::aim(int tile, const std::vector<Eye>& eyes, RayTile& rays) const {
  const Place at = place(tile);
  rays.groups = at.lines * grid_.samples;
  const auto first = static_cast<std::size_t>(tile * lines_of_tile_ * grid_.samples * kColumns);
  const float* x = x_.data() + first;
  const float* y = y_.data() + first;
  const float* z = z_.data() + first;
  const Eye* eye = eyes.data() + at.line * grid_.samples;
  for (int group = 0; group < rays.groups;
       ++group, ++eye, x += kColumns, y += kColumns, z += kColumns) {
    rays.ox[group] = eye->p_EC.x(), rays.oy[group] = eye->p_EC.y(), rays.oz[group] = eye->p_EC.z();
    float R[9];
    Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>{R} = eye->R_EB;
    float* dx = rays.dx + group * kColumns;
    float* dy = rays.dy + group * kColumns;
    float* dz = rays.dz + group * kColumns;
    for (int i = 0; i < kColumns; ++i) {
      dx[i] = R[0] * x[i] + R[1] * y[i] + R[2] * z[i];
      dy[i] = R[3] * x[i] + R[4] * y[i] + R[5] * z[i];
      dz[i] = R[6] * x[i] + R[7] * y[i] + R[8] * z[i];
    }
  }
}

}  // namespace gatefly::sim
