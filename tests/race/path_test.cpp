// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/path.hpp"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;

// 2 m north, a quarter circle to the right with radius 1.5 m, 1 m east.
Path hook() {
  Path path;
  path.segments.push_back({{0, 0}, 0.0, 0.0, 2.0});
  path.segments.push_back({{2, 0}, 0.0, 1 / 1.5, 1.5 * kPi / 2});
  path.segments.push_back({{3.5, 1.5}, kPi / 2, 0.0, 1.0});
  path.climb(-1.0, -2.0);
  return path;
}

TEST(Path, AnArcToTheRightEndsToTheRight) {
  const PathPoint end = point_on({{1, 2}, 0.0, 0.5, 2 * kPi / 2}, 2 * kPi / 2);  // r = 2, a quarter
  EXPECT_THAT(end.position, IsNear(Vector2d{3, 4}, 1e-12));
  EXPECT_NEAR(end.heading, kPi / 2, 1e-12);
}

TEST(Path, IsContinuousInPositionAndHeading) {
  const Path path = hook();
  for (double s = 0; s < path.length(); s += 0.01) {
    const PathPoint a = path.at(s), b = path.at(s + 1e-6);
    EXPECT_LT((a.position - b.position).norm(), 2e-6) << s;
    EXPECT_LT(std::abs(wrap_angle(a.heading - b.heading)), 2e-6) << s;
  }
}

TEST(Path, HeadingIsTheDirectionOfTravel) {
  for_all(200, [](Rng& rng) {
    const Path path = hook();
    const double s = rng.uniform(-1, path.length() + 1), h = 1e-6;
    const Vector2d along = (path.at(s + h).position - path.at(s - h).position) / (2 * h);
    const double heading = path.at(s).heading;
    EXPECT_THAT(along, IsNear(Vector2d{std::cos(heading), std::sin(heading)}, 1e-4));
  });
}

TEST(Path, GoesStraightOnBeyondItsEnds) {
  const Path path = hook();
  EXPECT_THAT(path.at(-1).position, IsNear(Vector2d{-1, 0}, 1e-12));
  EXPECT_THAT(path.at(path.length() + 2).position, IsNear(Vector2d{3.5, 4.5}, 1e-12));
  EXPECT_EQ(path.at(path.length() + 2).curvature, 0.0);
}

TEST(Path, NearestFindsThePointOneStandsBeside) {
  const Path path = hook();
  for_all(200, [&](Rng& rng) {
    const double s = rng.uniform(0, path.length()), side = rng.uniform(-0.4, 0.4);
    const PathPoint p = path.at(s);
    const Vector2d beside = p.position + side * Vector2d{-std::sin(p.heading), std::cos(p.heading)};
    EXPECT_NEAR(path.nearest(beside, std::max(0.0, s - 0.5), std::min(s + 0.8, path.length())), s,
                1e-9);
  });
}

TEST(Path, NothingInTheWindowIsNearerThanTheNearest) {
  Path nearly_a_circle;
  (void)nearly_a_circle.segments.push_back({.curvature = -0.8, .length = 1.8 * kPi / 0.8});
  for (const Path& path : {hook(), nearly_a_circle})
    for_all(300, [&](Rng& rng) {
      const double from = rng.uniform(-1, path.length()), to = from + rng.uniform(0, 2.5);
      const Vector2d position = path.at(rng.uniform(from, to)).position +
                                Vector2d{rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4)};
      const double found = path.nearest(position, from, to);
      EXPECT_GE(found, from);
      EXPECT_LE(found, to);
      const auto distance = [&](double s) { return (path.at(s).position - position).norm(); };
      for (double s = from; s <= to; s += 0.003)
        EXPECT_GE(distance(s), distance(found) - 1e-9) << s;
    });
}

TEST(Path, NearestStaysInItsWindow) {
  const Path path = hook();
  EXPECT_GE(path.nearest({100, 100}, 1.0, 2.0), 1.0);
  EXPECT_LE(path.nearest({100, 100}, 1.0, 2.0), 2.0);
  EXPECT_EQ(path.nearest({0, 0}, 1.5, 1.5), 1.5);
  EXPECT_EQ(path.nearest({0, 0}, 2.0, 1.0), 2.0) << "an empty window";
  EXPECT_EQ(path.nearest({NAN, 0}, 1.0, 2.0), 1.0);
}

TEST(Path, HeightIsASmoothRampDoneBeforeTheGate) {
  const Path path = hook();
  const double total = path.length();
  EXPECT_EQ(path.z_at(-1), -1.0);
  EXPECT_EQ(path.z_at(0), -1.0);
  EXPECT_NEAR(path.z_at(total - 1.5), -2.0, 1e-12);
  EXPECT_NEAR(path.z_at(total + 3), -2.0, 1e-12);
  for (double s = 0; s < total; s += 0.05)
    EXPECT_LE(path.z_at(s + 0.05), path.z_at(s)) << "climbs all the way";
}

TEST(Path, TheSlopeIsTheRateOfTheHeight) {
  Path path = hook();
  path.levels.clear();
  for (const auto& [s, z] : {std::pair{0.5, -1.0}, {2.0, -2.5}, {2.0, -1.8}, {4.5, -1.2}})
    (void)path.levels.push_back({s, z});
  for (const double s : {0.2, 0.7, 1.3, 1.9, 2.1, 3.0, 4.4, 5.0}) {
    const double h = 1e-6;
    EXPECT_NEAR(path.height_at(s).slope, (path.z_at(s + h) - path.z_at(s - h)) / (2 * h), 1e-6)
        << s;
  }
  EXPECT_NEAR(path.z_at(1.25), -1.75, 1e-12) << "half way";
  EXPECT_NEAR(path.z_at(2.0 - 1e-9), -2.5, 1e-6) << "arrives at one height,";
  EXPECT_NEAR(path.z_at(2.0), -1.8, 1e-12) << "leaves at another";
}

TEST(Path, AnEmptyPathAnswers) {
  const Path path;
  EXPECT_EQ(path.length(), 0.0);
  EXPECT_EQ(path.at(3.0).position, Vector2d(0, 0));
  EXPECT_TRUE(std::isfinite(path.z_at(1.0)));
}

}  // namespace
}  // namespace gatefly
