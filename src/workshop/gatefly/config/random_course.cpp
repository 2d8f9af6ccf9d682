// SPDX-License-Identifier: Apache-2.0
#include "gatefly/config/random_course.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "gatefly/config/course_check.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rng.hpp"

namespace gatefly::config {
namespace {

/// Sizes of a look's rooms: least and most of each side, height.
struct RoomKind {
  const char* look;
  Eigen::Vector3d least, most;
};
constexpr double kLoop = 18.0;  // at most so wide: a pilot flies from gate to gate by its IMU [m]
constexpr double kLeg = 2.6;    // a loop has so much for each of its gates, on average [m]

const std::array<RoomKind, 4>& room_kinds() {
  static const std::array<RoomKind, 4> kinds{RoomKind{"showroom", {13, 13, 3.2}, {20, 22, 3.4}},
                                             RoomKind{"hall", {13, 13, 3.4}, {22, 22, 5.0}},
                                             RoomKind{"dark_hall", {12, 12, 3.5}, {16, 16, 6.0}},
                                             RoomKind{"exhibition", {40, 40, 8.0}, {45, 65, 10}}};
  return kinds;
}

struct Course {
  Track track;
  const char* look = "";
};

/// Draws numbers as they will stand in the file: what is checked is what is written.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : rng_{seed} {
    for (int i = 0; i < 4; ++i) (void)rng_.next();  // seeds that follow each other start alike
  }
  double number(double low, double high) {
    return std::round(100.0 * rng_.uniform(low, high)) / 100.0;
  }
  double degrees(double low, double high) { return std::round(rng_.uniform(low, high)); }
  int count(int low, int high) { return low + rng_.uniform_index(high - low + 1); }
  bool chance(double share) { return rng_.uniform(0.0, 1.0) < share; }

 private:
  Rng rng_;
};

double rounded(double value) { return std::round(100.0 * value) / 100.0; }

/// A position along a loop round the middle, and the direction of flight there.
MapGate gate_on_loop(Dice& dice, const Eigen::Vector2d& middle, const Eigen::Vector2d& radii,
                     double angle, double side) {
  const auto [s, c] = sincos(angle);
  const double out = dice.number(0.65, 1.0);
  const Eigen::Vector2d along = side * Eigen::Vector2d{-radii.x() * s, radii.y() * c};
  MapGate gate;
  gate.p_EG = {rounded(middle.x() + out * radii.x() * c), rounded(middle.y() + out * radii.y() * s),
               -dice.number(1.1, 2.0)};
  const double turned = dice.degrees(-35.0, 35.0);
  gate.yaw_EG = wrap_angle((std::round(atan2(along.y(), along.x()) / kDegree) + turned) * kDegree);
  return gate;
}

/// A second gate over one that stands low: back over it, or through it and round again.
void stack(Dice& dice, Track& track) {
  const auto lower =
      static_cast<std::size_t>(dice.count(0, static_cast<int>(track.gates.size()) - 1));
  MapGate upper = track.gates[lower];
  track.gates[lower].p_EG.z() = -dice.number(0.6, 0.9);
  upper.p_EG.z() = track.gates[lower].p_EG.z() - dice.number(1.1, 1.3);
  if (dice.chance(0.5)) upper.yaw_EG = wrap_angle(upper.yaw_EG + kPi);
  track.gates.insert(track.gates.begin() + static_cast<std::ptrdiff_t>(lower) + 1, upper);
}

/// Answers false where the room is too small for as many gates as were drawn.
bool add_gates(Dice& dice, Track& track) {
  const Eigen::Vector2d half =
      (0.5 * track.room_size - Eigen::Vector2d::Constant(1.6)).cwiseMin(0.5 * kLoop);
  const Eigen::Vector2d radii{dice.number(0.75, 1.0) * half.x(), dice.number(0.75, 1.0) * half.y()};
  const bool stacked = dice.chance(1.0 / 3.0);
  const int count = dice.count(6, 12) - (stacked ? 1 : 0);
  if (kPi * radii.sum() < count * kLeg) return false;
  const double side = dice.chance(0.5) ? 1.0 : -1.0, first = dice.degrees(-180.0, 180.0);
  for (int i = 0; i < count; ++i) {
    const double jitter = dice.number(-0.25, 0.25);
    const double angle = first * kDegree + side * 2 * kPi * (i + jitter) / count;
    track.gates.push_back(gate_on_loop(dice, track.room_center, radii, angle, side));
  }
  if (stacked) stack(dice, track);
  return true;
}

void place_start(Dice& dice, Track& track) {
  const MapGate& gate = track.gates.front();
  const auto [s, c] = sincos(gate.yaw_EG);
  const double before = dice.number(3.0, 4.5), aside = dice.number(-0.4, 0.4);
  track.start = {rounded(gate.p_EG.x() - before * c - aside * s),
                 rounded(gate.p_EG.y() - before * s + aside * c)};
  track.start_heading = wrap_angle(gate.yaw_EG + dice.degrees(-10.0, 10.0) * kDegree);
}

