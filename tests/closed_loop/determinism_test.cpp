// SPDX-License-Identifier: Apache-2.0
// One seed, one flight: whatever the number of threads, and whatever else is drawn.
#include <atomic>
#include <cstring>
#include <filesystem>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/simulated_race/closed_loop/race.hpp"

#include "support/race_setup.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::simulated_race {
namespace {

using test::race_on;

/// Everything that reached the pilot and left it, tick by tick, as bytes.
struct Trace {
  std::vector<double> numbers;
  std::vector<std::vector<std::uint8_t>> frames;

  bool operator==(const Trace& other) const {
    // bytes: a NaN is itself
    return numbers.size() == other.numbers.size() && frames == other.frames &&
           std::memcmp(numbers.data(), other.numbers.data(), numbers.size() * sizeof(double)) == 0;
  }
};

Trace flown(const RaceConfig& race) {
  Trace trace;
  (void)fly(race, [&](const flight_log::Tick& tick) {
    const Sensors& s = tick.sensors;
    auto& n = trace.numbers;
    n.push_back(static_cast<double>(s.time.count()));
    for (const auto* v : {&s.imu.gyro_B, &s.imu.accel_B, &tick.truth.p_EB, &tick.truth.v_E})
      n.insert(n.end(), v->data(), v->data() + 3);
    n.insert(n.end(), tick.command.motors.begin(), tick.command.motors.end());
    n.push_back(s.sonar.value_or(-1.0)), n.push_back(s.baro.value_or(-1000.0));
    if (s.seen)
      for (const GateDetection& gate : s.seen->gates) {
        n.push_back(gate.fitness);
        for (const auto& corner : gate.corners_px) n.push_back(corner.x()), n.push_back(corner.y());
      }
    if (!tick.frame.empty()) trace.frames.emplace_back(tick.frame.begin(), tick.frame.end());
    return true;
  });
  return trace;
}

// Nothing from a cache: each bakes for itself.
TEST(Determinism, OneAndTwoThreadsBakeAndFlyTheSameToTheBit) {
  const test::TempFolder one_folder, two_folder;
  RaceConfig one = race_on("oval", 1006, 1);
  one.timeout = 3.0;
  RaceConfig two = one;
  one.sim.cache_dir = one_folder.path(), two.sim.cache_dir = two_folder.path();
  one.sim.bake_threads = 1, two.sim.bake_threads = 2;
  const Trace alone = flown(one);
  EXPECT_GT(alone.frames.size(), 30u);
  EXPECT_TRUE(alone == flown(two));
  two.sim.cache_dir = one.sim.cache_dir;
  EXPECT_TRUE(alone == flown(two)) << "from the cache";
}

/// Both races at the same time, as a campaign flies them.
std::array<Trace, 2> beside_each_other(const RaceConfig& a, const RaceConfig& b) {
  std::array<Trace, 2> traces;
  std::jthread other{[&] { traces[1] = flown(b); }};
  traces[0] = flown(a);
  other.join();
  return traces;
}

TEST(Determinism, TwoRacesAtTheSameTimeAreEachAsItIsAlone) {
  for (const Vision vision : {Vision::kRendered, Vision::kIdeal}) {
    RaceConfig a = race_on("oval", 1006, 1), b = race_on("oval", 1007, 1);
    a.vision = b.vision = vision;
    a.timeout = b.timeout = vision == Vision::kRendered ? 3.0 : 15.0;
    const auto together = beside_each_other(a, b);
    EXPECT_TRUE(together[0] == flown(a));
    EXPECT_TRUE(together[1] == flown(b));
    EXPECT_FALSE(together[0] == together[1]);
  }
}

}  // namespace
}  // namespace gatefly::simulated_race
