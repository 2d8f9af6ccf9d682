// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/course_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::drawing {
namespace {

using Eigen::Vector2d;

constexpr double kLongSide = 900.0, kShortest = 360.0, kMargin = 28.0, kHead = 34.0;  // [px]
constexpr double kFullHeight = 2.2;  // obstacles as high as this are drawn strongest [m]

Vector2d ahead(double heading) {
  const auto [s, c] = sincos(heading);
  return {c, s};
}
Vector2d right_of(const Vector2d& direction) { return {-direction.y(), direction.x()}; }

std::array<Vector2d, 4> rectangle(const Vector2d& center, const Vector2d& size, double heading) {
  const Vector2d along = 0.5 * size.x() * ahead(heading);
  const Vector2d across = 0.5 * size.y() * right_of(ahead(heading));
  return {center - along - across, center + along - across, center + along + across,
          center - along + across};
}

}  // namespace

Course course_of(const Track& track, const Color& gate) {
  Course course{
      .room_center = track.room_center, .room_size = track.room_size, .solids = {}, .gates = {}};
  for (const MapObstacle& obstacle : track.obstacles) course.solids.push_back({obstacle, false});
  for (const MapGate& each : track.gates) course.gates.push_back({each, gate});
  return course;
}

CourseMap::CourseMap(const Box& area, Course course, const Palette& palette)
    : course_{std::move(course)},
      palette_{palette},
      scale_{std::min(area.width / course_.room_size.y(), area.height / course_.room_size.x())},
      middle_{area.x + 0.5 * area.width, area.y + 0.5 * area.height} {
  for (const Course::Gate& each : course_.gates)
    tells_heights_ |= std::abs(each.gate.p_EG.z() - course_.gates[0].gate.p_EG.z()) > 0.25;
}

Vector2d CourseMap::at(const Vector2d& p_E) const {
  const Vector2d from_middle = p_E - course_.room_center;
  return middle_ + scale_ * Vector2d{from_middle.y(), -from_middle.x()};
}

void CourseMap::draw_arrow(Canvas& canvas, const Vector2d& p_E, const Vector2d& direction,
                           double length, const Color& color) const {
  const Vector2d tip = length / scale_ * direction, side = 0.4 * right_of(tip);
  canvas.polygon(std::array<Vector2d, 3>{at(p_E + tip), at(p_E + side), at(p_E - side)}, color);
}

void CourseMap::draw_solid(Canvas& canvas, const Course::Solid& solid) const {
  const MapObstacle& box = solid.box;
  const double strength = 0.35 + 0.65 * std::clamp(box.height / kFullHeight, 0.0, 1.0);
  const Color color = palette_.solid.faded(strength);
  if (solid.round) {
    canvas.disc(at(box.center), 0.5 * scale_ * box.size.x(), color);
    return;
  }
  auto shape = rectangle(box.center, box.size, box.heading);
  for (Vector2d& corner : shape) corner = at(corner);
  canvas.polygon(shape, color);
  canvas.outline(shape, {.color = palette_.rule, .width = 1.0});
}

void CourseMap::draw_floor(Canvas& canvas) const {
  auto room = rectangle(course_.room_center, course_.room_size, 0.0);
  for (Vector2d& corner : room) corner = at(corner);
  canvas.polygon(room, palette_.well);
  for (const Course::Solid& solid : course_.solids) draw_solid(canvas, solid);
  canvas.outline(room, {.color = palette_.rule, .width = 2.0});
}

void CourseMap::draw_way(Canvas& canvas, const Path& path, const Stroke& stroke,
                         double arrow) const {
  std::vector<Vector2d> points;
  const int steps = std::max(1, static_cast<int>(std::ceil(path.length() / 0.05)));
  for (int i = 0; i <= steps; ++i)
    points.push_back(at(path.at(path.length() * i / steps).position));
  canvas.polyline(points, stroke);
  if (arrow <= 0.0) return;
  const PathPoint middle = path.at(0.5 * path.length());
  draw_arrow(canvas, middle.position, ahead(middle.heading), arrow, stroke.color);
}

