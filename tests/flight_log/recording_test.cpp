// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/recording.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/flight_log/replay.hpp"
#include "gatefly/geometry/math.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::flight_log {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A log at 100 Hz of a drone 2 m above the floor, without sonar, barometer or pictures.
FlightFolder hovering(int rows) {
  FlightFolder folder;
  for (int i = 0; i < rows; ++i)
    folder.samples.push_back({.time = milliseconds{10 * i},
                              .imu = {.gyro_B = {0.1 * i, 0, 0}, .accel_B = {0, 0, -9.81}},
                              .true_p_EB = Eigen::Vector3d{1, 2, -2}});
  return folder;
}

std::vector<std::size_t> rows_with_sonar(const std::vector<RecordedTick>& ticks) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < ticks.size(); ++i)
    if (ticks[i].sensors.sonar) rows.push_back(i);
  return rows;
}

TEST(TicksOf, ALogAreItsRowsAsTheyStand) {
  FlightFolder folder = hovering(3);
  folder.samples[1].sonar = 1.5, folder.samples[2].baro = 1.75;
  folder.samples[2].true_p_EB.reset();
  const auto ticks = ticks_of(folder);
  ASSERT_EQ(ticks.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(ticks[i].sensors.time, folder.samples[i].time);
    EXPECT_EQ(ticks[i].sensors.imu.gyro_B, folder.samples[i].imu.gyro_B);
    EXPECT_EQ(ticks[i].sensors.imu.accel_B, folder.samples[i].imu.accel_B);
    EXPECT_EQ(ticks[i].sensors.sonar, folder.samples[i].sonar);
    EXPECT_EQ(ticks[i].sensors.baro, folder.samples[i].baro);
    EXPECT_EQ(ticks[i].p_EB, folder.samples[i].true_p_EB);
    EXPECT_FALSE(ticks[i].picture.has_value());
  }
}

std::vector<std::size_t> rows_of_take_off(const FlightFolder& folder) {
  std::vector<std::size_t> rows;
  const auto ticks = ticks_of(folder);
  for (std::size_t i = 0; i < ticks.size(); ++i)
    if (ticks[i].sensors.lifted) rows.push_back(i);
  return rows;
}

// A log whose drone does not rest as long as our pilot wants to must not leave the pilot on the
// ground.
TEST(TicksOf, AnotherPilotsTakeOffIsWhereThrustIsAskedForOrItClimbs) {
  FlightFolder folder = hovering(10);
  EXPECT_THAT(rows_of_take_off(folder), ElementsAre()) << "hovers from the first row on";
  folder.samples[7].true_p_EB->z() = -2.2;
  EXPECT_THAT(rows_of_take_off(folder), ElementsAre(7));
  for (auto& sample : folder.samples) sample.thrust = 0.0;
  folder.samples[4].thrust = 3500.0;
  EXPECT_THAT(rows_of_take_off(folder), ElementsAre(4));
  folder.samples[0].est_p_EB = Eigen::Vector3d::Zero();
  EXPECT_THAT(rows_of_take_off(folder), ElementsAre()) << "our own pilot's log";
}

// A recorder begins with the battery, a pilot that rests for so long takes off.
TEST(TicksOf, ALongRestBeforeAnotherPilotsTakeOffIsHeldBack) {
  FlightFolder folder = hovering(400);
  for (std::size_t i = 0; i < 400; ++i) folder.samples[i].lifted = i >= 300;
  const auto held = [&] {
    const auto ticks = ticks_of(folder);
    return std::count_if(ticks.begin(), ticks.end(), [](const auto& tick) { return tick.held; });
  };
  EXPECT_EQ(held(), 170) << "all but the last 1.3 s";
  const ReplayResult result = replay(
      [] {
        PilotConfig config;
        config.imu_hz = 100.0;
        config.track.gates = {MapGate{.p_EG = {4, 0, -1.5}}};
        return config;
      }(),
      ticks_of(folder), {});
  EXPECT_EQ(result.estimates.size(), 400) << "a row for each of the log's";
  folder.samples[0].est_p_EB = Eigen::Vector3d::Zero();
  EXPECT_EQ(held(), 0) << "our own pilot's log, which it flew from the first row on";
  folder.samples[0].est_p_EB.reset();
  for (auto& sample : folder.samples) sample.lifted = false;
  EXPECT_EQ(held(), 0) << "it never takes off";
}

