// SPDX-License-Identifier: Apache-2.0
#include "gatefly/detection/search/bar_pieces.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace gatefly {
namespace {

// Whether b is the same bar as a, farther down: what is behind a bar may hide some rows of it.
bool goes_on(const Bar& a, const Bar& b, int stride) {
  const double gap = b.top - a.bottom, y = 0.5 * (a.bottom + b.top);
  return gap > -1.5 * stride && gap < 4.5 * stride &&
         std::abs(beyond(a, y).x() - beyond(b, y).x()) <
             0.5 * stride + 0.3 * std::max(a.width, b.width);
}

Bar joined(const Bar& a, const Bar& b, int stride) {
  Bar bar{.top = a.top,
          .bottom = b.bottom,
          .strength = a.strength + b.strength,
          .width = (a.width * a.length() + b.width * b.length()) / (a.length() + b.length())};
  // One parabola through the rows of both.
  const double middle = 0.5 * (bar.top + bar.bottom), half = 0.5 * bar.length();
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  for (const Bar* piece : {&a, &b})
    // At most once a row: a stride is one at least.
    for (double y = piece->top; y <= piece->bottom; y += stride) {
      const double t = (y - middle) / half;
      const Eigen::Vector3d powers{1.0, t, t * t};
      A += powers * powers.transpose(), x += piece->on_curve(y).x() * powers;
    }
  const Eigen::Vector3d c = A.ldlt().solve(x);
  const double m = middle / half;
  bar.curve = {c[0] - c[1] * m + c[2] * m * m, (c[1] - 2.0 * c[2] * m) / half,
               c[2] / (half * half)};
  return bar;
}

// Joins the first two pieces that go on in each other; false: there are none.
bool join_two(BarFinder::Bars& bars, int stride) {
  for (Bar& bar : bars)
    for (Bar& other : bars) {
      if (&bar == &other || !goes_on(bar, other, stride)) continue;
      bar = joined(bar, other, stride);
      other = bars.back(), bars.pop_back();
      return true;
    }
  return false;
}

}  // namespace

Eigen::Vector2d beyond(const Bar& bar, double y) {
  const double on = std::clamp(y, bar.top, bar.bottom);
  return {bar.on_curve(on).x() + (y - on) * (bar.curve[1] + 2.0 * bar.curve[2] * on), y};
}

void join_pieces(BarFinder::Bars& bars, int stride) {
  // At most once a bar: each time there is one less.
  while (join_two(bars, stride)) {
  }
}

}  // namespace gatefly
