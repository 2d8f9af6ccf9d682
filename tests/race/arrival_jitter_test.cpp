// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/arrival_jitter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/generators.hpp"

namespace gatefly {
namespace {

using test::normal;
using testing::DoubleNear;

// Pictures at `hz` for five seconds, each late by its own error; some never arrive.
double found(double hz, double jitter, double lost = 0.0) {
  Rng rng{3};
  ArrivalJitter arrivals;
  for (int i = 0; i < static_cast<int>(5.0 * hz); ++i) {
    const double time = i / hz + jitter * normal(rng);
    if (rng.uniform(0.0, 1.0) >= lost) arrivals.arrived(time);
  }
  return arrivals.sigma();
}

TEST(ArrivalJitter, IsFoundInTheIntervals) {
  EXPECT_THAT(found(15.0, 0.02), DoubleNear(0.02, 0.007));
  EXPECT_THAT(found(15.0, 0.04), DoubleNear(0.04, 0.014));
}

TEST(ArrivalJitter, LostPicturesAreNone) {
  EXPECT_EQ(found(30.0, 0.001, 0.2), ArrivalJitter::kLeast);
}

TEST(ArrivalJitter, KeepsWithinItsBounds) {
  EXPECT_EQ(ArrivalJitter{}.sigma(), ArrivalJitter::kLeast);
  EXPECT_EQ(found(30.0, 0.0), ArrivalJitter::kLeast);
}

TEST(ArrivalJitter, PicturesThatComeAsTheyLikeAreNoWorseThanItsBound) {
  ArrivalJitter arrivals;
  double time = 0.0;
  for (int i = 0; i < 40; ++i) arrivals.arrived(time += 0.1 + 0.2 * (i % 3));
  EXPECT_EQ(arrivals.sigma(), ArrivalJitter::kMost);
}

TEST(ArrivalJitter, TimeThatStandsStillOrRunsBackIsNoInterval) {
  ArrivalJitter arrivals;
  for (int i = 0; i < 40; ++i) arrivals.arrived(1.0);
  for (int i = 0; i < 40; ++i) arrivals.arrived(2.0 - i);
  EXPECT_EQ(arrivals.sigma(), ArrivalJitter::kLeast);
}

}  // namespace
}  // namespace gatefly