TEST(TicksOf, NothingAreNone) { EXPECT_TRUE(ticks_of({}).empty()); }

TEST(TicksOf, ALostImuSampleStaysLost) {
  FlightFolder folder = hovering(2);
  folder.samples[1].imu.accel_B.y() = std::nan("");
  EXPECT_TRUE(std::isnan(ticks_of(folder)[1].sensors.imu.accel_B.y()));
}

TEST(TicksOf, APictureArrivesInItsRowAndOfTwoInOneTheLater) {
  FlightFolder folder = hovering(4);
  folder.images = {{.path = "a.jpg", .log_row = 1},
                   {.path = "b.jpg", .log_row = 3},
                   {.path = "c.jpg", .log_row = 3}};
  const auto ticks = ticks_of(folder);
  EXPECT_EQ(ticks[1].picture, 0u);
  EXPECT_FALSE(ticks[2].picture.has_value());
  EXPECT_EQ(ticks[3].picture, 2u);
}

TEST(TicksOf, APictureBeyondTheLogIsRefusedByName) {
  FlightFolder folder = hovering(4);
  folder.images = {{.path = "late.jpg", .log_row = 4}};
  EXPECT_THROW((void)ticks_of(folder), std::invalid_argument);
  EXPECT_THAT(test::error_of([&] { (void)ticks_of(folder); }),
              HasSubstr("late.jpg: arrives in row 4 of a log of 4"));
}

TEST(TicksOf, TruthStaysOutUnlessItIsAskedFor) {
  EXPECT_THAT(rows_with_sonar(ticks_of(hovering(20))), ElementsAre());
}

TEST(TicksOf, WithoutAnyHeightEachNewTruthStandsInForTheSonarOnce) {
  FlightFolder folder = hovering(20);
  for (std::size_t i = 7; i < 20; ++i) folder.samples[i].true_p_EB->z() = -2.5;
  for (std::size_t i = 12; i < 20; ++i) folder.samples[i].true_p_EB->x() = 1.1;
  const auto ticks = ticks_of(folder, SonarStandIn{});
  EXPECT_THAT(rows_with_sonar(ticks), ElementsAre(0, 7, 12));
  EXPECT_EQ(ticks[0].sensors.sonar, 2.0);
  EXPECT_EQ(ticks[12].sensors.sonar, 2.5);
}

TEST(TicksOf, OrTruthStandsInAtAGivenRate) {
  const auto ticks = ticks_of(hovering(20), {.period = 0.045});
  EXPECT_THAT(rows_with_sonar(ticks), ElementsAre(0, 5, 10, 15));
  EXPECT_EQ(ticks[5].sensors.sonar, 2.0);
  EXPECT_FALSE(ticks[5].sensors.baro.has_value());
}

TEST(TicksOf, OneHeightOfItsOwnAnywhereAndTruthStaysOut) {
  FlightFolder sonar = hovering(20), baro = hovering(20);
  sonar.samples[7].sonar = 1.9;
  baro.samples[3].baro = 1.9;
  EXPECT_THAT(rows_with_sonar(ticks_of(sonar, SonarStandIn{})), ElementsAre(7));
  EXPECT_THAT(rows_with_sonar(ticks_of(baro, SonarStandIn{})), ElementsAre());
}

TEST(TicksOf, TheStandInIsARangeAlongTheBodysAxis) {
  FlightFolder folder = hovering(1);
  folder.samples[0].ahrs = Attitude{.roll = 60.0 * kDegree};
  EXPECT_NEAR(ticks_of(folder, SonarStandIn{})[0].sensors.sonar.value(), 4.0, 1e-12);
  folder.samples[0].true_attitude = Attitude{.pitch = 60.0 * kDegree};  // goes before the AHRS's
  folder.samples[0].ahrs = Attitude{};
  EXPECT_NEAR(ticks_of(folder, SonarStandIn{})[0].sensors.sonar.value(), 4.0, 1e-12);
  folder.samples[0].true_attitude = Attitude{.roll = kPi};
  EXPECT_FALSE(ticks_of(folder, SonarStandIn{})[0].sensors.sonar.has_value()) << "it looks up";
}

