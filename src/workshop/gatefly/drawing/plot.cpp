// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gatefly/files/text.hpp"

namespace gatefly::drawing {
namespace {

constexpr double kStampWidth = 120.0;  // [px]

/// From values to pixels along one axis.
struct Axis {
  double low = 0.0, high = 1.0;  ///< Values; their logarithms to base 10 on a log axis.
  double from = 0.0, to = 1.0;   ///< [px]
  bool log = false;

  [[nodiscard]] double place(double value) const {
    const double at = log ? std::log10(value) : value;
    return from + (at - low) / (high - low) * (to - from);
  }
  [[nodiscard]] bool shows(double value) const {
    return std::isfinite(value) && (!log || value > 0.0);
  }
};

/// Around all values, with a little air.
Axis axis_of(const Plot& plot, Eigen::Index dimension, bool log, bool from_0) {
  Axis axis{.low = std::numeric_limits<double>::infinity(),
            .high = -std::numeric_limits<double>::infinity(),
            .log = log};
  for (const PlotSeries& series : plot.series)
    for (const Eigen::Vector2d& point : series.points) {
      const double value = point[dimension];
      if (!axis.shows(value)) continue;
      axis.low = std::min(axis.low, log ? std::log10(value) : value);
      axis.high = std::max(axis.high, log ? std::log10(value) : value);
    }
  if (axis.low > axis.high) axis.low = 0.0, axis.high = 1.0;
  if (from_0 && !log) axis.low = std::min(axis.low, 0.0);
  const double air = axis.high > axis.low ? 0.04 * (axis.high - axis.low) : 0.5;
  if (!from_0 || log || axis.low < 0.0) axis.low -= air;
  axis.high += air;
  return axis;
}

struct Tick {
  double value;
  std::string label;
};

std::vector<Tick> ticks_of(const Axis& axis, double about) {
  std::vector<Tick> list;
  if (!axis.log) {
    for (const double value : ticks(axis.low, axis.high, std::clamp(static_cast<int>(about), 2, 8)))
      list.push_back({value, files::text_of(value, 6)});
    return list;
  }
  for (double decade = std::floor(axis.low); decade <= axis.high; ++decade)
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double value = digit * std::pow(10.0, decade);
      if (std::log10(value) >= axis.low && std::log10(value) <= axis.high)
        list.push_back({value, files::text_of(value, 6)});
    }
  return list;
}

/// Letters, margins and strokes of one picture: the same on paper, whatever its size.
struct Style {
  double unit;  ///< 1 for a plot by itself, less for the small ones of a sheet.

