// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace gatefly {

/// Full-range JFIF Y'CbCr, each 0..255; grey has u = v = 128.
struct Yuv {
  std::uint8_t y, u, v;
};

/// The same with both chromas in one word, u + 2^16 v: added up or looked up at once.
struct PackedYuv {
  std::uint32_t uv;
  std::uint8_t y;

  [[nodiscard]] Yuv unpacked() const {
    return {y, static_cast<std::uint8_t>(uv), static_cast<std::uint8_t>(uv >> 16)};
  }
  [[nodiscard]] static PackedYuv of(Yuv c) { return {c.u | std::uint32_t{c.v} << 16, c.y}; }
};

/// How the bytes of a stored picture are laid out, line by line without padding.
enum class PixelFormat {
  kUyvy,    ///< 4:2:2 as from the Bebop: U Y0 V Y1 for each pair of stored columns.
  kRgb,     ///< 3 bytes a pixel.
  kYuv444,  ///< Y, Cb, Cr, 3 bytes a pixel: what a JPEG decodes to.
};

/// Bytes of one stored picture; 0 when a size is not positive.
[[nodiscard]] std::size_t image_bytes(PixelFormat format, int stored_width, int stored_height);

/// JFIF conversion, rounded to nearest.
[[nodiscard]] Yuv yuv_of_rgb(std::uint8_t r, std::uint8_t g, std::uint8_t b);

/// A picture somebody else owns, always addressed upright: u right, v down, origin top-left.
///
/// Cameras are mounted turned (the Bebop's sensor by 90°); the view turns coordinates, not pixels.
class Image {
 public:
  Image() = default;

