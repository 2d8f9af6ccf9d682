// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/simulated_race/results/flight_map.hpp"

namespace gatefly::simulated_race {

/// Curves over time: the truth and the pilot's belief.
struct StripCurve {
  std::string name, unit;
  std::function<double(const Moment&)> truth, estimate;
  double at_least;  ///< Upper end of the scale, when nothing is higher.
  bool is_height = false;
};

/// A gate that was passed: when, and between which heights it is open.
struct PassedGate {
  double time, low, high;
  drawing::Color color;
};

/// The last half minute of a curve, in a panel of its own.
class TimeStrip {
 public:
  /// @param moments  at least one, evenly spaced; must outlive the strip, as `curve` must.
  /// @param per_second  how many of them.
  TimeStrip(const drawing::Box& panel, const StripCurve& curve, std::span<const Moment> moments,
            double per_second);

  /// @param next  the gate that is flown to; its time is not known yet.
  void draw(drawing::Canvas& canvas, std::span<const PassedGate> passes,
            const std::optional<PassedGate>& next) const;

 private:
  void draw_scale(drawing::Canvas& canvas) const;
  void draw_pass(drawing::Canvas& canvas, const PassedGate& pass) const;
  void draw_next(drawing::Canvas& canvas, const PassedGate& next) const;
  void trace(drawing::Canvas& canvas, const std::function<double(const Moment&)>& value,
             const drawing::Stroke& stroke) const;
  [[nodiscard]] Eigen::Vector2d at(double time, double value) const;

  drawing::Box panel_;
  const StripCurve& curve_;
  std::span<const Moment> moments_;
  drawing::Box area_;
  double end_, top_;
};

}  // namespace gatefly::simulated_race
