// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/twin_body.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/sim/body.hpp"

namespace gatefly::sim {
namespace {

constexpr double kTwinStep = 1.0 / 1024;

double hover_speed(const world::VehicleTruth& v) {
  return std::sqrt(v.mass * kGravity / 4 / v.thrust_coefficient);
}

std::array<double, 4> all(double speed) { return {speed, speed, speed, speed}; }

/// Climbs, then rolls, pitches and yaws by rotor speeds alone; starts 0.1 s after the motors.
std::array<double, 4> manoeuvre(double t, double hover) {
  std::array<double, 4> command = all(hover * (t < 0.8 ? 1.15 : 1.02));
  const double roll = t > 0.8 && t < 0.9 ? 0.03 : t > 0.9 && t < 1.0 ? -0.03 : 0.0;
  const double pitch = t > 1.0 && t < 1.1 ? 0.04 : t > 1.1 && t < 1.2 ? -0.04 : 0.0;
  const double yaw = t > 1.2 && t < 1.6 ? 0.05 : 0.0;
  constexpr std::array<double, 4> kRoll{1, -1, -1, 1}, kPitch{-1, -1, 1, 1}, kYaw{-1, 1, -1, 1};
  for (std::size_t i = 0; i < 4; ++i)
    command[i] += hover * (roll * kRoll[i] + pitch * kPitch[i] + yaw * kYaw[i]);
  return command;
}

TEST(TwinBody, FliesLikeMuJoCosBody) {
  world::SimConfig config;
  config.world.room_size = {100, 100, 50};
  config.start = {{1.0, -2.0}, 0.7};
  config.wind = {{0.4, -0.3}, 0.5};
  config.vehicle.sag = 0.05;
  Body body{config};
  TwinBody twin{config};
  const double hover = hover_speed(config.vehicle);
  for (int i = 0; i < 2048; ++i) {
    const auto command = manoeuvre(i * kTwinStep, hover);
    body.step(command, kTwinStep);
    twin.step(command, kTwinStep);
  }
  const BodyState &a = body.state(), &b = twin.state();
  EXPECT_LT((a.p_EB - b.p_EB).norm(), 0.005);
  EXPECT_LT((a.v_E - b.v_E).norm(), 0.01);
  EXPECT_LT((a.rate_B - b.rate_B).norm(), 0.005);
  EXPECT_LT((R_EB_of(a.q_EB) - R_EB_of(b.q_EB)).norm(), 0.003);
  EXPECT_EQ(a.rotor_speed, b.rotor_speed);
  // It was a manoeuvre.
  EXPECT_LT(b.p_EB.z(), -1.0);
  EXPECT_GT((b.p_EB - Eigen::Vector3d{1.0, -2.0, 0.0}).head<2>().norm(), 0.3);
  EXPECT_GT(b.rate_B.z(), 0.3);
}

TEST(TwinBody, StandsStillOnThePadWithTheMotorsOff) {
  world::SimConfig config;
  config.start = {{1.0, -2.0}, 0.7};
  TwinBody twin{config};
  const Eigen::Vector3d start = twin.state().p_EB;
  for (int i = 0; i < 2048; ++i) twin.step({}, kTwinStep);
  EXPECT_LT((twin.state().p_EB - start).norm(), 1e-12);
  EXPECT_LT((twin.state().specific_force_B - Eigen::Vector3d{0, 0, -kGravity}).norm(), 1e-9);
  EXPECT_EQ(twin.contact(), "floor");
}

TEST(TwinBody, LeavesThePadWhenTheRotorsCarryItAndComesBackToIt) {
  const world::SimConfig config;
  TwinBody twin{config};
  const double hover = hover_speed(config.vehicle);
  for (int i = 0; i < 1024; ++i)
    twin.step(all(0.89 * hover), kTwinStep);  // the floor helps by 1.23
  EXPECT_EQ(twin.contact(), "floor");
  for (int i = 0; i < 512; ++i) twin.step(all(1.1 * hover), kTwinStep);
  EXPECT_EQ(twin.contact(), std::nullopt);
  EXPECT_LT(twin.state().p_EB.z(), -0.1);
  for (int i = 0; i < 2048; ++i) twin.step(all(0.8 * hover), kTwinStep);
  EXPECT_EQ(twin.contact(), "floor");
  EXPECT_NEAR(twin.state().p_EB.z(), -0.5 * config.vehicle.size.z(), 0.02);
}

struct Throw {
  const char* what;
  double north, east;  // where the gate stands; it is flown at from (0, 0)
  double height;
  std::string hit;
};

// Climbs to a height, leans forward, flies north at it.
std::string hit_by_flying_north(const world::SimConfig& config, double height, double lean,
                                auto&& body_of) {
  auto body = body_of(config);
  const double hover = hover_speed(config.vehicle);
  // An ideal autopilot: enough for a straight way.
  for (int i = 0; i < 12 * 1024; ++i) {
    const BodyState& s = body.state();
    const Eigen::Matrix3d R = R_EB_of(s.q_EB);
    const bool up = s.p_EB.z() < -height + 0.2;
    const double pitch = std::asin(-R(2, 0)), wanted = up ? -lean : 0.0;
    const double collective =
        0.15 * (s.p_EB.z() + height) + 0.15 * s.v_E.z() + 0.5 * (1.0 / R(2, 2) - 1.0);
    const double turn = std::clamp(0.5 * (wanted - pitch) - 0.1 * s.rate_B.y(), -0.1, 0.1);
    const double front = 1.0 + std::clamp(collective, -0.2, 0.2) + turn, back = front - 2.0 * turn;
    body.step({hover * front, hover * front, hover * back, hover * back}, kTwinStep);
    const auto contact = body.contact();
    if (contact && -body.state().p_EB.z() > 0.15) return *contact;
  }
  return "";
}

TEST(TwinBody, NamesWhatItHitsLikeMuJoCosBody) {
  for (const Throw& at : {Throw{"upper bar", 3.0, 0.0, 2.0, "gate 1 upper bar"},
                          Throw{"lower bar", 3.0, 0.0, 1.0, "gate 1 lower bar"},
                          Throw{"pole", 3.0, 0.0, 0.5, "gate 1 pole"},
                          Throw{"left bar", 3.0, 0.475, 1.5, "gate 1 left bar"},
                          Throw{"right bar", 3.0, -0.475, 1.5, "gate 1 right bar"},
                          Throw{"through it", 3.0, 0.0, 1.5, "north wall"},
                          Throw{"beside it", 3.0, 1.5, 1.5, "north wall"}}) {
    world::SimConfig config;
    config.world.gates = {{.p_EG = {at.north, at.east, -1.5}}};
    EXPECT_EQ(hit_by_flying_north(config, at.height, 0.1,
                                  [](const world::SimConfig& c) { return TwinBody{c}; }),
              at.hit)
        << at.what;
    EXPECT_EQ(hit_by_flying_north(config, at.height, 0.1,
                                  [](const world::SimConfig& c) { return Body{c}; }),
              at.hit)
        << at.what;
  }
}

TEST(TwinBody, NeverTurnsNonFiniteOnANonFiniteCommand) {
  TwinBody twin{world::SimConfig{}};
  for (int i = 0; i < 100; ++i) twin.step({std::nan(""), 1e300, -1e300, INFINITY}, kTwinStep);
  EXPECT_TRUE(twin.state().p_EB.allFinite());
}

}  // namespace
}  // namespace gatefly::sim