  /// @param stored_rotation_deg  0, 90, 180 or 270: how far the stored picture has to be turned
  ///                             counter-clockwise to be upright (Bebop: 90). Others act as 0.
  /// Without bytes, with a size that is not positive, or UYVY of odd width, the view is empty.
  Image(const std::uint8_t* bytes, PixelFormat format, int stored_width, int stored_height,
        int stored_rotation_deg = 0);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] bool empty() const { return width_ == 0; }
  /// As they are stored; none where the view is empty.
  [[nodiscard]] std::span<const std::uint8_t> bytes() const {
    return {bytes_, image_bytes(format_, width_, height_)};
  }
  [[nodiscard]] bool contains(int u, int v) const {
    return static_cast<unsigned>(u) < static_cast<unsigned>(width_) &&
           static_cast<unsigned>(v) < static_cast<unsigned>(height_);
  }

  /// Colour at an upright pixel; (u, v) must be inside.
  [[nodiscard]] Yuv at(int u, int v) const {
    const std::ptrdiff_t i = first_ + along_u_ * u + along_v_ * v;
    switch (format_) {
      case PixelFormat::kUyvy:
        return uyvy(bytes_, i);
      case PixelFormat::kRgb: {
        const std::uint8_t* p = bytes_ + 3 * i;
        return yuv_of_rgb(p[0], p[1], p[2]);
      }
      case PixelFormat::kYuv444:
        break;
    }
    const std::uint8_t* p = bytes_ + 3 * i;
    return {p[0], p[1], p[2]};
  }

  /// The same, packed.
  [[nodiscard]] PackedYuv packed_at(int u, int v) const {
    if (format_ != PixelFormat::kUyvy) return PackedYuv::of(at(u, v));
    const std::ptrdiff_t i = first_ + along_u_ * u + along_v_ * v;
    return packed_uyvy(bytes_ + ((2 * i) & ~std::ptrdiff_t{3}), bytes_[2 * i + 1]);
  }

  /// Calls visit(Yuv) for every `step`-th pixel of upright row v from column u on, `count` of them;
  /// all must be inside.
  template <class Visit>
  void visit_row(int u, int v, int step, int count, Visit visit) const {
    this->visit(u, v, along_u_ * step, count, visit);
  }
  /// The same down column u, from row v on.
  template <class Visit>
  void visit_column(int u, int v, int step, int count, Visit visit) const {
    this->visit(u, v, along_v_ * step, count, visit);
  }
  /// Row v, so many pixels at once: visit(std::array<PackedYuv, kAtOnce>), `count` times.
  template <std::size_t kAtOnce, class Visit>
  void visit_row_packed(int u, int v, int step, int count, Visit visit) const {
    std::ptrdiff_t i = first_ + along_u_ * u + along_v_ * v;
    const std::ptrdiff_t next = along_u_ * step;
    const std::uint8_t* const bytes = bytes_;
    std::array<PackedYuv, kAtOnce> colors;
    if (format_ == PixelFormat::kUyvy && next % 2 == 0) {
      // All are the first of their pair, or all the second.
      const std::uint8_t* pair = bytes + ((2 * i) & ~std::ptrdiff_t{3});
      const std::ptrdiff_t luma = 1 + 2 * (i & 1);
      for (int k = 0; k < count; ++k) {
        for (PackedYuv& c : colors) {
          c = packed_uyvy(pair, pair[luma]);
          pair += 2 * next;
        }
        visit(colors);
      }
      return;
    }
    for (int k = 0; k < count; ++k, u += step * static_cast<int>(kAtOnce)) {
      for (std::size_t j = 0; j < kAtOnce; ++j)
        colors[j] = PackedYuv::of(at(u + static_cast<int>(j) * step, v));
      visit(colors);
    }
  }

 private:
  // In U Y0 V Y1 only Y is a pixel's own; two pixels share U and V.
  [[nodiscard]] static Yuv uyvy(const std::uint8_t* bytes, std::ptrdiff_t i) {
    const std::uint8_t* const pair = bytes + ((2 * i) & ~std::ptrdiff_t{3});
    return {bytes[2 * i + 1], pair[0], pair[2]};
  }

  [[nodiscard]] static PackedYuv packed_uyvy(const std::uint8_t* pair, std::uint8_t luma) {
    static_assert(std::endian::native == std::endian::little, "U is the word's lowest byte");
    std::uint32_t word = 0;
    std::memcpy(&word, pair, sizeof word);
    return {word & 0x00ff00ff, luma};
  }

  template <class Visit>
  void visit(int u, int v, std::ptrdiff_t next, int count, Visit& visit) const {
    std::ptrdiff_t i = first_ + along_u_ * u + along_v_ * v;
    // The layout is asked once a line; what `visit` writes could be members, were they not copied.
    const std::uint8_t* const bytes = bytes_;
    if (format_ == PixelFormat::kUyvy && next % 2 == 0) {
      // All are the first of their pair, or all the second.
      const std::uint8_t* pair = bytes + ((2 * i) & ~std::ptrdiff_t{3});
      const std::ptrdiff_t luma = 1 + 2 * (i & 1);
      for (int k = 0; k < count; ++k, pair += 2 * next) visit(Yuv{pair[luma], pair[0], pair[2]});
    } else if (format_ == PixelFormat::kUyvy) {
      for (int k = 0; k < count; ++k, i += next) visit(uyvy(bytes, i));
    } else if (format_ == PixelFormat::kRgb) {
      for (int k = 0; k < count; ++k, i += next)
        visit(yuv_of_rgb(bytes[3 * i], bytes[3 * i + 1], bytes[3 * i + 2]));
    } else {
      for (int k = 0; k < count; ++k, i += next)
        visit(Yuv{bytes[3 * i], bytes[3 * i + 1], bytes[3 * i + 2]});
    }
  }

  const std::uint8_t* bytes_ = nullptr;
  PixelFormat format_ = PixelFormat::kYuv444;
  int width_ = 0, height_ = 0;  // upright
  // Stored pixels are counted line by line (lines of pairs are even); upright (u, v) is the one at
  // first + along_u u + along_v v.
  std::ptrdiff_t first_ = 0, along_u_ = 1, along_v_ = 0;
};

}  // namespace gatefly
