// SPDX-License-Identifier: Apache-2.0
// Three threads give the pilot what a replay gives it.
#include "gatefly/live/session.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"
#include "gatefly/live/folder_camera.hpp"
#include "gatefly/live/linked.hpp"

#include "support/recorded_flight.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;

struct Flown {
  std::vector<Command> commands;
  std::vector<Estimate> estimates;
  int pictures = 0;
};

/// The shipped flight through the threads; `pace` times its own, 0: as fast as it can.
Flown flown(const std::filesystem::path& directory, double pace) {
  const config::Config config = support::config_of(directory);
  const flight_log::FlightFolder folder = flight_log::read_flight_folder(directory);
  const auto ticks = flight_log::ticks_of(folder);
  const SessionPlan plan{.pilot = support::pilot_of(config, directory),
                         .rotation_deg = config.camera.stored_rotation_deg,
                         .recorded = true};
  const StoredSize size{config.camera.stored_width(), config.camera.stored_height()};
  Session session{
      plan, std::make_unique<FolderCamera>(directory, size, false),
      [&](Wires& wires, const RunClock& clock) { play(ticks, folder, pace, wires, clock); }};
  Flown all;
  const auto take = [&](const FlownTick& tick) {
    all.commands.push_back(tick.command);
    all.estimates.push_back(tick.estimate);
    all.pictures += tick.picture != nullptr;
  };
  session.start();
  while (!session.over()) {
    if (!session.drain(take)) std::this_thread::sleep_for(1ms);
  }
  session.drain(take);
  session.stop();
  return all;
}

std::array<double, 12> numbers_of(const Command& c) {
  return {c.attitude.roll,   c.attitude.pitch, c.attitude.yaw, c.attitude.yaw_rate,
          c.attitude.thrust, c.motors[0],      c.motors[1],    c.motors[2],
          c.motors[3],       c.rates_B.x(),    c.rates_B.y(),  c.rates_B.z()};
}

class SessionAtPace : public ::testing::TestWithParam<double> {};

void expect_as_replayed(const Flown& live, const flight_log::ReplayResult& replayed) {
  ASSERT_EQ(live.commands.size(), replayed.commands.size());
  EXPECT_EQ(live.commands.size(), 4103u) << "commands are compared";
  EXPECT_EQ(live.pictures, 39);
  for (std::size_t i = 0; i < live.commands.size(); ++i) {
    ASSERT_EQ(numbers_of(live.commands[i]), numbers_of(replayed.commands[i])) << "command " << i;
    ASSERT_EQ(live.estimates[i].p_EB, replayed.estimates[i].estimate.p_EB) << "estimate " << i;
  }
}

const auto kFlight = support::source_folder() / "tests" / "replay" / "oval_flight";

TEST_P(SessionAtPace, GivesTheCommandsOfAReplayToTheBit) {
  expect_as_replayed(flown(kFlight, GetParam()),
                     support::replayed_simulated(kFlight, flight_log::Estimator::kPilots));
}

INSTANTIATE_TEST_SUITE_P(Paces, SessionAtPace, ::testing::Values(0.0, 4.0));

TEST(Session, PicturesThatWereLateByTheirStampsAreReplayedSo) {
  const test::TempFolder temp;
  const auto directory = temp.path() / "flight";
  std::filesystem::copy(kFlight, directory);
  std::istringstream rows{files::read_file(kFlight / "images.csv")};
  std::string all, row;
  std::getline(rows, row);
  all = row + ",late_ns\n";
  for (int i = 0; std::getline(rows, row); ++i)
    all += row + "," + std::to_string(i * 7'213'265 % 50'000'000) + "\n";
  std::ofstream(directory / "images.csv") << all;

  const Flown live = flown(directory, 0.0);
  expect_as_replayed(live, support::replayed_simulated(directory, flight_log::Estimator::kPilots));
  const auto in_time = support::replayed_simulated(kFlight, flight_log::Estimator::kPilots);
  EXPECT_NE(live.estimates.back().p_EB, in_time.estimates.back().estimate.p_EB) << "it counts";
}

}  // namespace
}  // namespace gatefly::live