MapObstacle any_obstacle(Dice& dice, const Track& track) {
  const Eigen::Vector2d half = (0.5 * track.room_size).cwiseMin(0.6 * kLoop);
  MapObstacle box;
  box.center = {rounded(track.room_center.x() + dice.number(-1.0, 1.0) * half.x()),
                rounded(track.room_center.y() + dice.number(-1.0, 1.0) * half.y())};
  const double kind = dice.number(0.0, 1.0);
  if (kind < 0.35)  // a column
    box.size = {0.3, 0.3}, box.height = 2.2;
  else if (kind < 0.65)  // a show-case or a stand
    box.size = {1.1, dice.number(1.5, 3.5)}, box.height = 2.2;
  else  // a table
    box.size = {dice.number(0.8, 1.2), dice.number(1.0, 2.0)}, box.height = dice.number(0.5, 1.0);
  box.heading = dice.chance(0.7) ? 0.0 : dice.degrees(-90.0, 90.0) * kDegree;
  return box;
}

/// Obstacles that leave the course valid; one that does not is drawn again, now and then in vain.
void add_obstacles(Dice& dice, Track& track) {
  const int count = dice.count(0, 6);
  for (int i = 0, tries = 0; i < count && tries < 60; ++tries) {
    track.obstacles.push_back(any_obstacle(dice, track));
    if (course_problems(track).empty())
      ++i;
    else
      track.obstacles.pop_back();
  }
}

std::optional<Course> drawn(Dice& dice) {
  const RoomKind& kind = room_kinds()[static_cast<std::size_t>(dice.count(0, 3))];
  Course course{.track = {}, .look = kind.look};
  Track& track = course.track;
  track.laps = dice.count(1, 3);
  track.room_size = {dice.number(kind.least.x(), kind.most.x()),
                     dice.number(kind.least.y(), kind.most.y())};
  track.ceiling = dice.number(kind.least.z(), kind.most.z());
  track.room_center = {dice.number(-3.0, 3.0), dice.number(-3.0, 3.0)};
  if (!add_gates(dice, track)) return std::nullopt;
  place_start(dice, track);
  if (!course_problems(track).empty()) return std::nullopt;
  add_obstacles(dice, track);
  return course;
}

std::string list(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "[" : ", ") + files::fixed(value, 2);
  return text + "]";
}

std::string heading_line(double heading) {
  return "heading_deg = " + files::fixed(std::round(heading / kDegree) + 0.0, 1) + "\n";
}

std::string track_text(const Course& course, std::uint64_t seed) {
  const Track& track = course.track;
  std::string text = "# A course drawn at random: gatefly new track --random " +
                     std::to_string(seed) +
                     "\n# Metres and degrees; x north, y east, z down, heading clockwise from "
                     "north; z = 0 is the floor.\n";
  text += "name = \"random " + std::to_string(seed) + "\"\nlaps = " + std::to_string(track.laps) +
          "\n\n[start]\nposition_m = " + list({track.start.x(), track.start.y()}) + "\n" +
          heading_line(track.start_heading) + "\n# Gates, in the order of flight.\n";
  for (std::size_t i = 0; i < track.gates.size(); ++i) {
    const MapGate& gate = track.gates[i];
    text += "[[gates]]  # " + std::to_string(i + 1) +
            "\nposition_m = " + list({gate.p_EG.x(), gate.p_EG.y(), gate.p_EG.z()}) + "\n" +
            heading_line(gate.yaw_EG) + "side_m = " + files::fixed(gate.side, 2) +
            "\nbar_m = " + files::fixed(gate.bar, 2) + "\ncolor = \"orange\"\n\n";
  }
  for (const MapObstacle& box : track.obstacles)
    text += "[[obstacles]]\nbox_m = " + list({box.size.x(), box.size.y(), box.height}) +
            "\nposition_m = " + list({box.center.x(), box.center.y()}) + "\n" +
            heading_line(box.heading) + "\n";
  text += "[room]\nsize_m = " + list({track.room_size.x(), track.room_size.y(), track.ceiling}) +
          "\ncenter_m = " + list({track.room_center.x(), track.room_center.y()}) + "\nlook = \"" +
          course.look + "\"\n\n[randomize]\nlevel = \"race\"\n";
  return text;
}

}  // namespace

std::string random_course(std::uint64_t seed) {
  Dice dice{seed};
  for (int tries = 0; tries < 10000; ++tries)
    if (const auto course = drawn(dice)) return track_text(*course, seed);
  throw std::logic_error("random_course: no valid course in 10000 draws");
}

}  // namespace gatefly::config
