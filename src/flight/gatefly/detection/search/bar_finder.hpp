// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "gatefly/detection/picture_color.hpp"
#include "gatefly/detection/search/evidence_map.hpp"
#include "gatefly/geometry/divisor.hpp"
#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// An upright bar between two rows: a line, x = at_0 + slope y [px].
struct Bar {
  double at_0 = 0.0, slope = 0.0, top = 0.0, bottom = 0.0, strength = 0.0;
  double width = 0.0;  ///< Along the rows, mean [px].
  /// x = c₀ + c₁ y + c₂ y²: a lens bends long bars.
  Eigen::Vector3d curve = Eigen::Vector3d::Zero();

  [[nodiscard]] double x(double y) const { return at_0 + slope * y; }
  [[nodiscard]] Eigen::Vector2d at(double y) const { return {x(y), y}; }
  [[nodiscard]] double length() const { return bottom - top; }
  [[nodiscard]] Eigen::Vector2d on_curve(double y) const {
    return {curve[0] + y * (curve[1] + y * curve[2]), y};
  }
};

/// Finds bars: Li18's snakes (Algorithm 2), in strides, on colour evidence.
///
/// Every eighth row is read, every second pixel of it (at 315 x 160; larger pictures in larger
/// strides). A bar crosses several rows: a snake follows it from row to row, one may be missing.
/// [ours]
class BarFinder {
 public:
  /// Samples of a row whose mean is taken; rows are as many samples apart.
  static constexpr int kGroup = 4;
  static constexpr int kWholePicture = 0;  ///< Its mean colour is what is around every bar.
  using Bars = FixedList<Bar, 24>;

  /// @param widest  what is wider is no bar [samples].
  /// @param around  a colour's surroundings reach so many groups to each side, 1..3: wider than
  ///     the widest bar; or kWholePicture.
  BarFinder(int widest, int around)
      : widest_{widest}, reach_{std::clamp(around, kWholePicture, kMostReach)} {}

  /// The strongest bars; none in a picture that is too small. Allocates nothing.
  [[nodiscard]] const Bars& find(const Image& image, const PictureColor& color);
  /// Bars of the last find().
  [[nodiscard]] const Bars& bars() const { return bars_; }

  /// Evidence of the picture that was searched last, in 1/16 nats; outside there is none of a gate.
  class Evidence {
   public:
    /// @param cell  side of what is a place here: 1 for each pixel [px].
    Evidence(const BarFinder& finder, const Image& image, const PictureColor& color, int cell)
        : finder_{finder}, image_{image}, color_{color}, cell_{cell} {}

    /// Evidence of a cell, by the pixel in its middle.
    [[nodiscard]] int operator()(int x, int y) const {
      const int u = x * cell_ + cell_ / 2, v = y * cell_ + cell_ / 2;
      return image_.contains(u, v) ? at_pixel(u, v) : EvidenceMap::kOutside;
    }

    /// Visits `count` places from (x, y) on, (dx, dy) apart, in 1/65536 cells: visit(k, evidence).
    template <class Visit>
    void along(std::int64_t x, std::int64_t y, std::int64_t dx, std::int64_t dy, int count,
               const Visit& visit) const {
      x *= cell_, y *= cell_, dx *= cell_, dy *= cell_;
      const auto contains = [&](std::int64_t u, std::int64_t v) {
        return image_.contains(static_cast<int>(u >> 16), static_cast<int>(v >> 16));
      };
      // If both ends are inside, all is.
      const bool inside = contains(x, y) && contains(x + (count - 1) * dx, y + (count - 1) * dy);
      for (int k = 0; k < count; ++k, x += dx, y += dy)
        visit(k, inside || contains(x, y)
                     ? at_pixel(static_cast<int>(x >> 16), static_cast<int>(y >> 16))
                     : EvidenceMap::kOutside);
    }

    /// Visits `count` cells from (x, y) on, to the right or down: visit(evidence). What is around
    /// the middle one is taken for around all, a hopeless colour for 0.
    template <class Visit>
    void across(int x, int y, bool down, int count, const Visit& visit) const {
      const int u = x * cell_ + cell_ / 2, v = y * cell_ + cell_ / 2, last = (count - 1) * cell_;
      if (!image_.contains(u, v) || !image_.contains(down ? u : u + last, down ? v + last : v)) {
        for (int k = 0; k < count; ++k) visit(down ? (*this)(x, y + k) : (*this)(x + k, y));
        return;
      }
      const Yuv mean = finder_.around(group(down ? u : u + last / 2, down ? v + last / 2 : v));
      const auto take = [&](Yuv c) {
        const bool may_be_bar = color_.absolute(c) >= ColorModel::kHopeless;
        visit(may_be_bar ? std::min(color_.evidence(c, mean), EvidenceMap::kLimit) : 0);
      };
      if (down)
        image_.visit_column(u, v, cell_, count, take);
      else
        image_.visit_row(u, v, cell_, count, take);
    }