  Style(int width, int height)
      : unit{std::clamp(std::sqrt(1.0 * width * height / (1.0 * kPlotWidth * kPlotHeight)), 0.7,
                        1.0)} {}
  [[nodiscard]] double px(double of_full_size) const { return unit * of_full_size; }
  [[nodiscard]] Lettering letters(const Color& color, Align align = Align::kLeft) const {
    return {.color = color, .size = px(20.0), .align = align};
  }
};

void draw_axes(Canvas& canvas, const Plot& plot, const Axis& x, const Axis& y, const Box& area,
               const Style& style) {
  const Stroke grid{.color = kLight.grid, .width = 1.0};
  const Lettering below = style.letters(kLight.muted, Align::kCenter),
                  beside = style.letters(kLight.muted, Align::kRight);
  double free = area.x - style.px(60.0);  // labels of a log axis may not touch each other
  for (const Tick& tick : ticks_of(x, area.width / style.px(110.0))) {
    const double u = x.place(tick.value), half = 0.5 * canvas.text_width(tick.label, below);
    canvas.line({u, area.y}, {u, area.bottom()}, grid);
    if (u - half < free) continue;
    canvas.text({u, area.bottom() + style.px(28.0)}, tick.label, below);
    free = u + half + style.px(10.0);
  }
  for (const Tick& tick : ticks_of(y, area.height / style.px(45.0))) {
    const double v = y.place(tick.value);
    canvas.line({area.x, v}, {area.right(), v}, grid);
    canvas.text({area.x - style.px(12.0), v + style.px(7.0)}, tick.label, beside);
  }
  const std::array<Eigen::Vector2d, 3> frame{
      {{area.x, area.y}, {area.x, area.bottom()}, {area.right(), area.bottom()}}};
  canvas.polyline(frame, {.color = kLight.muted, .width = style.px(1.6)});
  canvas.text({0.5 * (area.x + area.right()), area.bottom() + style.px(62.0)}, plot.x_label,
              style.letters(kLight.ink, Align::kCenter));
  canvas.text({area.x, area.y - style.px(14.0)}, plot.y_label, style.letters(kLight.ink));
}

Stroke stroke_of(const PlotSeries& series, const Style& style) {
  return {.color = series.color, .width = style.px(2.6), .dash = style.px(1.6) * series.dash};
}

bool same_hue(const Color& a, const Color& b) { return a.faded(0) == b.faded(0); }

void draw_mark(Canvas& canvas, const PlotSeries& series, const Eigen::Vector2d& at,
               const Style& style) {
  const double r = style.px(6.0);
  const Color& color = series.color;
  if (series.rings) {
    canvas.circle(at, r + style.px(1.0), {.color = color, .width = style.px(2.6)});
  } else if (same_hue(color, kLight.gate_solid)) {
    canvas.fill({at.x() - 0.85 * r, at.y() - 0.85 * r, 1.7 * r, 1.7 * r}, color);
  } else if (same_hue(color, kLight.flown)) {
    const std::array<Eigen::Vector2d, 3> triangle{{at + Eigen::Vector2d{0.0, -1.25 * r},
                                                   at + Eigen::Vector2d{1.15 * r, 0.85 * r},
                                                   at + Eigen::Vector2d{-1.15 * r, 0.85 * r}}};
    canvas.polygon(triangle, color);
  } else if (same_hue(color, kLight.estimate)) {
    const std::array<Eigen::Vector2d, 4> diamond{
        {at + Eigen::Vector2d{0.0, -1.3 * r}, at + Eigen::Vector2d{1.3 * r, 0.0},
         at + Eigen::Vector2d{0.0, 1.3 * r}, at + Eigen::Vector2d{-1.3 * r, 0.0}}};
    canvas.polygon(diamond, color);
  } else if (same_hue(color, kLight.muted)) {
    const double d = 0.9 * r;
    const Stroke stroke{.color = color, .width = style.px(2.6)};
    canvas.line({at.x() - d, at.y() - d}, {at.x() + d, at.y() + d}, stroke);
    canvas.line({at.x() - d, at.y() + d}, {at.x() + d, at.y() - d}, stroke);
  } else {
    canvas.disc(at, 0.9 * r, color);
  }
}

/// Along a line many marks, or close ones, would hide it.
bool has_room(const std::vector<Eigen::Vector2d>& places, const Style& style) {
  constexpr std::size_t kMost = 40;
  double length = 0.0;
  for (std::size_t i = 1; i < places.size(); ++i) length += (places[i] - places[i - 1]).norm();
  return places.size() < 3 ||
         (places.size() <= kMost && length > style.px(22.0) * static_cast<double>(places.size()));
}

std::vector<Eigen::Vector2d> places_of(const PlotSeries& series, const Axis& x, const Axis& y) {
  std::vector<Eigen::Vector2d> places;
  for (const Eigen::Vector2d& point : series.points)
    if (x.shows(point.x()) && y.shows(point.y()))
      places.emplace_back(x.place(point.x()), y.place(point.y()));
  return places;
}

/// All lines have marks or none, so that curves of one plot look alike.
bool lines_have_marks(const Plot& plot, const Axis& x, const Axis& y, const Style& style) {
  return std::all_of(plot.series.begin(), plot.series.end(), [&](const PlotSeries& series) {
    return !series.line || series.area || !series.marks || series.rings ||
           has_room(places_of(series, x, y), style);
  });
}

void draw_series(Canvas& canvas, const PlotSeries& series,
                 const std::vector<Eigen::Vector2d>& places, bool marks, const Style& style) {
  if (series.area) {
    if (places.size() > 2) canvas.polygon(places, series.color);
    return;
  }
  if (series.line && places.size() > 1) canvas.polyline(places, stroke_of(series, style));
  if (!series.marks || (series.line && !series.rings && !marks)) return;
  for (const Eigen::Vector2d& place : places) draw_mark(canvas, series, place, style);
}

constexpr double kLegendTop = 84.0, kLegendLine = 32.0, kSample = 40.0;  // [px] of a full size

/// An entry of the legend, from the left end of its sample.
struct LegendEntry {
  const PlotSeries* series;
  Eigen::Vector2d at;
};

std::vector<LegendEntry> legend_of(Canvas& canvas, const Plot& plot, const Box& within,
                                   const Style& style) {
  std::vector<LegendEntry> entries;
  Eigen::Vector2d at{within.x, style.px(kLegendTop)};
  for (const PlotSeries& series : plot.series) {
    if (series.name.empty()) continue;  // shares the colour of a named one
    const double width =
        style.px(kSample + 10.0) + canvas.text_width(series.name, style.letters(kLight.ink));
    if (at.x() > within.x && at.x() + width > within.right())
      at = {within.x, at.y() + style.px(kLegendLine)};
    entries.push_back({&series, at});
    at.x() += width + style.px(34.0);
  }
  return entries;
}

void draw_legend(Canvas& canvas, const std::vector<LegendEntry>& entries, bool marks,
                 const Style& style) {
  const double sample = style.px(kSample);
  for (const auto& [series, at] : entries) {
    const double middle = at.y() - style.px(7.0);
    if (series->area)
      canvas.fill({at.x(), middle - style.px(8.0), sample, style.px(16.0)}, series->color);
    else if (series->line)
      canvas.line({at.x(), middle}, {at.x() + sample, middle}, stroke_of(*series, style));
    if (series->marks && !series->area && (marks || series->rings || !series->line))
      draw_mark(canvas, *series, {at.x() + 0.5 * sample, middle}, style);
    canvas.text({at.x() + sample + style.px(10.0), at.y()}, series->name,
                style.letters(kLight.ink));
  }
}

/// The range along one of the axes grows until both have the same scale.
void equalize(Axis& x, Axis& y) {
  const auto per_px = [](const Axis& axis) {
    return (axis.high - axis.low) / std::abs(axis.to - axis.from);
  };
  const double scale = std::max(per_px(x), per_px(y));
  for (Axis* axis : {&x, &y}) {
    const double more = scale * std::abs(axis->to - axis->from) - (axis->high - axis->low);
    axis->low -= 0.5 * more, axis->high += 0.5 * more;
  }
}

/// In letters as large as fit.
void draw_title(Canvas& canvas, const std::string& title, const Eigen::Vector2d& at, double width,
                const Style& style) {
  Lettering lettering{.color = kLight.ink, .size = style.px(26.0), .bold = true};
  // Letters have whole pixels: their width does not follow their size exactly.
  for (double wide = canvas.text_width(title, lettering); wide > width && lettering.size > 1.0;
       wide = canvas.text_width(title, lettering))
    lettering.size *= std::min(0.98, width / wide);
  canvas.text(at, title, lettering);
}

}  // namespace

