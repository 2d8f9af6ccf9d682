// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "gatefly/estimation/eskf/monitor.hpp"

#include "support/generators.hpp"

namespace gatefly::eskf {
namespace {

constexpr double kPicture = 1.0 / 15;  // [s]

// Eight squared normal numbers a picture, for ten minutes.
TEST(EskfMonitor, InnovationsAsTheyShouldBeAreNoDivergence) {
  Rng rng{3};
  Monitor monitor;
  for (double t = 0.0; t < 600.0; t += kPicture) {
    double nis = 0.0;
    for (int i = 0; i < 8; ++i) nis += std::pow(test::normal(rng), 2);
    monitor.taken(nis, 8, t);
  }
  EXPECT_FALSE(monitor.verdict().has_value());
}

TEST(EskfMonitor, InnovationsTwiceAsLargeForTwoSecondsAre) {
  Monitor monitor;
  double t = 0.0;
  for (; t < 5.0; t += kPicture) monitor.taken(8.0, 8, t);
  const double begun = t;
  for (; t < begun + 3.0; t += kPicture) monitor.taken(16.0, 8, t);
  ASSERT_TRUE(monitor.verdict().has_value());
  EXPECT_EQ(monitor.verdict()->why, Divergence::kInnovations);
  EXPECT_NEAR(monitor.verdict()->since, begun, 1.0);
}

TEST(EskfMonitor, GatesThatFitNowhereForTwoSecondsAreAndOneThatFitsBetweenThemEndsIt) {
  Monitor lost, found;
  for (double t = 0.0; t < 3.0; t += kPicture) {
    lost.refused(t);
    found.refused(t);
    if (t > 1.4 && t < 1.5) found.taken(8.0, 8, t);
  }
  ASSERT_TRUE(lost.verdict().has_value());
  EXPECT_EQ(lost.verdict()->why, Divergence::kNothingFits);
  EXPECT_FALSE(found.verdict().has_value());
}

TEST(EskfMonitor, AFalseAlarmNowAndThenIsNone) {
  Monitor monitor;
  for (double t = 0.0; t < 60.0; t += 0.7) monitor.refused(t);
  EXPECT_FALSE(monitor.verdict().has_value());
}

}  // namespace
}  // namespace gatefly::eskf
