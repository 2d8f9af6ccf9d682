// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "gatefly/race/path.hpp"
#include "gatefly/race/solids.hpp"
#include "gatefly/race/track.hpp"

namespace gatefly {

using Polyline = std::vector<Eigen::Vector3d>;  ///< Earth frame [m].

/// The free room as far as it matters, as a grid of places that are looked at when first asked for.
class RoomGrid {
 public:
  static constexpr double kNoWay = std::numeric_limits<double>::infinity();

  RoomGrid(const std::vector<MapSolid>& solids, const Track& room, const PlanParams& params,
           double step)
      : solids_{solids}, params_{params}, step_{step}, layer_{kLayer * step} {
    constexpr double kAround =
        3.0;  // beyond the outermost thing there is nothing to fly around [m]
    Eigen::Vector2d low = room.start, high = room.start;
    double top = 0.0;
    const auto take = [&](const Eigen::Vector2d& p, double reach) {
      low = low.cwiseMin(p - Eigen::Vector2d::Constant(reach));
      high = high.cwiseMax(p + Eigen::Vector2d::Constant(reach));
    };
    for (const MapSolid& solid : solids) {
      if (solid.kind != MapSolid::Kind::kObstacle && solid.kind != MapSolid::Kind::kGate) continue;
      take(solid.footprint.center, 0.5 * solid.footprint.size.norm() + kAround);
      top = std::max(top, solid.top);
    }
    low = low.cwiseMax(room.room_center - 0.5 * room.room_size);
    high = high.cwiseMin(room.room_center + 0.5 * room.room_size);
    low_ = {low.x(), low.y(), params.clearance};
    const double ceiling = std::min(room.ceiling, top + 2 * params.clearance) - params.clearance;
    nx_ = 1 + static_cast<int>((high.x() - low.x()) / step);
    ny_ = 1 + static_cast<int>((high.y() - low.y()) / step);
    nz_ = 1 + std::max(0, static_cast<int>((ceiling - low_.z()) / layer_));
    margins_.assign(static_cast<std::size_t>(nx_ * ny_ * nz_), NAN);
  }

  /// Room beyond what is wanted, beside things or above and below them; negative: too near [m].
  [[nodiscard]] double margin(const Eigen::Vector3d& p_E) const {
    double least = kNoWay;
    for (const MapSolid& solid : solids_) least = std::min(least, margin(solid, p_E));
    return least;
  }
  [[nodiscard]] bool is_free(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                             double least) const {
    const int steps = 1 + static_cast<int>((to - from).norm() / 0.05);
    for (int i = 0; i <= steps; ++i)
      if (margin(from + (to - from) * i / steps) < least) return false;
    return true;
  }

  /// The shortest way that keeps `least` more than what is wanted; empty: there is none.
  [[nodiscard]] Polyline shortest(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                  double least) const {
    const int goal = nearest_cell(to), start = nearest_cell(from);
    return search(
        start, goal,
        [&](double cost, int cell, int next) {
          const bool open = next == goal || margin_at(next) >= least;
          return open ? cost + weighted(place(next) - place(cell)) : kNoWay;
        },
        [&](int cell) { return weighted(place(goal) - place(cell)); });
  }

  /// The way whose narrowest place is widest, through nothing solid.
  [[nodiscard]] Polyline widest(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
    const double solid = -params_.clearance - params_.body_radius + 0.5 * step_;
    return search(
        nearest_cell(from), nearest_cell(to),
        [&](double cost, int, int next) {
          const double margin = margin_at(next);
          return margin < solid ? kNoWay : std::max(cost, -margin);
        },
        [](int) { return 0.0; }, -margin(from));
  }

  /// A gap at that place: between the two things that leave the least room there, both beside it or
  /// one above and one below.
  [[nodiscard]] Gap gap_at(const Eigen::Vector3d& p_E) const {
    const auto nearest = [&](const MapSolid* but) {
      const MapSolid* found = nullptr;
      for (const MapSolid& solid : solids_) {
        if (but != nullptr && solid.kind == but->kind && solid.number == but->number &&
            solid.kind != MapSolid::Kind::kWall)
          continue;  // a frame and its pole
        if (&solid == but || (but != nullptr && is_beside(solid, p_E) != is_beside(*but, p_E)))
          continue;
        if (found == nullptr || margin(solid, p_E) < margin(*found, p_E)) found = &solid;
      }
      return found;
    };
    const MapSolid* one = nearest(nullptr);
    return gap_between(*one, *nearest(one), params_);
  }

