// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>

#include <Eigen/Core>

namespace gatefly::refinement {

/// A side as x = at_0 + slope y + curve y². For a level one x and y are swapped: lines of constant y
/// always cross the bar.
struct Side {
  double at_0 = 0.0, slope = 0.0, curve = 0.0;
  double middle = 0.0;  // y halfway between its corners
  bool level = false;

  Side() = default;
  Side(const Eigen::Vector2d& a, const Eigen::Vector2d& b)
      : level{std::abs(b.x() - a.x()) > std::abs(b.y() - a.y())} {
    const double length = along(b) - along(a);
    slope = (across(b) - across(a)) / (std::abs(length) > 1e-9 ? length : 1e-9);
    at_0 = across(a) - slope * along(a), middle = 0.5 * (along(a) + along(b));
  }
  /// Bent between its corners a and b, which stay on it. @param sag  of its middle, across it.
  void bend(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& sag) {
    const double length = along(b) - along(a);
    if (!(std::abs(length) > 1.0)) return;
    // as far as that is along a line of pixels
    const double bow = 4.0 * across(sag) * (1.0 + slope * slope) / (length * length);
    curve = -bow, slope += bow * (along(a) + along(b)), at_0 -= bow * along(a) * along(b);
  }
  [[nodiscard]] double along(const Eigen::Vector2d& p) const { return level ? p.x() : p.y(); }
  [[nodiscard]] double across(const Eigen::Vector2d& p) const { return level ? p.y() : p.x(); }
  [[nodiscard]] double x(double y) const { return at_0 + y * (slope + y * curve); }
  [[nodiscard]] Eigen::Vector2d at(double y) const {
    return level ? Eigen::Vector2d{y, x(y)} : Eigen::Vector2d{x(y), y};
  }
  /// The straight side that touches it at y.
  [[nodiscard]] Side tangent(double y) const {
    Side line = *this;
    line.curve = 0.0, line.slope = slope + 2.0 * curve * y, line.at_0 = x(y) - line.slope * y;
    return line;
  }
  [[nodiscard]] double lean() const { return slope + 2.0 * curve * middle; }  // of its chord
  void lean_like(const Side& other, double y) {
    const double here = x(y);
    slope = other.lean() - 2.0 * curve * middle, at_0 = here - y * (slope + y * curve);
  }
  /// n · p = c, as (n, c).
  [[nodiscard]] Eigen::Vector3d equation() const {
    return level ? Eigen::Vector3d{-slope, 1.0, at_0} : Eigen::Vector3d{1.0, -slope, at_0};
  }
};

/// Crossing of two straight sides; nullopt when they are nearly parallel.
[[nodiscard]] inline std::optional<Eigen::Vector2d> crossing(const Side& before,
                                                             const Side& after) {
  const Eigen::Vector3d m = before.equation(), n = after.equation();
  const double det = m[0] * n[1] - m[1] * n[0];
  if (!(det * det > 0.04 * m.head<2>().squaredNorm() * n.head<2>().squaredNorm()))
    return std::nullopt;
  return Eigen::Vector2d{(m[2] * n[1] - m[1] * n[2]) / det, (m[0] * n[2] - m[2] * n[0]) / det};
}

/// How the crossings of a side's lines speak for a curve: x = ... + curve (y² - y_part y - part),
/// what is in brackets has no straight part of its own.
struct Curvature {
  double moment = 0.0, weight = 0.0;  // of the curve that fits best, least squares: moment / weight
  double part = 0.0, y_part = 0.0;

  void add_to(Side& side, double curve) const {
    side.curve += curve, side.slope -= curve * y_part, side.at_0 -= curve * part;
  }
};

}  // namespace gatefly::refinement
