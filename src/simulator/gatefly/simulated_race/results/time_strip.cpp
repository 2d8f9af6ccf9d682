// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/time_strip.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "gatefly/files/text.hpp"

namespace gatefly::simulated_race {
namespace {

constexpr double kWindow = 30.0;  // [s]

}  // namespace

TimeStrip::TimeStrip(const drawing::Box& panel, const StripCurve& curve,
                     std::span<const Moment> moments, double per_second)
    : panel_{panel},
      curve_{curve},
      moments_{moments},
      area_{.x = panel.x + 38,
            .y = panel.y + 44,
            .width = panel.width - 60,
            .height = panel.height - 60},
      end_{std::max(kWindow, moments.back().time)},
      top_{curve.at_least} {
  for (const Moment& m : moments) top_ = std::max(top_, std::ceil(curve.truth(m)));
  const auto shown = static_cast<std::size_t>(kWindow * per_second);
  if (moments.size() > shown) moments_ = moments.last(shown);
}

void TimeStrip::draw(drawing::Canvas& canvas, std::span<const PassedGate> passes,
                     const std::optional<PassedGate>& next) const {
  canvas.fill(panel_, drawing::kDark.panel, 8.0);
  canvas.text({panel_.x + 14, panel_.y + 27}, curve_.name,
              {.color = drawing::kDark.muted, .size = 16});
  canvas.text(
      {panel_.right() - 14, panel_.y + 28},
      files::fixed(curve_.truth(moments_.back()), 2) + " " + curve_.unit,
      {.color = drawing::kDark.ink, .size = 20, .align = drawing::Align::kRight, .bold = true});
  draw_scale(canvas);
  canvas.clip(
      {.x = area_.x - 2, .y = area_.y - 8, .width = area_.width + 16, .height = area_.height + 16});
  for (const PassedGate& pass : passes) draw_pass(canvas, pass);
  trace(canvas, curve_.estimate, {.color = drawing::kDark.estimate, .width = 1.4});
  trace(canvas, curve_.truth, {.color = drawing::kDark.flown, .width = 2.6});
  if (next && curve_.is_height) draw_next(canvas, *next);
  canvas.unclip();
  canvas.disc(at(moments_.back().time, curve_.truth(moments_.back())), 4.5, drawing::kDark.ink);
}

void TimeStrip::draw_scale(drawing::Canvas& canvas) const {
  for (double level = 0.0; level <= top_ + 1e-9; level += 1.0) {
    const double y = at(end_, level).y();
    canvas.line({area_.x, y}, {area_.right(), y}, {.color = drawing::kDark.rule, .width = 1.0});
    canvas.text({area_.x - 10, y + 5}, files::fixed(level, 0),
                {.color = drawing::kDark.muted, .size = 14, .align = drawing::Align::kRight});
  }
}

/// Over heights as wide as it is open.
void TimeStrip::draw_pass(drawing::Canvas& canvas, const PassedGate& pass) const {
  const double x = at(pass.time, 0.0).x();
  canvas.line({x, at(0, 0.0).y()}, {x, at(0, top_).y()},
              {.color = pass.color.faded(curve_.is_height ? 0.25 : 0.6), .width = 1.5});
  if (!curve_.is_height) return;
  const double low = at(0, pass.low).y(), high = at(0, pass.high).y();
  canvas.line({x, low}, {x, high}, {.color = pass.color.faded(0.35), .width = 7.0});
  for (const double y : {low, high})
    canvas.line({x - 5, y}, {x + 5, y}, {.color = pass.color, .width = 3.0});
}

/// At the right end: its time is not known yet.
void TimeStrip::draw_next(drawing::Canvas& canvas, const PassedGate& next) const {
  const double x = at(end_, 0.0).x() + 9.0;
  canvas.line({x, at(end_, next.low).y()}, {x, at(end_, next.high).y()},
              {.color = next.color, .width = 5.0});
}

void TimeStrip::trace(drawing::Canvas& canvas, const std::function<double(const Moment&)>& value,
                      const drawing::Stroke& stroke) const {
  std::vector<Eigen::Vector2d> points;
  for (const Moment& m : moments_) points.push_back(at(m.time, value(m)));
  canvas.polyline(points, stroke);
}

Eigen::Vector2d TimeStrip::at(double time, double value) const {
  return {area_.right() - (end_ - time) / kWindow * area_.width,
          area_.bottom() - value / top_ * area_.height};
}

}  // namespace gatefly::simulated_race
