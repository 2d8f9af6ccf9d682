// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/files/json.hpp"
#include "gatefly/files/output.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/tasks/recorded_flight.hpp"
#include "gatefly/tasks/smoothing/learnt_map.hpp"
#include "gatefly/tasks/smoothing/track_with_map.hpp"

#include "commands.hpp"
#include "render_again.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kDisagree = 4.0;  // standard deviations: 1 in 16,000 of a gate that has not moved

struct MapOptions {
  CommonOptions common;
  std::vector<std::string> flights;
  tasks::ReplayArguments replay;
  std::string out;
  bool json = false;
};

/// The map that the flights on one track have taught.
struct Learning {
  fs::path track_file;
  Track track;
  eskf::Priors priors;
  smoothing::Intake intake;  ///< Intake of the first flight.
  std::vector<smoothing::FlightMap> maps;
};

bool is_same(const Track& a, const Track& b) {
  if (a.gates.size() != b.gates.size()) return false;
  for (std::size_t i = 0; i < a.gates.size(); ++i) {
    const MapGate &one = a.gates[i], &other = b.gates[i];
    if (one.p_EG != other.p_EG || one.yaw_EG != other.yaw_EG || one.side != other.side)
      return false;
  }
  return true;
}

void learn_from(const std::string& directory, const MapOptions& options, Learning& learning) {
  tasks::ReplayArguments arguments = options.replay;
  arguments.directory = directory;
  arguments.config = options.common;
  arguments.estimator = "eskf";
  const tasks::RecordedFlight flight = tasks::read_flight(arguments);
  if (learning.maps.empty()) {
    learning.track_file = flight.track_file, learning.track = flight.pilot.track;
  } else if (!is_same(learning.track, flight.pilot.track)) {
    throw std::runtime_error(directory + ": was flown on " + flight.track_file.string() +
                             ", whose gates are others than those of " +
                             learning.track_file.string() + " (" + options.flights.front() +
                             "): flights of one track make a map");
  }
  smoothing::IntakeWatch watch;
  (void)tasks::replayed(flight, arguments, stop_if_interrupted, render_again(),
                        [&](const flight_log::ReplayedTick& tick) {
                          stop_if_interrupted();
                          if (const auto* filter = tick.pilot.navigator().error_state())
                            watch.update(*filter, tick.sensors.image || tick.sensors.seen);
                        });
  if (!watch.has_started() || watch.intake().ticks.empty())
    throw std::runtime_error(directory + ": never takes off, there is nothing to learn from it");
  const auto smoothed = smoothing::smooth(watch.intake(), {}, stop_if_interrupted);
  const auto map = smoothing::map_of(smoothed, watch.intake());
  if (std::none_of(map.seen.begin(), map.seen.end(), [](bool seen) { return seen; }))
    throw std::runtime_error(directory + ": no gate of " + flight.track_file.string() +
                             " was seen in it (gatefly replay says why)");
  if (learning.maps.empty()) learning.intake = watch.intake();
  learning.priors = watch.intake().setup.params.priors;
  learning.maps.push_back(map);
}

