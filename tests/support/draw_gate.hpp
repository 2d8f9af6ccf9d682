// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "gatefly/detection/quad.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rng.hpp"
#include "gatefly/pose/gate_fix.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::test {

/// Place of a drone relative to a gate and how it is turned.
struct View {
  Eigen::Vector3d p_GB{-3, 0, 0};
  Attitude attitude_GB{};  ///< Yaw relative to the gate.
};

/// The Bebop's: fisheye, 20° down.
inline CameraRig bebop_rig() {
  return {AnyCamera{DhaneFisheye{}}, camera_mount(20 * kDegree), {0.08, 0, 0}};
}

/// Pixel of a point in the gate's frame, if it shows.
inline std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& p_G, const View& view,
                                               const CameraRig& rig) {
  const Eigen::Matrix3d R_GB = rotation_EB(view.attitude_GB).matrix;
  return rig.lens.project((R_GB * rig.R_BC.matrix).transpose() *
                          (p_G - view.p_GB - R_GB * rig.p_BC));
}

/// The outer corners, TL TR BR BL as seen from before the gate; nullopt when one is out of the
/// lens.
inline std::optional<Quad> corners_of(double side, const View& view, const CameraRig& rig) {
  const double h = 0.5 * side;
  const std::array<Eigen::Vector3d, 4> p_G{{{0, -h, -h}, {0, h, -h}, {0, h, h}, {0, -h, h}}};
  Quad quad;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto px = pixel_of(p_G[i], view, rig);
    if (!px) return std::nullopt;
    quad[i] = *px;
  }
  return quad;
}

/// All four corners at least `margin` inside a picture.
inline bool inside_picture(const Quad& quad, int width, int height, double margin = 3.0) {
  for (const auto& p : quad)
    if (!(p.x() >= margin && p.y() >= margin && p.x() <= width - 1 - margin &&
          p.y() <= height - 1 - margin))
      return false;
  return true;
}

/// A picture to draw gates into; float colours, so that bars blend into the background at their
/// edges.
class Canvas {
 public:
  Canvas(int width, int height)
      : width_{width},
        height_{height},
        pixels_(static_cast<std::size_t>(width * height), {110, 128, 128}) {}

  /// Coloured noise around grey: what an ordinary wall does to a small sensor.
  void add_noise(Rng& rng, double luma = 20.0, double chroma = 4.0) {
    for (auto& c : pixels_) {
      c[0] += rng.uniform(-luma, luma);
      c[1] += rng.uniform(-chroma, chroma);
      c[2] += rng.uniform(-chroma, chroma);
    }
  }
  void fill(const std::array<double, 3>& color) {
    std::fill(pixels_.begin(), pixels_.end(), color);
  }
  /// One colour from column `from` to column `to`, from row `top` to row `bottom`.
  void paint(int from, int to, int top, int bottom, const std::array<double, 3>& color) {
    for (int v = std::max(0, top); v < std::min(height_, bottom); ++v)
      for (int u = std::max(0, from); u < std::min(width_, to); ++u) at(u, v) = color;
  }
  /// Back to grey.
  void blank(int from, int to, int top = 0, int bottom = 1 << 20) {
    paint(from, to, top, bottom, {110, 128, 128});
  }

  /// A gate by ray casting: each pixel is 4 x 4 rays to the gate plane, coloured where they hit the
  /// frame.
  void draw_gate(const View& view, const CameraRig& rig, double side = 1.0, double bar = 0.05,
                 const std::array<double, 3>& color = {120, 90, 190}) {
    const Eigen::Matrix3d R_GB = rotation_EB(view.attitude_GB).matrix;
    const Eigen::Matrix3d R_GC = R_GB * rig.R_BC.matrix;
    const Eigen::Vector3d eye = view.p_GB + R_GB * rig.p_BC;
    // Only where the frame can be: around its outline, or everywhere when part of it is out of the
    // lens.
    Eigen::Vector2d low{0, 0}, high{width_ - 1.0, height_ - 1.0};
    Eigen::Vector2d least{1e9, 1e9}, most{-1e9, -1e9};
    bool whole = true;
    for (int i = 0; i < 80; ++i) {
      const double along = side * ((i % 20) / 20.0 - 0.5),
                   across = 0.5 * side * (i < 40 ? -1.0 : 1.0);
      const bool upright = (i / 20) % 2 == 0;
      const auto px =
          pixel_of(upright ? Eigen::Vector3d{0, across, along} : Eigen::Vector3d{0, along, across},
                   view, rig);
      if (!px) {
        whole = false;
        break;
      }
      least = least.cwiseMin(*px), most = most.cwiseMax(*px);
    }
    if (whole)
      low = low.cwiseMax(least - Eigen::Vector2d{6, 6}),
      high = high.cwiseMin(most + Eigen::Vector2d{6, 6});

    constexpr int kRays = 4;
    for (int v = static_cast<int>(low.y()); v <= high.y(); ++v)
      for (int u = static_cast<int>(low.x()); u <= high.x(); ++u) {
        int hits = 0;
        for (int i = 0; i < kRays; ++i)
          for (int j = 0; j < kRays; ++j) {
            const Eigen::Vector2d px{u + (i + 0.5) / kRays - 0.5, v + (j + 0.5) / kRays - 0.5};
            const auto bearing = rig.lens.bearing(px);
            if (!bearing) continue;
            const Eigen::Vector3d d = R_GC * *bearing;
            if (d.x() < 1e-6 || eye.x() >= 0) continue;
            const Eigen::Vector3d hit = eye - d * (eye.x() / d.x());
            const double out = std::max(std::abs(hit.y()), std::abs(hit.z()));
            hits += out <= 0.5 * side && out >= 0.5 * side - bar;
          }
        const double part = static_cast<double>(hits) / (kRays * kRays);
        for (std::size_t k = 0; k < 3; ++k) at(u, v)[k] += part * (color[k] - at(u, v)[k]);
      }
  }

  /// The bytes as a sensor would store them; the canvas is upright.
  [[nodiscard]] std::vector<std::uint8_t> yuv444() const {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(pixels_.size() * 3);
    for (const auto& c : pixels_)
      for (const double x : c) bytes.push_back(byte(x));
    return bytes;
  }
  /// U Y V Y, chroma averaged over each pair of columns; `width` must be even.
  [[nodiscard]] std::vector<std::uint8_t> uyvy() const {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(pixels_.size() * 2);
    for (std::size_t i = 0; i + 1 < pixels_.size(); i += 2) {
      const auto &a = pixels_[i], &b = pixels_[i + 1];
      bytes.push_back(byte(0.5 * (a[1] + b[1])));
      bytes.push_back(byte(a[0]));
      bytes.push_back(byte(0.5 * (a[2] + b[2])));
      bytes.push_back(byte(b[0]));
    }
    return bytes;
  }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

 private:
  static std::uint8_t byte(double x) {
    return static_cast<std::uint8_t>(std::clamp(std::floor(x + 0.5), 0.0, 255.0));
  }
  std::array<double, 3>& at(int u, int v) {
    return pixels_[static_cast<std::size_t>(v * width_ + u)];
  }

  int width_, height_;
  std::vector<std::array<double, 3>> pixels_;
};

}  // namespace gatefly::test
