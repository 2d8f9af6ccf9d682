// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "gatefly/detection/color_model.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly {

/// Correction of a picture's chroma before a colour model is asked: a colour cast is removed, contrast
/// is increased.
struct ChromaTone {
  int neutral_u = 128, neutral_v = 128;
  int gain = 0;  ///< Fourths of an octave, 0..10.

  friend bool operator==(const ChromaTone&, const ChromaTone&) = default;
};

/// How a picture differs from those the tables were made for: dark, pale, blurred or coarsely
/// recorded ones show less colour contrast over the width of a bar, and less of everything else;
/// under another light all colours are shifted. [ours; scales chosen on the authors' labelled
/// pictures, docs/paper/results.md#other-pictures]
///
/// Contrast: along the model's hue, between pixels a bar's width or two apart, what a tenth of all
/// pairs exceed. Light: the medians of both chromas; small casts, which a room's own colours make,
/// are left. For an empty picture it is the default tone.
[[nodiscard]] ChromaTone tone_of(const Image& image, const ColorModel& model);

/// A colour model as one picture shows it: the same tables, asked by that picture's own tone.
class PictureColor {
 public:
  PictureColor();  ///< No colour speaks for the gate.
  /// As the model is, whatever the picture. Not explicit: searches can be asked with a model.
  PictureColor(const ColorModel& model);  // NOLINT(google-explicit-constructor)

  /// The model must stay. A tone like the last one's costs nothing.
  void set(const ColorModel& model, const ChromaTone& tone);

  [[nodiscard]] const ChromaTone& tone() const { return tone_; }

  /// Score that a frame loses in such a picture [nats]: faint colours make bars stand out less, and
  /// also everything that is mistaken for a bar.
  [[nodiscard]] double faintness() const { return faintness_; }

  /// Bin of a colour and of a difference in the model's tables.
  [[nodiscard]] std::size_t bin(Yuv c) const {
    return std::size_t{starts_.luma[c.y]} + starts_.u[c.u] + starts_.v[c.v];
  }
  [[nodiscard]] std::size_t difference_bin(Yuv c, Yuv around) const {
    const auto at = [](const auto& steps, std::ptrdiff_t a, std::ptrdiff_t b) {
      return std::size_t{(steps.data() + 255)[a - b]};
    };
    return at(starts_.luma_step, c.y, around.y) + at(starts_.u_step, c.u, around.u) +
           at(starts_.v_step, c.v, around.v);
  }

  /// Evidence of a colour alone, and of its difference from what is around, in 1 / kUnit nats.
  [[nodiscard]] int absolute(Yuv c) const { return model_->absolute[bin(c)]; }
  [[nodiscard]] int relative(Yuv c, Yuv around) const {
    return model_->relative[difference_bin(c, around)];
  }
  /// Mean of both.
  [[nodiscard]] int evidence(Yuv c, Yuv around) const {
    return (absolute(c) + relative(c, around)) / 2;
  }
  /// Whether a chroma is no bar's with any luma.
  [[nodiscard]] bool is_hopeless(PackedYuv c) const {
    return model_->hopeless[std::size_t{hopeless_u_[c.uv & 255]} | hopeless_v_[c.uv >> 16]] != 0;
  }

 private:
  void make_tables();

  const ColorModel* model_;
  ChromaTone tone_;
  double faintness_ = 0.0;
  ColorModel::Starts starts_ = ColorModel::kStarts;
  // where each chroma leads to in ColorModel::hopeless
  std::array<std::uint16_t, 256> hopeless_u_, hopeless_v_;
};

}  // namespace gatefly
