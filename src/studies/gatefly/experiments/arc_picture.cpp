// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/arc_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

using drawing::Box;
using drawing::Canvas;

using Points = std::vector<Eigen::Vector2d>;

/// A part of the entry's frame, seen from above, one scale for both axes.
class View {
 public:
  /// As large as fits into `box` around the middle of what is to be seen.
  View(const Box& box, const Eigen::Vector2d& low, const Eigen::Vector2d& high) : box_{box} {
    const Eigen::Vector2d size = high - low;
    scale_ = std::min(box.width / size.y(), box.height / size.x());
    middle_ = 0.5 * (low + high);
  }
  [[nodiscard]] Eigen::Vector2d place(const Eigen::Vector2d& p) const {
    return {box_.x + 0.5 * box_.width + scale_ * (p.y() - middle_.y()),
            box_.y + 0.5 * box_.height - scale_ * (p.x() - middle_.x())};
  }
  [[nodiscard]] Points place(const Points& points) const {
    Points places;
    for (const Eigen::Vector2d& p : points) places.push_back(place(p));
    return places;
  }
  [[nodiscard]] double low(int axis) const { return middle_[axis] - half(axis); }
  [[nodiscard]] double high(int axis) const { return middle_[axis] + half(axis); }
  [[nodiscard]] const Box& box() const { return box_; }

  void draw_grid(Canvas& canvas, int count, double letters) const {
    canvas.outline(std::array<Eigen::Vector2d, 4>{Eigen::Vector2d{box_.x, box_.y},
                                                  {box_.right(), box_.y},
                                                  {box_.right(), box_.bottom()},
                                                  {box_.x, box_.bottom()}},
                   {.color = drawing::kLight.rule, .width = 1.0});
    const drawing::Stroke grid{.color = drawing::kLight.grid, .width = 1.0};
    for (const double y : drawing::ticks(low(1), high(1), count)) {
      const double u = place({0.0, y}).x();
      canvas.line({u, box_.y}, {u, box_.bottom()}, grid);
      canvas.text(
          {u, box_.bottom() + letters + 4.0}, files::text_of(y, 3),
          {.color = drawing::kLight.muted, .size = letters, .align = drawing::Align::kCenter});
    }
    for (const double x : drawing::ticks(low(0), high(0), count)) {
      const double v = place({x, 0.0}).y();
      canvas.line({box_.x, v}, {box_.right(), v}, grid);
      canvas.text(
          {box_.x - 6.0, v + 0.35 * letters}, files::text_of(x, 3),
          {.color = drawing::kLight.muted, .size = letters, .align = drawing::Align::kRight});
    }
  }

 private:
  [[nodiscard]] double half(int axis) const {
    return 0.5 * (axis == 0 ? box_.height : box_.width) / scale_;
  }
  Box box_;
  double scale_ = 1.0;  ///< [px/m]
  Eigen::Vector2d middle_;
};

Points planned_path(const PlannedArc& planned) {
  constexpr double kRunIn = 0.6;  // drawn before and after it [m]
  Points path{{-kRunIn, 0.0}};
  for (int deg = 0; deg <= 180; deg += 3)
    path.emplace_back(planned.radius * std::sin(deg * kDegree),
                      planned.radius * (1.0 - std::cos(deg * kDegree)));
  path.emplace_back(-kRunIn, 2.0 * planned.radius);
  return path;
}

Points path_of(const BlindArc& arc) {
  Points path;
  for (const Eigen::Vector2d& p : arc.path) path.push_back(arc.in_entry_frame(p - arc.entry));
  return path;
}

/// One σ: where half the squared Mahalanobis distance is a half.
Points ellipse(const Spread2& spread) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes{spread.covariance};
  Points points;
  for (int deg = 0; deg < 360; deg += 4) {
    const Eigen::Vector2d unit{std::cos(deg * kDegree), std::sin(deg * kDegree)};
    points.emplace_back(spread.mean +
                        axes.eigenvectors() *
                            axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().cwiseProduct(unit));
  }
  return points;
}

