// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "gatefly/detection/quad.hpp"

namespace gatefly::files {

/// A row of labels.csv: one picture.
struct LabelledPicture {
  std::string image;
  std::vector<Quad> gates;  ///< As listed, any corner order; none: a picture without a gate.
  /// Distance to the gate [m], where the file has it.
  double true_distance = std::numeric_limits<double>::quiet_NaN();
  /// The first picture with the same pixels, itself or another; "" when not said.
  std::string first_identical;
};

struct Labels {
  std::vector<LabelledPicture> pictures;  ///< In the file's order, each once.
  /// Pictures left out because all their rows have degenerate_label = 1.
  std::vector<std::string> degenerate;
};

/// Reads `image,tl_u,...,bl_v`, several rows per picture; a row with has_gate = 0 or without any
/// corner says that the picture shows none. Also understood: true_distance_m,
/// first_identical_image, degenerate_label.
///
/// @throws std::runtime_error "file:line:column: ..." with the value and what is allowed.
[[nodiscard]] Labels read_labels(const std::filesystem::path& path);

}  // namespace gatefly::files
