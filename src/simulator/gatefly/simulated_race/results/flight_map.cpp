// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/flight_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "gatefly/files/text.hpp"

namespace gatefly::simulated_race {
namespace {

constexpr double kRange = 4.0;  // of the camera's view as drawn [m]

Eigen::Vector2d direction(double heading) { return {std::cos(heading), std::sin(heading)}; }

drawing::Color between(const drawing::Color& a, const drawing::Color& b, double part) {
  return {a.r + part * (b.r - a.r), a.g + part * (b.g - a.g), a.b + part * (b.b - a.b)};
}

}  // namespace

drawing::Color color_of(const world::WorldGate& gate) {
  const Eigen::Vector3d c = gate.color / std::max(1e-6, gate.color.maxCoeff());
  const auto coded = [](double linear) {  // sRGB
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
  };
  return {coded(c.x()), coded(c.y()), coded(c.z())};
}

drawing::Course course_of(const world::World& world) {
  drawing::Course course{.room_center = world.room_center,
                         .room_size = world.room_size.head<2>(),
                         .solids = {},
                         .gates = {}};
  for (const world::WorldBox& box : world.obstacles)
    course.solids.push_back(
        {{.center = box.center, .size = box.size, .heading = box.heading, .height = box.top},
         box.pole});
  for (const world::WorldGate& gate : world.gates)
    course.gates.push_back(
        {{.p_EG = gate.p_EG, .yaw_EG = gate.yaw_EG, .side = gate.side, .bar = gate.bar},
         color_of(gate)});
  return course;
}

FlightMap::FlightMap(const drawing::Box& area, const RaceConfig& race)
    : map_{area, course_of(race.sim.world), drawing::kDark}, fast_{1.4 * race.pilot.plan.speed} {}

drawing::Color FlightMap::color_of_speed(double speed) const {
  const double part = std::clamp(speed / fast_, 0.0, 1.0);
  return part < 0.6 ? between(drawing::kDark.slow, drawing::kDark.flown, part / 0.6)
                    : between(drawing::kDark.flown, drawing::kDark.fast, (part - 0.6) / 0.4);
}

void FlightMap::draw_course(drawing::Canvas& canvas, const RacePlan& plan) const {
  map_.draw_floor(canvas);
  const drawing::Stroke way{.color = drawing::kDark.plan, .width = 1.4, .dash = 5.0};
  map_.draw_way(canvas, plan.start, way, 0.0);
  for (const Path& leg : plan.legs) map_.draw_way(canvas, leg, way, 0.0);
  map_.draw_start(canvas, plan.start.at(0.0).position);
  map_.draw_gates(canvas);
  map_.draw_scale(canvas);
}

void FlightMap::draw_flown(drawing::Canvas& canvas, const Moment& from, const Moment& to,
                           double strength) const {
  // Darker, not translucent: translucent pieces show their overlapping ends as beads.
  canvas.line(at(from.true_p_EB.head<2>()), at(to.true_p_EB.head<2>()),
              {.color = between(drawing::kDark.well, color_of_speed(to.true_speed), strength),
               .width = 3.5});
}

void FlightMap::draw_estimate(drawing::Canvas& canvas, const Moment& from, const Moment& to) const {
  canvas.line(at(from.est_p_EB.head<2>()), at(to.est_p_EB.head<2>()),
              {.color = between(drawing::kDark.well, drawing::kDark.estimate, 0.75), .width = 1.1});
}

void FlightMap::draw_target(drawing::Canvas& canvas, int gate) const {
  const auto& gates = map_.course().gates;
  if (gate < 0 || static_cast<std::size_t>(gate) >= gates.size()) return;
  const auto index = static_cast<std::size_t>(gate);
  const drawing::Color& color = gates[index].color;
  canvas.disc(at(gates[index].gate.p_EG.head<2>()), 32.0, color.faded(0.2));
  map_.draw_gate(canvas, index, between(color, {1, 1, 1}, 0.35));
}

void FlightMap::draw_view(drawing::Canvas& canvas, const Eigen::Vector2d& p_E,
                          const Eigen::Vector2d& left_E, const Eigen::Vector2d& right_E) const {
  for (const double part : {0.4, 0.7, 1.0}) {  // fades with distance
    std::vector<Eigen::Vector2d> fan{at(p_E)};
    for (int i = 0; i <= 12; ++i) {
      const Eigen::Vector2d ray = left_E + (right_E - left_E) * (i / 12.0);
      if (ray.norm() > 1e-6) fan.push_back(at(p_E + part * kRange * ray.normalized()));
    }
    canvas.polygon(fan, drawing::kDark.found.faded(0.05));
  }
}

void FlightMap::draw_drone(drawing::Canvas& canvas, const Moment& now, double yaw) const {
  canvas.circle(at(now.est_p_EB.head<2>()), 6.0, {.color = drawing::kDark.estimate, .width = 1.5});
  const Eigen::Vector2d center = now.true_p_EB.head<2>(), ahead = direction(yaw),
                        right{-ahead.y(), ahead.x()};
  const auto point = [&](double along_px, double across_px) {
    return at(center + (along_px * ahead + across_px * right) / map_.scale());
  };
  const std::array<Eigen::Vector2d, 4> arrow{point(13, 0), point(-8, 8), point(-4, 0),
                                             point(-8, -8)};
  canvas.outline(arrow, {.color = drawing::kDark.page, .width = 4.0});
  canvas.polygon(arrow, drawing::kDark.ink);
}

void FlightMap::draw_contact(drawing::Canvas& canvas, const Moment& here) const {
  const Eigen::Vector2d middle = at(here.true_p_EB.head<2>());
  for (const auto& [color, width] :
       {std::pair{drawing::kDark.page, 9.0}, std::pair{drawing::kDark.bad, 5.0}})
    for (const double slope : {1.0, -1.0}) {
      const Eigen::Vector2d arm{13.0, 13.0 * slope};
      canvas.line(middle - arm, middle + arm, {.color = color, .width = width});
    }
}

void FlightMap::draw_legend(drawing::Canvas& canvas, const Eigen::Vector2d& at_px) const {
  Eigen::Vector2d pen = at_px;
  const auto name = [&](const std::string& text) {
    const drawing::Lettering lettering{.color = drawing::kDark.muted, .size = 14};
    canvas.text(pen + Eigen::Vector2d{0, 4}, text, lettering);
    pen.x() += canvas.text_width(text, lettering) + 20;
  };
  const auto sample = [&](const drawing::Stroke& stroke, const std::string& text) {
    canvas.line(pen, pen + Eigen::Vector2d{26, 0}, stroke);
    pen.x() += 34;
    name(text);
  };
  for (int i = 0; i < 40; ++i)
    canvas.fill({.x = pen.x() + i, .y = pen.y() - 1.5, .width = 1.5, .height = 3.0},
                color_of_speed(fast_ * i / 39.0));
  pen.x() += 48;
  name("flown, 0 to " + files::fixed(fast_, 1) + " m/s");
  sample({.color = drawing::kDark.estimate, .width = 1.5}, "pilot's estimate");
  sample({.color = drawing::kDark.plan, .width = 1.3, .dash = 5.0}, "plan");
}

}  // namespace gatefly::simulated_race
