// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "gatefly/config/json_schema.hpp"
#include "gatefly/drawing/course_map.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/tasks/course_report.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

using files::fixed;
using tasks::LegReport;

struct TrackOptions {
  CommonOptions common;
  std::string track, draw;
  bool json = false, schema = false;
};

std::string verdict(const tasks::CourseReport& course) {
  return course.file.track.name +
         (course.plan ? ": can be flown" : ": cannot be flown: " + course.reason);
}

std::string name_of(const LegReport& leg) {
  return (leg.from < 0 ? std::string{"start"} : "gate " + std::to_string(leg.from + 1)) +
         " to gate " + std::to_string(leg.to + 1);
}

void print_line(const char* name, const std::string& text) {
  std::cout << "  " << std::left << std::setw(17) << name << text << '\n';
}

void print_course(const tasks::CourseReport& course) {
  const Track& track = course.file.track;
  print_line("file", course.path.string());
  print_line("gates", std::to_string(track.gates.size()) + ", " + std::to_string(track.laps) +
                          (track.laps == 1 ? " lap" : " laps"));
  print_line("room", fixed(track.room_size.x(), 1) + " x " + fixed(track.room_size.y(), 1) +
                         " m, " + fixed(track.ceiling, 1) + " m high, look " +
                         course.file.world.look + ", " + std::to_string(track.obstacles.size()) +
                         (track.obstacles.size() == 1 ? " obstacle" : " obstacles"));
}

void print_way(const tasks::CourseReport& course) {
  const LegReport &tightest = course.tightest(), &run_in = course.shortest_run_in(),
                  &nearest = course.nearest();
  if (course.lap_length)
    print_line("lap", fixed(*course.lap_length, 1) + " m, " + fixed(*course.lap_time, 1) +
                          " s at the planned speed");
  print_line("race", fixed(course.race_length, 1) + " m, " + fixed(course.race_time, 1) +
                         " s from the start to the last gate, without take-off");
  print_line("speed", fixed(course.params.speed, 2) + " m/s, " + fixed(tightest.slowest, 2) +
                          " in the tightest turn");
  print_line("tightest turn",
             std::isfinite(tightest.radius)
                 ? "radius " + fixed(tightest.radius, 2) + " m, " + name_of(tightest)
                 : std::string{"none"});
  print_line("shortest run-in",
             fixed(run_in.run_in, 2) + " m straight before gate " + std::to_string(run_in.to + 1));
  print_line("least clearance", fixed(nearest.clearance.distance, 2) + " m to " +
                                    nearest.clearance.nearest + ", " + name_of(nearest) +
                                    " (wanted: " + fixed(course.params.clearance, 2) + ")");
}

/// gatefly track: what a course asks for. Exit 0 it can be flown, 1 it cannot, 2 unusable input.
int track(const TrackOptions& options) {
  if (options.schema) {
    std::cout << files::json_text(config::track_schema());
    return kDone;
  }
  if (options.track.empty())
    throw std::runtime_error("track: TRACK is required (--help shows what there is)");
  const tasks::CourseReport course = tasks::checked_course(options.track, options.common);
  check_outputs({{"--draw", options.draw, files::kOurPng}}, {course.path}, options.common);
  say_notes(course.notes);
  if (!options.draw.empty())
    drawing::drawn_course(course.file.track, course.plan ? &*course.plan : nullptr,
                          files::one_line(verdict(course), 110))
        .write_png(options.draw);
  if (options.json) {
    std::cout << files::json_text(as_json(course));
  } else {
    std::cout << coloured(course.plan.has_value(), verdict(course)) << '\n';
    if (!options.common.quiet) {
      print_course(course);
      if (course.plan) print_way(course);
      if (!options.draw.empty()) print_line("drawn", options.draw);
    }
  }
  return course.plan ? kDone : kAnswerIsNo;
}

}  // namespace

void declare_track(Command& command) {
  auto options = std::make_shared<TrackOptions>();
  command.footer(
      "Example:\n  gatefly track showroom\n"
      "  gatefly track mine.toml --draw mine.png --set control.speed_mps=1.4\n\n"
      "Lengths and times are the plan's, at the speeds it wants. A flight takes longer:\n"
      "it takes off, flies wider turns, and may search for a gate.\n"
      "Clearance is from the drone's outline.\n"
      "Exit code 0: the course can be flown; 1: it cannot, and why; 2: unusable arguments or "
      "file.");
  command.option("TRACK", options->track, "a name in tracks/ or a file");
  command.option("--draw", options->draw, "draw the course and the planned way from above")
      .path("FILE.png");
  command.flag("--json", options->json, "print the answer, leg by leg, as JSON");
  command.flag("--schema", options->schema, "print a JSON schema of track files, for editors");
  add_force(command, options->common);
  add_common(command, options->common);
  command.runs([options] { return track(*options); });
}

}  // namespace gatefly::cli
