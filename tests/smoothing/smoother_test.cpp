// SPDX-License-Identifier: Apache-2.0
// A late finding was true before: a drone that hovers and sees its gate only after a while.
#include "gatefly/tasks/smoothing/smoother.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/gate_corners.hpp"

#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly::smoothing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::IsNear;
using test::normal;

constexpr double kDt = 1.0 / 512.0;
const Vector3d kTruth{0.2, -0.15, 0.0};  // it believes that it stands at the origin

eskf::Setup one_gate() {
  eskf::Setup setup;
  setup.map.push_back({{4.0, 0.0, 0.0}, 0.0, {1.0, 0.05}});
  setup.R_BC = camera_mount(0.0).matrix;
  setup.camera = {{0.1, 0, 0}, 0.006};
  // All is known well but where the pad is.
  eskf::Priors& priors = setup.params.priors;
  priors.map = priors.map_height = 0.01, priors.map_yaw = 0.01, priors.map_size = 0.002;
  priors.heading = priors.tilt = 0.003;
  priors.mount.setConstant(0.003);
  priors.focal = priors.bend = priors.delay = 0.002;
  return setup;
}

eskf::GateSight sight_of_gate(const eskf::Setup& setup, double time, Rng& rng) {
  eskf::GateSight sight{.time = time, .features = {}};
  const auto corners = gate_corners_G(1.0);
  std::array<Vector2d, 4> px;
  Vector2d middle = Vector2d::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3d p_C =
        setup.R_BC.transpose() * (setup.map[0].p_EG + corners[i] - kTruth - setup.camera.p_BC);
    px[i] = p_C.head<2>() / p_C.z() / setup.camera.radians_per_px +
            0.5 * Vector2d{normal(rng), normal(rng)};
    middle += 0.25 * px[i];
  }
  for (std::size_t i = 0; i < 4; ++i) {
    eskf::Feature feature{.which = static_cast<std::uint8_t>(i)};
    const Vector2d slope = setup.camera.radians_per_px * px[i];
    feature.bearing_C = Vector3d{slope.x(), slope.y(), 1.0}.normalized();
    feature.from_middle_px = px[i] - middle;
    (void)sight.features.push_back(feature);
  }
  return sight;
}

struct Hovered {
  eskf::ErrorStateFilter filter;
  IntakeWatch watch;
  Vector3d after_1_s = Vector3d::Zero();
  Eigen::Matrix3d P_after_1_s = Eigen::Matrix3d::Zero();
};

// Six seconds; the gate is in view from the third one on, 15 times a second, 50 ms late.
Hovered hovered() {
  const eskf::Setup setup = one_gate();
  Hovered flight{eskf::ErrorStateFilter{setup}, {}};
  Rng rng{11};
  const Vector3d up{0, 0, -setup.params.gravity};
  flight.filter.start({.rest_accel_B = up}, 0.0);
  for (int i = 1; i <= 6 * 512; ++i) {
    const double t = kDt * i;
    const Vector3d shaking{0.3 * normal(rng), 0.3 * normal(rng), 0.6 * normal(rng)};
    flight.filter.predict({.gyro_B = Vector3d::Zero(), .accel_B = up + shaking}, kDt, t);
    const bool sees = t > 3.0 && i % 34 == 0;
    if (sees) {
      const eskf::GateSight sight = sight_of_gate(setup, t - 0.05, rng);
      EXPECT_TRUE(flight.filter.correct({&sight, 1}));
    }
    flight.watch.update(flight.filter, sees);
    if (i != 512) continue;
    flight.after_1_s = flight.filter.now().p_EB;
    flight.P_after_1_s = flight.filter.covariance().topLeftCorner<3, 3>();
  }
  return flight;
}

