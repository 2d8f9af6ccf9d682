// SPDX-License-Identifier: Apache-2.0
// The pilot on flights that really happened: IMU, motion-capture height and pictures of a Bebop.
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "gatefly/closed_loop/replay.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/io/config.hpp"
#include "gatefly/io/flight_folder.hpp"
#include "gatefly/io/image_file.hpp"
#include "gatefly/io/track_file.hpp"

namespace gatefly {
namespace {

namespace fs = std::filesystem;

fs::path flights() {
  if (const char* data = std::getenv("GATEFLY_DATA")) return fs::path{data} / "tudelft_bebop_flights";
  const char* source = std::getenv("GATEFLY_SOURCE_DIR");
  return fs::path{source == nullptr ? "." : source} / ".." / "shared" / "data" / "tudelft_bebop_flights";
}

closed_loop::ReplayResult replayed(const fs::path& directory, closed_loop::Estimator estimator = closed_loop::Estimator::kDrag) {
  const io::Config config = io::load_config(io::config_files(std::vector<std::string>{"flights"}));
  const io::FlightFolder folder = io::read_flight_folder(directory);
  PilotConfig pilot = config.pilot;
  pilot.track = io::read_track(io::find_track("flights")).track;
  pilot.track.start_heading = wrap_angle(folder.samples.front().ahrs->yaw + 11.5 * kDegree);
  std::vector<closed_loop::RecordedTick> ticks(folder.samples.size());
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const auto& sample = folder.samples[i];
    ticks[i].sensors.time = sample.time;
    ticks[i].sensors.imu = sample.imu;
    ticks[i].p_EB = sample.true_p_EB;
    if (i % 20 == 0) ticks[i].sensors.sonar = -sample.true_p_EB->z();  // the log has no sonar
  }
  for (std::size_t i = 0; i < folder.images.size(); ++i) ticks[folder.images[i].log_row].picture = i;
  io::ImageFile picture;
  return closed_loop::replay(pilot, ticks, [&](std::size_t i) {
    picture = io::read_image(folder.images[i].path);
    return picture.view(config.stored_rotation_deg);
  }, estimator);
}

TEST(RealFlight, ElevenIsFollowedToTheGateWithin04Metres) {
  const fs::path directory = flights() / "flight_11";
  if (!fs::exists(directory)) GTEST_SKIP() << "no real flights at " << directory << " (set GATEFLY_DATA)";
  const auto result = replayed(directory);
  EXPECT_TRUE(result.finite);
  EXPECT_EQ(result.gates_passed, 1);
  ASSERT_GT(result.rmse_samples, 1000);
  EXPECT_LT(result.rmse.x(), 0.4);
  EXPECT_LT(result.rmse.y(), 0.4);
  int seen = 0;
  for (const auto& row : result.pictures) seen += row.sighting.seen && row.picture >= 18 && row.picture <= 36;
  EXPECT_GE(seen, 12) << "of the 19 pictures labelled in the air";
}

// The same fixes through the inertial filter: another estimate, and as near.
TEST(RealFlight, TheInertialFilterFollowsElevenOnThePilotsFixes) {
  const fs::path directory = flights() / "flight_11";
  if (!fs::exists(directory)) GTEST_SKIP() << "no real flights at " << directory << " (set GATEFLY_DATA)";
  const auto drag = replayed(directory), inertial = replayed(directory, closed_loop::Estimator::kImu15);
  EXPECT_TRUE(inertial.finite);
  EXPECT_EQ(inertial.gates_passed, drag.gates_passed);
  EXPECT_NE(inertial.rmse, drag.rmse);
  EXPECT_LT(inertial.rmse.x(), 0.4);
  EXPECT_LT(inertial.rmse.y(), 0.4);
}

TEST(RealFlight, TenFlightsReplayWithoutANonFiniteNumber) {
  if (!fs::exists(flights())) GTEST_SKIP() << "no real flights at " << flights() << " (set GATEFLY_DATA)";
  for (int flight = 3; flight <= 12; ++flight) {
    const auto result = replayed(flights() / ((flight < 10 ? "flight_0" : "flight_") + std::to_string(flight)));
    EXPECT_TRUE(result.finite) << "flight " << flight;
  }
}

}  // namespace
}  // namespace gatefly
