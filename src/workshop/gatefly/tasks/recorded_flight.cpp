// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/recorded_flight.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "gatefly/config/derived.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/tasks/flight_inputs.hpp"

namespace gatefly::tasks {

namespace fs = std::filesystem;

namespace {

flight_log::PictureSource source_of(const RecordedFlight& flight, const RenderAgain& render_again,
                                    const std::function<void()>& now_and_then) {
  const int width = flight.config.camera.stored_width(),
            height = flight.config.camera.stored_height();
  switch (flight.pictures) {
    case flight_log::Pictures::kFilm:
      return flight_log::pictures_in_film(flight.folder, width, height);
    case flight_log::Pictures::kHashes:
      if (render_again) return render_again(flight, now_and_then);
      throw std::runtime_error(
          flight.folder.directory.string() +
          ": keeps no pictures; to render them again takes a gatefly with the simulator (or fly it "
          "with --frames)");
    case flight_log::Pictures::kNone:
    case flight_log::Pictures::kFiles:
      break;
  }
  return flight_log::pictures_in_files(flight.folder, width, height);
}

/// A pilot that estimates by another IMU than it steers by would never leave the ground without.
void expect_navigation_imu(const RecordedFlight& flight) {
  const auto& samples = flight.folder.samples;
  if (!(flight.pilot.filter_imu_hz > 0.0) ||
      std::any_of(samples.begin(), samples.end(), [](const flight_log::FlightSample& sample) {
        return sample.navigation_imu.has_value();
      }))
    return;
  throw std::runtime_error(flight.folder.log.string() + ": has no " +
                           flight_log::kNavigationImuColumns.front() + " ... " +
                           flight_log::kNavigationImuColumns.back() +
                           ", the IMU that filter.imu_hz (or sim.autopilot_imu_hz) = " +
                           files::text_of(flight.pilot.filter_imu_hz) + " is about");
}

flight_log::Estimator estimator_named(const std::string& name) {
  if (name == "drag") return flight_log::Estimator::kDrag;
  if (name == "eskf") return flight_log::Estimator::kEskf;
  if (name == "imu15") return flight_log::Estimator::kImu15;
  return flight_log::Estimator::kPilots;
}

}  // namespace

RecordedFlight read_flight(const ReplayArguments& arguments) {
  if (!(std::abs(arguments.heading_offset_deg) <= 360.0))
    throw std::runtime_error(
        "--heading-offset-deg = " + files::text_of(arguments.heading_offset_deg) +
        ", must be in -360..360");
  RecordedFlight flight;
  const fs::path directory = files::find_data(arguments.directory, arguments.data);
  flight.folder = flight_log::read_flight_folder(directory);
  flight.simulated = is_simulated(directory);
  if (flight.simulated) {
    expect_whole(directory, flight.folder);
    flight.config = config_of_flight(directory, arguments.config);
  } else {
    ConfigArguments config = arguments.config;
    config.configs.insert(config.configs.begin(), "flights");
    flight.config = load(config);
    flight.notes = flight.config.notes;
  }
  const fs::path track_path = !arguments.track.empty() ? config::find_track(arguments.track)
                              : flight.simulated       ? directory / "track.toml"
                                                       : config::find_track("flights");
  const config::TrackFile track = config::read_track(track_path, flight.config.gate);
  flight.track_file = track_path;
  if (flight.simulated) flight.config = config::on_course(std::move(flight.config), track);
  flight.pilot = flight.config.pilot;
  flight.pilot.track = track.track;
  if (flight.simulated)
    flight.pilot.track.laps = laps_of_flight(directory).value_or(track.track.laps);

  flight.true_gates = flight.simulated ? true_gates_of_flight(directory) : track.track.gates;
  if (flight.true_gates.size() != flight.pilot.track.gates.size()) flight.true_gates.clear();

  // A real log: heading from its own AHRS, plus what somebody knows it to be off.
  const auto& samples = flight.folder.samples;
  if (!flight.simulated && samples.front().ahrs)
    flight.pilot.track.start_heading =
        wrap_angle(samples.front().ahrs->yaw + arguments.heading_offset_deg * kDegree);
  flight.ticks = arguments.true_height
                     ? flight_log::ticks_of(flight.folder, flight_log::SonarStandIn{})
                     : flight_log::ticks_of(flight.folder);
  expect_navigation_imu(flight);
  flight.pictures = flight_log::where_pictures_are(flight.folder);
  if (!flight.simulated && flight.pictures == flight_log::Pictures::kHashes)
    flight.pictures = flight_log::Pictures::kFiles;  // nobody can render what was no simulation
  return flight;
}

const std::vector<std::string>& estimator_names() {
  static const std::vector<std::string> names{"drag", "eskf", "imu15"};
  return names;
}

std::string estimator_of(const ReplayArguments& arguments, const PilotConfig& pilot) {
  if (!arguments.estimator.empty()) return arguments.estimator;
  return pilot.filter_model == FilterModel::kOurs ? "eskf" : "drag";
}

flight_log::ReplayResult replayed(
    const RecordedFlight& flight, const ReplayArguments& arguments,
    const std::function<void()>& on_picture, const RenderAgain& render_again,
    const std::function<void(const flight_log::ReplayedTick&)>& on_tick) {
  flight_log::HashCheck hashes;
  const auto load_picture = flight_log::upright(
      flight_log::checked(source_of(flight, render_again, on_picture), flight.folder, hashes),
      flight.config.camera.stored_rotation_deg);
  const auto watched = [&](std::size_t picture) {
    if (on_picture) on_picture();
    return load_picture(picture);
  };
  try {
    auto result =
        flight_log::replay(flight.pilot, flight.ticks, watched,
                           estimator_named(arguments.estimator), on_tick, flight.true_gates);
    result.hashes = hashes;
    return result;
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(std::string("the track cannot be flown: ") + error.what());
  }
}

}  // namespace gatefly::tasks
