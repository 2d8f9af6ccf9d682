// SPDX-License-Identifier: Apache-2.0
// Whole races: rendered pictures or ideal detections in, motor commands out.
#include "gatefly/simulated_race/closed_loop/race.hpp"

#include <cstdlib>
#include <cstring>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/simulated_race/closed_loop/frames_again.hpp"

#include "support/allocation_counter.hpp"
#include "support/race_setup.hpp"

namespace gatefly::simulated_race {
namespace {

using test::race_on;

/// Everything a pilot was told and answered in one flight, as bytes.
struct Trace {
  std::vector<std::array<double, 8>> answers;  // roll, pitch, yaw, thrust, motors
  std::vector<Sensors> sensors;                // images point into `frames`
  std::vector<std::vector<std::uint8_t>> frames;
  RaceResult result;
};

std::array<double, 8> answer_of(const Command& c) {
  return {c.attitude.roll, c.attitude.pitch, c.attitude.yaw, c.attitude.thrust,
          c.motors[0],     c.motors[1],      c.motors[2],    c.motors[3]};
}

Trace flown(const RaceConfig& race) {
  Trace trace;
  trace.result = fly(race, [&](const flight_log::Tick& tick) {
    trace.answers.push_back(answer_of(tick.command));
    trace.sensors.push_back(tick.sensors);
    if (!tick.frame.empty()) trace.frames.emplace_back(tick.frame.begin(), tick.frame.end());
    return true;
  });
  return trace;
}

bool same_bytes(const std::vector<std::array<double, 8>>& a,
                const std::vector<std::array<double, 8>>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

TEST(Race, FinishesALapOfTheOval) {
  const Trace trace = flown(race_on("oval", 1001, 1));
  EXPECT_TRUE(trace.result.finished)
      << trace.result.stop_reason << ' ' << trace.result.crash_object;
  EXPECT_EQ(trace.result.gates_passed, 2);
  EXPECT_GT(trace.result.mean_speed, 1.3);
  EXPECT_GT(trace.result.true_positives, 20);
}

TEST(FramesAgain, AreTheFlightsOwnToTheBitFromItsRotorSpeedsAlone) {
  RaceConfig race = race_on("oval", 1003, 1);
  race.timeout = 4.0;
  const Trace trace = flown(race);
  ASSERT_GT(trace.frames.size(), 40u);
  FramesAgain again(race.sim, [&](std::size_t tick) {
    const auto& answer = trace.answers.at(tick);
    return std::array<double, 4>{answer[4], answer[5], answer[6], answer[7]};
  });
  std::size_t frame = 0;
  for (std::size_t tick = 0; tick < trace.sensors.size(); ++tick) {
    const auto picture = again.picture_of(tick);
    EXPECT_EQ(again.ticks(), tick + 1);
    ASSERT_EQ(!picture.empty(), trace.sensors[tick].image.has_value()) << tick;
    if (!picture.empty()) {
      ASSERT_EQ(std::vector(picture.begin(), picture.end()), trace.frames[frame++]) << tick;
    }
  }
  EXPECT_EQ(frame, trace.frames.size());
  // Those between need not be asked for.
  FramesAgain some(race.sim, [&](std::size_t tick) {
    const auto& answer = trace.answers.at(tick);
    return std::array<double, 4>{answer[4], answer[5], answer[6], answer[7]};
  });
  std::size_t last = trace.sensors.size() - 1;
  while (!trace.sensors[last].image) --last;
  const auto picture = some.picture_of(last);
  EXPECT_EQ(std::vector(picture.begin(), picture.end()), trace.frames.back());
}

TEST(Race, FinishesALapOfTheShowroom) {
  const RaceResult result = fly(race_on("showroom", 1002, 1), {});
  EXPECT_TRUE(result.finished) << result.stop_reason << ' ' << result.crash_object;
  EXPECT_EQ(result.gates_passed, 5);
}

// The original beside ours: a lap on the level that varies nothing, at about the paper's 1.5 m/s.
TEST(Race, TheOriginalFliesALapOfItsShowroom) {
  RaceConfig race = race_on("showroom-li18", 1002, 1, {"li18"}, "none");
  race.vision = Vision::kIdeal;
  race.allocations = [] { return static_cast<std::uint64_t>(test::allocations); };
  const RaceResult result = fly(race, {});
  EXPECT_TRUE(result.finished) << result.stop_reason << ' ' << result.crash_object;
  EXPECT_EQ(result.searches, 0);
  EXPECT_NEAR(result.mean_speed, 1.5, 0.15);
  EXPECT_EQ(result.step_allocations, 0u);
}

// Rendered pictures, the flown detector with its histogram bars: whatever becomes of it, it ends
// with a cause and allocates nothing.
TEST(Race, TheOriginalFliesOnPicturesToo) {
  RaceConfig race = race_on("showroom-li18", 1001, 1, {"li18"});
  race.allocations = [] { return static_cast<std::uint64_t>(test::allocations); };
  const RaceResult result = fly(race, {});
  EXPECT_GT(result.frames, 50);
  EXPECT_TRUE(result.finished || !result.crash_object.empty() || result.stop_reason == "abort")
      << "what ended it has a name: " << result.stop_reason;
  EXPECT_EQ(result.step_allocations, 0u);
}

TEST(Race, SameSeedSameBytes) {
  const RaceConfig race = race_on("oval", 1003, 1);
  const Trace one = flown(race), two = flown(race);
  EXPECT_TRUE(same_bytes(one.answers, two.answers));
  EXPECT_TRUE(one.frames == two.frames);
  EXPECT_EQ(one.result.race_time, two.result.race_time);
  EXPECT_EQ(one.result.estimation_rmse, two.result.estimation_rmse);
}

TEST(Race, AnotherSeedIsAnotherRace) {
  const Trace one = flown(race_on("oval", 1003, 1)), two = flown(race_on("oval", 1004, 1));
  EXPECT_FALSE(one.frames == two.frames);
}

TEST(Race, ThePilotsStepAllocatesNothing) {
  RaceConfig race = race_on("oval", 1005, 1);
  race.allocations = [] { return static_cast<std::uint64_t>(test::allocations); };
  const RaceResult result = fly(race, {});
  EXPECT_GT(result.frames, 100);
  EXPECT_EQ(result.step_allocations, 0u);
}

// Another drone in another wind between other gates in another light; only what its sensors say is
// held. The pilot must answer as before, to the bit, as long as that drone stays in the air.
TEST(Race, TruthThatNoSensorShowsDoesNotReachThePilot) {
  const RaceConfig race = race_on("oval", 1006, 1);
  const Trace before = flown(race);
  RaceConfig other = race;
  other.sim.vehicle.mass *= 1.05;
  other.sim.vehicle.inertia *= 1.3;
  other.sim.vehicle.rotor_drag *= 1.5;
  other.sim.vehicle.propeller_radius = 0.01;  // the referee's
  other.sim.wind = {.mean = {0.3, -0.4}, .gust = 0.2};
  for (auto& gate : other.sim.world.gates) gate.p_EG += Eigen::Vector3d{0.4, 0.3, -0.1};
  other.sim.light.group_gain = {0.3, 2.0, 0.5};
  other.sim.start.position += Eigen::Vector2d{0.5, 0.2};
  other.timeout = 300.0;
  std::size_t tick = 0, frame = 0;
  other.sensors = [&](Sensors& sensors) {
    sensors = before.sensors[std::min(tick++, before.sensors.size() - 1)];
    if (!sensors.image) return;
    sensors.image = Image{before.frames[frame++].data(), PixelFormat::kUyvy,
                          race.sim.camera.stored_width, race.sim.camera.stored_height, 90};
  };
  std::vector<std::array<double, 8>> answers;
  (void)fly(other, [&](const flight_log::Tick& now) {
    answers.push_back(answer_of(now.command));
    return answers.size() < before.answers.size();
  });
  ASSERT_GT(answers.size(), 1500u) << "it took off";
  EXPECT_TRUE(
      same_bytes(answers, {before.answers.begin(),
                           before.answers.begin() + static_cast<std::ptrdiff_t>(answers.size())}));
}

// Events after the last gate are told, and change nothing of what is called finished.
TEST(Race, SaysWhetherItLanded) {
  RaceConfig race = race_on("oval", 1001, 1);
  race.vision = Vision::kIdeal;
  const RaceResult result = fly(race, {});
  ASSERT_TRUE(result.finished);
  EXPECT_TRUE(result.landed);
  EXPECT_EQ(result.landing_contact, "");
}

// The sharper form: the recorded sensors alone, given to a pilot that lives in no simulator at all.
TEST(Race, ThePilotsAnswersFollowFromItsSensorsAlone) {
  const RaceConfig race = race_on("oval", 1007, 1);
  const Trace trace = flown(race);
  Pilot pilot{race.pilot};
  std::size_t frame = 0;
  std::vector<std::array<double, 8>> answers;
  for (Sensors sensors : trace.sensors) {
    if (sensors.image)
      sensors.image = Image{trace.frames[frame++].data(), PixelFormat::kUyvy,
                            race.sim.camera.stored_width, race.sim.camera.stored_height, 90};
    answers.push_back(answer_of(pilot.step(sensors)));
  }
  EXPECT_TRUE(same_bytes(trace.answers, answers));
}

TEST(Race, BlindfoldedThePilotLooksForTheGateAndThenGivesUpWithAReason) {
  RaceConfig race = race_on("oval", 1001, 1);
  race.pilot.gate_color = {};             // sees no colour at all
  race.pilot.phase.search_timeout = 2.0;  // nobody hovers blind for long: it drifts 0.2 m/s
  const RaceResult result = fly(race, {});
  EXPECT_FALSE(result.finished);
  EXPECT_EQ(result.stop_reason, "abort");
  EXPECT_EQ(result.abort_reason, "the next gate was not found");
}

RaceConfig ideal_race_on(const std::string& track, std::uint64_t seed, int laps) {
  RaceConfig race = race_on(track, seed, laps);
  race.vision = Vision::kIdeal;
  return race;
}

TEST(IdealRace, FinishesBothCourses) {
  for (const auto& [track, seed, gates] : {std::tuple{"oval", 1001, 6}, {"showroom", 1002, 15}}) {
    const RaceResult result = fly(ideal_race_on(track, static_cast<std::uint64_t>(seed), 3), {});
    EXPECT_TRUE(result.finished) << track << ' ' << result.stop_reason << ' '
                                 << result.crash_object;
    EXPECT_EQ(result.gates_passed, gates);
    EXPECT_GT(result.true_positives, 40);
    EXPECT_EQ(result.bake_seconds, 0.0);
  }
}

TEST(IdealRace, SameSeedSameBytesAndAnotherSeedAnotherFlight) {
  const Trace one = flown(ideal_race_on("oval", 1003, 1)),
              two = flown(ideal_race_on("oval", 1003, 1)),
              other = flown(ideal_race_on("oval", 1004, 1));
  EXPECT_TRUE(same_bytes(one.answers, two.answers));
  EXPECT_FALSE(same_bytes(one.answers, other.answers));
  EXPECT_TRUE(one.frames.empty());
}

TEST(IdealRace, TickByTickItIsTheSameRace) {
  const RaceConfig race = ideal_race_on("oval", 1003, 1);
  const Trace whole = flown(race);
  Flight flight{race}, beside{ideal_race_on("oval", 1004, 1)};
  Trace steps;
  while (flight.step()) {
    beside.step();  // another race in between changes nothing
    EXPECT_EQ(flight.tick().sensors.time.count(), whole.sensors[steps.answers.size()].time.count());
    steps.answers.push_back(answer_of(flight.tick().command));
  }
  EXPECT_TRUE(same_bytes(steps.answers, whole.answers));
  EXPECT_TRUE(flight.over());
  EXPECT_FALSE(flight.step());
  const RaceResult result = flight.result();
  EXPECT_TRUE(result.finished);
  EXPECT_EQ(result.stop_reason, whole.result.stop_reason);
  EXPECT_EQ(result.lap_times, whole.result.lap_times);
  EXPECT_EQ(result.estimation_rmse, whole.result.estimation_rmse);
  EXPECT_EQ(result.flight_time, whole.result.flight_time);
}

TEST(IdealRace, WhatIsStoppedDoesNotGoOn) {
  Flight flight{ideal_race_on("oval", 1003, 1)};
  EXPECT_EQ(flight.tick().sensors.time.count(), 0);
  EXPECT_TRUE(flight.step());
  EXPECT_FALSE(flight.over());
  flight.stop();
  EXPECT_TRUE(flight.over());
  EXPECT_FALSE(flight.step());
  EXPECT_EQ(flight.result().stop_reason, "stopped");
  EXPECT_FALSE(flight.result().finished);
}

TEST(IdealRace, ThePilotsStepAllocatesNothing) {
  RaceConfig race = ideal_race_on("oval", 1005, 3);
  race.allocations = [] { return static_cast<std::uint64_t>(test::allocations); };
  const RaceResult result = fly(race, {});
  EXPECT_GT(result.true_positives, 40);
  EXPECT_EQ(result.step_allocations, 0u);
}

TEST(IdealRace, ThePilotsAnswersFollowFromItsSensorsAlone) {
  const RaceConfig race = ideal_race_on("oval", 1007, 1);
  const Trace trace = flown(race);
  Pilot pilot{race.pilot};
  std::vector<std::array<double, 8>> answers;
  for (const Sensors& sensors : trace.sensors) answers.push_back(answer_of(pilot.step(sensors)));
  EXPECT_TRUE(same_bytes(trace.answers, answers));
}

/// A search, and what came of it.
struct Searched {
  int target = 0, passed = 0;  ///< When it began.
  bool found = false;          ///< The pilot flew on towards the same gate ...
  int next_target = -1;        ///< ... and, that one passed, to this.
};

struct SearchedFlight {
  std::vector<Searched> searches;
  int believed = 0;  ///< Gates that the pilot thinks it passed.
  RaceResult result;
};

SearchedFlight searched(const RaceConfig& race) {
  SearchedFlight flight;
  bool was_searching = false;
  flight.result = fly(race, [&](const flight_log::Tick& tick) {
    const bool searching = std::holds_alternative<Search>(tick.pilot.phase());
    flight.believed = tick.pilot.estimate().gates_passed;
    if (searching && !was_searching)
      flight.searches.push_back({tick.pilot.target_gate(), flight.believed});
    if (!flight.searches.empty()) {
      Searched& last = flight.searches.back();
      last.found =
          last.found || (was_searching && std::holds_alternative<Straight>(tick.pilot.phase()));
      if (flight.believed == last.passed + 1 && last.next_target < 0)
        last.next_target = tick.pilot.target_gate();
    }
    was_searching = searching;
    return true;
  });
  return flight;
}

// Six frames in seven are lost: again and again the pilot has to look for its gate.
TEST(IdealRace, AGateThatWasLostIsFoundAndPassedAndTheNextOneFollows) {
  int rounds = 0, finished = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    SCOPED_TRACE(seed);
    RaceConfig race = ideal_race_on("oval", seed, 3);
    race.sim.sensors.frame_loss = 0.85;
    const SearchedFlight flight = searched(race);
    EXPECT_EQ(flight.result.searches, static_cast<int>(flight.searches.size()));
    if (!flight.result.finished) continue;
    ++finished;
    EXPECT_EQ(flight.believed, flight.result.gates_passed) << "what it believes, it has passed";
    for (const Searched& search : flight.searches)
      if (search.found && search.next_target >= 0 && search.passed + 1 < 6) {
        EXPECT_EQ(search.next_target, (search.target + 1) % 2);
        ++rounds;
      }
  }
  EXPECT_GE(finished, 5);
  EXPECT_GE(rounds, 3);
}

TEST(IdealRace, AWallThatThePilotDoesNotKnowOfIsACrashWithAName) {
  RaceConfig race = ideal_race_on("oval", 1001, 1);
  race.pilot.phase.first_gate_timeout = 0.0;  // for a gate that the wall hides it would wait
  // Half way from the pad to the first gate, right across.
  const Eigen::Vector2d half_way =
      0.5 * (race.sim.world.gates[0].p_EG.head<2>() + race.pilot.track.start);
  race.sim.world.obstacles.push_back({half_way, {0.1, 6.0}, 0.0, 0.0, 3.0, false});
  const std::string wall = "obstacle " + std::to_string(race.sim.world.obstacles.size());
  const RaceResult result = fly(race, {});
  EXPECT_EQ(result.stop_reason, "crash");
  EXPECT_EQ(result.crash_object, wall);
}

}  // namespace
}  // namespace gatefly::simulated_race
