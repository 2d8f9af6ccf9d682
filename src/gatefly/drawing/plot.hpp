// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/drawing/canvas.hpp"

namespace gatefly::io {

/// One curve of a plot.
struct PlotSeries {
  std::string name = {};  ///< In the legend; "" is not.
  /// In order. What is not finite, or not above 0 on a log axis, is left out.
  std::vector<Eigen::Vector2d> points = {};
  Color color = look::kDetection;
  bool line = true;    ///< Joins the points.
  bool rings = false;  ///< Rings instead of discs: somebody else's points beside ours.
  bool marks = true;   ///< A disc or ring at each point.
  bool area = false;   ///< Filled as a polygon, without line or marks.
  double dash = 0.0;   ///< Of the line: length of dashes and gaps [px]; 0: one line.
};

struct Plot {
  std::string title = {}, x_label = {}, y_label = {};
  std::vector<PlotSeries> series = {};
  bool log_x = false;
  bool y_from_0 = true;
};

/// Places for about `count` ticks at 1, 2 or 5 times a power of ten that lie in [low, high].
[[nodiscard]] std::vector<double> ticks(double low, double high, int count);

/// Draws axes with ticks and grid, the curves, and a legend above them, in as many lines as it takes.
/// Without any point the axes are empty.
[[nodiscard]] Canvas draw(const Plot& plot, int width = 960, int height = 600);

}  // namespace gatefly::io
