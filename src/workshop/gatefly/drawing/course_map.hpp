// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/drawing/canvas.hpp"
#include "gatefly/race/path.hpp"
#include "gatefly/race/track.hpp"

namespace gatefly::drawing {

/// Contents of a course's map, as the pilot knows it or as it really stands.
struct Course {
  struct Solid {
    MapObstacle box;
    bool round = false;  ///< A pole, of diameter box.size.x().
  };
  struct Gate {
    MapGate gate;
    Color color;
  };
  Eigen::Vector2d room_center{0, 0}, room_size{1, 1};  ///< North, east [m].
  std::vector<Solid> solids;
  std::vector<Gate> gates;
};
[[nodiscard]] Course course_of(const Track& track, const Color& gate);

/// A course from above, north up: how plots and films draw it.
class CourseMap {
 public:
  /// @param area  where on the canvas; the room is fitted into it.
  CourseMap(const Box& area, Course course, const Palette& palette);

  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector2d& p_E) const;
  [[nodiscard]] double scale() const { return scale_; }  ///< [px/m]
  [[nodiscard]] const Course& course() const { return course_; }

  /// Room and solid things, the higher the stronger.
  void draw_floor(Canvas& canvas) const;
  /// @param arrow  length of a tip in its middle [px]; 0: none.
  void draw_way(Canvas& canvas, const Path& path, const Stroke& stroke, double arrow) const;
  void draw_start(Canvas& canvas, const Eigen::Vector2d& p_E) const;
  /// Each with its number; with its height, too, where gates differ in it.
  void draw_gates(Canvas& canvas) const;
  void draw_gate(Canvas& canvas, std::size_t gate, const Color& color) const;
  /// A metre or ten, at the lower left of the room.
  void draw_scale(Canvas& canvas) const;

 private:
  void draw_solid(Canvas& canvas, const Course::Solid& solid) const;
  void draw_arrow(Canvas& canvas, const Eigen::Vector2d& p_E, const Eigen::Vector2d& direction,
                  double length, const Color& color) const;

  Course course_;
  const Palette& palette_;
  double scale_;
  Eigen::Vector2d middle_;
  bool tells_heights_ = false;
};

/// A picture of a course: room, obstacles, start, numbered gates with their direction, the planned
/// way.
///
/// @param plan  nullptr: there is none.
/// @param title  above it, on one line.
[[nodiscard]] Canvas drawn_course(const Track& track, const RacePlan* plan,
                                  const std::string& title);

}  // namespace gatefly::drawing
