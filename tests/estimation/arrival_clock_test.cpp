// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/arrival_clock.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/for_all.hpp"
#include "support/generators.hpp"

namespace gatefly {
namespace {

using test::for_all;
using test::normal;

struct Taken {
  double sample, arrival, clock, interval;
};

/// Samples of a regular clock, each late on its way by `late` of its number, until they have arrived.
template <class Late>
std::vector<Taken> taken(ArrivalClock clock, double hz, int count, Late late) {
  std::vector<Taken> all;
  double last = -1.0;
  for (int i = 0; i < count; ++i) {
    const double sample = 0.3 + i / hz, arrival = std::max(last + 1e-4, sample + late(i));
    clock.arrived(last = arrival);
    all.push_back({sample, arrival, clock.time(), clock.interval()});
  }
  return all;
}

constexpr auto kInTime = [](int) { return 0.0; };

TEST(ArrivalClock, IsTheArrivalsWhereTheyAreRegularWhateverTheirRate) {
  for (const double hz : {25.0, 50.0, 100.0, 512.0})
    for (const Taken& one : taken(ArrivalClock{hz}, hz, 200, kInTime))
      EXPECT_NEAR(one.clock, one.arrival, 1e-9) << hz;
}

TEST(ArrivalClock, FindsARateThatIsNotTheNominalOne) {
  for (const double hz : {23.0, 35.0, 50.0, 60.0, 92.0}) {
    const auto all = taken(ArrivalClock{50.0}, hz, 600, kInTime);
    for (auto one = all.end() - 50; one != all.end(); ++one) {
      EXPECT_NEAR(one->clock, one->arrival, 1e-4) << hz;
      EXPECT_NEAR(one->interval, 1.0 / hz, 1e-4) << hz;
    }
  }
}

double scatter(const std::vector<Taken>& all, double Taken::*what) {
  double mean = 0.0, square = 0.0;
  const auto n = static_cast<double>(all.size());
  for (const Taken& one : all) {
    const double late = one.*what - one.sample;
    mean += late / n, square += late * late / n;
  }
  return std::sqrt(square - mean * mean);
}

// Late by what is half normal: of that the mean stays, which nobody can see.
TEST(ArrivalClock, IsHalfAsIrregularAsWhatArrives) {
  for_all(20, [](Rng& rng) {
    auto all = taken(ArrivalClock{50.0}, 50.0 * rng.uniform(0.95, 1.05), 1000,
                     [&](int) { return std::abs(0.003 * normal(rng)); });
    all.erase(all.begin(), all.begin() + 100);  // until its rate is found
    EXPECT_LT(scatter(all, &Taken::clock), 0.6 * scatter(all, &Taken::arrival));
  });
}

TEST(ArrivalClock, GoesForwardNeverAheadOfAnArrivalAndItsIntervalsAddUp) {
  for_all(50, [](Rng& rng) {
    ArrivalClock clock{rng.uniform(25.0, 200.0)};
    double arrival = 0.3, first = -1.0, sum = 0.0;
    for (int i = 0; i < 500; ++i) {
      arrival += rng.uniform(0.001, 0.1);  // asked for when somebody had time
      const double before = clock.time();
      clock.arrived(arrival);
      if (first < 0.0) first = clock.time();
      EXPECT_GT(clock.time(), before);
      EXPECT_LE(clock.time(), arrival);
      EXPECT_GE(clock.time(), arrival - 0.0061);
      sum += clock.interval();
      EXPECT_NEAR(sum, clock.time() - first, 1e-9);
    }
  });
}

TEST(ArrivalClock, OneThatIsLostIsAGapOfTwo) {
  const auto all = taken(ArrivalClock{50.0}, 50.0, 100, kInTime);
  ArrivalClock clock{50.0};
  for (int i = 0; i < 100; ++i)
    if (i % 7 != 3) clock.arrived(all[static_cast<std::size_t>(i)].arrival);
  EXPECT_NEAR(clock.time(), all.back().arrival, 1e-9);
  EXPECT_NEAR(clock.interval(), 0.02, 1e-9);
}

}  // namespace
}  // namespace gatefly
