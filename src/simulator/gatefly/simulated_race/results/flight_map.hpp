// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "gatefly/drawing/course_map.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"

namespace gatefly::simulated_race {

/// One moment of a flight, as far as pictures of it need it.
struct Moment {
  double time = 0.0;                                                                        ///< [s]
  Eigen::Vector3d true_p_EB = Eigen::Vector3d::Zero(), est_p_EB = Eigen::Vector3d::Zero();  ///< [m]
  double true_speed = 0.0, est_speed = 0.0;  ///< [m/s]
};

/// The course as it really stands, gates in their colours.
[[nodiscard]] drawing::Course course_of(const world::World& world);
/// A gate's colour on a dark ground: as bright as it can be.
[[nodiscard]] drawing::Color color_of(const world::WorldGate& gate);

/// A flight on the map of its course.
class FlightMap {
 public:
  /// @param area  where on the canvas; the room is fitted into it.
  FlightMap(const drawing::Box& area, const RaceConfig& race);

  /// Room, obstacles and gates where they really stand, and the way that the pilot planned by its
  /// map.
  void draw_course(drawing::Canvas& canvas, const RacePlan& plan) const;
  /// The way from one moment to the next, coloured by speed. @param strength  0..1
  void draw_flown(drawing::Canvas& canvas, const Moment& from, const Moment& to,
                  double strength) const;
  void draw_estimate(drawing::Canvas& canvas, const Moment& from, const Moment& to) const;
  /// The gate that the pilot flies to.
  void draw_target(drawing::Canvas& canvas, int gate) const;
  /// Draws the camera's view: from bearing to bearing, on the floor plan.
  void draw_view(drawing::Canvas& canvas, const Eigen::Vector2d& p_E, const Eigen::Vector2d& left_E,
                 const Eigen::Vector2d& right_E) const;
  void draw_drone(drawing::Canvas& canvas, const Moment& now, double yaw) const;
  /// A cross where the race was lost.
  void draw_contact(drawing::Canvas& canvas, const Moment& at) const;
  /// Which line is which, below the map: from `at` to the right.
  void draw_legend(drawing::Canvas& canvas, const Eigen::Vector2d& at) const;

 private:
  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector2d& p_E) const { return map_.at(p_E); }
  [[nodiscard]] drawing::Color color_of_speed(double speed) const;

  drawing::CourseMap map_;
  double fast_ = 2.5;  ///< Speed of the brightest colour [m/s].
};

}  // namespace gatefly::simulated_race
