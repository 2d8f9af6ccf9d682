// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gatefly::drawing {

/// Each part 0..1; a: 1 hides what is below, 0 is not there.
struct Color {
  double r = 0.0, g = 0.0, b = 0.0, a = 1.0;

  [[nodiscard]] constexpr Color faded(double alpha) const { return {r, g, b, a * alpha}; }
  bool operator==(const Color&) const = default;
};

/// From 0xRRGGBB.
[[nodiscard]] constexpr Color color_of(unsigned rgb) {
  return {((rgb >> 16) & 255) / 255.0, ((rgb >> 8) & 255) / 255.0, (rgb & 255) / 255.0};
}

/// "#rrggbb", without what `a` says.
[[nodiscard]] std::string css_of(const Color& color);

/// The one look of plots, films, pages: every colour by what it stands for. The names and values are
/// those of viewer/src/style.css (a test compares them).
struct Palette {
  Color page, panel, well;  ///< Surfaces: around panels, panels, hollows in them.
  Color ink, muted;         ///< Text that is read first, and then.
  Color rule, grid, solid;  ///< Borders, lines of a grid, solid things.
  Color gate, gate_solid;   ///< A gate in letters and thin lines, and in areas and curves.
  Color flown, slow, fast;  ///< The true way; coloured by speed: slow, flown, fast.
  Color estimate, found;    ///< The pilot's belief, the detector's finds.
  Color plan;               ///< The way as planned.
  Color good, bad, warn, focus;
};

/// Plots, README's diagrams, pages by day.
inline constexpr Palette kLight{.page = color_of(0xf4f6f8),
                                .panel = color_of(0xffffff),
                                .well = color_of(0xeef1f4),
                                .ink = color_of(0x17202b),
                                .muted = color_of(0x525d6b),
                                .rule = color_of(0xd5dbe1),
                                .grid = color_of(0xe6eaee),
                                .solid = color_of(0x9aa7b5),
                                .gate = color_of(0xb45309),
                                .gate_solid = color_of(0xf28a1d),
                                .flown = color_of(0x15803d),
                                .slow = color_of(0x0f5132),
                                .fast = color_of(0x8a7a00),
                                .estimate = color_of(0xbe1e79),
                                .found = color_of(0x0e7490),
                                .plan = color_of(0x64748b),
                                .good = color_of(0x15803d),
                                .bad = color_of(0xb91c1c),
                                .warn = color_of(0x8a5200),
                                .focus = color_of(0x0b5fce)};

/// Films, what is drawn over pictures, pages by night.
inline constexpr Palette kDark{.page = color_of(0x10141a),
                               .panel = color_of(0x171d26),
                               .well = color_of(0x0c1015),
                               .ink = color_of(0xe6edf3),
                               .muted = color_of(0x9aa7b5),
                               .rule = color_of(0x2b3542),
                               .grid = color_of(0x222b36),
                               .solid = color_of(0x46566a),
                               .gate = color_of(0xff8c1a),
                               .gate_solid = color_of(0xff8c1a),
                               .flown = color_of(0x7ee787),
                               .slow = color_of(0x1f6f5c),
                               .fast = color_of(0xfff27a),
                               .estimate = color_of(0xf472b6),
                               .found = color_of(0x22d3ee),
                               .plan = color_of(0x8293a8),
                               .good = color_of(0x7ee787),
                               .bad = color_of(0xff8080),
                               .warn = color_of(0xffc46b),
                               .focus = color_of(0x7cc4ff)};

/// The style sheet's variables: "--page:#f4f6f8;--panel:...".
[[nodiscard]] std::string css_of(const Palette& palette);

}  // namespace gatefly::drawing
