// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/way_round.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gatefly/geometry/math.hpp"
#include "gatefly/race/room_grid.hpp"

namespace gatefly {
namespace {

constexpr double kSteepest = 0.7;     // metres up or down a metre of way, else at a stop
constexpr double kWidest = 3.0;       // radius of a rounded corner, or as speed needs [m]
constexpr double kKeptRunOut = 0.15;  // of the straight behind a gate, when a corner is rounded [m]
constexpr double kKeptRunIn = 1.0;    // and before one [m]
constexpr double kStopSeconds = 4.0;  // what a stop costs

double heading_of(const Eigen::Vector2d& way) { return atan2(way.y(), way.x()); }

std::string metres(double value) {
  std::string text = std::to_string(std::round(value * 100.0) / 100.0);
  return text.substr(0, text.find('.') + 3) + " m";
}

/// A corner of a way of straight pieces; where one arrives at another height than one leaves, one
/// stops.
struct Corner {
  Eigen::Vector2d p{0, 0};
  double z_arrive = 0.0, z_leave = 0.0;
};

/// Leaves out what need not be touched on the way.
Polyline pulled_taut(const Polyline& line, const RoomGrid& grid, double least) {
  Polyline taut{line.front()};
  // At most once a point of the line.
  for (std::size_t i = 0; i + 1 < line.size();) {
    std::size_t next = line.size() - 1;
    // At most once a point of the line.
    while (next > i + 1 && !grid.is_free(line[i], line[next], least)) --next;
    taut.push_back(line[next]);
    i = next;
  }
  return taut;
}

/// Steep pieces become level ones: the height is changed at the end that has the room for it.
std::vector<Corner> with_level_pieces(const Polyline& line, const RoomGrid& grid, double least) {
  constexpr double kSamePlace = 0.05;  // [m]
  std::vector<Corner> corners{{line[0].head<2>(), line[0].z(), line[0].z()}};
  for (std::size_t i = 1; i < line.size(); ++i) {
    Corner& last = corners.back();
    const Eigen::Vector2d p = line[i].head<2>();
    const double way = (p - last.p).norm(), z = line[i].z();
    if (way < kSamePlace) {
      last.z_leave = z;
      continue;
    }
    Corner next{p, z, z};
    if (std::abs(z - last.z_leave) > kSteepest * way) {
      const Eigen::Vector3d here{last.p.x(), last.p.y(), z};
      const bool at_once = corners.size() > 1 && grid.is_free(here, line[i], least);
      (at_once ? last.z_leave : next.z_arrive) = at_once ? z : last.z_leave;
    }
    corners.push_back(next);
  }
  return corners;
}

/// The path along these corners, each rounded by the widest arc that `wideness` of its pieces
/// leaves room for, else a stop; nullopt: it has too many.
std::optional<Path> path_along(const std::vector<Corner>& corners, const LegEnd& from,
                               double wideness, const PlanParams& params) {
  Path path;
  bool fits = true;
  const double widest = std::max(kWidest, widest_radius(params));
  const std::size_t pieces = corners.size() - 1;
  const auto length = [&](std::size_t i) { return (corners[i + 1].p - corners[i].p).norm(); };
  const auto heading = [&](std::size_t i) { return heading_of(corners[i + 1].p - corners[i].p); };
  // Length of a piece that an arc at one of its ends may use.
  const auto usable = [&](std::size_t i) {
    if (i == 0 && from.gate >= 0) return std::max(0.0, length(i) - kKeptRunOut);
    if (i + 1 == pieces) return std::max(0.0, length(i) - kKeptRunIn);
    return 0.5 * length(i);
  };
  const auto stop_at = [&](double s, double leave_heading, const Corner& corner) {
    fits = fits && path.stops.push_back({s, leave_heading, corner.z_leave}) &&
           path.levels.push_back({s, corner.z_leave});
  };

  double s = 0.0, used = 0.0;  // so far along the path; of the next piece, by the arc before it
  fits = path.levels.push_back({0.0, corners[0].z_arrive});
  const bool turns_first = std::abs(wrap_angle(heading(0) - from.heading)) > 5.0 * kDegree;
  if (from.gate < 0 && (turns_first || corners[0].z_arrive != corners[0].z_leave))
    stop_at(0.0, heading(0), corners[0]);
  for (std::size_t i = 0; i < pieces; ++i) {
    const bool last = i + 1 == pieces;
    const Corner& corner = corners[i + 1];
    const double turn = last ? 0.0 : wrap_angle(heading(i + 1) - heading(i));
    const auto [half_sine, half_cosine] = sincos(0.5 * turn);
    const double half = std::abs(half_sine) / std::max(half_cosine, 1e-9);  // of the turn: tangent
    const double room = last ? 0.0 : wideness * std::min(usable(i), usable(i + 1));
    const double radius = std::min(widest, room / std::max(half, 1e-9));
    const bool straight_on = half < 1e-6;
    const bool stops = !last && (corner.z_arrive != corner.z_leave ||
                                 (radius < params.min_radius && !straight_on));
    const double tangent = last || stops || straight_on ? 0.0 : radius * half;

    const double straight = length(i) - used - tangent;
    const Eigen::Vector2d along = (corner.p - corners[i].p).normalized();
    const Eigen::Vector2d start = corners[i].p + used * along;
    if (straight > 1e-6) fits = fits && path.segments.push_back({start, heading(i), 0.0, straight});
    s += std::max(0.0, straight);
    if (tangent > 0.0) {
      const Segment arc{corner.p - tangent * along, heading(i), std::copysign(1.0 / radius, turn),
                        radius * std::abs(turn)};
      fits = fits && path.segments.push_back(arc) &&
             path.levels.push_back({s + 0.5 * arc.length, corner.z_arrive});
      s += arc.length;
    } else {
      fits = fits && path.levels.push_back({s, corner.z_arrive});
    }
    if (stops) stop_at(s, heading(i + 1), corner);
    used = tangent;
  }
  if (!fits) return std::nullopt;
  return path;
}

double cost_of(const Path& path, const PlanParams& params) {
  double cost = kStopSeconds * static_cast<double>(path.stops.size());
  for (const Segment& segment : path.segments) {
    cost += segment.length / speed_on(segment, params);
    const double curvature = std::abs(segment.curvature);
    cost += (0.9 * curvature + 0.3) * curvature * segment.length;
  }
  const Segment& last = path.segments.back();
  const double run_in = last.curvature == 0.0 ? last.length : 0.0;
  return cost + 2.0 * std::max(0.0, wanted_run_in(params) - run_in);
}

Eigen::Vector3d along_axis(const LegEnd& end, double distance) {
  const auto [s, c] = sincos(end.heading);
  return end.p_E + distance * Eigen::Vector3d{c, s, 0.0};
}

class WaySearch {
 public:
  WaySearch(const std::vector<MapSolid>& solids, const PlanParams& params, const LegEnd& from,
            const LegEnd& to)
      : solids_{solids}, params_{params}, from_{from}, to_{to} {}

