// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/drawing/canvas.hpp"

namespace gatefly::drawing {

/// One curve of a plot.
struct PlotSeries {
  std::string name = {};  ///< In the legend; "" is not.
  /// In order. What is not finite, or not above 0 on a log axis, is left out.
  std::vector<Eigen::Vector2d> points = {};
  Color color = kLight.found;
  bool line = true;    ///< Joins the points.
  bool rings = false;  ///< Rings: somebody else's points beside ours.
  /// Something at each point, of a shape of its own for every colour, so that nobody has to tell
  /// curves by colour alone. On lines only where no line of the plot has too many points.
  bool marks = true;
  bool area = false;  ///< Filled as a polygon, without line or marks.
  double dash = 0.0;  ///< Length of dashes and gaps [px]; 0: one solid line.
};

struct Plot {
  std::string title = {}, x_label = {}, y_label = {};
  std::vector<PlotSeries> series = {};
  bool log_x = false;
  bool y_from_0 = true;
  bool equal_scales = false;  ///< A metre is as long along x as along y.
};

/// A plot by itself, and a row of several [px].
inline constexpr int kPlotWidth = 1200, kPlotHeight = 800, kRowHeight = 400;

/// Places for about `count` ticks at 1, 2 or 5 times a power of ten that lie in [low, high].
[[nodiscard]] std::vector<double> ticks(double low, double high, int count);

/// Draws axes with ticks and grid, the curves, and a legend above them, in as many lines as it takes.
/// Without any point the axes are empty.
[[nodiscard]] Canvas draw(const Plot& plot, int width = kPlotWidth, int height = kPlotHeight);

/// Several plots, row by row, as wide as one by itself. What is left of the last row its plots share.
[[nodiscard]] Canvas draw_sheet(std::span<const Plot> plots, int columns,
                                int row_height = kRowHeight);

/// The stamp of a run with fewer repeats, at the top right.
void stamp_quick(Canvas& canvas);

}  // namespace gatefly::drawing
