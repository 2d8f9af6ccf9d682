// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "gatefly/experiments/upright_picture.hpp"

namespace gatefly::experiments {

/// A named change of pictures.
struct PictureChange {
  const char *key, *words;
  /// @return nothing where a picture leaves no room for it.
  std::optional<UprightPicture> (*apply)(const UprightPicture& picture);
  bool every_gate = false;  ///< Every gate is looked for, not the best alone.
};

/// The first changes nothing. Same picture, same change of it.
[[nodiscard]] std::span<const PictureChange> picture_changes();

}  // namespace gatefly::experiments
