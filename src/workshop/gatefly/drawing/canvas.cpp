// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include <cairo.h>

#include "gatefly/files/output.hpp"

namespace gatefly::drawing {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

void use(cairo_t* context, const Color& color) {
  cairo_set_source_rgba(context, color.r, color.g, color.b, color.a);
}

void use(cairo_t* context, const Lettering& lettering) {
  cairo_select_font_face(context, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         lettering.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, lettering.size);
}

void check(cairo_surface_t* surface) {
  const cairo_status_t status = cairo_surface_status(surface);
  if (status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error(std::string{"no picture to draw on: "} +
                             cairo_status_to_string(status));
}

/// A pixel as Cairo keeps it: 0x00RRGGBB in the machine's own byte order. JFIF 1.02, full range.
std::uint32_t pixel_of(const Yuv& c) {
  const double y = c.y, u = c.u - 128.0, v = c.v - 128.0;
  const auto part = [](double x) {
    return static_cast<std::uint32_t>(std::clamp(std::lround(x), 0L, 255L));
  };
  return part(y + 1.402 * v) << 16 | part(y - 0.344136 * u - 0.714136 * v) << 8 |
         part(y + 1.772 * u);
}

cairo_status_t append(void* file, const unsigned char* bytes, unsigned length) try {
  static_cast<std::string*>(file)->append(reinterpret_cast<const char*>(bytes), length);
  return CAIRO_STATUS_SUCCESS;
} catch (const std::bad_alloc&) {
  return CAIRO_STATUS_NO_MEMORY;
}

}  // namespace

void Canvas::Free::operator()(cairo_t* context) const { cairo_destroy(context); }
void Canvas::Free::operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }

Canvas::Canvas(int width, int height, const Color& background)
    : surface_{
          cairo_image_surface_create(CAIRO_FORMAT_RGB24, std::max(width, 0), std::max(height, 0))} {
  check(surface_.get());
  if (width < 1 || height < 1) throw std::runtime_error("no picture to draw on: it has no pixels");
  context_.reset(cairo_create(surface_.get()));
  cairo_set_line_cap(context_.get(), CAIRO_LINE_CAP_ROUND);
  cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_ROUND);
  use(context_.get(), background);
  cairo_paint(context_.get());
}

int Canvas::width() const { return cairo_image_surface_get_width(surface_.get()); }
int Canvas::height() const { return cairo_image_surface_get_height(surface_.get()); }

void Canvas::fill(const Box& box, const Color& color, double corner_radius) {
  cairo_t* const c = context_.get();
  use(c, color);
  cairo_new_path(c);
  if (corner_radius > 0.0) {
    const double r = std::min({corner_radius, 0.5 * box.width, 0.5 * box.height});
    cairo_arc(c, box.right() - r, box.y + r, r, -0.25 * kTurn, 0.0);
    cairo_arc(c, box.right() - r, box.bottom() - r, r, 0.0, 0.25 * kTurn);
    cairo_arc(c, box.x + r, box.bottom() - r, r, 0.25 * kTurn, 0.5 * kTurn);
    cairo_arc(c, box.x + r, box.y + r, r, 0.5 * kTurn, 0.75 * kTurn);
    cairo_close_path(c);
  } else {
    cairo_rectangle(c, box.x, box.y, box.width, box.height);
  }
  cairo_fill(c);
}

void Canvas::trace(Points points, const Stroke& stroke) {
  cairo_t* const c = context_.get();
  use(c, stroke.color);
  cairo_set_line_width(c, stroke.width);
  cairo_set_dash(c, &stroke.dash, stroke.dash > 0.0 ? 1 : 0, 0.0);
  cairo_new_path(c);
  for (const auto& p : points) cairo_line_to(c, p.x(), p.y());
}

void Canvas::line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Stroke& stroke) {
  const Eigen::Vector2d ends[] = {from, to};
  polyline(ends, stroke);
}

void Canvas::polyline(Points points, const Stroke& stroke) {
  trace(points, stroke);
  cairo_stroke(context_.get());
}

void Canvas::outline(Points points, const Stroke& stroke) {
  trace(points, stroke);
  cairo_close_path(context_.get());
  cairo_stroke(context_.get());
}

void Canvas::polygon(Points points, const Color& color) {
  trace(points, {.color = color});
  cairo_fill(context_.get());
}

void Canvas::disc(const Eigen::Vector2d& center, double radius, const Color& color) {
  use(context_.get(), color);
  cairo_new_path(context_.get());
  cairo_arc(context_.get(), center.x(), center.y(), radius, 0.0, kTurn);
  cairo_fill(context_.get());
}

