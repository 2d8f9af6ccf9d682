// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/files/csv.hpp"
#include "gatefly/files/json.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/live/drone_file.hpp"
#include "gatefly/tasks/flight_inputs.hpp"
#include "gatefly/tasks/identification/drag_fit.hpp"
#include "gatefly/tasks/identification/thrust_fit.hpp"
#include "gatefly/tasks/recorded_flight.hpp"

#include "commands.hpp"
#include "render_again.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;
using identification::DragFit;

struct IdentifyOptions {
  CommonOptions common;
  std::vector<std::string> flights;
  std::string data, track;
  bool json = false;
};

struct Identified {
  std::string name;
  DragFit fit;
};

nlohmann::ordered_json as_json(const DragFit& fit) {
  return {{"k_x_1ps", fit.drag.x()},           {"k_x_sigma", fit.drag_sigma.x()},
          {"k_y_1ps", fit.drag.y()},           {"k_y_sigma", fit.drag_sigma.y()},
          {"accel_bias_x_mps2", fit.bias.x()}, {"accel_bias_y_mps2", fit.bias.y()}};
}

/// A folder of flights stands for the flights in it.
std::vector<fs::path> flight_folders(const IdentifyOptions& options) {
  std::vector<fs::path> folders;
  for (const std::string& given : options.flights) {
    const fs::path path = data_at(given, options.data);
    if (!fs::is_directory(path)) throw std::runtime_error(given + ": there is no such folder");
    if (flight_log::log_in(path)) {
      folders.push_back(path);
      continue;
    }
    const std::size_t before = folders.size();
    for (const auto& entry : fs::directory_iterator(path))
      if (flight_log::log_in(entry.path())) folders.push_back(entry.path());
    if (folders.size() == before)
      throw std::runtime_error(given + ": there is no log_si.csv in it, nor in its folders");
    std::sort(folders.begin() + static_cast<std::ptrdiff_t>(before), folders.end());
  }
  return folders;
}

void print(const std::vector<Identified>& all, const DragFit& mean) {
  const auto row = [](const std::string& name, const DragFit& fit, bool single) {
    std::cout << std::left << std::setw(12) << name << std::right << std::fixed
              << std::setprecision(2) << std::setw(7) << fit.drag.x() << " ± "
              << 1.96 * fit.drag_sigma.x() << std::setw(8) << fit.drag.y() << " ± "
              << 1.96 * fit.drag_sigma.y() << std::setw(8) << fit.bias.x() << std::setw(7)
              << fit.bias.y();
    if (single)
      std::cout << std::setprecision(1) << std::setw(9) << fit.heading_offset / kDegree
                << std::setprecision(2) << std::setw(9) << fit.rms;
    std::cout << '\n';
  };
  std::cout << "flight       k_x [1/s] 95 %   k_y [1/s] 95 %    bias x, y     heading   misfit\n"
               "                                                 [m/s²]           [°]      [m]\n";
  for (const Identified& one : all) row(one.name, one.fit, true);
  if (all.size() > 1) row("mean", mean, false);
}

/// A picture's middle that is off by some pixels looks like tilt [°].
constexpr double kMiddleDeg = 0.7;

/// Drone constants learnt in one of our flights from the gates on its map, without motion capture.
struct Learnt {
  std::string name;
  std::size_t fixes = 0;
  std::optional<identification::Known> tilt_deg, latency_ms;
  double told_tilt_deg = 0.0, told_latency_ms = 0.0;
  std::string command;  ///< Variable of the thrust curve: "rotor speed [rad/s]".
  std::optional<identification::ThrustFit> thrust;
  std::string why_no_thrust;
};

/// The commands of a log's rows, and what they are; none where it has none. Throttle as the controller makes it of the stick.
struct Commands {
  std::string name, unit;
  std::vector<double> values;
  std::optional<live::DroneFile> drone;
};

