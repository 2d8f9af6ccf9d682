// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/hall_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "gatefly/drawing/annotate.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::experiments {
namespace {

constexpr int kWidth = 400, kHeight = 300, kCaption = 28, kGap = 8, kTop = 60, kColumns = 5;
constexpr std::size_t kOfASeed = 4;

drawing::Canvas tile_of(const HallPicture& picture, const HallGate& gate) {
  const Image image = picture.view();
  // Three times the gate's side, four times at most enlarged, all of the picture at least.
  const double side = std::sqrt(files::polygon_area(gate.corners_px));
  const double scale = std::clamp(kHeight / (3.0 * side), kHeight / 480.0, 4.0);
  const Eigen::Vector2d at =
      Eigen::Vector2d{0.5 * kWidth, 0.5 * kHeight} - scale * center(gate.corners_px);
  drawing::Canvas canvas(kWidth, kHeight + kCaption);
  canvas.clip({0.0, 0.0, kWidth, kHeight});
  canvas.image(image, at, scale);
  drawing::draw_detection(
      canvas, {.corners_px = gate.corners_px}, at, scale,
      {.color = gate.is_false() ? drawing::kDark.estimate : drawing::kDark.flown, .width = 1.0});
  canvas.unclip();
  canvas.text({4.0, kHeight + 19.0},
              picture.name + ", " + fixed(side, 0) +
                  " px: " + (gate.is_false() ? "score " + fixed(gate.score, 2) : gate.cause),
              {.size = 15.0});
  return canvas;
}

}  // namespace

HallSheet::Tiles HallSheet::tiles_of(const HallSeed& hall, const std::vector<HallGate>& gates,
                                     bool wrong) {
  Tiles tiles;
  for (const HallGate& gate : gates)
    if (gate.is_false() == wrong && !gate.hit && tiles.size() < kOfASeed)
      tiles.push_back(tile_of(hall.pictures[gate.picture], gate));
  return tiles;
}

void HallSheet::add(Tiles& tiles) {
  std::move(tiles.begin(), tiles.end(), std::back_inserter(tiles_));
  tiles.clear();
}

drawing::Canvas HallSheet::drawn() const {
  const int rows = std::max(1, (static_cast<int>(tiles_.size()) + kColumns - 1) / kColumns);
  constexpr int kWide = kWidth + kGap, kHigh = kHeight + kCaption + kGap;
  drawing::Canvas canvas(kGap + kColumns * kWide, kTop + rows * kHigh);
  canvas.text({kGap, 38.0}, tiles_.empty() ? title_ + ": none" : title_,
              {.size = 26.0, .bold = true});
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    const int column = static_cast<int>(i) % kColumns, row = static_cast<int>(i) / kColumns;
    canvas.paste(tiles_[i], {static_cast<double>(kGap + column * kWide),
                             static_cast<double>(kTop + row * kHigh)});
  }
  return canvas;
}

}  // namespace gatefly::experiments
