// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/course_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "gatefly/config/derived.hpp"
#include "gatefly/config/faults.hpp"
#include "gatefly/race/course.hpp"

namespace gatefly::tasks {
namespace {

using nlohmann::json;

LegReport report_of(const Path& path, int from, int to, const CourseReport& course) {
  LegReport leg{.from = from,
                .to = to,
                .length = path.length(),
                .slowest = course.params.speed,
                .radius = std::numeric_limits<double>::infinity(),
                .clearance = clearance_of(path, course.file.track, course.params, from, to)};
  for (const Segment& segment : path.segments) {
    const double speed = speed_on(segment, course.params);
    leg.time += segment.length / speed;
    leg.slowest = std::min(leg.slowest, speed);
    if (segment.curvature != 0.0)
      leg.radius = std::min(leg.radius, 1.0 / std::abs(segment.curvature));
  }
  const Segment& last = path.segments.back();
  leg.run_in = last.curvature == 0.0 ? last.length : 0.0;
  return leg;
}

void add_way(CourseReport& course) {
  const int gates = static_cast<int>(course.file.track.gates.size());
  course.legs.push_back(report_of(course.plan->start, -1, 0, course));
  int from = 0;
  for (const Path& path : course.plan->legs) {
    course.legs.push_back(report_of(path, from, (from + 1) % gates, course));
    ++from;
  }
  const std::size_t passes =
      course.file.track.gates.size() * static_cast<std::size_t>(course.file.track.laps);
  for (std::size_t pass = 0; pass < passes; ++pass) {
    const LegReport& leg = course.legs[pass == 0 ? 0 : 1 + (pass - 1) % course.plan->legs.size()];
    course.race_length += leg.length;
    course.race_time += leg.time;
  }
  if (course.file.track.laps == 1) return;
  course.lap_length = course.lap_time = 0.0;
  for (std::size_t i = 1; i < course.legs.size(); ++i) {
    *course.lap_length += course.legs[i].length;
    *course.lap_time += course.legs[i].time;
  }
}

json finite(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json as_json(const LegReport& leg) {
  return {{"from_gate", leg.from < 0 ? json(nullptr) : json(leg.from + 1)},
          {"to_gate", leg.to + 1},
          {"length_m", leg.length},
          {"time_s", leg.time},
          {"slowest_mps", leg.slowest},
          {"tightest_radius_m", finite(leg.radius)},
          {"run_in_m", leg.run_in},
          {"clearance_m", leg.clearance.distance},
          {"nearest", leg.clearance.nearest}};
}

template <class Value>
const LegReport& least(const std::vector<LegReport>& legs, Value value) {
  return *std::min_element(legs.begin(), legs.end(), [&](const LegReport& a, const LegReport& b) {
    return value(a) < value(b);
  });
}

}  // namespace

const LegReport& CourseReport::tightest() const {
  return least(legs, [](const LegReport& leg) { return leg.radius; });
}
const LegReport& CourseReport::shortest_run_in() const {
  return least(legs, [](const LegReport& leg) { return leg.run_in; });
}
const LegReport& CourseReport::nearest() const {
  return least(legs, [](const LegReport& leg) { return leg.clearance.distance; });
}

CourseReport checked_course(const std::string& track, const ConfigArguments& arguments) {
  CourseReport report;
  config::Config config = load(arguments);
  report.path = config::find_track(track);
  report.file = config::read_track(report.path, config.gate);
  config = config::on_course(std::move(config), report.file);
  config::expect_gates_of(config::with_faults(report.file.faults, config.faults, "[faults]"),
                          report.file.track.gates.size(), report.path.string());
  report.notes = config.notes;
  report.params = config.pilot.plan;
  try {
    const bool by_exits = config.pilot.control_scheme == Scheme::kPaper;
    const Course course =
        by_exits ? Course::by_exits(report.file.track) : Course{report.file.track, report.params};
    report.plan = course.plan();
  } catch (const std::invalid_argument& no_way) {
    report.reason = no_way.what();
    return report;
  }
  add_way(report);
  return report;
}

json as_json(const CourseReport& report) {
  const Track& track = report.file.track;
  json answer = {{"track", track.name},
                 {"file", report.path.string()},
                 {"can_be_flown", report.plan.has_value()},
                 {"reason", report.plan ? json(nullptr) : json(report.reason)},
                 {"gates", track.gates.size()},
                 {"laps", track.laps},
                 {"obstacles", track.obstacles.size()},
                 {"room_m", {track.room_size.x(), track.room_size.y(), track.ceiling}},
                 {"look", report.file.world.look},
                 {"speed_mps", report.params.speed},
                 {"wanted_clearance_m", report.params.clearance}};
  if (!report.plan) return answer;
  answer["lap_length_m"] = report.lap_length ? json(*report.lap_length) : json(nullptr);
  answer["lap_time_s"] = report.lap_time ? json(*report.lap_time) : json(nullptr);
  answer["race_length_m"] = report.race_length;
  answer["race_time_s"] = report.race_time;
  answer["tightest_radius_m"] = finite(report.tightest().radius);
  answer["shortest_run_in_m"] = report.shortest_run_in().run_in;
  answer["least_clearance_m"] = report.nearest().clearance.distance;
  answer["legs"] = json::array();
  for (const LegReport& leg : report.legs) answer["legs"].push_back(as_json(leg));
  return answer;
}

}  // namespace gatefly::tasks