 private:
  [[nodiscard]] double margin_beside(const MapSolid& solid, const Eigen::Vector3d& p_E) const {
    return solid.beside(p_E.head<2>()) - params_.clearance - params_.body_radius;
  }
  [[nodiscard]] double margin_above(const MapSolid& solid, const Eigen::Vector3d& p_E) const {
    return solid.above_or_below(-p_E.z()) - params_.clearance;
  }
  [[nodiscard]] double margin(const MapSolid& solid, const Eigen::Vector3d& p_E) const {
    return std::max(margin_beside(solid, p_E), margin_above(solid, p_E));
  }
  [[nodiscard]] bool is_beside(const MapSolid& solid, const Eigen::Vector3d& p_E) const {
    return margin_beside(solid, p_E) >= margin_above(solid, p_E);
  }
  static constexpr double kLayer = 1.25;       // between the grid's heights, in steps aside
  static constexpr double kClimbWeight = 3.0;  // a metre up or down is worth so many aside

  static double weighted(const Eigen::Vector3d& way) {
    return Eigen::Vector3d{way.x(), way.y(), kClimbWeight * way.z()}.norm();
  }
  [[nodiscard]] int cell_of(int x, int y, int z) const { return (z * ny_ + y) * nx_ + x; }
  [[nodiscard]] Eigen::Vector3d place(int cell) const {
    const int x = cell % nx_, y = cell / nx_ % ny_, z = cell / nx_ / ny_;
    return {low_.x() + step_ * x, low_.y() + step_ * y, -low_.z() - layer_ * z};
  }
  [[nodiscard]] int nearest_cell(const Eigen::Vector3d& p_E) const {
    const auto index = [](double value, double step, int count) {
      return std::clamp(static_cast<int>(std::lround(value / step)), 0, count - 1);
    };
    return cell_of(index(p_E.x() - low_.x(), step_, nx_), index(p_E.y() - low_.y(), step_, ny_),
                   index(-p_E.z() - low_.z(), layer_, nz_));
  }
  double margin_at(int cell) const {
    double& known = margins_[static_cast<std::size_t>(cell)];
    if (std::isnan(known)) known = margin(place(cell));
    return known;
  }

  /// Best first (A*): `step` is the cost of a cell by way of its neighbour, `rest` at most what is
  /// still to come.
  template <class Step, class Rest>
  Polyline search(int from, int to, Step step, Rest rest, double first = 0.0) const {
    std::vector<double> costs(margins_.size(), kNoWay);
    std::vector<int> before(margins_.size(), -1);
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    costs[static_cast<std::size_t>(from)] = first;
    open.emplace(first + rest(from), from);
    std::vector<bool> done(margins_.size());
    // At most once an entry: each cell, once done, adds one for each of its 26 neighbours at most.
    while (!open.empty()) {
      const int cell = open.top().second;
      open.pop();
      if (done[static_cast<std::size_t>(cell)]) continue;
      done[static_cast<std::size_t>(cell)] = true;
      if (cell == to) return way_back(cell, before);
      const int x = cell % nx_, y = cell / nx_ % ny_, z = cell / nx_ / ny_;
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const int nx = x + dx, ny = y + dy, nz = z + dz;
            if (nx < 0 || ny < 0 || nz < 0 || nx >= nx_ || ny >= ny_ || nz >= nz_) continue;
            const int next = cell_of(nx, ny, nz);
            if (done[static_cast<std::size_t>(next)]) continue;
            const double cost = step(costs[static_cast<std::size_t>(cell)], cell, next);
            if (cost >= costs[static_cast<std::size_t>(next)]) continue;
            costs[static_cast<std::size_t>(next)] = cost;
            before[static_cast<std::size_t>(next)] = cell;
            open.emplace(cost + rest(next), next);
          }
    }
    return {};
  }
  Polyline way_back(int cell, const std::vector<int>& before) const {
    Polyline line;
    // At most once a cell: the one before was done earlier.
    for (; cell >= 0; cell = before[static_cast<std::size_t>(cell)]) line.push_back(place(cell));
    std::reverse(line.begin(), line.end());
    return line;
  }

  const std::vector<MapSolid>& solids_;
  const PlanParams& params_;
  double step_, layer_;  ///< Aside and up [m].
  Eigen::Vector3d low_;  ///< North, east, height.
  int nx_ = 0, ny_ = 0, nz_ = 0;
  mutable std::vector<double> margins_;
};

}  // namespace gatefly