void draw_cross(Canvas& canvas, const Eigen::Vector2d& at, double half,
                const drawing::Stroke& stroke) {
  canvas.line({at.x() - half, at.y()}, {at.x() + half, at.y()}, stroke);
  canvas.line({at.x(), at.y() - half}, {at.x(), at.y() + half}, stroke);
}

void draw_ends(Canvas& canvas, const View& view, const std::vector<ArcSource>& sources,
               const PlannedArc& planned) {
  canvas.clip(view.box());
  canvas.polyline(view.place(planned_path(planned)),
                  {.color = drawing::kLight.muted, .width = 1.5, .dash = 6.0});
  for (const ArcSource& source : sources)
    for (const BlindArc& arc : source.arcs)
      canvas.disc(view.place(arc.displacement()), source.arcs.size() > 30 ? 2.5 : 4.0,
                  source.color.faded(0.75));
  for (const ArcSource& source : sources) {
    const Spread2 spread = source.displacement();
    if (spread.count < 2) continue;
    canvas.outline(view.place(ellipse(spread)), {.color = source.color, .width = 2.0});
    draw_cross(canvas, view.place(spread.mean), 7.0, {.color = source.color, .width = 2.0});
  }
  draw_cross(canvas, view.place({0.0, 2.0 * planned.radius}), 11.0,
             {.color = drawing::kLight.ink, .width = 2.0});
  canvas.unclip();
}

void draw_paths(Canvas& canvas, const View& view, const std::vector<ArcSource>& sources,
                const PlannedArc& planned) {
  canvas.clip(view.box());
  for (const ArcSource& source : sources)
    for (const BlindArc& arc : source.arcs)
      canvas.polyline(
          view.place(path_of(arc)),
          {.color = source.color.faded(source.arcs.size() > 30 ? 0.25 : 0.8), .width = 1.2});
  canvas.polyline(view.place(planned_path(planned)),
                  {.color = drawing::kLight.ink, .width = 1.5, .dash = 6.0});
  canvas.disc(view.place({0.0, 0.0}), 4.0, drawing::kLight.ink);
  canvas.unclip();
}

/// From each error of the estimate when the gate is seen again to that half a second later.
void draw_jumps(Canvas& canvas, const View& view, const std::vector<ArcSource>& sources) {
  canvas.clip(view.box());
  draw_cross(canvas, view.place({0.0, 0.0}), 11.0, {.color = drawing::kLight.ink, .width = 2.0});
  for (const ArcSource& source : sources)
    for (const BlindArc& arc : source.arcs) {
      if (!arc.detail) continue;
      const Eigen::Vector2d &from = arc.detail->error_before, &to = arc.detail->error_after;
      if (!from.allFinite() || !to.allFinite()) continue;
      canvas.line(view.place(from), view.place(to), {.color = source.color.faded(0.3), .width = 1});
      canvas.circle(view.place(from), 3.0, {.color = source.color.faded(0.8), .width = 1.2});
      canvas.disc(view.place(to), 2.5, source.color);
    }
  canvas.unclip();
}

void draw_one(Canvas& canvas, const View& view, const BlindArc& arc, const drawing::Color& color,
              const PlannedArc& planned) {
  constexpr double kLetters = 14.0;
  view.draw_grid(canvas, 4, 13.0);
  canvas.clip(view.box());
  canvas.polyline(view.place(planned_path(planned)),
                  {.color = drawing::kLight.muted, .width = 1.3, .dash = 5.0});
  canvas.polyline(view.place(path_of(arc)), {.color = color, .width = 1.8});
  canvas.disc(view.place({0.0, 0.0}), 4.0, drawing::kLight.flown);
  canvas.disc(view.place(arc.displacement()), 4.0, drawing::kLight.gate_solid);
  canvas.unclip();
  const Eigen::Vector2d d = arc.displacement();
  const Box& box = view.box();
  canvas.text({box.x, box.y - 25.0}, arc.flight, {.size = kLetters, .bold = true});
  canvas.text({box.x, box.y - 7.0},
              "(" + files::fixed(d.x(), 2) + ", " + files::fixed(d.y(), 2) + ") m, " +
                  files::fixed(arc.duration(), 2) + " s, " + files::fixed(arc.entry_speed(), 2) +
                  " to " + files::fixed(arc.exit_speed(), 2) + " m/s",
              {.color = drawing::kLight.muted, .size = kLetters});
}

