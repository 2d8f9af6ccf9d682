// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/identification/thrust_fit.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "gatefly/geometry/math.hpp"

namespace gatefly::identification {
namespace {

// All ours.
constexpr double kStretch = 0.25;   // [s]
constexpr std::size_t kLeast = 12;  // pieces: 3 s
constexpr double kLagStep = 0.01;   // [s]
constexpr int kLagSteps = 15;
constexpr double kMostSigma = 0.3;    // of an exponent that is worth saying
constexpr double kCurve = 0.1;        // of an exponent: a battery sags under more load
constexpr double kSystematic = 0.01;  // of thrust: battery, floor, the accelerometer's scale

struct Piece {
  double command = 0.0, accel = 0.0;  // logarithms
};

/// Means over pieces, the commands so much earlier.
std::vector<Piece> pieces_of(std::span<const ThrustPoint> points, double bias, double lag) {
  std::vector<Piece> pieces;
  double command = 0.0, accel = 0.0, count = 0.0, begin = points.front().t;
  std::size_t earlier = 0;
  for (const ThrustPoint& point : points) {
    while (earlier + 1 < points.size() && points[earlier + 1].t <= point.t - lag) ++earlier;
    if (point.t - begin >= kStretch) {
      // A gap in the log is no piece.
      if (count > 0.0 && point.t - begin < 2.0 * kStretch && accel > 0.0)
        pieces.push_back({command / count, std::log(accel / count)});
      command = accel = count = 0.0, begin = point.t;
    }
    if (points[earlier].t > point.t - lag || !(points[earlier].command > 0.0)) continue;
    command += std::log(points[earlier].command), accel += point.accel + bias, count += 1.0;
  }
  return pieces;
}

struct Line {
  double slope = 0.0, middle = 0.0, at = 0.0;  // accel = middle + slope (command - at)
  double spread = 0.0;                         // of the commands, summed squares
  double rms = 0.0, alike = 1.0;               // how much wider sums are as neighbours err alike
};

Line line_through(const std::vector<Piece>& pieces, std::optional<double> slope) {
  const auto count = static_cast<double>(pieces.size());
  Line line;
  for (const Piece& piece : pieces)
    line.at += piece.command / count, line.middle += piece.accel / count;
  double product = 0.0;
  for (const Piece& piece : pieces) {
    line.spread += (piece.command - line.at) * (piece.command - line.at);
    product += (piece.command - line.at) * (piece.accel - line.middle);
  }
  line.slope = slope.value_or(line.spread > 0.0 ? product / line.spread : 0.0);
  double squares = 0.0, neighbours = 0.0, before = 0.0;
  for (const Piece& piece : pieces) {
    const double off = piece.accel - line.middle - line.slope * (piece.command - line.at);
    squares += off * off, neighbours += off * before, before = off;
  }
  line.rms = std::sqrt(squares / std::max(1.0, count - 2.0));
  const double rho = squares > 0.0 ? std::clamp(neighbours / squares, 0.0, 0.8) : 0.0;
  line.alike = std::sqrt((1.0 + rho) / (1.0 - rho));
  return line;
}

}  // namespace

std::optional<ThrustFit> fit_thrust(std::span<const ThrustPoint> points) {
  if (points.empty()) return std::nullopt;
  ThrustFit fit;
  const double time = points.back().t - points.front().t;
  double upwards = 0.0, upright = 0.0;
  for (const ThrustPoint& point : points)
    upwards += point.accel * point.upright, upright += point.upright;
  if (!(time > 0.0 && upright > 0.0)) return std::nullopt;
  const double changed = (points.back().v_down - points.front().v_down) / time;
  fit.accel_bias = ((kGravity - changed) * static_cast<double>(points.size()) - upwards) / upright;

  std::optional<Line> best;
  for (int step = 0; step <= kLagSteps; ++step) {
    const double lag = step * kLagStep;
    const std::vector<Piece> pieces = pieces_of(points, fit.accel_bias, lag);
    if (pieces.size() < kLeast) break;
    const Line line = line_through(pieces, std::nullopt);
    if (best && line.rms >= best->rms) continue;
    best = line;
    fit.lag = lag, fit.pieces = pieces.size();
  }
  if (!best) return std::nullopt;
  double slope_sigma =
      best->spread > 0.0 ? best->rms * best->alike / std::sqrt(best->spread) : kMostSigma;
  if (slope_sigma < kMostSigma && best->slope > 0.0) {
    slope_sigma = std::hypot(slope_sigma, kCurve);
    fit.exponent = Known{best->slope, slope_sigma};
  } else {  // thrust is about quadratic in a speed, less steep in a throttle
    constexpr double kGuess = 1.5;
    slope_sigma = 0.4;
    best = line_through(pieces_of(points, fit.accel_bias, fit.lag), kGuess);
  }
  fit.rms = best->rms;
  const double away = std::log(kGravity) - best->middle;
  const double of_middle = best->rms * best->alike / std::sqrt(static_cast<double>(fit.pieces));
  const double of_slope = slope_sigma * away / best->slope;
  fit.hover.value = std::exp(best->at + away / best->slope);
  fit.hover.sigma = fit.hover.value * std::hypot(of_middle, kSystematic, of_slope) / best->slope;
  return fit;
}

}  // namespace gatefly::identification
