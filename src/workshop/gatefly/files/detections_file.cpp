// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/detections_file.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "gatefly/files/text.hpp"

namespace gatefly::files {
namespace {

constexpr std::array<const char*, 8> kCorners{"tl_u", "tl_v", "tr_u", "tr_v",
                                              "br_u", "br_v", "bl_u", "bl_v"};

double coordinate(const Quad& quad, std::size_t k) {
  return quad[k / 2][static_cast<Eigen::Index>(k % 2)];
}

std::string name_of(DetectionMethod method) {
  return method == DetectionMethod::kFrames ? "frames"
         : method == DetectionMethod::kBars ? "bars"
                                            : "snake";
}

}  // namespace

DetectionRow row_of(const std::string& image, int rank, const GateDetection& gate) {
  return {.image = image,
          .gate = rank,
          .corners_px = gate.corners_px,
          .fitness = gate.fitness,
          .method = name_of(gate.method),
          .corner_fitness = gate.corner_fitness};
}

std::string detections_header() {
  std::string line = "image,gate";
  for (const char* name : kCorners) line += std::string{","} + name;
  return line + ",fitness,method,tl_fitness,tr_fitness,br_fitness,bl_fitness\n";
}

std::string line_of(const DetectionRow& row) {
  std::string line = row.image + ',' + std::to_string(row.gate);
  for (std::size_t k = 0; k < kCorners.size(); ++k)
    line += ',' + text_of(coordinate(row.corners_px, k), 7);
  line += ',' + text_of(row.fitness, 4) + ',' + row.method;
  for (const double fitness : row.corner_fitness) line += ',' + text_of(fitness, 3);
  return line + '\n';
}

std::string detections_csv(std::span<const DetectionRow> rows) {
  std::string csv = detections_header();
  for (const DetectionRow& row : rows) csv += line_of(row);
  return csv;
}

std::vector<Quad> read_corners(const Csv& csv) {
  std::vector<Quad> quads(csv.rows());
  for (std::size_t k = 0; k < kCorners.size(); ++k) {
    const std::vector<double> values = csv.numbers(kCorners[k]);
    for (std::size_t row = 0; row < quads.size(); ++row)
      quads[row][k / 2][static_cast<Eigen::Index>(k % 2)] = values[row];
  }
  return quads;
}

bool is_whole(const Quad& quad) {
  for (const auto& corner : quad)
    if (!corner.allFinite()) return false;
  return true;
}

void expect_whole(const Quad& quad, const Csv& csv, std::size_t row) {
  for (std::size_t k = 0; k < kCorners.size(); ++k)
    if (std::isnan(coordinate(quad, k)))
      throw std::runtime_error(csv.place(row, kCorners[k]) + ": " + kCorners[k] +
                               " = '', must be a number");
}

std::vector<DetectionRow> read_detections(const std::filesystem::path& path) {
  const Csv csv(path);
  const auto images = csv.texts("image");
  const auto quads = read_corners(csv);
  std::vector<DetectionRow> rows(csv.rows());
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i] = {.image = images[i], .corners_px = quads[i]};

  if (csv.has("method")) {
    const auto methods = csv.texts("method");
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].method = methods[i];
  }
  if (csv.has("gate")) {
    const auto ranks = csv.numbers("gate");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (!(ranks[i] >= 0 && ranks[i] < 1e6 && ranks[i] == std::floor(ranks[i])))
        throw std::runtime_error(csv.place(i, "gate") + ": gate = '" + csv.texts("gate")[i] +
                                 "', must be a whole number, 0 or more");
      rows[i].gate = static_cast<int>(ranks[i]);
    }
  }
  if (csv.has("fitness")) {
    const auto fitness = csv.numbers("fitness");
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].fitness = fitness[i];
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].image.empty())
      throw std::runtime_error(csv.place(i, "image") +
                               ": image = '', must be a picture's file name");
    if (rows[i].method != "bars") expect_whole(rows[i].corners_px, csv, i);
  }
  return rows;
}

}  // namespace gatefly::files
