// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/twin_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "gatefly/drawing/annotate.hpp"
#include "gatefly/files/scoring.hpp"

namespace gatefly::experiments {
namespace {

constexpr int kRows = 8, kPairs = 2, kGap = 8, kTop = 60, kScale = 2;

/// Pictures with a gate, the largest first.
std::vector<const TwinPicture*> by_size(std::span<const TwinPicture> pictures) {
  std::vector<const TwinPicture*> list;
  for (const TwinPicture& picture : pictures)
    if (picture.gate) list.push_back(&picture);
  std::stable_sort(list.begin(), list.end(), [](const TwinPicture* a, const TwinPicture* b) {
    return files::polygon_area(*a->gate) > files::polygon_area(*b->gate);
  });
  return list;
}

const TwinPicture* of_size(std::span<const TwinPicture* const> list, double area) {
  return *std::min_element(list.begin(), list.end(), [&](const auto* a, const auto* b) {
    return std::abs(std::log(files::polygon_area(*a->gate) / area)) <
           std::abs(std::log(files::polygon_area(*b->gate) / area));
  });
}

void place(drawing::Canvas& canvas, const TwinPicture& picture, const Eigen::Vector2d& at) {
  const Image image = picture.view();
  canvas.clip({at.x(), at.y(), static_cast<double>(kScale * image.width()),
               static_cast<double>(kScale * image.height())});
  canvas.image(image, at, kScale);
  canvas.text(at + Eigen::Vector2d{6.0, 20.0}, picture.name,
              {.color = drawing::kDark.ink, .size = 15.0});
  canvas.unclip();
}

}  // namespace

drawing::Canvas twin_sheet(std::span<const TwinPicture> real,
                           std::span<const TwinPicture> rendered) {
  const auto reals = by_size(real), others = by_size(rendered);
  if (reals.empty() || others.empty()) return {1, 1};
  const int width = kScale * reals.front()->view().width() + kGap,
            height = kScale * reals.front()->view().height() + kGap;
  drawing::Canvas canvas(2 * kPairs * width + kGap, kTop + kRows * height);
  for (int pair = 0; pair < kPairs; ++pair) {
    const double x = kGap + 2.0 * pair * width;
    canvas.text({x, 40.0}, "real", {.size = 28.0, .bold = true});
    canvas.text({x + width, 40.0}, "rendered, as large", {.size = 28.0, .bold = true});
    for (int row = 0; row < kRows; ++row) {
      const std::size_t rank =
          static_cast<std::size_t>(row * kPairs + pair) * (reals.size() - 1) / (kRows * kPairs - 1);
      const double y = kTop + static_cast<double>(row) * height;
      place(canvas, *reals[rank], {x, y});
      place(canvas, *of_size(others, files::polygon_area(*reals[rank]->gate)), {x + width, y});
    }
  }
  return canvas;
}

}  // namespace gatefly::experiments
