// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/baseline/mahony.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/matchers.hpp"

namespace gatefly::baseline {
namespace {

using namespace test;
using Eigen::Vector3d;

constexpr double kDt = 1.0 / 512;
const Vector3d kUp{0, 0, -9.81};

// ė = −Kp sin e: for small angles a decay with Kp.
TEST(Mahony, TheTiltDecaysWithKp) {
  Mahony mahony;
  mahony.start({0.1, -0.05, 0.7});
  for (int i = 0; i < 2 * 512; ++i) mahony.update({Vector3d::Zero(), kUp}, kDt);
  EXPECT_NEAR(mahony.attitude().roll, 0.1 * std::exp(-1.0), 2e-3);
  EXPECT_NEAR(mahony.attitude().pitch, -0.05 * std::exp(-1.0), 2e-3);
}

TEST(Mahony, TheIntegralFindsAGyroBias) {
  Mahony mahony{{.kp = 0.5, .ki = 0.1}};
  const Vector3d bias{0.02, -0.01, 0};
  for (int i = 0; i < 120 * 512; ++i) mahony.update({bias, kUp}, kDt);
  EXPECT_THAT(mahony.gyro_bias(), IsNear(bias, 1e-4));
  EXPECT_NEAR(mahony.attitude().roll, 0, 1e-3);
}

// In a coordinated turn the specific force lies along the body's z: it takes the bank for level
// flight.
TEST(Mahony, LeansInATurn) {
  Mahony mahony;
  const double roll = 10 * kDegree, yaw_rate = 1.07;
  mahony.start({roll, 0, 0});
  const Vector3d gyro = rotation_x(-roll) * Vector3d{0, 0, yaw_rate},
                 accel{0, 0, -9.81 / cos(roll)};
  for (int i = 0; i < 3 * 512; ++i) mahony.update({gyro, accel}, kDt);
  const Eigen::RowVector3d down = mahony.R_EB().matrix.row(2),
                           true_down = rotation_EB(Attitude{roll, 0, 0}).matrix.row(2);
  EXPECT_GT(std::acos(down.dot(true_down)), 4 * kDegree);
}

TEST(Mahony, NoForceAndNoTimeCorrectNothing) {
  Mahony mahony;
  mahony.start({0.3, 0.1, 0});
  mahony.update({Vector3d::Zero(), Vector3d::Zero()}, 1.0);
  mahony.update({Vector3d{1, 1, 1}, kUp}, 0.0);
  EXPECT_NEAR(mahony.attitude().roll, 0.3, 1e-12);
  EXPECT_NEAR(mahony.attitude().pitch, 0.1, 1e-12);
}

}  // namespace
}  // namespace gatefly::baseline
