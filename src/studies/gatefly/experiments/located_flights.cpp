// SPDX-License-Identifier: Apache-2.0
// Real flights, and where the gates stood that they flew to: nobody wrote that down.
#include "gatefly/experiments/located_flights.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "gatefly/config/track_file.hpp"
#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/tasks/identification/drag_fit.hpp"

namespace gatefly::experiments {
namespace {

namespace fs = std::filesystem;
using flight_log::RecordedTick;
using flight_log::ReplayResult;

constexpr double kAltitudePeriod = 1.0 / 15.0, kAltitudeSigma = 0.05;  // as blind-real [s], [m]
constexpr double kWellInTheAir = 0.8;                                  // [m]
constexpr double kBorderPx = 3.0, kOutlierPx = 5.0;
constexpr std::size_t kFewestPictures = 5;
constexpr double kSameGate = 0.5;  // places nearer than this are one gate's [m]

/// With a sonar that is as noisy as a real one.
std::vector<RecordedTick> ticks_with_sonar(const flight_log::FlightFolder& folder) {
  return flight_log::ticks_of(
      folder, {.period = kAltitudePeriod, .noise = [stream = sim::Stream{1, "altitude"}]() mutable {
                 return kAltitudeSigma * stream.normal();
               }});
}

/// Attitudes that our AHRS has without any picture.
LoggedMotion motion_of(const flight_log::FlightFolder& folder,
                       const std::vector<RecordedTick>& ticks, PilotConfig pilot) {
  pilot.track.start_heading = 0.0;
  LoggedMotion motion{folder};
  motion.clear_attitudes();
  const ReplayResult blind = flight_log::replay(pilot, ticks, [](std::size_t) { return Image{}; });
  for (const auto& row : blind.estimates) motion.add_attitude(row.t, row.estimate.attitude);
  return motion;
}

bool clear_of_border(const Quad& px, const config::Config& config) {
  return std::all_of(px.begin(), px.end(), [&](const Eigen::Vector2d& p) {
    return p.x() > kBorderPx && p.y() > kBorderPx && p.x() < config.camera.width - 1 - kBorderPx &&
           p.y() < config.camera.height - 1 - kBorderPx;
  });
}

std::vector<GatePicture> gates_in(const Flight& flight, const config::Config& config) {
  const auto detector = std::make_unique<GateDetector>(config.pilot.detector);
  std::vector<GatePicture> seen;
  for (const flight_log::FlightImage& image : flight.folder.images) {
    const double t = seconds(image.time);
    if (flight.motion.position(t).z() > -kWellInTheAir) continue;
    const files::ImageFile file = files::read_image(image.path);
    const auto gates =
        detector->look(file.view(config.camera.stored_rotation_deg), config.pilot.gate_color).gates;
    if (!gates.empty() && gates[0].whole && clear_of_border(gates[0].corners_px, config))
      seen.push_back({t, clockwise_from_top_left(gates[0].corners_px)});
  }
  return seen;
}

/// Guesses a gate's place from the nearest picture, its size and the heading of drag.
Survey first_guess(const Flight& flight, const PilotConfig& pilot) {
  Survey guess;
  const auto drag = identification::fit_drag(flight.folder);
  guess.flights = {
      {.heading = log_yaw(flight) + (drag ? drag->heading_offset : 0.0), .tilt = 15.0 * kDegree}};
  const GatePicture& nearest = *std::max_element(
      flight.seen.begin(), flight.seen.end(), [](const GatePicture& a, const GatePicture& b) {
        return std::abs(area(a.px)) < std::abs(area(b.px));
      });
  Attitude attitude = flight.motion.attitude(nearest.t);
  attitude.yaw += guess.flights[0].heading;
  const CameraRig rig = mounted(pilot.camera, guess.airframe, guess.flights[0]);
  const double distance =
      168.0 * pilot.track.gates.front().side / std::sqrt(std::abs(area(nearest.px)));
  const Eigen::Vector3d ray_C =
      rig.lens.bearing(center(nearest.px)).value_or(Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d ray_E = rotation_EB(attitude).matrix * (rig.R_BC.matrix * ray_C);
  guess.gates = {{.p_EG = flight.motion.position(nearest.t) + distance * ray_E,
                  .yaw = gatefly::atan2(ray_E.y(), ray_E.x())}};
  return guess;
}

SurveyFlight sights_of(const Flight& flight, std::size_t gate) {
  return {.motion = &flight.motion, .pictures = flight.seen, .gate = gate};
}

/// A flight alone. Pictures that no gate of its own explains are dropped: another thing was seen.
Survey alone(Flight& flight, const PilotConfig& pilot) {
  Survey survey = first_guess(flight, pilot);
  for (int round = 0; round < 3 && flight.seen.size() >= kFewestPictures; ++round) {
    const SurveyFlight sights = sights_of(flight, 0);
    survey = surveyed({&sights, 1}, survey, Open::kNotAirframe, pilot);
    std::erase_if(flight.seen, [&](const GatePicture& p) {
      return misfit_px(survey, 0, sights, p, pilot) > kOutlierPx;
    });
  }
  return survey;
}

/// All flights together, but one; what only that one would tell stays as it is in `start`.
Survey together(const Located& found, const Survey& start, std::optional<std::size_t> but,
                const PilotConfig& pilot) {
  std::vector<SurveyFlight> sights;
  for (std::size_t i = 0; i < found.flights.size(); ++i) {
    sights.push_back(sights_of(found.flights[i], found.gate_of[i]));
    if (i == but) sights.back().pictures.clear();
  }
  return surveyed(sights, start, Open::kAll, pilot);
}

}  // namespace

double log_yaw(const Flight& flight) {
  return flight.folder.samples.front().ahrs ? flight.folder.samples.front().ahrs->yaw : 0.0;
}

PilotConfig pilot_for_recordings(const config::Config& config) {
  PilotConfig pilot = config.pilot;
  pilot.track = config::read_track(config::find_track("flights")).track;
  pilot.track.room_size = {100.0, 100.0};  // whatever way a frame is turned
  pilot.phase.climb_timeout = 60.0;        // these drones climb when somebody else wants
  return pilot;
}

std::vector<Flight> flights_in(const fs::path& folder, const config::Config& config,
                               const PilotConfig& pilot, const Options& options) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && entry.path().filename().string().starts_with("flight_"))
      paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  if (paths.empty())
    throw std::runtime_error(folder.string() + ": there is no folder flight_* in it");
  std::vector<Flight> flights;
  for (const fs::path& path : paths) {
    if (options.stopped()) throw Stopped{};
    options.progress(0.4 * static_cast<double>(flights.size()) / static_cast<double>(paths.size()),
                     path.filename().string());
    Flight flight{.name = path.filename().string(),
                  .folder = flight_log::read_flight_folder(path),
                  .ticks = {},
                  .motion = {},
                  .seen = {}};
    flight.ticks = ticks_with_sonar(flight.folder);
    flight.motion = motion_of(flight.folder, flight.ticks, pilot);
    flight.seen = gates_in(flight, config);
    flights.push_back(std::move(flight));
  }
  return flights;
}

