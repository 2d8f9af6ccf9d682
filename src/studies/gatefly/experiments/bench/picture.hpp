// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gatefly/sensing/image.hpp"

namespace gatefly::bench {

/// A picture as the camera delivers it: UYVY, turned.
struct Picture {
  std::string name;
  std::vector<std::uint8_t> uyvy;
  int stored_width = 0, stored_height = 0, rotation_deg = 90;

  [[nodiscard]] Image view() const {
    return {uyvy.data(), PixelFormat::kUyvy, stored_width, stored_height, rotation_deg};
  }
};

/// The same picture in UYVY; an odd last column of the stored one is left out.
[[nodiscard]] Picture as_uyvy(const std::string& name, const Image& stored, int rotation_deg);

/// A drawing that gives a detector work: "checker:8" and the like, numbers after the kind.
struct Pattern {
  std::string kind;
  std::array<double, 3> numbers{};

  [[nodiscard]] std::string name() const;
};

/// Kinds of patterns with the range of their numbers.
struct PatternKind {
  std::string kind, what;
  std::array<double, 3> least, most;
};
[[nodiscard]] std::span<const PatternKind> pattern_kinds();

/// "checker:8:0.5:0", missing numbers in the middle of their range.
/// @throws std::runtime_error one line: no such kind or number.
[[nodiscard]] Pattern pattern_of(const std::string& text);

/// The pattern in orange on a grey wall, upright `width` x `height` (even); lengths in it grow with
/// the width.
[[nodiscard]] Picture drawn(const Pattern& pattern, int width = 315, int height = 160);

}  // namespace gatefly::bench
