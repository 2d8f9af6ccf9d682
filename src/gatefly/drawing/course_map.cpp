// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/course_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "gatefly/geometry/math.hpp"

namespace gatefly::io {
namespace {

using Eigen::Vector2d;

constexpr double kLongSide = 900.0, kShortest = 360.0, kMargin = 28.0, kHead = 34.0;  // [px]
constexpr double kFullHeight = 2.2;  // obstacles as high as this are drawn strongest [m]

Vector2d ahead(double heading) {
  const auto [s, c] = sincos(heading);
  return {c, s};
}
Vector2d right_of(const Vector2d& direction) { return {-direction.y(), direction.x()}; }

class CourseMap {
 public:
  CourseMap(const Track& track, const std::string& title)
      : track_{track},
        scale_{kLongSide / track.room_size.maxCoeff()},
        canvas_{width(track.room_size.y()), height(track.room_size.x())},
        middle_{0.5 * canvas_.width(), 0.5 * (canvas_.height() + kHead)} {
    canvas_.text({kMargin, kHead}, title, {.size = 15, .bold = true});
  }

  Canvas drawn(const RacePlan* plan) && {
    draw_room();
    for (const MapObstacle& obstacle : track_.obstacles) draw_obstacle(obstacle);
    if (plan != nullptr) {
      draw_way(plan->start);
      for (const Path& leg : plan->legs) draw_way(leg);
    }
    draw_start();
    for (std::size_t i = 0; i < track_.gates.size(); ++i) draw_gate(i);
    draw_scale();
    return std::move(canvas_);
  }

 private:
  [[nodiscard]] int pixels(double metres, double more) const {
    return static_cast<int>(std::lround(std::max(kShortest, metres * scale_) + more));
  }
  [[nodiscard]] int width(double east) const { return pixels(east, 2 * kMargin); }
  [[nodiscard]] int height(double north) const { return pixels(north, 2 * kMargin + kHead); }

  [[nodiscard]] Vector2d at(const Vector2d& p_E) const {
    const Vector2d from_middle = p_E - track_.room_center;
    return middle_ + scale_ * Vector2d{from_middle.y(), -from_middle.x()};
  }

  [[nodiscard]] std::array<Vector2d, 4> rectangle(const Vector2d& center, const Vector2d& size,
                                                  double heading) const {
    const Vector2d along = 0.5 * size.x() * ahead(heading);
    const Vector2d across = 0.5 * size.y() * right_of(ahead(heading));
    return {at(center - along - across), at(center + along - across), at(center + along + across),
            at(center - along + across)};
  }

  /// A tip of so many pixels that points along `direction` on the floor.
  void draw_arrow(const Vector2d& p_E, const Vector2d& direction, double length,
                  const Color& color) {
    const Vector2d tip = length / scale_ * direction, side = 0.4 * right_of(tip);
    canvas_.polygon(std::array<Vector2d, 3>{at(p_E + tip), at(p_E + side), at(p_E - side)}, color);
  }

  void draw_room() {
    const auto room = rectangle(track_.room_center, track_.room_size, 0.0);
    canvas_.polygon(room, kLight.panel);
    canvas_.outline(room, {.color = kLight.rule, .width = 2.0});
  }

  void draw_obstacle(const MapObstacle& obstacle) {
    const double strength = std::clamp(obstacle.height / kFullHeight, 0.0, 1.0);
    const auto shape = rectangle(obstacle.center, obstacle.size, obstacle.heading);
    canvas_.polygon(shape, kLight.solid.faded(0.35 + 0.65 * strength));
    canvas_.outline(shape, {.color = kLight.rule, .width = 1.0});
  }

  void draw_way(const Path& path) {
    std::vector<Vector2d> points;
    const int steps = std::max(1, static_cast<int>(std::ceil(path.length() / 0.05)));
    for (int i = 0; i <= steps; ++i)
      points.push_back(at(path.at(path.length() * i / steps).position));
    canvas_.polyline(points, {.color = kLight.flown, .width = 1.8});
    const PathPoint middle = path.at(0.5 * path.length());
    draw_arrow(middle.position, ahead(middle.heading), 11.0, kLight.flown);
  }

  void draw_start() {
    const Color color = kLight.ink;
    canvas_.disc(at(track_.start), 5.0, color);
    canvas_.circle(at(track_.start), 9.0, {.color = color, .width = 1.2});
    const Vector2d direction = ahead(track_.start_heading);
    canvas_.text(at(track_.start - 24.0 / scale_ * direction) + Vector2d{0, 4}, "start",
                 {.color = color, .size = 12, .align = Align::kCenter});
  }

  void draw_gate(std::size_t index) {
    const MapGate& gate = track_.gates[index];
    const Vector2d center = gate.p_EG.head<2>(), direction = ahead(gate.yaw_EG),
                   right = right_of(direction);
    const double bar = std::max(0.5 * gate.side, 9.0 / scale_);
    draw_arrow(center, direction, 16.0, kLight.gate_solid);
    canvas_.line(at(center - bar * right), at(center + bar * right),
                 {.color = kLight.gate_solid, .width = 4.5});
    canvas_.text(at(center + (bar + 13.0 / scale_) * right) + Vector2d{0, 5},
                 std::to_string(index + 1),
                 {.color = kLight.gate_solid, .size = 15, .align = Align::kCenter, .bold = true});
  }

  void draw_scale() {
    double metres = 1.0;
    while (metres * scale_ < 25.0) metres *= 10.0;
    const Vector2d from{kMargin + 10.0, canvas_.height() - kMargin - 12.0};
    const Stroke stroke{.color = kLight.muted, .width = 2.0};
    canvas_.line(from, from + Vector2d{metres * scale_, 0}, stroke);
    canvas_.text(from + Vector2d{metres * scale_ + 8, 4},
                 std::to_string(std::lround(metres)) + " m, north up",
                 {.color = kLight.muted, .size = 12});
  }

  const Track& track_;
  double scale_;
  Canvas canvas_;
  Vector2d middle_;
};

}  // namespace

Canvas drawn_course(const Track& track, const RacePlan* plan, const std::string& title) {
  return CourseMap{track, title}.drawn(plan);
}

}  // namespace gatefly::io
