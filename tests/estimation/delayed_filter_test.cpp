// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/delayed_filter.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSample = 1.0 / 512;
const std::size_t kMoments = moments_for(0.25, 512.0);

Fix near_fix(const Vector3d& p, double sigma = 0.05) {
  Fix fix;
  fix.p_GB = p;
  fix.covariance = sigma * sigma * Matrix3d::Identity();
  return fix;
}

drag_model::Input still() {
  drag_model::Input u;
  u.accel_B = {0, 0, -9.81};
  return u;
}

/// Hovers at (-4, 0, 0); the filter started `off` from there.
class Hovering {
 public:
  explicit Hovering(const Vector3d& off = Vector3d::Zero()) : filter{DragFilterParams{}, kMoments} {
    filter.start(Vector3d{-4, 0, 0} + off, Vector3d::Zero(), {}, 0.0);
  }
  void wait(double seconds) {
    for (const double until = time + seconds; time < until - 0.5 * kSample;)
      filter.predict(still(), kSample, time += kSample);
  }
  Fusion see(const Vector3d& p) {
    wait(0.066);
    return filter.correct(near_fix(p), time - 0.044, true);
  }
  [[nodiscard]] double error() const {
    return (filter.now().position() - Vector3d{-4, 0, 0}).norm();
  }

  DelayedFilter filter;
  double time = 0.0;
};

TEST(DelayedFilter, AFixIsFusedAtTheMomentOfItsPicture) {
  drag_model::Input u = still();
  u.accel_B.x() = -0.8;  // 1.5 m/s
  DelayedFilter late{DragFilterParams{}, kMoments};
  late.start({-4, 0, 0}, Vector3d::Zero(), {}, 0.0);
  DragFilter in_time{DragFilterParams{}};
  in_time.start({-4, 0, 0}, Vector3d::Zero());
  for (int i = 1; i <= 120; ++i) {
    late.predict(u, kSample, i * kSample);
    in_time.predict(u, kSample);
    if (i == 40) (void)in_time.correct(near_fix({-3.85, 0.05, 0}));
    if (i == 60)
      (void)in_time.correct_altitude(0.03, 0.04), (void)late.correct_altitude(0.03, 0.04, 0.0);
  }
  EXPECT_EQ(late.correct(near_fix({-3.85, 0.05, 0}), 40 * kSample), Fusion::kAccepted);
  EXPECT_THAT(late.now().state(), IsNear(in_time.state(), 1e-12));
  EXPECT_THAT(late.now().covariance(), IsNear(in_time.covariance(), 1e-12));
}

// Four fixes of the last 200 ms and an outlier among them, in all 120 orders of arrival.
TEST(DelayedFilter, TheOrderOfArrivalDoesNotMatter) {
  for_all(3, [](Rng& rng) {
    std::vector<drag_model::Input> inputs;
    for (int i = 0; i < 120; ++i) inputs.push_back(any_input(rng));
    std::vector<Fix> fixes;
    for (int k = 0; k < 5; ++k)
      fixes.push_back(near_fix(Vector3d{-4, 0, 0} + any_vector3(rng, 0.1)));
    fixes[2].p_GB.y() += 3.0;
    std::vector<int> order{0, 1, 2, 3, 4};
    std::optional<DelayedFilter> first;
    do {
      DelayedFilter filter{DragFilterParams{}, kMoments};
      filter.start({-4, 0, 0}, Vector3d::Zero(), {}, 0.0);
      for (int i = 1; i <= 120; ++i) {
        filter.predict(inputs[static_cast<std::size_t>(i - 1)], kSample, i * kSample);
        if (i % 26 == 0) (void)filter.correct_altitude(0.02, 0.04, 0.05);
      }
      for (const int k : order)
        (void)filter.correct(fixes[static_cast<std::size_t>(k)], (20 + 20 * k) * kSample);
      if (!first) first = filter;
      EXPECT_THAT(filter.now().state(), IsNear(first->now().state(), 1e-9));
      EXPECT_THAT(filter.now().covariance(), IsNear(first->now().covariance(), 1e-9));
    } while (std::next_permutation(order.begin(), order.end()));
  });
}

TEST(DelayedFilter, WhatIsOlderThanTheMemoryIsRefusedAndChangesNothing) {
  Hovering drone;
  drone.wait(0.5);
  const drag_model::State before = drone.filter.now().state();
  EXPECT_EQ(drone.filter.at(0.2), nullptr);
  EXPECT_EQ(drone.filter.correct(near_fix({-4, 0.1, 0}), 0.2), Fusion::kTooLate);
  EXPECT_EQ(drone.filter.now().state(), before);
  EXPECT_NE(drone.filter.at(0.26), nullptr);
  EXPECT_EQ(drone.filter.correct(near_fix({-4, 0.1, 0}), 0.26), Fusion::kAccepted);
}

