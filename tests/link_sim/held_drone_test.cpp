// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/held_drone.hpp"

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

namespace gatefly::link_sim {
namespace {

constexpr double kDt = 0.001;

TEST(HeldDrone, IsLevelAndStillUntilItIsTurned) {
  HeldDrone drone{world::SimConfig{}};
  for (int i = 0; i < 500; ++i) drone.step(kDt);
  EXPECT_NEAR(drone.told().imu.accel_B.z(), -kGravity, 1.5);
  EXPECT_LT(drone.told().imu.gyro_B.norm(), 0.1);
  EXPECT_LT(drone.state().p_EB.z(), -0.5) << "off the floor";
  EXPECT_FALSE(drone.turns());
}

TEST(HeldDrone, ATurnIsAboutOneAxisOfTheBodyAndBackAndRatesAreTheAttitudes) {
  for (int axis = 0; axis < 3; ++axis) {
    SCOPED_TRACE(axis);
    HeldDrone drone{world::SimConfig{}};
    const Eigen::Matrix3d before = sim::R_EB_of(drone.state().q_EB);
    drone.turn(axis);
    double most = 0.0;
    for (int i = 0; i < 2500; ++i) {
      const Eigen::Matrix3d last = sim::R_EB_of(drone.state().q_EB);
      const Eigen::Vector3d rate = drone.state().rate_B;
      drone.step(kDt);
      const Eigen::Vector3d turned = turn_of(last.transpose() * sim::R_EB_of(drone.state().q_EB));
      EXPECT_LT((turned / kDt - 0.5 * (rate + drone.state().rate_B)).norm(), 0.01) << i;
      const Eigen::Vector3d from_start =
          turn_of(before.transpose() * sim::R_EB_of(drone.state().q_EB));
      most = std::max(most, from_start[axis]);
      EXPECT_NEAR(from_start.norm(), std::abs(from_start[axis]), 1e-9);
    }
    EXPECT_NEAR(most, kPi / 3, 1e-3);
    EXPECT_FALSE(drone.turns());
    EXPECT_LT((sim::R_EB_of(drone.state().q_EB) - before).norm(), 1e-9);
  }
}

TEST(HeldDrone, ATurnThatGoesOnIsLeftAlone) {
  HeldDrone drone{world::SimConfig{}};
  drone.turn(0);
  for (int i = 0; i < 500; ++i) drone.step(kDt);
  drone.turn(2);
  drone.step(kDt);
  EXPECT_GT(drone.state().rate_B.x(), 0.5);
  EXPECT_EQ(drone.state().rate_B.z(), 0.0);
}

}  // namespace
}  // namespace gatefly::link_sim
