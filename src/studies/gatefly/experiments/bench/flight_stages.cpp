// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/bench/flight_stages.hpp"

#include <array>
#include <optional>

#include "gatefly/control/indi.hpp"
#include "gatefly/experiments/bench/opencv_baseline.hpp"
#include "gatefly/flight_log/baseline/imu15.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::bench {
namespace {

drag_model::Input input_of(const RecordedFlight::Moment& m) {
  return {.roll = m.attitude.roll,
          .pitch = m.attitude.pitch,
          .yaw = m.attitude.yaw,
          .accel_B = m.imu.accel_B,
          .gyro_B = m.imu.gyro_B};
}

std::optional<Fix> fix_of(const RecordedFlight::Sight& sight, const PilotConfig& config) {
  return fix_from_corners(sight.corners_px, sight.R_GB, config.track.gates.front().side,
                          config.camera, config.pose);
}

/// The same by cv::solvePnP; the lens is ours in both.
void position_by_pnp(const RecordedFlight::Sight& sight, const PilotConfig& config) {
  std::array<Eigen::Vector3d, 4> bearings;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto bearing = config.camera.lens.bearing(sight.corners_px[i]);
    if (!bearing) return;
    bearings[i] = *bearing;
  }
  (void)opencv_position(bearings, config.track.gates.front().side);
}

/// The two filters in turns, on the same samples and positions; each starts a correction from where
/// it started.
void add_filters(std::vector<Stage>& stages, const std::shared_ptr<const RecordedFlight>& flight,
                 const PilotConfig& config) {
  constexpr std::size_t kAtOnce = 64;
  auto fixes = std::make_shared<std::vector<Fix>>();
  for (const auto& sight : flight->sights)
    if (const auto fix = fix_of(sight, config)) fixes->push_back(*fix);
  const std::size_t moments = flight->moments.size(), enough = fixes->empty() ? 0 : 512;
  const auto add = [&](const std::string& name, const std::string& what, std::size_t inputs,
                       std::function<void(std::size_t)> work, const std::string& baseline = "") {
    stages.push_back({.name = name,
                      .what = what,
                      .inputs = inputs,
                      .call = std::move(work),
                      .baseline = baseline,
                      .at_once = kAtOnce});
  };
  const baseline::Imu15 classic{{}};
  auto inertial = std::make_shared<baseline::Imu15>(classic);
  add("predict15", "15-state inertial filter, one IMU sample", moments,
      [=](std::size_t i) { inertial->predict(flight->moments[i].imu, flight->moments[i].dt); });
  auto filter = std::make_shared<DragFilter>(config.filter);
  add(
      "predict", "drag filter, one IMU sample", moments,
      [=](std::size_t i) { filter->predict(input_of(flight->moments[i]), flight->moments[i].dt); },
      "predict15");
  const auto fix_at = [=](std::size_t i) -> const Fix& { return (*fixes)[i % fixes->size()]; };
  add("correct15", "15-state inertial filter, one position", enough, [=](std::size_t i) {
    *inertial = classic;
    inertial->correct_position(fix_at(i).p_GB, fix_at(i).covariance.diagonal().cwiseSqrt());
  });
  auto corrected = std::make_shared<DragFilter>(config.filter);
  add(
      "correct", "drag filter, one position", enough,
      [=](std::size_t i) {
        corrected->start(fix_at(i).p_GB, Eigen::Vector3d::Zero());
        (void)corrected->correct(fix_at(i));
      },
      "correct15");
}

}  // namespace

RecordedFlight recorded_flight(const simulated_race::RaceConfig& race, std::size_t pictures,
                               const std::function<bool()>& stopped) {
  RecordedFlight flight;
  double time = 0.0;
  const auto result = simulated_race::fly(race, [&](const flight_log::Tick& tick) {
    const double now = 1e-9 * static_cast<double>(tick.sensors.time.count());
    const double dt = now - time;
    time = now;
    if (std::holds_alternative<OnGround>(tick.pilot.phase())) return !stopped();
    const Estimate estimate = tick.pilot.estimate();
    const Eigen::Matrix3d R_EB = rotation_EB(estimate.attitude).matrix;
    flight.moments.push_back({tick.sensors.imu, estimate.attitude, R_EB.transpose() * estimate.v_E,
                              tick.command.attitude, dt});
    if (!tick.frame.empty()) {
      const auto& camera = race.sim.camera;
      flight.pictures.push_back({"frame " + std::to_string(flight.pictures.size()),
                                 {tick.frame.begin(), tick.frame.end()},
                                 camera.stored_width,
                                 camera.stored_height,
                                 90});
      const Sighting& sighting = tick.pilot.sighting();
      if (sighting.used >= 0) {
        const double yaw =
            race.pilot.track.gates[static_cast<std::size_t>(tick.pilot.target_gate())].yaw_EG;
        flight.sights.push_back(
            {sighting.detections[static_cast<std::size_t>(sighting.used)].corners_px,
             {rotation_z(-yaw) * R_EB}});
      }
    }
    return flight.pictures.size() < pictures && !stopped();
  });
  flight.timings = result.timings;
  return flight;
}

std::vector<Stage> flight_stages(std::shared_ptr<const RecordedFlight> flight,
                                 const PilotConfig& config) {
  constexpr std::size_t kAtOnce = 64;
  const std::size_t moments = flight->moments.size(), sights = flight->sights.size();
  std::vector<Stage> stages;

  auto ahrs = std::make_shared<Ahrs>(config.ahrs);
  stages.push_back({.name = "ahrs",
                    .what = "attitude, one IMU sample",
                    .inputs = moments,
                    .call =
                        [=](std::size_t i) {
                          const auto& m = flight->moments[i];
                          ahrs->update(m.imu, m.v_B, m.dt);
                        },
                    .at_once = kAtOnce});
  add_filters(stages, flight, config);
  auto indi = std::make_shared<Indi>(config.indi, config.vehicle);
  stages.push_back({.name = "indi",
                    .what = "rotor speeds, one IMU sample",
                    .inputs = moments,
                    .call =
                        [=](std::size_t i) {
                          const auto& m = flight->moments[i];
                          (void)indi->step(m.command, rotation_EB(m.attitude), m.imu.gyro_B, m.dt);
                        },
                    .at_once = kAtOnce});
  if (has_opencv())
    stages.push_back(
        {.name = "pnp", .what = "cv::solvePnP", .inputs = sights, .call = [=](std::size_t i) {
           position_by_pnp(flight->sights[i], config);
         }});
  stages.push_back({.name = "fix",
                    .what = "position from four corners",
                    .inputs = sights,
                    .call = [=](std::size_t i) { (void)fix_of(flight->sights[i], config); },
                    .baseline = has_opencv() ? "pnp" : ""});
  stages.push_back({.name = "plan",
                    .what = "the whole course, before take-off",
                    .inputs = 1,
                    .call = [=](std::size_t) { (void)plan_race(config.track, config.plan); }});
  return stages;
}

}  // namespace gatefly::bench
