// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/robustness_pictures.hpp"

#include <algorithm>
#include <cmath>

namespace gatefly::experiments {
namespace {

using Eigen::Vector2d;

constexpr double kRow = 24.0, kNames = 280.0, kAxis = 860.0, kFirstRow = 92.0, kMargin = 24.0;

void draw_mark(drawing::Canvas& canvas, const Vector2d& at, const RowMarks& marks) {
  if (marks.bars)
    canvas.line(at - Vector2d{0.0, 0.4 * kRow}, at + Vector2d{0.0, 0.4 * kRow},
                {.color = marks.color, .width = 3.0});
  else
    canvas.disc(at, 5.0, marks.color.faded(0.85));
}

void draw_legend(drawing::Canvas& canvas, std::span<const RowMarks> marks) {
  double x = kNames;
  for (const RowMarks& kind : marks) {
    draw_mark(canvas, {x, 56.0}, kind);
    canvas.text({x + 12.0, 61.0}, kind.name);
    x += 44.0 + canvas.text_width(kind.name);
  }
}

/// A gate's corners: lines would hide its bars.
void mark(drawing::Canvas& canvas, const Quad& gate, const Vector2d& at, double scale,
          double radius, const drawing::Color& color) {
  for (const Vector2d& corner : gate)
    canvas.disc(at + scale * (corner + Vector2d{0.5, 0.5}), radius, color);
}

/// A changed picture in a cell of its original's size.
void draw_cell(drawing::Canvas& canvas, const drawing::Box& cell, const UprightPicture& original,
               const PictureChange& change, const OwnSet& set) {
  canvas.text({cell.x, cell.y - 5.0}, change.words, {.size = 12.0});
  const auto picture = change.apply(original);
  if (!picture) return;
  const double scale = cell.width / picture->width;
  const Vector2d at{cell.x, cell.y};
  canvas.clip(cell);
  canvas.image(picture->view(), at, scale);
  for (const Quad& gate : picture->gates) mark(canvas, gate, at, scale, 3.5, drawing::kDark.good);
  tuning::Judging judging = set.judging;
  judging.all = change.every_gate;
  judging.lowest = set.config.pilot.detector.min_score;
  for (const tuning::Judged& found :
       tuning::found_in(picture->view(), set.config.pilot.gate_color, judging))
    mark(canvas, found.corners_px, at, scale, 2.0, drawing::kLight.focus);
  canvas.unclip();
}

}  // namespace

drawing::Canvas draw_rows(const std::string& title, std::span<const std::string> rows,
                          std::span<const RowMarks> marks, double most) {
  const double bottom = kFirstRow + kRow * static_cast<double>(rows.size());
  drawing::Canvas canvas(static_cast<int>(kNames + kAxis + 2.0 * kMargin),
                         static_cast<int>(bottom + 2.0 * kMargin));
  canvas.text({kMargin, 32.0}, title, {.size = 18.0, .bold = true});
  draw_legend(canvas, marks);
  for (int tick = 0; tick <= 10; ++tick) {
    const double x = kNames + 0.1 * tick * kAxis;
    canvas.line({x, kFirstRow - 8.0}, {x, bottom}, {.color = drawing::kLight.grid, .width = 1.0});
    canvas.text({x, bottom + 18.0}, files::text_of(0.1 * tick * most, 2),
                {.color = drawing::kLight.muted, .align = drawing::Align::kCenter});
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const double y = kFirstRow + kRow * (static_cast<double>(row) + 0.5);
    canvas.line({kNames, y}, {kNames + kAxis, y}, {.color = drawing::kLight.grid, .width = 1.0});
    canvas.text({kNames - 12.0, y + 4.5}, rows[row], {.align = drawing::Align::kRight});
    for (const RowMarks& kind : marks)
      if (std::isfinite(kind.values[row]))
        draw_mark(canvas, {kNames + kAxis * std::min(1.0, kind.values[row] / most), y}, kind);
  }
  return canvas;
}

drawing::Canvas sheet_of_changes(const UprightPicture& original, const OwnSet& set) {
  constexpr int kColumns = 6, kGap = 16, kWords = 24;
  const auto changes = picture_changes();
  const int width = original.width, height = original.height;
  const int rows = (static_cast<int>(changes.size()) + kColumns - 1) / kColumns;
  drawing::Canvas canvas(kColumns * (width + kGap) + kGap, rows * (height + kWords + kGap) + kGap);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const int column = static_cast<int>(i) % kColumns, row = static_cast<int>(i) / kColumns;
    draw_cell(canvas,
              {static_cast<double>(kGap + column * (width + kGap)),
               static_cast<double>(kGap + kWords + row * (height + kWords + kGap)),
               static_cast<double>(width), static_cast<double>(height)},
              original, changes[i], set);
  }
  return canvas;
}

}  // namespace gatefly::experiments
