// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/race_maker.hpp"

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "gatefly/config/derived.hpp"
#include "gatefly/config/faults.hpp"
#include "gatefly/config/randomize_keys.hpp"
#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/files/xxh64.hpp"
#include "gatefly/sim/drawn.hpp"
#include "gatefly/sim/scene.hpp"
#include "gatefly/simulated_race/built_from.hpp"
#include "gatefly/tasks/flight_inputs.hpp"

namespace gatefly::simulated_race {
namespace {

namespace fs = std::filesystem;

void refuse_unflyable(const config::Config& config) {
  if (config.gate.corners != "outer")
    throw std::runtime_error("gate.corners = \"" + config.gate.corners +
                             "\", must be \"outer\" to fly");
  if (config.camera.stored_width() % 2 != 0)
    throw std::runtime_error(
        "camera.size_px = [" + std::to_string(config.camera.width) + ", " +
        std::to_string(config.camera.height) + "], but pictures are stored " +
        std::to_string(config.camera.stored_width()) +
        " px wide (camera.stored_rotation_deg): must be even to fly, for UYVY");
  if (config.rates.filter_imu_hz > 0.0 && !(config.sim.sensors.autopilot_imu_hz > 0.0))
    throw std::runtime_error("filter.imu_hz = " + files::text_of(config.rates.filter_imu_hz) +
                             ", but nobody hands on such an IMU: sim.autopilot_imu_hz = 0, must be "
                             "25..512 to fly");
  constexpr double kGravity = 9.81, kToSpare = 1.1;  // [with less no seed finishes the oval]
  const config::VehicleDescription& v = config.vehicle;
  const auto lifts = [&](double speed) {
    return 4.0 * v.thrust_coefficient * speed * speed / kGravity;
  };
  const auto fail = [&](const char* key, double speed, const std::string& what) {
    throw std::runtime_error("vehicle.mass_kg = " + files::text_of(v.mass) +
                             ", but four rotors at " + key + " = " + files::text_of(speed) +
                             " lift " + files::text_of(lifts(speed), 3) +
                             " kg (vehicle.thrust_coefficient): " + what);
  };
  if (lifts(v.max_speed) < kToSpare * v.mass)
    fail("vehicle.max_rotor_radps", v.max_speed, "must be a tenth more than its mass to fly");
  if (lifts(v.min_speed) >= v.mass)
    fail("vehicle.min_rotor_radps", v.min_speed, "must be less than its mass to come down");
}

/// Pictures take a light map, and that takes memory and time by the room's area.
void refuse_too_large_for_pictures(const world::World& world, const fs::path& path) {
  try {
    (void)sim::make_scene(world);
  } catch (const std::length_error& error) {
    const Eigen::Vector3d& size = world.room_size;
    throw std::runtime_error(path.string() + ": room.size_m = [" + files::text_of(size.x()) + ", " +
                             files::text_of(size.y()) + ", " + files::text_of(size.z()) + "]: " +
                             error.what() + "; one of 100 x 100 m fits, --vision ideal needs none");
  }
}

std::string fingerprint_of(const RaceIdentity& race,
                           const std::map<std::string, std::string>& inputs) {
  nlohmann::json all{
      {"vision", race.vision}, {"config", race.config}, {"track", inputs.at("track.toml")}};
  if (const auto table = inputs.find("colors.toml"); table != inputs.end()) {
    all["colors"] = table->second;  // its content counts, not where it lies
    all["config"]["color"].erase("table");
  }
  const std::string text = all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
  return files::text_of_xxh64(files::xxh64({bytes, text.size()}));
}

}  // namespace

RaceMaker::RaceMaker(const RaceArguments& given) {
  tasks::ConfigArguments arguments = given.config;
  config::Config config = tasks::load(arguments);
  refuse_unflyable(config);
  const fs::path path = config::find_track(given.track);
  config::TrackFile file = config::read_track(path, config.gate);
  config = config::on_course(std::move(config), file);
  if (given.laps) file.track.laps = *given.laps;

  const int laps = file.track.laps;
  nominal(config, path, std::move(file), given.vision);
  if (nominal_.vision == Vision::kRendered) refuse_too_large_for_pictures(nominal_.sim.world, path);
  inputs_ = tasks::flight_inputs(arguments, config, path, laps);
  identity_.configuration = fingerprint_of(identity_, inputs_);

  // Whether there is a way at all, before anything is written or rendered.
  try {
    const Pilot plans{nominal_.pilot};
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(path.string() + ": cannot be flown: " + error.what());
  }
  notes_ = config.notes;
}

RaceMaker RaceMaker::of_flight(const fs::path& directory) {
  config::Config config = tasks::config_of_flight(directory, {});
  config::TrackFile file = config::read_track(directory / "track.toml", config.gate);
  config = config::on_course(std::move(config), file);
  if (const auto laps = tasks::laps_of_flight(directory)) file.track.laps = *laps;
  RaceMaker maker;
  maker.nominal(config, directory / "track.toml", std::move(file), "rendered");
  return maker;
}

void RaceMaker::nominal(const config::Config& config, const fs::path& path, config::TrackFile file,
                        const std::string& vision) {
  nominal_.vision = vision == "ideal" ? Vision::kIdeal : Vision::kRendered;
  nominal_.timeout = config.sim.timeout;
  nominal_.pilot = config.pilot;
  nominal_.pilot.track = file.track;
  nominal_.sim = config::simulator_config(config, file);
  nominal_.sim.cache_dir = files::cache_dir();
  nominal_.sim.faults = config::with_faults(file.faults, config.faults, "[faults]");
  config::expect_gates_of(nominal_.sim.faults, file.track.gates.size(), path.string());
  randomize_ = config::randomized(file.randomize, config.randomize, "[randomize]");

  identity_ = {.track = file.track.name,
               .seed = 0,
               .vision = vision,
               .version = GATEFLY_VERSION,
               .commit = built_from(),
               .configuration = {},
               .config = config::as_json(config)};
  for (const auto& key : config::randomize_keys())
    identity_.config["randomize"][key.rule.name.substr(10)] = key.get(randomize_);
  for (const auto& key : config::fault_keys())
    identity_.config["faults"][key.rule.name.substr(7)] = key.get(nominal_.sim.faults);
  identity_.config["laps"] = file.track.laps;
}

Race RaceMaker::race(std::uint64_t seed) const {
  Race race{nominal_, identity_};
  race.config.sim = sim::drawn(nominal_.sim, randomize_, seed);
  race.identity.seed = seed;
  return race;
}

}  // namespace gatefly::simulated_race
