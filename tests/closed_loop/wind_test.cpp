// SPDX-License-Identifier: Apache-2.0
// Moving air, whole races with ideal vision: 3 laps of the showroom in 0.3 m/s of wind and as strong gusts.
#include <gtest/gtest.h>

#include "gatefly/sim/drawn.hpp"
#include "gatefly/simulated_race/closed_loop/race.hpp"

#include "support/race_setup.hpp"

namespace gatefly {
namespace {

simulated_race::RaceResult flown_in_wind(FilterModel model, double wind, std::uint64_t seed) {
  const config::Config config = config::load_config(config::config_files({}));
  const config::TrackFile file = config::read_track(config::find_track("showroom"));
  simulated_race::RaceConfig race;
  race.vision = simulated_race::Vision::kIdeal;
  race.pilot = config.pilot;
  race.pilot.track = file.track;
  race.pilot.filter_model = model;
  world::Randomize level = file.randomize;
  level.wind = level.gust = wind;
  race.sim = sim::drawn(config::simulator_config(config, file), level, seed);
  return simulated_race::fly(race, {});
}

// Six races are some 10 s of CPU. Before, with drag for the velocity over ground, none of forty finished.
TEST(Wind, RacesFinishInADraughtAndThePilotKnowsHowWrongItIs) {
  int finished = 0;
  double nees = 0.0, cpu = 0.0;
  constexpr int kRaces = 6;
  for (int race = 0; race < kRaces; ++race) {
    const auto result =
        flown_in_wind(FilterModel::kOurs, 0.3, 1301 + static_cast<std::uint64_t>(race));
    finished += result.finished;
    nees += result.consistency.nees.sum_per_dof / std::max(1, result.consistency.nees.samples);
    cpu += result.cpu_seconds;
  }
  EXPECT_GE(finished, kRaces - 1);
  EXPECT_LT(nees / kRaces, 2.0);
  EXPECT_GT(nees / kRaces, 0.5);
  EXPECT_LT(cpu, 30.0);
}

TEST(Wind, TheSameRaceEndsEarlyWhenDragCountsAsVelocityOverGround) {
  EXPECT_FALSE(flown_in_wind(FilterModel::kDrag, 0.3, 1301).finished);
}

}  // namespace
}  // namespace gatefly
