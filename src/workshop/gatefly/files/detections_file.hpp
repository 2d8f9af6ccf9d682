// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "gatefly/detection/gate_detection.hpp"
#include "gatefly/detection/quad.hpp"
#include "gatefly/files/csv.hpp"

namespace gatefly::files {

/// One row of detections.csv: a gate found in a picture.
struct DetectionRow {
  std::string image;  ///< The file's name; "f7.avi#12" in a video.
  int gate = 0;       ///< Rank in its picture, 0 is the best.
  Quad corners_px{};  ///< As listed; upright picture, pixel centres at integers.
  double fitness = 0.0;
  std::string method = "snake";  ///< "bars": only the u of two bars counts.
  /// 0: the corner is not in the picture.
  std::array<double, 4> corner_fitness{1.0, 1.0, 1.0, 1.0};
};

[[nodiscard]] DetectionRow row_of(const std::string& image, int rank, const GateDetection& gate);

/// The columns of detections.csv, and one row of it; each ends its line. Corners keep 7 digits.
[[nodiscard]] std::string detections_header();
[[nodiscard]] std::string line_of(const DetectionRow& row);

/// The whole of detections.csv.
[[nodiscard]] std::string detections_csv(std::span<const DetectionRow> rows);

/// Reads what detections_csv() or another program wrote: image and corners; gate, fitness, method
/// when there, not the corners' own fitness.
/// @throws std::runtime_error "file:line:column: ..." with the value and what is allowed.
[[nodiscard]] std::vector<DetectionRow> read_detections(const std::filesystem::path& path);

/// The four corners of every row from columns tl_u, tl_v, tr_u, ... bl_v; NaN where a cell is
/// empty.
[[nodiscard]] std::vector<Quad> read_corners(const Csv& csv);

/// Whether all eight numbers are there.
[[nodiscard]] bool is_whole(const Quad& quad);

/// @throws std::runtime_error "file:line:column: tr_v = '', must be a number" for the first cell
///     that is empty.
void expect_whole(const Quad& quad, const Csv& csv, std::size_t row);

}  // namespace gatefly::files
