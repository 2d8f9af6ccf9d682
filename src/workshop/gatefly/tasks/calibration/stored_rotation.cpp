// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/stored_rotation.hpp"

#include <algorithm>
#include <map>
#include <memory>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/labels_file.hpp"

namespace gatefly::calibration {
namespace {

constexpr double kSamePx = 10.0;       // as far from its label a gate is still the labelled one
constexpr std::size_t kPictures = 20;  // that are looked at
constexpr int kLeastHits = 3;

/// The turn that finds gates, where no other finds half as many.
std::optional<int> standing_out(const std::map<int, int>& hits) {
  for (const auto& [turn, count] : hits)
    if (count >= kLeastHits && std::none_of(hits.begin(), hits.end(), [&](const auto& other) {
          return other.first != turn && 2 * other.second > count;
        }))
      return turn;
  return std::nullopt;
}

}  // namespace

std::optional<int> stored_rotation_of(const std::filesystem::path& flight,
                                      const Eigen::Vector2i& upright_px,
                                      const GateDetectorParams& params, const ColorModel& color) {
  const files::Labels labels = files::read_labels(flight / "labels.csv");
  const auto detector = std::make_unique<GateDetector>(params);
  std::map<int, int> hits;
  std::size_t pictures = 0;
  for (const files::LabelledPicture& picture : labels.pictures) {
    if (picture.gates.size() != 1 || !std::filesystem::exists(flight / picture.image) ||
        ++pictures > kPictures)
      continue;
    const files::ImageFile file = files::read_image(flight / picture.image);
    for (const int turn : {0, 90, 180, 270}) {
      const Image image = file.view(turn);
      if (Eigen::Vector2i{image.width(), image.height()} != upright_px) continue;
      const auto found = detector->look(image, color).gates;
      if (!found.empty() &&
          (center(found[0].corners_px) - center(picture.gates[0])).norm() < kSamePx)
        ++hits[turn];
    }
  }
  return standing_out(hits);
}

std::string stored_rotation_doubt(const Boards& boards) {
  if (boards.size_px.y() > boards.size_px.x())
    return "pictures of " + std::to_string(boards.size_px.x()) + "x" +
           std::to_string(boards.size_px.y()) +
           " stand on end: if the sensor is mounted turned, calibrate again with --rotate 90 (or "
           "270)";
  if (boards.listed)
    return "a corner list does not tell how pictures are stored, stored_rotation_deg = 0 is a "
           "guess: --rotate 90 if these are corners of turned "
           "pictures; if of upright ones, but the camera stores them turned, set "
           "stored_rotation_deg";
  return "";
}

}  // namespace gatefly::calibration
