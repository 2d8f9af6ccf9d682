// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/consistency.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::simulated_race {
namespace {

// 20,000 draws: the mean within 4 standard errors of 1, 95 % within 4 standard errors inside.
TEST(ChiSquareCount, NormalErrorsAreAsExpected) {
  sim::Stream stream{1, "chi square"};
  for (const int dof : {1, 2, 3, 4, 8}) {
    ChiSquareCount count;
    for (int i = 0; i < 20'000; ++i) {
      double chi2 = 0.0;
      for (int k = 0; k < dof; ++k) {
        const double z = stream.normal();
        chi2 += z * z;
      }
      count.add(chi2, dof);
    }
    EXPECT_EQ(count.samples, 20'000);
    EXPECT_NEAR(count.sum_per_dof / count.samples, 1.0, 4 * std::sqrt(2.0 / dof / 20'000)) << dof;
    EXPECT_NEAR(static_cast<double>(count.inside) / count.samples, 0.95,
                4 * std::sqrt(0.95 * 0.05 / 20'000))
        << dof;
  }
}

TEST(ChiSquareCount, WhatHasNoDegreeOfFreedomIsNotCounted) {
  ChiSquareCount count;
  count.add(1.0, 0);
  count.add(1.0, 9);
  EXPECT_EQ(count.samples, 0);
}

constexpr double kTick = 1.0 / 512.0;

/// A gate that faces 40° farther right than its map says.
struct Course {
  Course() {
    gate = {.p_EG = {4.0, -1.0, -1.6}, .yaw_EG = 0.9};
    map.gates = {{.p_EG = {3.9, -1.1, -1.5}, .yaw_EG = 0.2}};
  }
  [[nodiscard]] ConsistencyWatch watch() const { return ConsistencyWatch{{gate}, map}; }
  /// Belief of a pilot without error in the gate's own frame.
  [[nodiscard]] Belief right() const {
    return {.on_course = true, .p_GB = rotation_z(-gate.yaw_EG) * (p_EB - gate.p_EG)};
  }
  /// Belief that is off by `error_E` in earth axes, from where the gate stands.
  [[nodiscard]] Belief off_by(const Eigen::Vector3d& error_E) const {
    return {.on_course = true,
            .p_GB = rotation_z(-map.gates[0].yaw_EG) * (p_EB + error_E - gate.p_EG)};
  }
  world::WorldGate gate;
  Track map;
  Eigen::Vector3d p_EB{1.0, 0.5, -1.4};
};

// Errors drawn from the covariance that the pilot states: NEES / 3 averages 1 within four standard
// errors, 95 % lie inside; long and narrow, so that another frame than the gate's shows.
TEST(ConsistencyWatch, ConsistentErrorsHaveANeesOfOnePerDegree) {
  const Course course;
  Eigen::Matrix3d covariance;
  covariance << 0.25, 0.03, 0.0, 0.03, 0.01, 0.002, 0.0, 0.002, 0.004;
  const Eigen::Matrix3d root = covariance.llt().matrixL();
  for (const double overconfidence : {1.0, 0.5}) {  // consistent, and overconfident by two
    ConsistencyWatch watch = course.watch();
    sim::Stream stream{2, "errors"};
    for (int tick = 0; tick < 51'200; ++tick) {
      Belief belief = course.right();
      belief.p_GB += root * Eigen::Vector3d{stream.normal(), stream.normal(), stream.normal()};
      belief.covariance_GB = overconfidence * overconfidence * covariance;
      watch.update(belief, course.p_EB, tick * kTick);
    }
    const ChiSquareCount& nees = watch.result().nees;
    EXPECT_NEAR(nees.samples, 20 * 100, 40) << "20 Hz, every 26th tick";
    EXPECT_NEAR(nees.sum_per_dof / nees.samples, 1.0 / (overconfidence * overconfidence),
                4 * std::sqrt(2.0 / 3 / nees.samples) / (overconfidence * overconfidence));
    const double inside = static_cast<double>(nees.inside) / nees.samples;
    if (overconfidence == 1.0)
      EXPECT_NEAR(inside, 0.95, 4 * std::sqrt(0.95 * 0.05 / nees.samples));
    else
      EXPECT_LT(inside, 0.6);
  }
}

TEST(ConsistencyWatch, OnlyFixesThatCorrectedTheFilterCountForNis) {
  const Course course;
  ConsistencyWatch watch = course.watch();
  Sighting fix;
  fix.source = Sighting::Source::kCorners, fix.nis = 2.4, fix.nis_dof = 2;
  Sighting refused;
  refused.offered = true;
  Belief belief = course.right();
  for (int tick = 0; tick < 512; ++tick) {
    belief.sighting = tick == 100 || tick == 200 ? &fix : tick == 300 ? &refused : nullptr;
    watch.update(belief, course.p_EB, tick * kTick);
  }
  EXPECT_EQ(watch.result().nis.samples, 2);
  EXPECT_DOUBLE_EQ(watch.result().nis.sum_per_dof, 2 * 1.2);
}

/// Divergences after so many seconds of an error, a fix being offered at `offered_at`.
int divergences(const Course& course, const Eigen::Vector3d& error_E, double seconds,
                double offered_at) {
  ConsistencyWatch watch = course.watch();
  Sighting offered;
  offered.offered = true;
  Belief belief = course.off_by(error_E);
  bool done = false;
  for (double time = 0.0; time < seconds; time += kTick) {
    const bool now = !done && time >= offered_at;
    done = done || now;
    belief.sighting = now ? &offered : nullptr;
    watch.update(belief, course.p_EB, time);
  }
  return watch.result().divergences;
}

TEST(ConsistencyWatch, FarForLongAlthoughAFixWasOfferedIsOneDivergence) {
  const Course course;
  const Eigen::Vector3d far{0.0, 1.1, 0.0}, near{0.0, 0.9, 0.0};
  EXPECT_EQ(divergences(course, far, 10.0, 0.5), 1) << "once, however long";
  EXPECT_EQ(divergences(course, far, 10.0, 5.0), 1) << "whenever the fix came";
  EXPECT_EQ(divergences(course, far, 0.9, 0.5), 0) << "not for long";
  EXPECT_EQ(divergences(course, near, 10.0, 0.5), 0) << "not far";
  EXPECT_EQ(divergences(course, far, 10.0, 99.0), 0) << "nothing was offered";
}

TEST(ConsistencyWatch, AFixBeforeItWasFarDoesNotMakeADivergenceNorAShortReturnTwoOfOne) {
  const Course course;
  ConsistencyWatch watch = course.watch();
  Sighting offered;
  offered.offered = true;
  const auto pass = [&](double from, double to, double error, double offered_at) {
    Belief belief = course.off_by({error, 0, 0});
    for (double time = from; time < to; time += kTick) {
      belief.sighting = std::abs(time - offered_at) < 0.6 * kTick ? &offered : nullptr;
      watch.update(belief, course.p_EB, time);
    }
    return watch.result().divergences;
  };
  EXPECT_EQ(pass(0, 2, 0.5, 1.0), 0);
  EXPECT_EQ(pass(2, 5, 2.0, -1.0), 0) << "offered only before";
  EXPECT_EQ(pass(5, 8, 2.0, 6.0), 1);
  EXPECT_EQ(pass(8, 9, 0.5, -1.0), 1);
  EXPECT_EQ(pass(9, 12, 2.0, -1.0), 1) << "a second time, and nothing offered";
  EXPECT_EQ(pass(12, 13, 2.0, 12.5), 2);
}

TEST(ConsistencyWatch, AGateThatFacesElsewhereIsNoDivergence) {
  const Course course;
  // In earth axes the drone is where it believes to be; in the gate's own frame it is metres off.
  const Belief belief = course.off_by({0, 0, 0});
  EXPECT_GT((course.right().p_GB - belief.p_GB).norm(), 2.0);
  EXPECT_EQ(divergences(course, {0, 0, 0}, 10.0, 0.5), 0);
}

TEST(ConsistencyWatch, OffTheCourseNothingCounts) {
  const Course course;
  ConsistencyWatch watch = course.watch();
  Sighting offered;
  offered.offered = true, offered.source = Sighting::Source::kCorners;
  offered.nis = 1.0, offered.nis_dof = 3;
  Belief belief = course.off_by({5, 0, 0});
  belief.on_course = false, belief.sighting = &offered;
  for (int tick = 0; tick < 5120; ++tick) watch.update(belief, course.p_EB, tick * kTick);
  EXPECT_EQ(watch.result().nees.samples, 0);
  EXPECT_EQ(watch.result().nis.samples, 0);
  EXPECT_EQ(watch.result().divergences, 0);
}

TEST(BeliefOf, APilotOnItsPadIsNotOnCourse) {
  PilotConfig config;
  config.track.gates = {{.p_EG = {4.0, 0.0, -1.5}}};
  const Pilot pilot{config};
  EXPECT_FALSE(belief_of(pilot, true).on_course);
}

}  // namespace
}  // namespace gatefly::simulated_race