  /// With as much room to spare as leaves a way without stops; else the best with stops.
  std::optional<Path> path(const RoomGrid& grid) const {
    std::optional<Path> best;
    double best_cost = RoomGrid::kNoWay;
    for (const double spare : {0.4, 0.25, 0.1, 0.02}) {
      bool connected = true;  // if two places are not, others as far from everything hardly are
      for (const double run_out : {nearest_to_gate() + spare, 2 * nearest_to_gate() + spare})
        for (const double run_in : {wanted_run_in(params_), 1.6, nearest_to_gate() + spare}) {
          const auto found = connected ? paths(grid, run_out, run_in, spare) : std::nullopt;
          connected = found.has_value();
          for (const Path& path : found.value_or(std::vector<Path>{}))
            if (const double cost = cost_of(path, params_); cost < best_cost)
              best = path, best_cost = cost;
        }
      if (best && best->stops.empty()) break;
    }
    return best;
  }

  /// The gap that is too narrow; nullopt: wide enough, as far as this grid can tell.
  std::optional<std::string> blocked(const RoomGrid& grid) const {
    for (const LegEnd* end : {&from_, &to_}) {
      const Eigen::Vector3d p_E =
          along_axis(*end, end == &from_ ? nearest_to_gate() : -nearest_to_gate());
      if (end->gate >= 0 && grid.margin(p_E) < 0.0) return told(gap_at_gate(*end, p_E));
    }
    const Polyline line = grid.widest(behind_from(nearest_to_gate()), before_to(nearest_to_gate()));
    if (line.empty()) return "what stands between them leaves no gap";
    const Eigen::Vector3d narrowest = *std::min_element(
        line.begin(), line.end(), [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
          return grid.margin(a) < grid.margin(b);
        });
    const Gap gap = grid.gap_at(narrowest);
    if (gap.width >= gap.needed) return std::nullopt;
    return told(gap);
  }

