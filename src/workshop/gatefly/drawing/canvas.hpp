// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/drawing/palette.hpp"
#include "gatefly/sensing/image.hpp"

struct _cairo;  // Cairo's own names; its header stays in canvas.cpp
struct _cairo_surface;

namespace gatefly::drawing {

struct Stroke {
  Color color = kLight.ink;
  double width = 1.5;  ///< [px]
  double dash = 0.0;   ///< Length of dashes and gaps [px]; 0: one line.
};

enum class Align { kLeft, kCenter, kRight };

struct Lettering {
  Color color = kLight.ink;
  double size = 13.0;  ///< [px]
  Align align = Align::kLeft;
  bool bold = false;
};

/// Upright rectangle [px].
struct Box {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;

  [[nodiscard]] double right() const { return x + width; }
  [[nodiscard]] double bottom() const { return y + height; }
};

/// An RGB picture to draw on: x right, y down, pixel (0, 0) covers [0, 1) x [0, 1).
class Canvas {
 public:
  using Points = std::span<const Eigen::Vector2d>;

  /// @throws std::runtime_error when there is no such picture: a side not in 1..32767, no memory.
  Canvas(int width, int height, const Color& background = kLight.panel);

  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;

  void fill(const Box& box, const Color& color, double corner_radius = 0.0);
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Stroke& stroke);
  void polyline(Points points, const Stroke& stroke);  ///< Open.
  void outline(Points points, const Stroke& stroke);   ///< Closed.
  void polygon(Points points, const Color& color);     ///< Filled.
  void disc(const Eigen::Vector2d& center, double radius, const Color& color);
  void circle(const Eigen::Vector2d& center, double radius, const Stroke& stroke);
  /// One line; `at` is on its baseline, at the end that `align` says.
  void text(const Eigen::Vector2d& at, const std::string& line, const Lettering& lettering = {});
  [[nodiscard]] double text_width(const std::string& line, const Lettering& lettering = {});

  /// The upright picture with its top-left corner at `at`: enlarged pixels stay squares, or are
  /// interpolated (`smooth`).
  void image(const Image& image, const Eigen::Vector2d& at, double scale, bool smooth = false);
  void paste(const Canvas& other, const Eigen::Vector2d& at);

  /// Limits everything drawn until unclip() to the inside of `box`.
  void clip(const Box& box);
  void unclip();

  /// R G B, 3 bytes a pixel, line by line without padding.
  [[nodiscard]] std::vector<std::uint8_t> rgb() const;
  /// A PNG file that says it is of gatefly's making.
  [[nodiscard]] std::string png() const;
  /// Writes it whole or not at all. @throws CannotWrite naming the file and why.
  void write_png(const std::filesystem::path& path) const;

 private:
  struct Free {
    void operator()(_cairo* context) const;
    void operator()(_cairo_surface* surface) const;
  };
  void trace(Points points, const Stroke& stroke);

  std::unique_ptr<_cairo_surface, Free> surface_;
  std::unique_ptr<_cairo, Free> context_;
};

}  // namespace gatefly::drawing