std::vector<double> ticks(double low, double high, int count) {
  std::vector<double> list;
  if (!(high > low) || !std::isfinite(high - low) || count < 1) return list;
  const double raw = (high - low) / count, power = std::pow(10.0, std::floor(std::log10(raw)));
  const double digits = raw / power;
  const double step = power * (digits <= 1.0   ? 1.0
                               : digits <= 2.0 ? 2.0
                               : digits <= 5.0 ? 5.0
                                               : 10.0);
  // Whole multiples: sums of steps would drift.
  // + 0.0: never -0
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
    list.push_back(i * step + 0.0);
  return list;
}

Canvas draw(const Plot& plot, int width, int height) {
  Canvas canvas(width, height);
  const Style style(width, height);
  Box area{.x = style.px(96.0),
           .y = style.px(140.0),
           .width = std::max(10.0, width - style.px(132.0)),
           .height = 0.0};
  const std::vector<LegendEntry> legend = legend_of(canvas, plot, area, style);
  if (legend.empty())
    area.y -= style.px(kLegendLine);
  else
    area.y += legend.back().at.y() - style.px(kLegendTop);
  area.height = std::max(10.0, height - style.px(84.0) - area.y);
  Axis x = axis_of(plot, 0, plot.log_x, false), y = axis_of(plot, 1, false, plot.y_from_0);
  x.from = area.x, x.to = area.right();
  y.from = area.bottom(), y.to = area.y;
  if (plot.equal_scales && !plot.log_x) equalize(x, y);
  // Beside the stamp, which every plot leaves room for.
  draw_title(canvas, plot.title, {area.x, style.px(44.0)}, area.right() - area.x - kStampWidth,
             style);
  const bool marks = lines_have_marks(plot, x, y, style);
  draw_legend(canvas, legend, marks, style);
  draw_axes(canvas, plot, x, y, area, style);
  canvas.clip({area.x - style.px(8.0), area.y - style.px(8.0), area.width + style.px(16.0),
               area.height + style.px(16.0)});
  for (const PlotSeries& series : plot.series)
    draw_series(canvas, series, places_of(series, x, y), marks, style);
  canvas.unclip();
  return canvas;
}

Canvas draw_sheet(std::span<const Plot> plots, int columns, int row_height) {
  const int count = static_cast<int>(plots.size()), full = std::max(1, columns);
  const int rows = std::max(1, (count + full - 1) / full);
  Canvas sheet(kPlotWidth, rows * row_height);
  for (int i = 0; i < count; ++i) {
    const int row = i / full, in_row = std::min(full, count - row * full);
    const int width = kPlotWidth / in_row;
    sheet.paste(draw(plots[static_cast<std::size_t>(i)], width, row_height),
                {1.0 * (i % full) * width, 1.0 * row * row_height});
  }
  return sheet;
}

void stamp_quick(Canvas& canvas) {
  const double unit = std::max(1.0, 1.0 * canvas.width() / kPlotWidth);
  const Lettering lettering{
      .color = kLight.warn, .size = 15.0 * unit, .align = Align::kCenter, .bold = true};
  const Box plate{canvas.width() - (kStampWidth - 4.0) * unit, 8.0 * unit,
                  (kStampWidth - 12.0) * unit, 26.0 * unit};
  const double border = 1.5 * unit;
  canvas.fill(plate, kLight.warn, 6.0 * unit);
  canvas.fill(
      {plate.x + border, plate.y + border, plate.width - 2.0 * border, plate.height - 2.0 * border},
      kLight.panel, 5.0 * unit);
  canvas.text({plate.x + 0.5 * plate.width, plate.y + 18.5 * unit}, "quick run", lettering);
}

}  // namespace gatefly::drawing