void CourseMap::draw_start(Canvas& canvas, const Vector2d& p_E) const {
  canvas.disc(at(p_E), 4.0, palette_.ink);
  canvas.circle(at(p_E), 8.0, {.color = palette_.ink, .width = 1.4});
  canvas.text(at(p_E) + Vector2d{0, 24}, "start",
              {.color = palette_.muted, .size = 13, .align = Align::kCenter});
}

void CourseMap::draw_gate(Canvas& canvas, std::size_t index, const Color& color) const {
  const MapGate& gate = course_.gates[index].gate;
  const Vector2d center = gate.p_EG.head<2>(), direction = ahead(gate.yaw_EG),
                 right = right_of(direction);
  const double bar = std::max(0.5 * gate.side, 9.0 / scale_);
  draw_arrow(canvas, center, direction, 16.0, color);
  canvas.line(at(center - bar * right), at(center + bar * right), {.color = color, .width = 5.0});
  const Vector2d beside = at(center + (bar + 14.0 / scale_) * right) + Vector2d{0, 5};
  canvas.text(beside, std::to_string(index + 1),
              {.color = color, .size = 16, .align = Align::kCenter, .bold = true});
  if (!tells_heights_) return;
  // Away from the gate.
  const Vector2d out = (at(center + right) - at(center)).normalized();
  const bool aside = std::abs(out.x()) > 0.5;
  const Vector2d more = aside ? Vector2d{out.x() > 0.0 ? 9.0 : -9.0, 0.0}
                              : Vector2d{0.0, out.y() > 0.0 ? 16.0 : -16.0};
  canvas.text(beside + more, files::fixed(-gate.p_EG.z(), 1) + " m",
              {.color = palette_.muted,
               .size = 13,
               .align = !aside          ? Align::kCenter
                        : out.x() > 0.0 ? Align::kLeft
                                        : Align::kRight});
}

void CourseMap::draw_gates(Canvas& canvas) const {
  for (std::size_t i = 0; i < course_.gates.size(); ++i)
    draw_gate(canvas, i, course_.gates[i].color);
}

void CourseMap::draw_scale(Canvas& canvas) const {
  double metres = 1.0;
  while (metres * scale_ < 25.0) metres *= 10.0;
  const Vector2d from = at(course_.room_center - 0.5 * course_.room_size) + Vector2d{12.0, -12.0};
  canvas.line(from, from + Vector2d{metres * scale_, 0}, {.color = palette_.muted, .width = 2.0});
  canvas.text(from + Vector2d{metres * scale_ + 8, 5},
              std::to_string(std::lround(metres)) + " m, north up",
              {.color = palette_.muted, .size = 13});
}

Canvas drawn_course(const Track& track, const RacePlan* plan, const std::string& title) {
  const double scale = kLongSide / track.room_size.maxCoeff();
  const auto pixels = [&](double metres, double more) {
    return static_cast<int>(std::lround(std::max(kShortest, metres * scale) + more));
  };
  Canvas canvas(pixels(track.room_size.y(), 2 * kMargin),
                pixels(track.room_size.x(), 2 * kMargin + kHead));
  const Box area{.x = kMargin,
                 .y = kMargin + kHead,
                 .width = canvas.width() - 2 * kMargin,
                 .height = canvas.height() - 2 * kMargin - kHead};
  const CourseMap map(area, course_of(track, kLight.gate), kLight);
  canvas.text({kMargin, kHead}, title, {.size = 15, .bold = true});
  map.draw_floor(canvas);
  if (plan != nullptr) {
    const Stroke way{.color = kLight.flown, .width = 1.8};
    map.draw_way(canvas, plan->start, way, 11.0);
    for (const Path& leg : plan->legs) map.draw_way(canvas, leg, way, 11.0);
  }
  map.draw_start(canvas, track.start);
  map.draw_gates(canvas);
  map.draw_scale(canvas);
  return canvas;
}

}  // namespace gatefly::drawing