Commands commands_of(const flight_log::FlightFolder& folder) {
  Commands commands;
  const auto& samples = folder.samples;
  const auto spins = [](const flight_log::FlightSample& sample) {
    return sample.motors.has_value();
  };
  if (std::any_of(samples.begin(), samples.end(), spins)) {
    commands.name = "rotor speed", commands.unit = "rad/s";
    for (const flight_log::FlightSample& sample : samples) {
      double squares = 0.0;
      if (sample.motors)
        for (const double speed : *sample.motors) squares += 0.25 * speed * speed;
      commands.values.push_back(std::sqrt(squares));
    }
    return commands;
  }
  if (folder.log.extension() == ".gz") return commands;
  std::string text = files::read_file(folder.log);
  text.resize(text.rfind('\n') + 1);  // the line within which a recorder was cut is none
  const files::Csv log{folder.log, std::move(text)};
  const fs::path constants = folder.directory / "drone.toml";
  if (!log.has("stick_throttle_us") || !fs::exists(constants)) return commands;
  commands.name = "throttle", commands.unit = "of 1000";
  commands.drone = live::read_drone(constants);
  double held = 0.0;
  for (const double stick : log.numbers("stick_throttle_us")) {
    if (std::isfinite(stick))
      held = commands.drone->throttle.throttle(
          static_cast<std::uint16_t>(std::clamp(stick, 1000.0, 2000.0)));
    commands.values.push_back(held);
  }
  return commands;
}

/// On its way through the gates, by the pilot that is asked now: a take-off's thrust goes to climbing, and near the floor there is more of it.
bool is_under_way(const Pilot& pilot) {
  return is_flying(pilot.phase()) && !std::holds_alternative<TakeOff>(pilot.phase());
}

Learnt learn(const fs::path& folder, const IdentifyOptions& options) {
  if (options.track.empty() && !tasks::is_simulated(folder))
    throw std::runtime_error(folder.string() +
                             ": has no map of its own; --track names where the gates stand");
  tasks::ReplayArguments arguments;
  arguments.directory = folder.string();
  arguments.config = options.common;
  arguments.track = options.track;
  arguments.estimator = "eskf";
  const tasks::RecordedFlight flight = tasks::read_flight(arguments);
  const Commands commands = commands_of(flight.folder);
  Learnt learnt;
  std::vector<identification::ThrustPoint> points;
  const flight_log::ReplayResult result = tasks::replayed(
      flight, arguments, stop_if_interrupted, render_again(),
      [&](const flight_log::ReplayedTick& tick) {
        if (!is_under_way(tick.pilot) || tick.index >= commands.values.size()) return;
        const Imu& imu = tick.sensors.imu;
        const double command = commands.values[tick.index];
        if (!imu.accel_B.allFinite() || !(command > 0.0)) return;
        const Attitude& attitude = tick.estimate.attitude;
        points.push_back({.t = 1e-9 * static_cast<double>(tick.sensors.time.count()),
                          .command = command,
                          .accel = -imu.accel_B.z(),
                          .upright = cos(attitude.roll) * cos(attitude.pitch),
                          .v_down = tick.estimate.v_E.z()});
      });
  learnt.name = fs::weakly_canonical(folder).filename().string();
  for (const flight_log::EstimateRow& row : result.estimates)
    learnt.fixes += row.source != Sighting::Source::kNone;
  const PilotConfig& pilot = flight.pilot;
  learnt.told_tilt_deg = flight.config.camera.tilt_down / kDegree;
  learnt.told_latency_ms = 1e3 * pilot.camera_timing.latency;
  constexpr std::size_t kLeastFixes = 10;
  if (result.findings && learnt.fixes >= kLeastFixes && !result.divergence) {
    // Wider than the filter's own by what 20 flights of known tilt were off by; an arrival that
    // jitters only comes later: without stamps its mean is in what is found, and not quite.
    constexpr double kCenterDeg = 0.3, kJitterMs = 2.0;
    const eskf::Findings& found = *result.findings;
    learnt.tilt_deg = {learnt.told_tilt_deg + found.tilt.value / kDegree,
                       std::hypot(found.tilt.sigma / kDegree, kCenterDeg)};
    learnt.latency_ms = {learnt.told_latency_ms - 1e3 * found.delay.value,
                         std::hypot(1e3 * found.delay.sigma, kJitterMs)};
  }
  learnt.command = commands.name + " [" + commands.unit + "]";
  learnt.thrust = identification::fit_thrust(points);
  if (commands.values.empty())
    learnt.why_no_thrust =
        "the log has neither rotor speeds nor sticks with a drone.toml beside it";
  else if (!learnt.thrust)
    learnt.why_no_thrust = "less than 3 s under way between gates";
  return learnt;
}

