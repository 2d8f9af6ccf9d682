// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/air.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/body.hpp"
#include "gatefly/sim/twin_body.hpp"

#include "support/matchers.hpp"

namespace gatefly::sim {
namespace {

using test::IsNear;

constexpr double kStep = 1.0 / 1024;

/// Towards east, its axis 2 m north of the origin.
world::Jet eastward() {
  return {.through = {2.0, 7.0}, .heading = 0.5 * kPi, .speed = 0.3, .width = 1.0};
}

TEST(Jet, IsFastestOnItsAxisHalfAsFastAtHalfItsWidthAndNothingBeyondItsWidth) {
  for (const double east : {-6.0, 0.0, 30.0}) {  // the same all along
    EXPECT_THAT(jet_at(eastward(), {2.0, east}), IsNear(Eigen::Vector2d{0.0, 0.3}, 1e-12));
    for (const double aside : {-0.5, 0.5})
      EXPECT_THAT(jet_at(eastward(), {2.0 + aside, east}),
                  IsNear(Eigen::Vector2d{0.0, 0.15}, 1e-12));
    for (const double aside : {-1.001, 1.001, 8.0})
      EXPECT_EQ(jet_at(eastward(), {2.0 + aside, east}), Eigen::Vector2d::Zero());
  }
}

TEST(Jet, CarriesAsMuchAirAsOneOfItsWidthThatIsEverywhereAsFast) {
  world::Jet jet = eastward();
  jet.width = 0.7;
  double flow = 0.0, last = 0.0;
  constexpr double kSlice = 1e-3;
  for (double north = 0.0; north < 4.0; north += kSlice) {
    const double speed = jet_at(jet, {north, 0.0}).norm();
    flow += kSlice * speed;
    EXPECT_LT(std::abs(speed - last), 2e-3) << "it is smooth";
    last = speed;
  }
  EXPECT_NEAR(flow, jet.speed * jet.width, 1e-6);
}

TEST(Shear, GrowsAsideOfItsMiddleStandsThereAndIsTheSameAlong) {
  const world::Shear shear{
      .middle = {1.0, -2.0}, .heading = 0.0, .rate = 0.1};  // north; right is east
  EXPECT_EQ(shear_at(shear, {1.0, -2.0}), Eigen::Vector2d::Zero());
  EXPECT_THAT(shear_at(shear, {9.0, 1.0}), IsNear(Eigen::Vector2d{0.3, 0.0}, 1e-12));
  EXPECT_THAT(shear_at(shear, {-4.0, -5.0}), IsNear(Eigen::Vector2d{-0.3, 0.0}, 1e-12));
}

TEST(Wash, PushesAwayFromEachWallWithinAMetreAndNowhereElse) {
  const Eigen::AlignedBox2d room{Eigen::Vector2d{-3.0, -4.0}, Eigen::Vector2d{5.0, 4.0}};
  EXPECT_EQ(wash_at(room, {1.0, 0.0}), Eigen::Vector2d::Zero());
  EXPECT_EQ(wash_at(room, {-2.0, 3.0}), Eigen::Vector2d::Zero());
  EXPECT_THAT(wash_at(room, {4.5, 0.0}), IsNear(Eigen::Vector2d{-0.125, 0.0}, 1e-12));
  EXPECT_THAT(wash_at(room, {-2.5, 0.0}), IsNear(Eigen::Vector2d{0.125, 0.0}, 1e-12));
  EXPECT_THAT(wash_at(room, {-2.8, -3.5}), IsNear(Eigen::Vector2d{0.32, 0.125}, 1e-12));
  EXPECT_LT(wash_at(room, {4.001, 0.0}).norm(), 1e-5) << "it begins smoothly";
}

world::SimConfig in_room(const world::Wind& wind) {
  world::SimConfig config;
  config.world.room_size = {10.0, 10.0, 3.0};
  config.wind = wind;
  return config;
}

TEST(Air, StandsStillToTheBitWhereNothingMovesIt) {
  Air air{in_room({.wash = 1.0})};
  BodyState state;
  for (int i = 0; i < 100; ++i) air.advance(state, 1.0, i * kStep, kStep);
  EXPECT_EQ(air.velocity_E(), Eigen::Vector3d::Zero());
}

TEST(Air, IsTheSumOfWhatMovesIt) {
  const world::Wind wind{.mean = {0.2, -0.1},
                         .jet = {.through = {1.0, 0.0}, .heading = 0.0, .speed = 0.4},
                         .shear = {.middle = {0.0, 0.0}, .heading = 0.0, .rate = 0.1}};
  Air air{in_room(wind)};
  BodyState state;
  state.p_EB = {3.0, 0.5, -1.5};
  air.advance(state, 1.0, 0.0, kStep);
  EXPECT_THAT(air.velocity_E(), IsNear(Eigen::Vector3d{0.2 + 0.2 + 0.05, -0.1, 0.0}, 1e-12));
}

TEST(Air, WashComesAndGoesWithItsMeanAndOnlyWhileRotorsTurn) {
  Air at_hover{in_room({.wash = 1.0})}, slow{in_room({.wash = 0.5})}, off{in_room({.wash = 1.0})};
  BodyState state;
  state.p_EB = {4.5, 0.0, -1.5};
  double sum = 0.0, sum2 = 0.0;
  constexpr int kSteps = 1024 * 2000;
  for (int i = 0; i < kSteps; ++i) {
    at_hover.advance(state, 1.0, i * kStep, kStep);
    const double away = -at_hover.velocity_E().x();
    sum += away, sum2 += away * away;
    if (i >= 1024) continue;
    slow.advance(state, 0.8, i * kStep, kStep);
    off.advance(state, 0.0, i * kStep, kStep);
    ASSERT_NEAR(slow.velocity_E().x(), 0.4 * at_hover.velocity_E().x(), 1e-12);
    ASSERT_EQ(off.velocity_E().norm(), 0.0);
  }
  // 2,000 correlation times: a mean within 3 sigma / sqrt(2000).
  const double mean = sum / kSteps;
  EXPECT_NEAR(mean, 0.125, 0.07 * 0.125);
  EXPECT_NEAR(std::sqrt(sum2 / kSteps - mean * mean), 0.125, 0.07 * 0.125);
}

TEST(Air, WashLeavesGustsAsTheyWere) {
  Air without{in_room({.gust = 0.3})}, with{in_room({.gust = 0.3, .wash = 1.0})};
  BodyState far;
  far.v_E = {1.0, 0.0, 0.0};
  for (int i = 0; i < 1000; ++i) {
    without.advance(far, 1.0, i * kStep, kStep), with.advance(far, 1.0, i * kStep, kStep);
    ASSERT_EQ(with.velocity_E(), without.velocity_E());
  }
}

/// Up, then across the jet and towards a wall.
std::array<double, 4> flown(double t, double hover) {
  const double lift = t < 0.8 ? 1.15 : 1.02;
  const double pitch = t > 1.0 && t < 1.1 ? 0.04 : t > 1.1 && t < 1.2 ? -0.04 : 0.0;
  return {hover * (lift - pitch), hover * (lift - pitch), hover * (lift + pitch),
          hover * (lift + pitch)};
}

TEST(Air, MovesMuJoCosBodyAndItsTwinAlike) {
  world::SimConfig config =
      in_room({.jet = {.through = {4.0, 0.0}, .heading = 0.5 * kPi, .speed = 1.0},
               .shear = {.middle = {0.0, 0.0}, .heading = 0.3, .rate = 0.2},
               .wash = 1.0});
  config.world.room_size.z() = 50.0;
  config.start.position = {3.5, 0.0};
  Body body{config};
  TwinBody twin{config};
  config.wind = {};
  TwinBody still{config};
  const double hover =
      std::sqrt(config.vehicle.mass * kGravity / 4 / config.vehicle.thrust_coefficient);
  for (int i = 0; i < 2048; ++i) {
    const auto command = flown(i * kStep, hover);
    body.step(command, kStep), twin.step(command, kStep), still.step(command, kStep);
  }
  EXPECT_LT((body.state().p_EB - twin.state().p_EB).norm(), 0.005);
  EXPECT_LT((body.state().wind_E - twin.state().wind_E).norm(), 0.005);
  EXPECT_GT((twin.state().p_EB - still.state().p_EB).norm(), 0.2) << "it did move them";
}

}  // namespace
}  // namespace gatefly::sim