Located located(std::vector<Flight>& flights, const PilotConfig& pilot) {
  Located found;
  std::vector<Flight> rest;
  for (Flight& flight : flights) {
    Survey own;
    if (flight.seen.size() >= kFewestPictures) own = alone(flight, pilot);
    if (flight.seen.size() < kFewestPictures) {
      rest.push_back(std::move(flight));
      continue;
    }
    auto& gates = found.survey.gates;
    const auto same = std::find_if(gates.begin(), gates.end(), [&](const SurveyedGate& g) {
      return (g.p_EG - own.gates[0].p_EG).norm() < kSameGate;
    });
    found.gate_of.push_back(static_cast<std::size_t>(same - gates.begin()));
    if (same == gates.end()) gates.push_back(own.gates[0]);
    found.survey.flights.push_back(own.flights[0]);
    found.flights.push_back(std::move(flight));
  }
  flights = std::move(rest);
  found.survey = together(found, found.survey, {}, pilot);
  return found;
}

Located with_logged_attitudes(Located found, const PilotConfig& pilot) {
  for (std::size_t i = 0; i < found.flights.size(); ++i) {
    found.flights[i].motion = LoggedMotion{found.flights[i].folder};
    found.survey.flights[i].heading -= log_yaw(found.flights[i]);
  }
  found.survey = together(found, found.survey, {}, pilot);
  return found;
}

Survey by_the_others(const Located& found, std::size_t i, const PilotConfig& pilot) {
  Survey survey = together(found, found.survey, i, pilot);
  const std::size_t gate = found.gate_of[i];
  const SurveyFlight sights = sights_of(found.flights[i], 0);
  const Survey one = surveyed(
      {&sights, 1},
      {.airframe = survey.airframe, .gates = {survey.gates[gate]}, .flights = {survey.flights[i]}},
      found.shared(i) ? Open::kFlights : Open::kNotAirframe, pilot);
  survey.gates[gate] = one.gates[0], survey.flights[i] = one.flights[0];
  return survey;
}

PilotConfig told(PilotConfig pilot, const Survey& survey, std::size_t gate, std::size_t flight) {
  pilot.track.gates.front().p_EG = survey.gates[gate].p_EG,
  pilot.track.gates.front().yaw_EG = survey.gates[gate].yaw;
  pilot.track.start_heading = survey.flights[flight].heading;
  // A surveyed gate is known as well as a pad and a map usually are.
  const PilotConfig usual;
  pilot.ahrs.start_heading_sigma = usual.ahrs.start_heading_sigma;
  pilot.filter.start_sigma = usual.filter.start_sigma;
  pilot.gate_yaw_sigma = usual.gate_yaw_sigma;
  pilot.camera = mounted(pilot.camera, survey.airframe, survey.flights[flight]);
  pilot.camera_timing.latency = survey.airframe.exposure_delay;
  return pilot;
}

PilotConfig told_the_gate(PilotConfig pilot, const SurveyedGate& gate, const Flight& flight) {
  pilot.filter_model = FilterModel::kOurs;
  pilot.track.gates.front().p_EG = gate.p_EG, pilot.track.gates.front().yaw_EG = gate.yaw;
  pilot.track.start_heading = log_yaw(flight);
  return pilot;
}

double misfit_px(const Located& found, const PilotConfig& pilot) {
  double squares = 0.0, n = 0.0;
  for (std::size_t i = 0; i < found.flights.size(); ++i) {
    const SurveyFlight sights = sights_of(found.flights[i], found.gate_of[i]);
    for (const GatePicture& picture : sights.pictures)
      squares += std::pow(misfit_px(found.survey, i, sights, picture, pilot), 2), n += 1.0;
  }
  return std::sqrt(squares / n);
}

}  // namespace gatefly::experiments