nlohmann::ordered_json as_json(const Learnt& learnt) {
  const auto pair = [](const auto& known) {
    return known ? nlohmann::ordered_json{{"value", known->value}, {"sigma", known->sigma}}
                 : nlohmann::ordered_json{};
  };
  nlohmann::ordered_json json{{"flight", learnt.name},
                              {"fixes", learnt.fixes},
                              {"camera_tilt_deg", pair(learnt.tilt_deg)},
                              {"camera_latency_ms", pair(learnt.latency_ms)},
                              {"command", learnt.command},
                              {"hover", nullptr},
                              {"exponent", nullptr},
                              {"drag", nullptr}};
  if (learnt.thrust) {
    json["hover"] = pair(std::optional{learnt.thrust->hover});
    json["exponent"] = pair(learnt.thrust->exponent);
    json["thrust_lag_s"] = learnt.thrust->lag;
    json["accel_bias_up_mps2"] = learnt.thrust->accel_bias;
  }
  return json;
}

void print(const Learnt& learnt) {
  const auto line = [](const char* name, const std::optional<identification::Known>& known,
                       int digits, const std::string& rest) {
    std::cout << "  " << std::left << std::setw(16) << name;
    if (known)
      std::cout << files::fixed(known->value, digits) << " ± " << files::fixed(known->sigma, digits)
                << ' ';
    std::cout << rest << '\n';
  };
  std::cout << learnt.name << ": " << files::amount(learnt.fixes, "picture")
            << " corrected the filter (± is one sigma)\n";
  const std::string few = "not known: too few gates seen, or the filter has diverged";
  line("camera tilt", learnt.tilt_deg, 2,
       learnt.tilt_deg ? "° with the picture's middle (camera.tilt_deg; told " +
                             files::fixed(learnt.told_tilt_deg, 2) + "); of the mount alone ± " +
                             files::fixed(std::hypot(learnt.tilt_deg->sigma, kMiddleDeg), 2)
                       : few);
  line("camera latency", learnt.latency_ms, 0,
       learnt.latency_ms ? "ms to the middle of the exposure (told " +
                               files::fixed(learnt.told_latency_ms, 0) + ")"
                         : few);
  std::optional<identification::Known> hover, exponent;
  if (learnt.thrust) hover = learnt.thrust->hover, exponent = learnt.thrust->exponent;
  line(
      "hover", hover, 1,
      hover ? learnt.command + ", at this battery's charge" : "not known: " + learnt.why_no_thrust);
  line("exponent", exponent, 2,
       exponent
           ? "of thrust over " + learnt.command
           : "not known: " + (learnt.thrust ? "it hardly did but hover" : learnt.why_no_thrust));
  line("drag", std::nullopt, 0,
       "not known: a filter that takes drag for its speed cannot measure it; true positions can");
}

/// A flight of ours or of a recorder: it has no true positions of motion capture beside its own attitude.
bool is_own(const fs::path& folder, const std::string& track) {
  return tasks::is_simulated(folder) || fs::exists(folder / flight_log::kRecordingMark) ||
         !track.empty();
}

