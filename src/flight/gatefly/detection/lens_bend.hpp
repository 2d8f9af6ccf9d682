// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "gatefly/detection/gate_detector_params.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// How a lens bends straight bars: its radial part as two tables, made once. [ours]
///
/// Rays from 90° on, where camera models end, and pixels beyond a fitted polynomial's use are
/// continued, so that a gate may reach over the picture's border. A tangential part is left out: it
/// moves a bar, it hardly bends it.
class LensBend {
 public:
  /// Straight: nothing bends.
  LensBend() = default;
  /// Allocates, once. No lens, or one that bends nothing by a tenth of a pixel: straight.
  explicit LensBend(const PictureLens& lens);

  [[nodiscard]] bool is_straight() const { return rays_.empty(); }
  [[nodiscard]] bool is_known() const { return known_; }
  /// Pixels of the lens' pictures a pixel of `image`; nullopt where that is of another shape.
  [[nodiscard]] std::optional<double> scale_of(const Image& image) const;
  /// The place of the corner of `image`'s first pixel in the lens' pictures.
  [[nodiscard]] Eigen::Vector2d origin_in(const Image& image, double scale) const;

  /// Unit vector in C that a pixel of the lens' picture looks along; nullopt far outside.
  [[nodiscard]] std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& px) const {
    const Eigen::Vector2d m = (px - center_px_).cwiseProduct(per_focal_);
    const double at = m.squaredNorm() * rays_per_unit_;
    if (!(at < kEntries)) return std::nullopt;
    const auto k = static_cast<std::size_t>(at);
    const double part = at - static_cast<double>(k);
    const Ray &a = rays_[k], &b = rays_[k + 1];
    const double sine = a.sine + part * (b.sine - a.sine);
    return Eigen::Vector3d{sine * m.x(), sine * m.y(), a.cosine + part * (b.cosine - a.cosine)};
  }
  /// Image point of a direction in C, of any length; nullopt: behind the camera.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel(const Eigen::Vector3d& direction_C) const {
    const Eigen::Vector3d d = direction_C.normalized();
    const double at = (1.0 - d.z()) * pixels_per_unit_;
    if (!(at < kEntries)) return std::nullopt;
    const auto k = static_cast<std::size_t>(std::max(0.0, at));
    const double part = at - static_cast<double>(k);
    const double radius = radii_[k] + part * (radii_[k + 1] - radii_[k]);
    return Eigen::Vector2d{center_px_ + radius * d.head<2>().cwiseQuotient(per_focal_)};
  }

 private:
  static constexpr int kEntries = 512;

  // A ray drawn at radius r of a lens of focal length 1, by r².
  struct Ray {
    double sine, cosine;  // of the angle from the axis; the former / r
  };

  std::vector<Ray> rays_;
  std::vector<double> radii_;  // r / sine of the angle, by 1 - cosine
  Eigen::Vector2d center_px_{0, 0}, per_focal_{1, 1};
  double rays_per_unit_ = 0.0, pixels_per_unit_ = 0.0;  // entries
  int width_ = 0, height_ = 0;                          // of the lens' pictures; 0: any
  bool known_ = true, any_shape_ = false;
};

/// An equidistant lens that shows so wide an angle across the width of any picture [rad]: what one
/// number says of a lens. 0: a straight one.
/// @param center  of the lens, off the picture's middle, in its widths.
[[nodiscard]] PictureLens equidistant_lens(double angle_across,
                                           const Eigen::Vector2d& center = {0, 0});

/// The bend of straight bars in one picture, in its cells. As cheap to copy as a pointer.
class SideCurves {
 public:
  /// Straight lines.
  SideCurves() = default;
  /// @param bend  must stay.
  /// @param cell  side of a cell [px].
  SideCurves(const LensBend& bend, const Image& image, double cell = 1.0) {
    const auto scale = bend.scale_of(image);
    known_ = bend.is_known() && scale;
    if (scale && !bend.is_straight())
      bend_ = &bend, cell_px_ = *scale * cell, origin_px_ = bend.origin_in(image, *scale);
  }

  [[nodiscard]] bool bent() const { return bend_ != nullptr; }
  /// Whether anybody said which lens it was: a straight one else, or one that bends.
  [[nodiscard]] bool known() const { return known_; }
  /// The same as a guess: nobody said so.
  [[nodiscard]] SideCurves guessed() const {
    SideCurves curves = *this;
    curves.known_ = false;
    return curves;
  }

  /// A bar's image from a to b is a + t (b - a) + 4 t (1 - t) sag, t = 0..1. 0 where the lens does
  /// not reach.
  [[nodiscard]] Eigen::Vector2d sag(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    if (bend_ == nullptr) return Eigen::Vector2d::Zero();
    const auto from = bend_->ray(to_lens(a)), to = bend_->ray(to_lens(b));
    const auto on_bar = from && to ? bend_->pixel(*from + *to) : std::nullopt;
    if (!on_bar) return Eigen::Vector2d::Zero();
    // The ray halfway is drawn a little before or behind the middle.
    const Eigen::Vector2d d = b - a, off = to_cells(*on_bar) - 0.5 * (a + b), normal{-d.y(), d.x()};
    const double square = std::max(1e-9, d.squaredNorm()), before = off.dot(d) / square;
    return off.dot(normal) / (square * std::max(0.5, 1.0 - 4.0 * before * before)) * normal;
  }

  /// Crossing of the bars through a, b and through c, d, nearer to b; nullopt when they are nearly
  /// parallel or the lens does not reach there. bent() only.
  [[nodiscard]] std::optional<Eigen::Vector2d> crossing(const Eigen::Vector2d& a,
                                                        const Eigen::Vector2d& b,
                                                        const Eigen::Vector2d& c,
                                                        const Eigen::Vector2d& d) const {
    const auto ray_a = bend_->ray(to_lens(a)), ray_b = bend_->ray(to_lens(b)),
               ray_c = bend_->ray(to_lens(c)), ray_d = bend_->ray(to_lens(d));
    if (!ray_a || !ray_b || !ray_c || !ray_d) return std::nullopt;
    const Eigen::Vector3d m = ray_a->cross(*ray_b), n = ray_c->cross(*ray_d);
    Eigen::Vector3d met = m.cross(n);
    if (!(met.squaredNorm() > 0.04 * m.squaredNorm() * n.squaredNorm())) return std::nullopt;
    if (met.dot(*ray_b) < 0.0) met = -met;
    const auto px = bend_->pixel(met);
    return px ? std::optional{to_cells(*px)} : std::nullopt;
  }

  /// A square's corners made larger by `factor` about its middle, in its own plane.
  [[nodiscard]] Quad scaled(const Quad& quad, double factor) const;

 private:
  [[nodiscard]] Eigen::Vector2d to_lens(const Eigen::Vector2d& p) const {
    return ((p.array() + 0.5) * cell_px_ + origin_px_.array()).matrix();
  }
  [[nodiscard]] Eigen::Vector2d to_cells(const Eigen::Vector2d& px) const {
    return ((px - origin_px_).array() / cell_px_ - 0.5).matrix();
  }

  const LensBend* bend_ = nullptr;
  double cell_px_ = 1.0;                   // pixels of the lens' pictures
  Eigen::Vector2d origin_px_{-0.5, -0.5};  // of the first cell's corner, there
  bool known_ = true;
};

}  // namespace gatefly