TEST(Smoother, KnowsFromTheBeginningWhatIsFoundOnlyLater) {
  const Hovered flight = hovered();
  const Smoothed smoothed = smooth(flight.watch.intake());
  EXPECT_TRUE(smoothed.settled);
  EXPECT_GT((flight.after_1_s - kTruth).norm(), 0.2);
  EXPECT_THAT(at(smoothed, 1.0).p_EB, IsNear(kTruth, 0.1));
  const auto then =
      std::find_if(smoothed.certainties.begin(), smoothed.certainties.end(),
                   [&](const Certainty& c) { return smoothed.path[c.moment].time > 1.0 - 1e-3; });
  ASSERT_NE(then, smoothed.certainties.end());
  for (int axis = 0; axis < 2; ++axis)
    EXPECT_LT(std::sqrt(then->P(axis, axis)), 0.7 * std::sqrt(flight.P_after_1_s(axis, axis)));
}

TEST(Smoother, EndsWhereTheFilterEnds) {
  const Hovered flight = hovered();
  const Smoothed smoothed = smooth(flight.watch.intake());
  const eskf::Nominal& last = smoothed.path.back().x;
  EXPECT_NEAR(smoothed.path.back().time, 6.0, 1e-9);
  // But for what the filter's one linearisation leaves.
  EXPECT_THAT(last.p_EB, IsNear(flight.filter.now().p_EB, 0.02));
  EXPECT_THAT(last.v_E, IsNear(flight.filter.now().v_E, 0.02));
  const Certainty& end = smoothed.certainties.back();
  ASSERT_EQ(end.moment, smoothed.path.size() - 1);
  for (int state = 0; state < eskf::kGyroBias; ++state)
    EXPECT_NEAR(std::sqrt(end.P(state, state)) / flight.filter.sigma(state), 1.0, 0.05) << state;
}

TEST(Smoother, TakesInEverySampleAndEverySightingOnce) {
  const Hovered flight = hovered();
  const Intake& intake = flight.watch.intake();
  std::size_t samples = 0, sights = 0;
  double before = intake.start.time;
  for (const eskf::Tick& tick : intake.ticks) {
    EXPECT_GT(tick.time, before);
    before = tick.time;
    samples += tick.samples.size(), sights += tick.sights.size();
  }
  EXPECT_EQ(samples, 6u * 512u);
  EXPECT_EQ(sights, 45u);  // every 34th sample after the third second
}

// Twelve gates and eight slots: with each target the filter's memory may begin anew.
TEST(Smoother, TakesInEverySampleOnceWhenGatesChangeSlots) {
  eskf::Setup setup = one_gate();
  for (int i = 1; i < 12; ++i)
    setup.map.push_back({{4.0 + 3.0 * i, 2.0 * i, 0.0}, 0.0, {1.0, 0.05}});
  eskf::ErrorStateFilter filter{setup};
  IntakeWatch watch;
  Rng rng{12};
  const Vector3d up{0, 0, -setup.params.gravity};
  filter.start({.rest_accel_B = up}, 0.0);
  std::vector<std::size_t> seen;  // which landmarks, in order
  std::size_t target = 0;
  for (int i = 1; i <= 6 * 512; ++i) {
    const double t = kDt * i;
    filter.predict({.gyro_B = Vector3d::Zero(), .accel_B = up}, kDt, t);
    const bool sees = i % 37 == 0;
    if (sees) {
      eskf::GateSight sight = sight_of_gate(setup, t - 0.05, rng);
      sight.slot = filter.target_slot();
      if (filter.correct({&sight, 1})) seen.push_back(target);
    }
    if (i % 256 == 0) {
      target = static_cast<std::size_t>(i / 256) % 12;
      filter.set_target(setup.map[target].p_EG, 0.0);
    }
    watch.update(filter, sees);
  }
  std::size_t samples = 0;
  std::vector<std::size_t> taken;
  double before = 0.0;
  for (const eskf::Tick& tick : watch.intake().ticks) {
    EXPECT_GT(tick.time, before);
    before = tick.time, samples += tick.samples.size();
    for (const eskf::GateSight& sight : tick.sights)
      taken.push_back(static_cast<std::size_t>(sight.slot));
  }
  EXPECT_EQ(samples, 6u * 512u);
  EXPECT_EQ(taken, seen);
  EXPECT_GT(*std::max_element(seen.begin(), seen.end()), 8u);
}

}  // namespace
}  // namespace gatefly::smoothing
