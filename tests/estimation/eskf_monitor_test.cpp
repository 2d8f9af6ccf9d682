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

// Ten pictures at 5 Hz show what was in view for two seconds, the one that the first shows included.
TEST(EskfMonitor, TenSlowPicturesAreTwoSeconds) {
  Monitor ten{{.pause = 0.9, .least = 6}}, nine{{.pause = 0.9, .least = 6}};
  for (int i = 0; i < 11; ++i) {
    ten.looked(0.2 * i), nine.looked(0.2 * i);
    if (i > 0) ten.refused(0.2 * i);
    if (i > 1) nine.refused(0.2 * i);
  }
  EXPECT_TRUE(ten.verdict().has_value());
  EXPECT_FALSE(nine.verdict().has_value());
}

// After a long time without any picture nobody knows since when the gate has been in view.
TEST(EskfMonitor, APauseBetweenPicturesIsNoTimeInView) {
  Monitor monitor{{.pause = 0.9, .least = 2}};
  monitor.looked(0.0);
  for (const double t : {1.5, 2.0, 3.0}) monitor.looked(t), monitor.refused(t);
  EXPECT_FALSE(monitor.verdict().has_value());
}

TEST(EskfMonitor, AFalseAlarmNowAndThenIsNone) {
  Monitor monitor;
  for (double t = 0.0; t < 60.0; t += 0.7) monitor.refused(t);
  EXPECT_FALSE(monitor.verdict().has_value());
}

}  // namespace
}  // namespace gatefly::eskf
