// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <pybind11/pybind11.h>

#include "gatefly/config/config.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::python {

/// gatefly.Image: a picture whose bytes belong to a Python object, which it keeps.
struct Picture {
  pybind11::object owner;
  const std::uint8_t* bytes = nullptr;
  PixelFormat format = PixelFormat::kRgb;
  int stored_width = 0, stored_height = 0, rotation_deg = 0;

  [[nodiscard]] Image view() const {
    return {bytes, format, stored_width, stored_height, rotation_deg};
  }
};

/// A gatefly.Image, or an upright RGB array: looked at in place when it is contiguous, else copied.
/// @throws TypeError, gatefly.Error: anything else.
[[nodiscard]] Picture picture_of(const pybind11::object& image);

/// The bytes of another, copied.
[[nodiscard]] Picture copied_picture(const void* bytes, PixelFormat format, int stored_width,
                                     int stored_height, int rotation_deg);

/// A file's picture, turned as `gatefly detect` with this configuration turns it.
[[nodiscard]] Picture read_picture(const pybind11::object& path, const config::Config& config);

}  // namespace gatefly::python