   private:
    [[nodiscard]] int at_pixel(int u, int v) const {
      return finder_.evidence_of(color_, image_.packed_at(u, v), group(u, v));
    }
    [[nodiscard]] std::size_t group(int u, int v) const {
      return static_cast<std::size_t>(finder_.groups_of_(v) * kMostGroups + finder_.groups_of_(u));
    }

    const BarFinder& finder_;
    const Image image_;
    const PictureColor& color_;
    int cell_;
  };
  /// @param color  must stay.
  [[nodiscard]] Evidence evidence(const Image& image, const PictureColor& color, int cell) const {
    return {*this, image, color, cell};
  }
  Evidence evidence(const Image& image, PictureColor&& color, int cell) const = delete;

  /// Whether the picture that was searched last is large enough for evidence.
  [[nodiscard]] bool has_evidence() const { return rows_ > 0 && groups_ > 0; }
  [[nodiscard]] int step() const { return step_; }      ///< Pixels from sample to sample.
  [[nodiscard]] int stride() const { return stride_; }  ///< Pixels from row to row.

 private:
  struct Snake;
  // evidence of a hopeless colour: with -2.5 nats a gap in a bar would count too much
  static constexpr int kNoBar = -24;
  static constexpr int kMostColumns = 160, kMostRows = 40, kMostGroups = kMostColumns / kGroup;
  static constexpr int kMostReach = 3;  // of what is around, to each side [groups]
  static constexpr int kBeyond = 8;     // groups beside a row
  static_assert(kMostGroups < 64, "a row's groups fit one number, a bit each");
  static_assert(kBeyond > kMostReach, "groups beside a row suffice for what is around its first");

  void read(const Image& image, const PictureColor& color);
  template <class T>
  using Sums = std::array<std::array<T, kBeyond + kMostGroups + kBeyond>, kMostRows>;
  template <class T>
  void average_around(const Sums<T>& sums, std::uint8_t* around) const;
  void average_everywhere();
  template <class Visit>
  void each_crossing(const Image& image, const PictureColor& color, int row, const Visit& visit);
  [[nodiscard]] Bar bar_of(const Snake& snake) const;

  // Evidence of a pixel. Skips the neighbourhood mean where the colour alone rules out a bar.
  [[nodiscard]] int evidence_of(const PictureColor& color, PackedYuv c, std::size_t group) const {
    if (color.is_hopeless(c)) return kNoBar;
    const Yuv pixel = c.unpacked();
    if (color.absolute(pixel) < ColorModel::kHopeless) return kNoBar;
    return std::clamp(color.evidence(pixel, around(group)), -EvidenceMap::kLimit,
                      EvidenceMap::kLimit);
  }
  [[nodiscard]] Yuv around(std::size_t group) const {
    return {around_y_[group], around_uv_[2 * group], around_uv_[2 * group + 1]};
  }
  [[nodiscard]] int first_column() const { return step_ / 2; }
  [[nodiscard]] int row_px(int row) const { return row * stride_ + stride_ / 2; }

  Bars bars_;  // of the picture that was searched last
  int widest_, reach_;
  int step_ = 1, stride_ = kGroup;
  Divisor groups_of_{kGroup};  // pixels to groups
  // read of the picture; four samples of a row make a group
  int rows_ = 0, groups_ = 0;
  // Sums of each group; beyond either side as at the border. Chromas as PackedYuv has them.
  Sums<std::uint16_t> sums_y_{};
  Sums<std::uint32_t> sums_uv_{};
  // Means of the groups around each; u and v in turns.
  std::array<std::uint8_t, kMostGroups * kMostRows> around_y_{};
  std::array<std::uint8_t, 2 * kMostGroups * kMostRows> around_uv_{};
  // evidence of a row's samples, of both tables together
  std::array<std::int16_t, kMostColumns> twice_{};
  // of each row, a bit for each group: whether it may hold a bar
  std::array<std::uint64_t, kMostRows> hopeful_{};
};

}  // namespace gatefly
