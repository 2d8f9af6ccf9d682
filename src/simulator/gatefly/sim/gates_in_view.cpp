// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/gates_in_view.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/exposure.hpp"

namespace gatefly::sim {
namespace {

constexpr double kEdgeOn = 0.2;  // seen at less than this much depth its frame is a line [m]
// a gate of 1 m at pose.max_distance_m: farther ones are not used [px]
constexpr double kMinSide = 20.0;
constexpr double kMaxAspect = 1.8;  // seen more from the side no statistics were taken
// part of the picture's height that shows a bar [Li18 flight code: 0.28]
constexpr double kMinBar = 0.35;
constexpr double kMinGap = 40.0;  // between two bars: the same [px]
constexpr int kBarSamples = 12;

/// Middle of the part of an upright bar that is in the picture; nullopt when that is short.
std::optional<Eigen::Vector2d> bar_in_view(Exposure& exposure, const Eigen::Vector3d& middle_E,
                                           double side) {
  Eigen::Vector2d sum{0, 0};
  double low = 1e9, high = -1e9;
  int count = 0;
  for (int i = 0; i < kBarSamples; ++i) {
    const double z = side * ((i + 0.5) / kBarSamples - 0.5);
    const auto px = exposure.project(middle_E + Eigen::Vector3d{0, 0, z});
    if (!px || !exposure.inside(*px)) continue;
    sum += *px, ++count;
    low = std::min(low, px->y()), high = std::max(high, px->y());
  }
  if (count == 0 || high - low < kMinBar * exposure.height()) return std::nullopt;
  return Eigen::Vector2d{sum / count};
}

/// Nothing solid between camera and a corner, but the gate's own bars around it.
bool in_sight(const Sight& sight, const Eigen::Vector3d& eye_E, const Eigen::Vector3d& corner_E) {
  return !sight.occluded(eye_E, corner_E + 0.12 * (eye_E - corner_E).normalized());
}

std::optional<GateView> view_of(const world::WorldGate& gate, const Sight& sight,
                                Exposure& exposure) {
  GateView view;
  view.corners_px.fill(Eigen::Vector2d::Zero());  // of those behind the camera, too
  const Eigen::Matrix3d R_EG = rotation_z(gate.yaw_EG);
  const Eigen::Vector3d eye_E = exposure.eye_E(), to_gate = gate.p_EG - eye_E;
  view.distance = to_gate.norm();
  const double depth = R_EG.col(0).dot(to_gate);
  if (std::abs(depth) < kEdgeOn) return std::nullopt;
  const double right = depth > 0.0 ? 0.5 : -0.5;  // from behind left is right
  const double ahead = near_face(gate.side, gate.bar, gate.depth);
  // Seen so much from the side that its own boards hide the middle of its edge, a corner is no corner.
  const Eigen::Vector3d to_middle_E = std::copysign(ahead, depth) * R_EG.col(0),
                        face_E = gate.p_EG - to_middle_E;
  auto corners_G = gate_corners_G(1.0);
  if (depth < 0.0) std::swap(corners_G[0], corners_G[1]), std::swap(corners_G[2], corners_G[3]);
  // In the frame of who flies through it this way.
  Eigen::Matrix3d R_EF = R_EG;
  if (depth < 0.0) R_EF.leftCols<2>() *= -1.0;
  const Eigen::Vector3d eye_F = -R_EF.transpose() * to_gate;
  const auto shift_E = [&](double side, std::size_t i, CornerOf of) -> Eigen::Vector3d {
    return R_EF * outline_shift_G(side * gate_corners_G(1.0)[i], eye_F, ahead, of);
  };
  std::array<bool, 4> seen{}, above{};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d corner_E = face_E + gate.side * (R_EG * corners_G[i]);
    const auto px = exposure.project(corner_E + shift_E(gate.side, i, CornerOf::kFrame));
    if (!px) continue;
    view.corners_px[i] = *px, view.drawn[i] = true;
    above[i] = px->y() < 0.0;
    seen[i] = exposure.inside(*px) && in_sight(sight, eye_E, corner_E + to_middle_E);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const double inner = gate.side - 2.0 * gate.bar;
    const Eigen::Vector3d inner_E = face_E + inner * (R_EG * corners_G[i]);
    const auto px = exposure.project(inner_E + shift_E(inner, i, CornerOf::kOpening));
    view.inner_seen[i] =
        px && exposure.inside(*px) && in_sight(sight, eye_E, inner_E + to_middle_E);
  }
  view.side_px = exposure.px_per_radian() * gate.side / view.distance;
  view.seen = seen;
  view.whole = seen[0] && seen[1] && seen[2] && seen[3];
  view.only_lower_corners = above[0] && above[1] && seen[2] && seen[3];
  const Eigen::Vector3d aside = (gate.side - gate.bar) * right * R_EG.col(1);
  const auto left_bar = bar_in_view(exposure, face_E - aside, gate.side),
             right_bar = bar_in_view(exposure, face_E + aside, gate.side);
  if (left_bar && right_bar && right_bar->x() - left_bar->x() > kMinGap)
    view.bars_px = {*left_bar, *right_bar};
  return view;
}

}  // namespace

std::vector<GateView> gates_in_view(const world::World& world, const world::CameraTruth& camera,
                                    const Sight& sight, double t_start,
                                    std::span<const BodyPose> history) {
  Exposure exposure{camera, t_start, history};
  std::vector<GateView> views;
  for (std::size_t i = 0; i < world.gates.size(); ++i) {
    const world::WorldGate& gate = world.gates[i];
    auto view = gate.missing ? std::nullopt : view_of(gate, sight, exposure);
    if (!view || (gate.hidden_beyond > 0.0 && view->distance > gate.hidden_beyond)) continue;
    view->gate = static_cast<int>(i);
    views.push_back(*view);
  }
  std::sort(views.begin(), views.end(),
            [](const GateView& a, const GateView& b) { return a.distance < b.distance; });
  return views;
}

int seen_corners(const GateView& view) {
  return static_cast<int>(std::count(view.seen.begin(), view.seen.end(), true));
}

std::optional<CutKind> cut_kind(const std::array<bool, 4>& seen) {
  switch (std::count(seen.begin(), seen.end(), true)) {
    case 2:
      if (seen[0] && seen[1]) return CutKind::kUpper;
      if (seen[2] && seen[3]) return CutKind::kLower;
      return seen[0] == seen[2] ? CutKind::kDiagonal : CutKind::kSide;
    case 3:
      return CutKind::kThree;
    default:
      return std::nullopt;
  }
}

const GateView* largest_of(std::span<const GateView> views) {
  const auto diagonals = [](const GateView& view) {
    const Eigen::Vector2d a = view.corners_px[2] - view.corners_px[0],
                          b = view.corners_px[3] - view.corners_px[1];
    return std::abs(a.x() * b.y() - a.y() * b.x());
  };
  const GateView* largest = nullptr;
  for (const GateView& view : views)
    if (view.whole && detectable(view.corners_px) &&
        (largest == nullptr || diagonals(view) > diagonals(*largest)))
      largest = &view;
  return largest;
}

bool detectable(const std::array<Eigen::Vector2d, 4>& corners) {
  double shortest = 1e9, longest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double side = (corners[(i + 1) % 4] - corners[i]).norm();
    shortest = std::min(shortest, side), longest = std::max(longest, side);
  }
  return shortest >= kMinSide && longest <= kMaxAspect * shortest;
}

}  // namespace gatefly::sim
