// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/labels_file.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "gatefly/files/csv.hpp"
#include "gatefly/files/detections_file.hpp"
#include "gatefly/files/scoring.hpp"

namespace gatefly::files {
namespace {

/// A column of 0 and 1; `otherwise` in every row when there is no such column.
std::vector<bool> flags(const Csv& csv, const std::string& column, bool otherwise) {
  std::vector<bool> values(csv.rows(), otherwise);
  if (!csv.has(column)) return values;
  const auto texts = csv.texts(column);
  for (std::size_t row = 0; row < texts.size(); ++row) {
    if (texts[row] != "0" && texts[row] != "1")
      throw std::runtime_error(csv.place(row, column) + ": " + column + " = '" + texts[row] +
                               "', must be 0 or 1");
    values[row] = texts[row] == "1";
  }
  return values;
}

bool is_empty(const Quad& quad) {
  return std::all_of(quad.begin(), quad.end(),
                     [](const auto& p) { return std::isnan(p.x()) && std::isnan(p.y()); });
}

}  // namespace

Labels read_labels(const std::filesystem::path& path) {
  const Csv csv(path);
  const auto images = csv.texts("image");
  const auto quads = read_corners(csv);
  const bool says_so = csv.has("has_gate");
  const auto has_gate = flags(csv, "has_gate", true);
  const auto degenerate = flags(csv, "degenerate_label", false);
  const auto distances =
      csv.has("true_distance_m") ? csv.numbers("true_distance_m") : std::vector<double>{};
  const auto identical = csv.has("first_identical_image") ? csv.texts("first_identical_image")
                                                          : std::vector<std::string>{};

  Labels labels;
  std::map<std::string, std::size_t> place_of;
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    if (images[row].empty())
      throw std::runtime_error(csv.place(row, "image") +
                               ": image = '', must be a picture's file name");
    if (degenerate[row]) {
      labels.degenerate.push_back(images[row]);
      continue;
    }
    const auto [found, added] = place_of.try_emplace(images[row], labels.pictures.size());
    if (added)
      labels.pictures.push_back({.image = images[row], .gates = {}, .first_identical = {}});
    LabelledPicture& picture = labels.pictures[found->second];
    if (!distances.empty()) picture.true_distance = distances[row];
    if (!identical.empty()) picture.first_identical = identical[row];
    if (!has_gate[row] || (!says_so && is_empty(quads[row]))) continue;
    expect_whole(quads[row], csv, row);
    if (polygon_area(quads[row]) <= 0.0)
      throw std::runtime_error(
          csv.place(row) + ": its corners enclose no area (degenerate_label = 1 leaves a row out)");
    picture.gates.push_back(quads[row]);
  }
  std::erase_if(labels.degenerate,
                [&](const std::string& image) { return place_of.contains(image); });
  return labels;
}

}  // namespace gatefly::files
