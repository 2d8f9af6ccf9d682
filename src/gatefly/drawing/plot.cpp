// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/plot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gatefly/files/text.hpp"

namespace gatefly::io {
namespace {

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

std::vector<Tick> ticks_of(const Axis& axis) {
  std::vector<Tick> list;
  if (!axis.log) {
    for (const double value : ticks(axis.low, axis.high, 8))
      list.push_back({value, text_of(value, 6)});
    return list;
  }
  for (double decade = std::floor(axis.low); decade <= axis.high; ++decade)
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double value = digit * std::pow(10.0, decade);
      if (std::log10(value) >= axis.low && std::log10(value) <= axis.high)
        list.push_back({value, text_of(value, 6)});
    }
  return list;
}

void draw_axes(Canvas& canvas, const Plot& plot, const Axis& x, const Axis& y, const Box& area) {
  canvas.fill(area, look::kPanel);
  const Stroke grid{.color = look::kFaint.faded(0.6), .width = 1.0};
  for (const Tick& tick : ticks_of(x)) {
    const double u = x.place(tick.value);
    canvas.line({u, area.y}, {u, area.bottom()}, grid);
    canvas.text({u, area.bottom() + 20.0}, tick.label,
                {.color = look::kMuted, .size = 12.0, .align = Align::kCenter});
  }
  for (const Tick& tick : ticks_of(y)) {
    const double v = y.place(tick.value);
    canvas.line({area.x, v}, {area.right(), v}, grid);
    canvas.text({area.x - 8.0, v + 4.0}, tick.label,
                {.color = look::kMuted, .size = 12.0, .align = Align::kRight});
  }
  canvas.text({0.5 * (area.x + area.right()), area.bottom() + 44.0}, plot.x_label,
              {.align = Align::kCenter});
  canvas.text({area.x, area.y - 10.0}, plot.y_label);
}

Stroke stroke_of(const PlotSeries& series) {
  return {.color = series.color, .width = 1.6, .dash = series.dash};
}

void draw_mark(Canvas& canvas, const PlotSeries& series, const Eigen::Vector2d& at) {
  if (series.rings)
    canvas.circle(at, 4.5, {.color = series.color, .width = 1.8});
  else
    canvas.disc(at, 3.5, series.color);
}

void draw_series(Canvas& canvas, const PlotSeries& series, const Axis& x, const Axis& y) {
  std::vector<Eigen::Vector2d> places;
  for (const Eigen::Vector2d& point : series.points)
    if (x.shows(point.x()) && y.shows(point.y()))
      places.emplace_back(x.place(point.x()), y.place(point.y()));
  if (series.area) {
    if (places.size() > 2) canvas.polygon(places, series.color);
    return;
  }
  if (series.line && places.size() > 1) canvas.polyline(places, stroke_of(series));
  if (!series.marks) return;
  for (const Eigen::Vector2d& place : places) draw_mark(canvas, series, place);
}

constexpr double kLegendTop = 64.0, kLegendLine = 20.0, kSample = 26.0;  // [px]

/// An entry of the legend, from the left end of its sample.
struct LegendEntry {
  const PlotSeries* series;
  Eigen::Vector2d at;
};

std::vector<LegendEntry> legend_of(Canvas& canvas, const Plot& plot, const Box& within) {
  std::vector<LegendEntry> entries;
  Eigen::Vector2d at{within.x, kLegendTop};
  for (const PlotSeries& series : plot.series) {
    if (series.name.empty()) continue;  // shares the colour of a named one
    const double width = kSample + 8.0 + canvas.text_width(series.name);
    if (at.x() > within.x && at.x() + width > within.right()) at = {within.x, at.y() + kLegendLine};
    entries.push_back({&series, at});
    at.x() += width + 28.0;
  }
  return entries;
}

void draw_legend(Canvas& canvas, const std::vector<LegendEntry>& entries) {
  for (const auto& [series, at] : entries) {
    const double middle = at.y() - 4.5;
    if (series->area)
      canvas.fill({at.x(), middle - 5.0, kSample, 10.0}, series->color);
    else if (series->line)
      canvas.line({at.x(), middle}, {at.x() + kSample, middle}, stroke_of(*series));
    if (series->marks && !series->area)
      draw_mark(canvas, *series, {at.x() + 0.5 * kSample, middle});
    canvas.text({at.x() + kSample + 8.0, at.y()}, series->name);
  }
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
  Box area{.x = 70.0, .y = 108.0, .width = std::max(10.0, width - 100.0), .height = 0.0};
  const std::vector<LegendEntry> legend = legend_of(canvas, plot, area);
  if (!legend.empty()) area.y += legend.back().at.y() - kLegendTop;
  area.height = std::max(10.0, height - 68.0 - area.y);
  Axis x = axis_of(plot, 0, plot.log_x, false), y = axis_of(plot, 1, false, plot.y_from_0);
  x.from = area.x, x.to = area.right();
  y.from = area.bottom(), y.to = area.y;
  canvas.text({area.x, 34.0}, plot.title, {.size = 17.0, .bold = true});
  draw_legend(canvas, legend);
  draw_axes(canvas, plot, x, y, area);
  for (const PlotSeries& series : plot.series) draw_series(canvas, series, x, y);
  return canvas;
}

}  // namespace gatefly::io
