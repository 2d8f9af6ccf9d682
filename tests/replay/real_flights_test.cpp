// SPDX-License-Identifier: Apache-2.0
// The pilot on flights that really happened: IMU, motion-capture height and pictures of a Bebop.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "support/recorded_flight.hpp"

namespace gatefly {
namespace {

namespace fs = std::filesystem;

fs::path flights() { return support::real_flights(); }

flight_log::ReplayResult replayed(const fs::path& directory,
                                  flight_log::Estimator estimator = flight_log::Estimator::kDrag) {
  return support::replayed_real(directory, 11.5, estimator);
}

TEST(RealFlight, ElevenIsFollowedToTheGateWithin04Metres) {
  const fs::path directory = flights() / "flight_11";
  if (!fs::exists(directory))
    GTEST_SKIP() << "no real flights at " << directory << " (set GATEFLY_DATA)";
  const auto result = replayed(directory);
  EXPECT_TRUE(result.finite);
  EXPECT_EQ(result.gates_passed, 1);
  ASSERT_GT(result.rmse_samples, 1000);
  EXPECT_LT(result.rmse.x(), 0.4);
  EXPECT_LT(result.rmse.y(), 0.4);
  int seen = 0;
  for (const auto& row : result.pictures)
    seen += row.sighting.seen && row.picture >= 18 && row.picture <= 36;
  EXPECT_GE(seen, 12) << "of the 19 pictures labelled in the air";
}

// The same fixes through the inertial filter: another estimate, and as near.
TEST(RealFlight, TheInertialFilterFollowsElevenOnThePilotsFixes) {
  const fs::path directory = flights() / "flight_11";
  if (!fs::exists(directory))
    GTEST_SKIP() << "no real flights at " << directory << " (set GATEFLY_DATA)";
  const auto drag = replayed(directory),
             inertial = replayed(directory, flight_log::Estimator::kImu15);
  EXPECT_TRUE(inertial.finite);
  EXPECT_EQ(inertial.gates_passed, drag.gates_passed);
  EXPECT_NE(inertial.rmse, drag.rmse);
  EXPECT_LT(inertial.rmse.x(), 0.4);
  EXPECT_LT(inertial.rmse.y(), 0.4);
}

/// As plain `gatefly replay` does it: the filter that finds heading, tilt and delay by itself, without a
/// height.
flight_log::ReplayResult plain(const fs::path& directory) {
  const config::Config config =
      config::load_config(config::config_files(std::vector<std::string>{"flights"}));
  const flight_log::FlightFolder folder = flight_log::read_flight_folder(directory);
  PilotConfig pilot = config.pilot;
  pilot.track = config::read_track(config::find_track("flights")).track;
  pilot.track.start_heading = folder.samples.front().ahrs.value().yaw;
  const auto load =
      flight_log::upright(flight_log::pictures_in_files(folder, config.camera.stored_width(),
                                                        config.camera.stored_height()),
                          config.camera.stored_rotation_deg);
  return flight_log::replay(pilot, flight_log::ticks_of(folder), load, flight_log::Estimator::kEskf,
                            {}, pilot.track.gates);
}

// Nothing is told of a flight but its own sensors, the gate and where the drone was put.
TEST(RealFlight, EightFlightsFindTheirGateByThemselvesAndTheTwoElsewhereSaySo) {
  if (!fs::exists(flights()))
    GTEST_SKIP() << "no real flights at " << flights() << " (set GATEFLY_DATA)";
  for (int flight = 3; flight <= 12; ++flight) {
    const auto result =
        plain(flights() / ((flight < 10 ? "flight_0" : "flight_") + std::to_string(flight)));
    const bool elsewhere = flight == 5 || flight == 9;  // their gate is not the map's
    EXPECT_EQ(result.divergence.has_value() || !result.known_to.has_value(), elsewhere)
        << "flight " << flight;
    if (elsewhere) continue;
    ASSERT_TRUE(result.known_to.has_value()) << "flight " << flight;
    EXPECT_LT(*result.known_to, 0.2) << "flight " << flight;
    EXPECT_LT(result.score.gate.rms().x(), 0.15) << "flight " << flight;
    EXPECT_LT(result.score.gate.rms().y(), 0.15) << "flight " << flight;
  }
}

TEST(RealFlight, TenFlightsReplayWithoutANonFiniteNumber) {
  if (!fs::exists(flights()))
    GTEST_SKIP() << "no real flights at " << flights() << " (set GATEFLY_DATA)";
  for (int flight = 3; flight <= 12; ++flight) {
    const auto result =
        replayed(flights() / ((flight < 10 ? "flight_0" : "flight_") + std::to_string(flight)));
    EXPECT_TRUE(result.finite) << "flight " << flight;
  }
}

}  // namespace
}  // namespace gatefly