TEST(DelayedFilter, WhatWasSeenBeforeTheFrameChangedIsRefused) {
  Hovering drone;
  drone.wait(0.2);
  drone.filter.change_frame(Matrix3d::Identity(), {-3, 0, 0}, 0.0, {});
  drone.wait(0.02);
  EXPECT_EQ(drone.filter.correct(near_fix({-7, 0.1, 0}), 0.15), Fusion::kTooLate);
  EXPECT_EQ(drone.filter.correct(near_fix({-7, 0.1, 0}), 0.21), Fusion::kAccepted);
}

TEST(DelayedFilter, OneOrTwoWrongGatesThrowNothing) {
  Hovering drone;
  for (int k = 0; k < 60; ++k) {
    const bool wrong = k % 5 > 2;  // two in a row
    const Fusion fusion = drone.see(wrong ? Vector3d{-4, 1.5, 0} : Vector3d{-4, 0, 0});
    EXPECT_EQ(fusion, wrong ? Fusion::kRefused : Fusion::kAccepted) << k;
    EXPECT_LT(drone.error(), 0.05) << k;
  }
}

TEST(DelayedFilter, AlternatingOutliersNeverThrowIt) {
  Hovering drone;
  for (int k = 0; k < 100; ++k) {
    const bool good = k % 10 == 0;  // or else its growing covariance would accept them at last
    const Fusion fusion = drone.see({-4, good ? 0.0 : k % 2 == 0 ? 2.0 : -2.0, 0});
    EXPECT_EQ(fusion, good ? Fusion::kAccepted : Fusion::kRefused) << k;
    EXPECT_LT(drone.error(), 0.1) << k;
  }
}

// Two metres off and sure of it: six fixes of 15 Hz last the 0.3 s that are asked for.
TEST(DelayedFilter, IsNeverLockedOut) {
  for (const Vector3d& off : {Vector3d{2, 0, 0}, Vector3d{0, -2, 0}, Vector3d{-1.4, 1.4, 0}}) {
    Hovering drone{off};
    const Vector3d bias = drone.filter.now().state().segment<3>(drag_model::kBiasX);
    int fixes = 0;
    while (drone.error() > 0.1 && fixes < 20) (void)drone.see({-4, 0, 0}), ++fixes;
    EXPECT_LE(fixes, 6);
    EXPECT_THAT(drone.filter.now().state().segment<3>(drag_model::kBiasX), IsNear(bias, 1e-9));
    EXPECT_THAT(drone.filter.now().covariance(), IsCovariance());
    EXPECT_EQ(drone.see({-4, 0, 0}), Fusion::kAccepted);
  }
}

// Two metres off, and one fix in three is an outlier anywhere: five right ones more than wrong ones
// take 13 fixes, and luck.
TEST(DelayedFilter, OutliersInBetweenDelayTheRestartButDoNotPreventIt) {
  for_all(20, [](Rng& rng) {
    Hovering drone{Vector3d{0, 2, 0}};
    int fixes = 0;
    while (drone.error() > 0.15 && fixes < 30)
      (void)drone.see(fixes++ % 3 == 2 ? Vector3d{-4, 0, 0} + any_vector3(rng, 3.0)
                                       : Vector3d{-4, 0, 0});
    EXPECT_LE(fixes, 13);
  });
}

// An error of the position corrupted the bias, too: after a restart it is learnt anew, or the drone
// drifts off again.
TEST(DelayedFilter, AfterARestartTheBiasIsLearntAnew) {
  Hovering drone;
  for (int k = 0; k < 150; ++k) (void)drone.see({-4, 0, 0});
  const double sure = drone.filter.now().covariance()(drag_model::kBiasY, drag_model::kBiasY);
  for (int k = 0; k < 12; ++k) (void)drone.see({-4, 2.5, 0});
  EXPECT_GT(drone.filter.now().covariance()(drag_model::kBiasY, drag_model::kBiasY), 4.0 * sure);
  EXPECT_NEAR(drone.filter.now().position().y(), 2.5, 0.1);
}

// The same picture four times counts once.
TEST(DelayedFilter, OnePictureCannotAgreeWithItself) {
  Hovering drone{Vector3d{2, 0, 0}};
  drone.wait(0.5);
  for (int k = 0; k < 10; ++k)
    EXPECT_EQ(drone.filter.correct(near_fix({-4, 0, 0}), drone.time - 0.044, true),
              Fusion::kRefused);
}

TEST(DelayedFilter, NonFiniteFixesChangeNothing) {
  Hovering drone;
  drone.wait(0.1);
  const drag_model::State before = drone.filter.now().state();
  for (int k = 0; k < 10; ++k) EXPECT_NE(drone.see({std::nan(""), 0, 0}), Fusion::kRestarted);
  EXPECT_THAT(drone.filter.now().position(), IsNear(before.head<3>(), 1e-6));
  EXPECT_EQ(drone.filter.correct(near_fix({-4, 0, 0}), std::nan("")), Fusion::kTooLate);
}

}  // namespace
}  // namespace gatefly
