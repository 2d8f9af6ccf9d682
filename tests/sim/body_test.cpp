// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/body.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"

namespace gatefly::sim {
namespace {

constexpr double kPhysics = 1.0 / 1024;

double hovering_speed(const world::VehicleTruth& v) {
  return std::sqrt(v.mass * 9.81 / 4 / v.thrust_coefficient);
}

TEST(Body, StandsStillOnThePadWithTheMotorsOff) {
  Body body{world::SimConfig{}};
  for (int i = 0; i < 2048; ++i) body.step({}, kPhysics);
  EXPECT_LT(body.state().v_E.norm(), 1e-3);
  EXPECT_NEAR(body.state().specific_force_B.z(), -9.81, 0.05);
  ASSERT_TRUE(body.contact().has_value());
  EXPECT_EQ(*body.contact(), "floor");
}

TEST(Body, HoversAtHoverSpeedAndReadsOneG) {
  Body body{world::SimConfig{}};
  const double hover = hovering_speed(world::VehicleTruth{});
  for (int i = 0; i < 1000; ++i)  // off the floor, which helps
    body.step({1.1 * hover, 1.1 * hover, 1.1 * hover, 1.1 * hover}, kPhysics);
  for (int i = 0; i < 200; ++i) body.step({hover, hover, hover, hover}, kPhysics);
  EXPECT_LT(body.state().p_EB.z(), -0.1);
  // Rising slowly, drag pulls down a little; nothing else.
  const double v_z = body.state().v_E.z();
  EXPECT_NEAR(body.state().specific_force_B.z(), -9.81 - 0.15 * v_z + 0.022 * std::abs(v_z) * -v_z,
              0.05);
}

TEST(Body, StartsWhereAndHowItIsPut) {
  world::SimConfig config;
  config.start = {{1.0, -2.0}, 0.7};
  const Body body{config};
  EXPECT_NEAR(body.state().p_EB.x(), 1.0, 1e-9);
  EXPECT_NEAR(body.state().p_EB.y(), -2.0, 1e-9);
  EXPECT_NEAR(attitude_of(RotationEB{R_EB_of(body.state().q_EB)}).yaw, 0.7, 1e-9);
}

struct Push {
  const char* what;
  std::array<double, 4> factor;  // left front, right front, right back, left back
  Eigen::Vector3d rate_sign;
};

TEST(Body, RotorsTurnItTheWayTheyShould) {
  const double hover = hovering_speed(world::VehicleTruth{});
  for (const Push& push :
       {Push{"left rotors roll right", {1.1, 1, 1, 1.1}, {1, 0, 0}},
        Push{"front rotors pitch up", {1.1, 1.1, 1, 1}, {0, 1, 0}},
        Push{"right front and left back yaw right", {1, 1.1, 1, 1.1}, {0, 0, 1}}}) {
    Body body{world::SimConfig{}};
    for (int i = 0; i < 400; ++i)
      body.step({1.1 * hover, 1.1 * hover, 1.1 * hover, 1.1 * hover}, kPhysics);
    std::array<double, 4> command{};
    for (std::size_t i = 0; i < 4; ++i) command[i] = hover * push.factor[i];
    for (int i = 0; i < 60; ++i) body.step(command, kPhysics);
    for (int axis = 0; axis < 3; ++axis) {
      if (push.rate_sign(axis) > 0)
        EXPECT_GT(body.state().rate_B(axis), 0.05) << push.what;
      else
        EXPECT_NEAR(body.state().rate_B(axis), 0.0, 0.02) << push.what;
    }
  }
}

TEST(Body, NamesWhatItHits) {
  world::SimConfig config;
  // a board 1 m above the pad
  config.world.obstacles = {world::WorldBox{{0, 0}, {2, 2}, 0.0, 1.0, 1.2, false}};
  Body body{config};
  const double full = 1.3 * hovering_speed(config.vehicle);
  std::string hit;
  for (int i = 0; i < 2048 && hit.empty(); ++i) {
    body.step({full, full, full, full}, kPhysics);
    if (body.state().p_EB.z() < -0.3 && body.contact()) hit = *body.contact();
  }
  EXPECT_EQ(hit, "obstacle 1");
}

TEST(Body, NeverTurnsNonFiniteOnANonFiniteCommand) {
  Body body{world::SimConfig{}};
  for (int i = 0; i < 100; ++i) body.step({std::nan(""), 1e300, -1e300, INFINITY}, kPhysics);
  EXPECT_TRUE(body.state().p_EB.allFinite());
}

}  // namespace
}  // namespace gatefly::sim