/// Extent that a panel must show.
struct Frame {
  Eigen::Vector2d low{-0.5, -0.5}, high{0.5, 0.5};

  void include(const Eigen::Vector2d& p) {
    if (p.allFinite()) low = low.cwiseMin(p), high = high.cwiseMax(p);
  }
};

void draw_legend(Canvas& canvas, Eigen::Vector2d at, const std::vector<ArcSource>& sources) {
  for (const ArcSource& source : sources) {
    canvas.disc({at.x() + 6.0, at.y() - 4.5}, 4.0, source.color);
    const drawing::Lettering letters{.size = 16.0};
    canvas.text({at.x() + 18.0, at.y()}, source.name, letters);
    at.x() += 18.0 + canvas.text_width(source.name, letters) + 26.0;
  }
}

}  // namespace

Spread2 ArcSource::displacement() const {
  if (told) return *told;
  Points points;
  for (const BlindArc& arc : arcs) points.push_back(arc.displacement());
  return spread_of(points);
}

drawing::Canvas picture_of(const std::vector<ArcSource>& sources, const ArcSource& each,
                           const PlannedArc& planned) {
  constexpr int kWidth = drawing::kPlotWidth, kTop = 500, kColumns = 3, kTileHeight = 260;
  const int rows = (static_cast<int>(each.arcs.size()) + kColumns - 1) / kColumns;
  Canvas canvas(kWidth, kTop + std::max(1, rows) * kTileHeight + 20);
  canvas.text({60.0, 40.0}, "Blind half circles, seen from the entry: x ahead, y to the inside",
              {.size = 22.0, .bold = true});
  draw_legend(canvas, {60.0, 74.0}, sources);

  // Around every end point, the planned one and what is told of others.
  Frame ends{.low = {0.0, 2.0 * planned.radius}, .high = {0.0, 2.0 * planned.radius}},
      paths{.low = {-1.0, -0.4}, .high = {2.6, 2.0 * planned.radius}}, jumps;
  for (const ArcSource& source : sources) {
    const Spread2 spread = source.displacement();
    if (source.told)
      ends.include(spread.mean - spread.deviation()),
          ends.include(spread.mean + spread.deviation());
    for (const BlindArc& arc : source.arcs) {
      ends.include(arc.displacement()), paths.include(arc.displacement());
      if (arc.detail)
        jumps.include(arc.detail->error_before), jumps.include(arc.detail->error_after);
    }
  }
  const auto panel = [&](double x, const Frame& frame, const std::string& title) {
    const Box box{.x = x, .y = 124.0, .width = 330.0, .height = 310.0};
    const Eigen::Vector2d air = Eigen::Vector2d::Constant(0.2);
    const View view{box, frame.low - air, frame.high + air};
    view.draw_grid(canvas, 6, 14.0);
    canvas.text({box.x, box.y - 12.0}, title, {.size = 14.0});
    canvas.text({box.x + 0.5 * box.width, box.bottom() + 40.0}, "y [m]",
                {.size = 14.0, .align = drawing::Align::kCenter});
    return view;
  };
  draw_ends(canvas, panel(60.0, ends, "x [m]: ends, 1 σ about means; black: planned"), sources,
            planned);
  draw_paths(canvas, panel(450.0, paths, "x [m]: 0.5 s before to after; dashed: planned"), sources,
             planned);
  draw_jumps(canvas, panel(840.0, jumps, "x [m]: estimate - truth, seen again (ring), +0.5 s"),
             sources);

  for (std::size_t i = 0; i < each.arcs.size(); ++i) {
    const auto column = static_cast<double>(i % kColumns), row = static_cast<double>(i / kColumns);
    const View view{{.x = 60.0 + column * 390.0,
                     .y = kTop + 40.0 + row * kTileHeight,
                     .width = 330.0,
                     .height = kTileHeight - 75.0},
                    {-1.0, -0.5},
                    {2.4, 5.0}};
    draw_one(canvas, view, each.arcs[i], each.color, planned);
  }
  return canvas;
}

}  // namespace gatefly::experiments