void Canvas::circle(const Eigen::Vector2d& center, double radius, const Stroke& stroke) {
  trace({}, stroke);
  cairo_arc(context_.get(), center.x(), center.y(), radius, 0.0, kTurn);
  cairo_stroke(context_.get());
}

double Canvas::text_width(const std::string& line, const Lettering& lettering) {
  use(context_.get(), lettering);
  cairo_text_extents_t extents{};
  cairo_text_extents(context_.get(), line.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::text(const Eigen::Vector2d& at, const std::string& line, const Lettering& lettering) {
  const double part = lettering.align == Align::kLeft     ? 0.0
                      : lettering.align == Align::kCenter ? 0.5
                                                          : 1.0;
  const double x = at.x() - part * text_width(line, lettering);
  use(context_.get(), lettering.color);
  cairo_move_to(context_.get(), x, at.y());
  cairo_show_text(context_.get(), line.c_str());
}

void Canvas::image(const Image& image, const Eigen::Vector2d& at, double scale, bool smooth) {
  if (image.empty() || !(scale > 0.0)) return;
  const std::unique_ptr<cairo_surface_t, Free> source{
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width(), image.height())};
  check(source.get());
  unsigned char* const bytes = cairo_image_surface_get_data(source.get());
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(source.get()));
  for (int v = 0; v < image.height(); ++v)
    for (int u = 0; u < image.width(); ++u) {
      const std::uint32_t pixel = pixel_of(image.at(u, v));
      std::memcpy(bytes + static_cast<std::size_t>(v) * stride + 4 * static_cast<std::size_t>(u),
                  &pixel, 4);
    }
  cairo_surface_mark_dirty(source.get());

  cairo_t* const c = context_.get();
  cairo_save(c);
  cairo_translate(c, at.x(), at.y());
  cairo_scale(c, scale, scale);
  cairo_set_source_surface(c, source.get(), 0.0, 0.0);
  cairo_pattern_set_filter(cairo_get_source(c), scale < 1.0 ? CAIRO_FILTER_GOOD
                                                : smooth    ? CAIRO_FILTER_GOOD
                                                            : CAIRO_FILTER_NEAREST);
  if (smooth) cairo_pattern_set_extend(cairo_get_source(c), CAIRO_EXTEND_PAD);
  cairo_rectangle(c, 0.0, 0.0, image.width(), image.height());
  cairo_fill(c);
  cairo_restore(c);
}

void Canvas::paste(const Canvas& other, const Eigen::Vector2d& at) {
  cairo_set_source_surface(context_.get(), other.surface_.get(), at.x(), at.y());
  cairo_paint(context_.get());
}

void Canvas::clip(const Box& box) {
  cairo_save(context_.get());
  cairo_rectangle(context_.get(), box.x, box.y, box.width, box.height);
  cairo_clip(context_.get());
}

void Canvas::unclip() { cairo_restore(context_.get()); }

std::vector<std::uint8_t> Canvas::rgb() const {
  cairo_surface_flush(surface_.get());
  const unsigned char* const bytes = cairo_image_surface_get_data(surface_.get());
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface_.get()));
  const auto columns = static_cast<std::size_t>(width()),
             lines = static_cast<std::size_t>(height());
  std::vector<std::uint8_t> out(3 * columns * lines);
  std::uint8_t* to = out.data();
  for (std::size_t y = 0; y < lines; ++y)
    for (std::size_t x = 0; x < columns; ++x, to += 3) {
      std::uint32_t pixel = 0;
      std::memcpy(&pixel, bytes + y * stride + 4 * x, 4);
      to[0] = static_cast<std::uint8_t>(pixel >> 16);
      to[1] = static_cast<std::uint8_t>(pixel >> 8);
      to[2] = static_cast<std::uint8_t>(pixel);
    }
  return out;
}

std::string Canvas::png() const {
  std::string file;
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface_.get(), append, &file);
  if (status != CAIRO_STATUS_SUCCESS) throw std::runtime_error(cairo_status_to_string(status));
  // A text chunk, by its length, name, content and checksum, behind the signature and the header.
  constexpr std::string_view kChunk{"\0\0\0\x10tEXtSoftware\0gatefly\x94\xd6\x0c\x15", 28};
  constexpr std::size_t kHeaderEnd = 33;
  return file.insert(kHeaderEnd, kChunk);
}

void Canvas::write_png(const std::filesystem::path& path) const { files::write_file(path, png()); }

}  // namespace gatefly::drawing