 private:
  /// So far off a gate's middle its own frame leaves room to turn [m].
  [[nodiscard]] double nearest_to_gate() const {
    constexpr double kHalfFrame = 0.05;
    return params_.clearance + params_.body_radius + kHalfFrame + 0.01;
  }
  [[nodiscard]] Eigen::Vector3d behind_from(double run_out) const {
    return from_.gate < 0 ? from_.p_E : along_axis(from_, run_out);
  }
  [[nodiscard]] Eigen::Vector3d before_to(double run_in) const { return along_axis(to_, -run_in); }

  /// The clear ones by way of these two places, none where they are taken; nullopt: nothing connects them.
  [[nodiscard]] std::optional<std::vector<Path>> paths(const RoomGrid& grid, double run_out,
                                                       double run_in, double spare) const {
    const Eigen::Vector3d leave = behind_from(run_out), arrive = before_to(run_in);
    const double least = 0.6 * spare;  // between the grid's places
    if (grid.margin(leave) < least || grid.margin(arrive) < least) return std::vector<Path>{};
    Polyline line = grid.shortest(leave, arrive, spare);
    if (line.empty()) return std::nullopt;
    line.front() = leave, line.back() = arrive;
    line = pulled_taut(line, grid, least);
    if (from_.gate >= 0) line.insert(line.begin(), from_.p_E);
    line.push_back(to_.p_E);
    const std::vector<Corner> corners = with_level_pieces(line, grid, least);
    const double wanted = params_.clearance + params_.body_radius;
    std::vector<Path> clear;
    for (const double wideness : {1.0, 0.7, 0.4, 0.0})
      if (const auto path = path_along(corners, from_, wideness, params_);
          path &&
          nearest_solid(solids_, params_, *path, from_.gate, to_.gate, wanted).distance >= wanted)
        clear.push_back(*path);
    return clear;
  }

  /// The gap between a gate's frame and the thing that stands too near behind or before it.
  [[nodiscard]] Gap gap_at_gate(const LegEnd& end, const Eigen::Vector3d& p_E) const {
    const MapSolid *frame = nullptr, *nearest = nullptr;
    double least = RoomGrid::kNoWay;
    for (const MapSolid& solid : solids_) {
      if (solid.kind == MapSolid::Kind::kGate && solid.number == end.gate) {
        if (frame == nullptr) frame = &solid;
        continue;
      }
      const double near = std::max(solid.beside(p_E.head<2>()), solid.above_or_below(-p_E.z()));
      if (near < least) nearest = &solid, least = near;
    }
    return gap_between(*frame, *nearest, params_);
  }

  static std::string told(const Gap& gap) {
    return "the widest gap, " + gap.between + ", is " + metres(gap.width) + ", " +
           metres(gap.needed - gap.width) + " too narrow";
  }

  const std::vector<MapSolid>& solids_;
  const PlanParams& params_;
  const LegEnd &from_, &to_;
};

}  // namespace

WayRound way_round(const std::vector<MapSolid>& solids, const Track& room, const PlanParams& params,
                   const LegEnd& from, const LegEnd& to) {
  const WaySearch search{solids, params, from, to};
  // At most twice.
  for (double step = 0.2;; step *= 0.5) {
    const RoomGrid grid{solids, room, params, step};
    if (auto path = search.path(grid)) return {std::move(path), ""};
    const auto blocked = search.blocked(grid);
    if (blocked) return {std::nullopt, *blocked};
    if (step <= 0.1) return {std::nullopt, "there is no room to turn"};
  }
}

}  // namespace gatefly
