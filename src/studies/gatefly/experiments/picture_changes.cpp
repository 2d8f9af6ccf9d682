// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/picture_changes.hpp"

#include <array>

#include "gatefly/experiments/color_changes.hpp"
#include "gatefly/experiments/shape_changes.hpp"

namespace gatefly::experiments {
namespace {

using Picture = UprightPicture;
using Changed = std::optional<UprightPicture>;

constexpr double kBarWidth = 0.05 / 0.95;  // of a side of the bars' middle lines [Li18's gates]
constexpr double kBand = 2.0 / 3.0;        // of a side

template <int kQuality, files::ChromaSampling kSampling>
Changed jpeg(const Picture& p) {
  return through_jpeg(p, kQuality, kSampling);
}

template <Bar kBar>
Changed band(const Picture& p) {
  return with_band(p, kBar, kBand, kBarWidth);
}

Changed nothing(const Picture& p) { return p; }

using files::ChromaSampling::k420;
using files::ChromaSampling::k444;

constexpr std::array kChanges{
    PictureChange{"nothing", "nothing", nothing},
    PictureChange{"jpeg50-420", "JPEG quality 50, 4:2:0", jpeg<50, k420>},
    PictureChange{"jpeg50-444", "JPEG quality 50, 4:4:4", jpeg<50, k444>},
    PictureChange{"jpeg20-420", "JPEG quality 20, 4:2:0", jpeg<20, k420>},
    PictureChange{"jpeg20-444", "JPEG quality 20, 4:4:4", jpeg<20, k444>},
    PictureChange{"chroma-blur-2", "chroma blurred, sigma 2 px",
                  [](const Picture& p) -> Changed { return blurred(p, 2.0, Blurred::kChroma); }},
    PictureChange{"luma-blur-2", "luma blurred, sigma 2 px",
                  [](const Picture& p) -> Changed { return blurred(p, 2.0, Blurred::kLuma); }},
    PictureChange{"blur-2", "blur, sigma 2 px",
                  [](const Picture& p) -> Changed { return blurred(p, 2.0); }},
    PictureChange{"blur-3", "blur, sigma 3 px",
                  [](const Picture& p) -> Changed { return blurred(p, 3.0); }},
    PictureChange{"size-0.5", "size x0.5",
                  [](const Picture& p) -> Changed { return resized(p, 0.5); }},
    PictureChange{"size-2", "size x2", [](const Picture& p) -> Changed { return resized(p, 2.0); }},
    PictureChange{"size-4", "size x4", [](const Picture& p) -> Changed { return resized(p, 4.0); }},
    PictureChange{"bright-0.5", "brightness x0.5",
                  [](const Picture& p) -> Changed {
                    return gained(p, {0.5, 0.5, 0.5});
                  }},
    PictureChange{"bright-0.25", "brightness x0.25",
                  [](const Picture& p) -> Changed {
                    return gained(p, {0.25, 0.25, 0.25});
                  }},
    PictureChange{"gamma-0.5", "gamma 0.5 (brighter)",
                  [](const Picture& p) -> Changed { return with_gamma(p, 0.5); }},
    PictureChange{"gamma-2", "gamma 2 (darker)",
                  [](const Picture& p) -> Changed { return with_gamma(p, 2.0); }},
    PictureChange{"saturation-0.6", "saturation x0.6",
                  [](const Picture& p) -> Changed { return saturated(p, 0.6); }},
    PictureChange{"saturation-0.3", "saturation x0.3",
                  [](const Picture& p) -> Changed { return saturated(p, 0.3); }},
    PictureChange{"white-bluer", "white balance: red x0.8, blue x1.3",
                  [](const Picture& p) -> Changed {
                    return gained(p, {0.8, 1.0, 1.3});
                  }},
    PictureChange{"white-redder", "white balance: red x1.2, blue x0.8",
                  [](const Picture& p) -> Changed {
                    return gained(p, {1.2, 1.0, 0.8});
                  }},
    PictureChange{"hue+20", "hue +20 degrees",
                  [](const Picture& p) -> Changed { return with_hue_turned(p, 20.0); }},
    PictureChange{"hue-20", "hue -20 degrees",
                  [](const Picture& p) -> Changed { return with_hue_turned(p, -20.0); }},
    PictureChange{"motion-9", "motion blur 9 px across",
                  [](const Picture& p) -> Changed { return moved_across(p, 9); }},
    PictureChange{"motion-15", "motion blur 15 px across",
                  [](const Picture& p) -> Changed { return moved_across(p, 15); }},
    PictureChange{"motion-9-down", "motion blur 9 px down",
                  [](const Picture& p) -> Changed { return moved_down(p, 9); }},
    PictureChange{"noise-8", "noise, sigma 8",
                  [](const Picture& p) -> Changed { return noisy(p, 8.0); }},
    PictureChange{"turned-15", "turned by 15 degrees",
                  [](const Picture& p) -> Changed { return rotated(p, 15.0); }},
    PictureChange{"turned-30", "turned by 30 degrees",
                  [](const Picture& p) -> Changed { return rotated(p, 30.0); }},
    PictureChange{"flipped", "left and right exchanged",
                  [](const Picture& p) -> Changed { return flipped(p); }},
    PictureChange{"band-top", "a dark band over the top bar", band<Bar::kTop>},
    PictureChange{"band-right", "a dark band over the right bar", band<Bar::kRight>},
    PictureChange{"band-bottom", "a dark band over the bottom bar", band<Bar::kBottom>},
    PictureChange{"band-left", "a dark band over the left bar", band<Bar::kLeft>},
    PictureChange{"nothing-every", "nothing, every gate looked for", nothing, true},
    PictureChange{"second-gate", "a second gate, x0.7, beside it",
                  [](const Picture& p) { return with_second_gate(p, 0.7); }, true}};

}  // namespace

std::span<const PictureChange> picture_changes() { return kChanges; }

}  // namespace gatefly::experiments