nlohmann::ordered_json as_json(const MapOptions& options, const Learning& learning,
                               const Track& learnt, const smoothing::LearntMap& map) {
  nlohmann::ordered_json answer{{"track", learning.track.name},
                                {"out", options.out},
                                {"flights", nlohmann::ordered_json::array()},
                                {"gates", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < options.flights.size(); ++i)
    answer["flights"].push_back({{"flight", options.flights[i]}, {"worst_sigmas", map.worst[i]}});
  for (std::size_t i = 0; i < learnt.gates.size(); ++i) {
    const MapGate &now = learnt.gates[i], &before = learning.track.gates[i];
    const Eigen::Vector3d moved = now.p_EG - before.p_EG, &sigma = *now.position_sigma;
    answer["gates"].push_back({{"gate", i + 1},
                               {"moved_m", {moved.x(), moved.y(), moved.z()}},
                               {"position_sigma_m", {sigma.x(), sigma.y(), sigma.z()}},
                               {"turned_deg", wrap_angle(now.yaw_EG - before.yaw_EG) / kDegree},
                               {"heading_sigma_deg", *now.yaw_sigma / kDegree},
                               {"side_m", now.side},
                               {"side_sigma_m", *now.side_sigma}});
  }
  return answer;
}

void print(const MapOptions& options, const Learning& learning, const Track& learnt) {
  std::cout << "gate   north    east    down [m]        turned [deg]   side [m]\n" << std::fixed;
  for (std::size_t i = 0; i < learnt.gates.size(); ++i) {
    const MapGate &now = learnt.gates[i], &before = learning.track.gates[i];
    const Eigen::Vector3d moved = now.p_EG - before.p_EG;
    std::cout << std::setw(4) << i + 1 << std::setprecision(3) << std::showpos;
    for (int axis = 0; axis < 3; ++axis) std::cout << std::setw(8) << moved(axis);
    std::cout << std::noshowpos << " ± " << now.position_sigma->head<2>().maxCoeff()
              << std::setprecision(1) << std::showpos << std::setw(8)
              << wrap_angle(now.yaw_EG - before.yaw_EG) / kDegree << std::noshowpos << " ± "
              << *now.yaw_sigma / kDegree << std::setprecision(3) << std::setw(9) << now.side
              << " ± " << *now.side_sigma << '\n';
  }
  if (!files::is_stdout(options.out)) std::cout << "written: " << options.out << '\n';
}

int map(const MapOptions& options) {
  if (options.json && files::is_stdout(options.out))
    throw std::runtime_error("--json and --out -: both want stdout; name a file");
  std::vector<fs::path> inputs{options.replay.track};
  for (const std::string& flight : options.flights)
    inputs.push_back(data_at(flight, options.replay.data));
  check_outputs({{"--out", options.out, {"learnt track", smoothing::kLearntTrack}}}, inputs,
                options.common);
  catch_interrupt();
  Learning learning;
  for (const std::string& flight : options.flights) learn_from(flight, options, learning);
  const auto fused = smoothing::fused(learning.maps, learning.priors);
  const Track learnt = smoothing::with_map(learning.track, fused, learning.intake);
  for (std::size_t i = 0; i < options.flights.size(); ++i)
    if (fused.worst[i] > kDisagree)
      std::cerr << "gatefly map: " << options.flights[i] << ": a gate is "
                << files::fixed(fused.worst[i], 1)
                << " standard deviations from where the other flights have it: was it moved in "
                   "between, or do seeds differ?\n";
  const fs::path out = options.out;
  const std::string text = smoothing::track_file_with(learning.track_file, learnt, options.flights);
  files::write_file(out, text);
  if (options.json)
    std::cout << files::json_text(as_json(options, learning, learnt, fused));
  else if (!options.common.quiet && !files::is_stdout(options.out))
    print(options, learning, learnt);
  return kDone;
}

}  // namespace

void declare_map(Command& command) {
  auto options = std::make_shared<MapOptions>();
  command.footer(
      "Example:\n  gatefly map out/showroom-1 --out learnt.toml\n"
      "  gatefly fly learnt.toml\n\n"
      "Each flight is flown again and smoothed; what they say of the gates is fused. The course as "
      "a "
      "whole\n"
      "stays where the map has it, the gates move within it. The file has how sure each gate is, "
      "and "
      "the\n"
      "pilot believes that. Comments of the old file are left out. Real flights: the track is "
      "--track, else\n"
      "tracks/flights.toml. Exit code 0: written; 2: unusable input.");
  command.option("FLIGHT", options->flights, "flight folders, of one track").required().path();
  command.option("--out", options->out, "the track file to write (- for stdout)")
      .required()
      .path("TRACK");
  command.option("--track", options->replay.track,
                 "instead of the folders' own: a name in tracks/ or a file");
  command
      .option("--heading-offset-deg", options->replay.heading_offset_deg,
              "real logs: motion capture's heading minus the log's own (differs by flight)")
      .show_default();
  command
      .option("--data", options->replay.data,
              "where a FLIGHT is looked for that is not here [$GATEFLY_DATA]")
      .path("DIR");
  command.flag("--json", options->json, "print JSON");
  add_force(command, options->common);
  add_common(command, options->common);
  command.runs([options] { return map(*options); });
}

}  // namespace gatefly::cli
