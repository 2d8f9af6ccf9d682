// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "gatefly/experiments/upright_picture.hpp"
#include "gatefly/files/jpeg_writer.hpp"

namespace gatefly::experiments {

// Changes that another camera, light or motion makes to an RGB picture. Gates stay where they are;
// what lies beyond the border is as on it; results are rounded to 8 bits.

/// Each colour times its factor: brightness, white balance.
[[nodiscard]] UprightPicture gained(const UprightPicture& picture,
                                    const std::array<double, 3>& rgb_factors);
/// Each colour to the power of gamma, of full scale: 2 darkens.
[[nodiscard]] UprightPicture with_gamma(const UprightPicture& picture, double gamma);
/// Chroma times a factor, luma kept.
[[nodiscard]] UprightPicture saturated(const UprightPicture& picture, double factor);
/// Chroma turned from Cb towards Cr, luma kept.
[[nodiscard]] UprightPicture with_hue_turned(const UprightPicture& picture, double degrees);

/// Channels of a picture that a blur blurs.
enum class Blurred { kAll, kLuma, kChroma };
/// Gaussian. @param sigma_px  above 0
[[nodiscard]] UprightPicture blurred(const UprightPicture& picture, double sigma_px,
                                     Blurred part = Blurred::kAll);
/// The mean of so many pixels (odd) side by side, or one above the other.
[[nodiscard]] UprightPicture moved_across(const UprightPicture& picture, int pixels);
[[nodiscard]] UprightPicture moved_down(const UprightPicture& picture, int pixels);

/// Normal noise, of its own in every pixel and colour; the same on each picture of a size.
[[nodiscard]] UprightPicture noisy(const UprightPicture& picture, double sigma);

/// Stored as a JPEG and read again, as the program's reader does: Y'CbCr.
[[nodiscard]] UprightPicture through_jpeg(const UprightPicture& picture, int quality,
                                          files::ChromaSampling sampling);

}  // namespace gatefly::experiments
