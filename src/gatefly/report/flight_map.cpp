// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/flight_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "gatefly/files/text.hpp"

namespace gatefly::io {
namespace {

constexpr double kFullHeight = 2.2;  // obstacles as high as this are drawn strongest [m]
constexpr double kRange = 4.0;       // of the camera's view as drawn [m]
constexpr Color kSlow = color_of(0x1f6f5c), kQuick = kDark.flown, kFast = color_of(0xfff27a);

Eigen::Vector2d direction(double heading) { return {std::cos(heading), std::sin(heading)}; }

Color between(const Color& a, const Color& b, double part) {
  return {a.r + part * (b.r - a.r), a.g + part * (b.g - a.g), a.b + part * (b.b - a.b)};
}

/// The corners of a rectangle lying at `center`, `half` sized, turned by `heading`.
std::array<Eigen::Vector2d, 4> corners(const Eigen::Vector2d& center, const Eigen::Vector2d& half,
                                       double heading) {
  const Eigen::Vector2d along = half.x() * direction(heading);
  const Eigen::Vector2d across = half.y() * Eigen::Vector2d{-std::sin(heading), std::cos(heading)};
  return {center - along - across, center + along - across, center + along + across,
          center - along + across};
}

}  // namespace

FlightMap::FlightMap(const Box& area, const closed_loop::RaceConfig& race)
    : world_{race.sim.world},
      fast_{1.4 * race.pilot.plan.speed},
      scale_{std::min(area.width / world_.room_size.y(), area.height / world_.room_size.x())},
      middle_px_{area.x + 0.5 * area.width, area.y + 0.5 * area.height} {}

Eigen::Vector2d FlightMap::at(const Eigen::Vector2d& p_E) const {
  const Eigen::Vector2d from_middle = p_E - world_.room_center;
  return middle_px_ + scale_ * Eigen::Vector2d{from_middle.y(), -from_middle.x()};
}

Color FlightMap::color_of_speed(double speed) const {
  const double part = std::clamp(speed / fast_, 0.0, 1.0);
  return part < 0.6 ? between(kSlow, kQuick, part / 0.6)
                    : between(kQuick, kFast, (part - 0.6) / 0.4);
}

void FlightMap::draw_obstacle(Canvas& canvas, const sim::WorldBox& box) const {
  const Color color = kDark.solid.faded(0.35 + 0.65 * std::clamp(box.top / kFullHeight, 0.0, 1.0));
  if (box.pole) {
    canvas.disc(at(box.center), 0.5 * scale_ * box.size.x(), color);
    return;
  }
  auto shape = corners(box.center, 0.5 * box.size, box.heading);
  for (auto& corner : shape) corner = at(corner);
  canvas.polygon(shape, color);
  canvas.outline(shape, {.color = kDark.rule.faded(0.7), .width = 1.0});
}

void FlightMap::draw_gate(Canvas& canvas, std::size_t gate, const Color& color) const {
  const sim::WorldGate& g = world_.gates[gate];
  const Eigen::Vector2d center = g.p_EG.head<2>(), ahead = direction(g.yaw_EG),
                        right{-ahead.y(), ahead.x()};
  const double bar = std::max(0.5 * g.side, 9.0 / scale_), tip = 13.0 / scale_;
  const std::array<Eigen::Vector2d, 3> arrow{at(center + tip * ahead),
                                             at(center + tip * (0.25 * ahead + 0.35 * right)),
                                             at(center + tip * (0.25 * ahead - 0.35 * right))};
  canvas.polygon(arrow, color);
  canvas.line(at(center - bar * right), at(center + bar * right), {.color = color, .width = 4.5});
  const Eigen::Vector2d beside = at(center + (bar + 13.0 / scale_) * right);
  canvas.text(beside + Eigen::Vector2d{0, 5}, std::to_string(gate + 1),
              {.color = color, .size = 14, .align = Align::kCenter, .bold = true});
}

void FlightMap::draw_path(Canvas& canvas, const Path& path) const {
  std::vector<Eigen::Vector2d> points;
  const int steps = static_cast<int>(std::ceil(path.length() / 0.1));
  for (int i = 0; i <= steps; ++i)
    points.push_back(at(path.at(path.length() * i / std::max(steps, 1)).position));
  canvas.polyline(points, {.color = kDark.plan, .width = 1.3, .dash = 5.0});
}

void FlightMap::draw_course(Canvas& canvas, const RacePlan& plan) const {
  auto room = corners(world_.room_center, 0.5 * world_.room_size.head<2>(), 0.0);
  for (auto& corner : room) corner = at(corner);
  canvas.polygon(room, kDark.page);
  for (const auto& box : world_.obstacles) draw_obstacle(canvas, box);
  canvas.outline(room, {.color = kDark.rule, .width = 2.0});

  draw_path(canvas, plan.start);
  for (const Path& leg : plan.legs) draw_path(canvas, leg);
  canvas.circle(at(plan.start.at(0.0).position), 6.0, {.color = kDark.muted, .width = 1.5});
  for (std::size_t i = 0; i < world_.gates.size(); ++i) draw_gate(canvas, i, kDark.gate_solid);

  const Eigen::Vector2d scale = room[0] + Eigen::Vector2d{10, -10};  // one metre, at the lower left
  canvas.line(scale, scale + Eigen::Vector2d{scale_, 0}, {.color = kDark.muted, .width = 2.0});
  canvas.text(scale + Eigen::Vector2d{scale_ + 8, 4}, "1 m", {.color = kDark.muted, .size = 12});
}

void FlightMap::draw_flown(Canvas& canvas, const Moment& from, const Moment& to,
                           double strength) const {
  // Darker, not translucent: translucent pieces show their overlapping ends as beads.
  canvas.line(
      at(from.true_p_EB.head<2>()), at(to.true_p_EB.head<2>()),
      {.color = between(kDark.page, color_of_speed(to.true_speed), strength), .width = 3.0});
}

void FlightMap::draw_estimate(Canvas& canvas, const Moment& from, const Moment& to) const {
  canvas.line(at(from.est_p_EB.head<2>()), at(to.est_p_EB.head<2>()),
              {.color = between(kDark.page, kDark.estimate, 0.75), .width = 1.1});
}

void FlightMap::draw_target(Canvas& canvas, int gate) const {
  if (gate < 0 || static_cast<std::size_t>(gate) >= world_.gates.size()) return;
  const auto index = static_cast<std::size_t>(gate);
  canvas.disc(at(world_.gates[index].p_EG.head<2>()), 26.0, kDark.gate_solid.faded(0.16));
  draw_gate(canvas, index, between(kDark.gate_solid, {1, 1, 1}, 0.35));
}

void FlightMap::draw_view(Canvas& canvas, const Eigen::Vector2d& p_E, const Eigen::Vector2d& left_E,
                          const Eigen::Vector2d& right_E) const {
  for (const double part : {0.4, 0.7, 1.0}) {  // fades with distance
    std::vector<Eigen::Vector2d> fan{at(p_E)};
    for (int i = 0; i <= 12; ++i) {
      const Eigen::Vector2d ray = left_E + (right_E - left_E) * (i / 12.0);
      if (ray.norm() > 1e-6) fan.push_back(at(p_E + part * kRange * ray.normalized()));
    }
    canvas.polygon(fan, kDark.found.faded(0.05));
  }
}

void FlightMap::draw_drone(Canvas& canvas, const Moment& now, double yaw) const {
  canvas.circle(at(now.est_p_EB.head<2>()), 6.0, {.color = kDark.estimate, .width = 1.5});
  const Eigen::Vector2d center = now.true_p_EB.head<2>(), ahead = direction(yaw),
                        right{-ahead.y(), ahead.x()};
  const auto point = [&](double along_px, double across_px) {
    return at(center + (along_px * ahead + across_px * right) / scale_);
  };
  const std::array<Eigen::Vector2d, 4> arrow{point(13, 0), point(-8, 8), point(-4, 0),
                                             point(-8, -8)};
  canvas.outline(arrow, {.color = kDark.page, .width = 4.0});
  canvas.polygon(arrow, kDark.ink);
}

void FlightMap::draw_legend(Canvas& canvas, const Eigen::Vector2d& at_px) const {
  Eigen::Vector2d pen = at_px;
  const auto name = [&](const std::string& text) {
    const Lettering lettering{.color = kDark.muted, .size = 12};
    canvas.text(pen + Eigen::Vector2d{0, 4}, text, lettering);
    pen.x() += canvas.text_width(text, lettering) + 20;
  };
  const auto sample = [&](const Stroke& stroke, const std::string& text) {
    canvas.line(pen, pen + Eigen::Vector2d{26, 0}, stroke);
    pen.x() += 34;
    name(text);
  };
  for (int i = 0; i < 40; ++i)
    canvas.fill({.x = pen.x() + i, .y = pen.y() - 1.5, .width = 1.5, .height = 3.0},
                color_of_speed(fast_ * i / 39.0));
  pen.x() += 48;
  name("flown, 0 to " + fixed(fast_, 1) + " m/s");
  sample({.color = kDark.estimate, .width = 1.5}, "pilot's estimate");
  sample({.color = kDark.plan, .width = 1.3, .dash = 5.0}, "plan");
  sample({.color = kDark.gate_solid, .width = 4.5}, "gate");
}

}  // namespace gatefly::io