TEST(TicksOf, NoTruthOrOnTheFloorNoStandIn) {
  FlightFolder folder = hovering(4);
  folder.samples[0].true_p_EB.reset();
  folder.samples[1].true_p_EB->z() = 0.0;
  folder.samples[2].true_p_EB->z() = 0.1;
  EXPECT_THAT(rows_with_sonar(ticks_of(folder, {.period = 0.0})), ElementsAre(3));
}

TEST(TicksOf, NoiseIsDrawnOnceForEachReading) {
  int drawn = 0;
  const auto ticks =
      ticks_of(hovering(20), {.period = 0.045, .noise = [&] { return 0.1 * ++drawn; }});
  EXPECT_EQ(drawn, 4);
  EXPECT_DOUBLE_EQ(ticks[0].sensors.sonar.value(), 2.1);
  EXPECT_DOUBLE_EQ(ticks[15].sensors.sonar.value(), 2.4);
}

// A logger that stopped for a second: stamps stay as they are, and nothing is made up for the gap.
TEST(TicksOf, AGapInTimeStaysAGap) {
  FlightFolder folder = hovering(20);
  for (std::size_t i = 10; i < 20; ++i) folder.samples[i].time += milliseconds{1000};
  const auto ticks = ticks_of(folder, {.period = 0.045});
  EXPECT_EQ(ticks[10].sensors.time - ticks[9].sensors.time, milliseconds{1010});
  EXPECT_THAT(rows_with_sonar(ticks), ElementsAre(0, 5, 10, 15));
}

TEST(PicturesInFiles, AreLoadedUprightAndReplayedInTheirTicks) {
  const test::TempFolder directory;
  FlightFolder folder = hovering(4);
  folder.images = {{.path = directory.file("a.ppm", "P6 2 1 255\nRRRGGG"), .log_row = 1},
                   {.path = directory.file("b.ppm", "P6 2 1 255\nGGGBBB"), .log_row = 3}};
  const auto load = upright(pictures_in_files(folder, 2, 1), 90);
  const Image first = load(0);
  EXPECT_EQ(first.width(), 1);
  EXPECT_EQ(first.height(), 2);
  EXPECT_EQ(load(1).height(), 2);

  PilotConfig pilot;
  pilot.track.gates = {MapGate{.p_EG = {4, 0, -1.5}}};
  std::vector<std::size_t> loaded;
  const ReplayResult result = replay(pilot, ticks_of(folder), [&](std::size_t i) {
    loaded.push_back(i);
    return load(i);
  });
  EXPECT_THAT(loaded, ElementsAre(0, 1));
  ASSERT_EQ(result.pictures.size(), 2u);
  EXPECT_DOUBLE_EQ(result.pictures[1].t, 0.03);
  EXPECT_EQ(result.estimates.size(), 4u);
}

TEST(PicturesInFiles, OfAnotherSizeThanTheCamerasAreRefused) {
  const test::TempFolder directory;
  FlightFolder folder = hovering(1);
  folder.images = {{.path = directory.file("a.ppm", "P6 3 1 255\nRRRGGGBBB"), .log_row = 0}};
  EXPECT_THAT(test::error_of([&] { (void)pictures_in_files(folder, 1, 3)(0); }),
              HasSubstr("a.ppm: is 3 x 1, the camera's as stored 1 x 3 (camera.size_px)"));
}

TEST(PicturesInFiles, APictureThatIsNotThereSaysItsName) {
  FlightFolder folder = hovering(1);
  folder.images = {{.path = "nowhere.jpg", .log_row = 0}};
  EXPECT_THAT(test::error_of([&] { (void)pictures_in_files(folder, 0, 0)(0); }),
              HasSubstr("nowhere.jpg"));
}

}  // namespace
}  // namespace gatefly::flight_log
