// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gatefly/sensing/image.hpp"

namespace gatefly::files {

/// A picture, upright, as the bytes of a PNG in 8-bit RGB.
/// @throws std::runtime_error when libpng cannot.
[[nodiscard]] std::string png_of(const Image& image);

}  // namespace gatefly::files