int identify_own(const std::vector<fs::path>& folders, const IdentifyOptions& options) {
  nlohmann::ordered_json answer{{"flights", nlohmann::ordered_json::array()}};
  bool all = true;
  int unusable = 0;
  for (const fs::path& folder : folders) {
    try {
      const Learnt learnt = learn(folder, options);
      all = all && learnt.tilt_deg && learnt.thrust;
      if (options.json)
        answer["flights"].push_back(as_json(learnt));
      else
        print(learnt);
    } catch (const std::runtime_error& error) {
      ++unusable;
      std::cerr << "gatefly identify: " << files::reason_of(error) << '\n';
    }
  }
  if (options.json) std::cout << files::json_text(answer);
  return unusable > 0 ? kUnusable : all ? kDone : kAnswerIsNo;
}

int identify(const IdentifyOptions& options) {
  (void)load(options.common);
  std::vector<Identified> all;
  bool some_without = false;
  int unusable = 0;
  const std::vector<fs::path> folders = flight_folders(options);
  const auto own = [&](const fs::path& folder) { return is_own(folder, options.track); };
  if (std::any_of(folders.begin(), folders.end(), own)) {
    if (!std::all_of(folders.begin(), folders.end(), own))
      throw std::runtime_error(
          "flights with motion capture and flights without: not at once, one or the other");
    return identify_own(folders, options);
  }
  for (const fs::path& folder : folders) {
    std::optional<DragFit> fit;
    try {
      fit = identification::fit_drag(flight_log::read_flight_folder(folder));
    } catch (const std::runtime_error& error) {
      ++unusable;
      std::cerr << "gatefly identify: " << files::reason_of(error) << '\n';
      continue;
    }
    const std::string name = fs::weakly_canonical(folder).filename().string();
    if (fit) {
      all.push_back({name, *fit});
    } else {
      some_without = true;
      std::cerr << "gatefly identify: " << folder.string()
                << ": no second above 0.9 m with true position, velocity and attitude; left out\n";
    }
  }
  if (all.empty()) return unusable > 0 ? kUnusable : kAnswerIsNo;
  std::vector<DragFit> fits;
  for (const Identified& one : all) fits.push_back(one.fit);
  const DragFit mean = identification::mean_of(fits);
  if (options.json) {
    nlohmann::ordered_json answer{{"mean", as_json(mean)},
                                  {"flights", nlohmann::ordered_json::array()}};
    for (const Identified& one : all) {
      nlohmann::ordered_json flight = as_json(one.fit);
      flight["flight"] = one.name, flight["heading_offset_deg"] = one.fit.heading_offset / kDegree;
      flight["misfit_m"] = one.fit.rms, flight["pieces"] = one.fit.pieces;
      answer["flights"].push_back(flight);
    }
    std::cout << files::json_text(answer);
  } else {
    print(all, mean);
  }
  return unusable > 0 ? kUnusable : some_without ? kAnswerIsNo : kDone;
}

}  // namespace

void declare_identify(Command& command) {
  auto options = std::make_shared<IdentifyOptions>();
  command.footer(
      "Example:\n  gatefly identify tudelft_bebop_flights\n\n"
      "With true positions and velocities (ot_*) and the autopilot's attitude (ahrs_*) in "
      "log_si.csv: drag, bias,\n"
      "heading. Of a flight of fly, run or record, or of any with --track: the camera's tilt and "
      "latency, hover and\n"
      "exponent of thrust, by the gates on the map.\n"
      "Exit code 0: all flights identified; 1: some were not; 2: unusable arguments or log; 130: "
      "Ctrl-C.");
  command.option("DIR", options->flights, "flight folders, or folders of them").required().path();
  command
      .option("--data", options->data, "folder of real data [$GATEFLY_DATA, else ../shared/data]")
      .path("DIR");
  command
      .option("--track", options->track,
              "the map of flights without motion capture: a name in tracks/ or a file [the "
              "folder's own]")
      .path("FILE");
  command.flag("--json", options->json, "numbers for programs");
  add_common(command, options->common);
  command.runs([options] { return identify(*options); });
}

}  // namespace gatefly::cli
