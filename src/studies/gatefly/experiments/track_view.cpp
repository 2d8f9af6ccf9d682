// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/track_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTurn = 30.0 * kDegree, kTilt = 40.0 * kDegree;  // of the eye

/// Parallel projection: the figure's axes are x to the right and -y up, as the paper draws them.
Vector2d seen(const Vector3d& p) {
  const Vector3d figure{p.x(), -p.y(), -p.z()};
  const auto [st, ct] = sincos(kTurn);
  const double right = ct * figure.x() - st * figure.y(), away = st * figure.x() + ct * figure.y();
  const auto [se, ce] = sincos(kTilt);
  return {right, -(se * away + ce * figure.z())};
}

/// Scale and shift into a box.
struct Projection {
  Vector2d offset{0, 0};
  double scale = 1.0;

  [[nodiscard]] Vector2d operator()(const Vector3d& p) const { return offset + scale * seen(p); }
};

std::array<Vector3d, 4> floor_corners(const Vector2d& center, const Vector2d& size,
                                      double heading) {
  std::array<Vector3d, 4> corners;
  constexpr std::array<double, 4> kX{-1, 1, 1, -1}, kY{-1, -1, 1, 1};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3d off{0.5 * kX[i] * size.x(), 0.5 * kY[i] * size.y(), 0.0};
    corners[i] = Vector3d{center.x(), center.y(), 0.0} + rotation_z(heading) * off;
  }
  return corners;
}

Projection fitted(const drawing::Box& box, const Track& track) {
  Vector2d low{1e9, 1e9}, high{-1e9, -1e9};
  for (const Vector3d& corner : floor_corners(track.room_center, track.room_size, 0.0))
    for (const double height : {0.0, 2.5}) {
      const Vector2d at = seen(corner - Vector3d{0, 0, height});
      low = low.cwiseMin(at), high = high.cwiseMax(at);
    }
  const Vector2d size = high - low;
  Projection projection;
  projection.scale = std::min(box.width / size.x(), box.height / size.y());
  projection.offset = Vector2d{box.x + 0.5 * box.width, box.y + 0.5 * box.height} -
                      projection.scale * 0.5 * (low + high);
  return projection;
}

void draw_box(drawing::Canvas& canvas, const Projection& at, const MapObstacle& solid) {
  const auto floor = floor_corners(solid.center, solid.size, solid.heading);
  std::array<Vector2d, 4> low, high;
  for (std::size_t i = 0; i < 4; ++i) {
    low[i] = at(floor[i]);
    high[i] = at(floor[i] - Vector3d{0, 0, solid.height});
  }
  const drawing::Stroke stroke{.color = drawing::kLight.solid, .width = 1.0};
  canvas.polygon(high, drawing::kLight.solid.faded(0.35));
  canvas.outline(low, stroke), canvas.outline(high, stroke);
  for (std::size_t i = 0; i < 4; ++i) canvas.line(low[i], high[i], stroke);
}

void draw_gate(drawing::Canvas& canvas, const Projection& at, const MapGate& gate, int number) {
  const Eigen::Matrix3d R = rotation_z(gate.yaw_EG);
  const double h = 0.5 * gate.side;
  std::array<Vector2d, 4> frame;
  constexpr std::array<double, 4> kY{-1, 1, 1, -1}, kZ{-1, -1, 1, 1};
  for (std::size_t i = 0; i < 4; ++i)
    frame[i] = at(gate.p_EG + R * Vector3d{0, kY[i] * h, kZ[i] * h});
  canvas.outline(frame, {.color = drawing::kLight.gate_solid, .width = 3.0});
  const Vector3d foot{gate.p_EG.x(), gate.p_EG.y(), 0.0};
  canvas.line(at(gate.p_EG + Vector3d{0, 0, h}), at(foot),
              {.color = drawing::kLight.gate_solid, .width = 1.5});
  canvas.text(
      at(gate.p_EG - Vector3d{0, 0, h}) + Vector2d{0, -6}, "G" + std::to_string(number),
      {.color = drawing::kLight.gate, .size = 15, .align = drawing::Align::kCenter, .bold = true});
}

}  // namespace

void draw_track_3d(drawing::Canvas& canvas, const drawing::Box& box, const Track& track,
                   const std::vector<Trajectory>& flown) {
  const Projection at = fitted(box, track);
  std::array<Vector2d, 4> room;
  const auto corners = floor_corners(track.room_center, track.room_size, 0.0);
  for (std::size_t i = 0; i < 4; ++i) room[i] = at(corners[i]);
  canvas.polygon(room, drawing::kLight.well);
  canvas.outline(room, {.color = drawing::kLight.rule, .width = 1.0});
  for (const MapObstacle& solid : track.obstacles) draw_box(canvas, at, solid);
  for (const Trajectory& way : flown) {
    std::vector<Vector2d> floor, air;
    for (const Vector3d& p : way.points) {
      floor.push_back(at({p.x(), p.y(), 0.0}));
      air.push_back(at(p));
    }
    canvas.polyline(floor, {.color = way.color.faded(0.15), .width = 1.0});
    canvas.polyline(air, {.color = way.color.faded(0.85), .width = 1.8});
  }
  for (std::size_t i = 0; i < track.gates.size(); ++i)
    draw_gate(canvas, at, track.gates[i], static_cast<int>(i + 1));
}

}  // namespace gatefly::experiments
