// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/attitude.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector3d;

TEST(Attitude, RotationsAreRotations) {
  for_all(200, [](Rng& rng) {
    const double a = rng.uniform(-10, 10);
    EXPECT_THAT(rotation_x(a), IsRotation());
    EXPECT_THAT(rotation_y(a), IsRotation());
    EXPECT_THAT(rotation_z(a), IsRotation());
    EXPECT_THAT(rotation_EB(any_attitude(rng, 1.5)).matrix, IsRotation());
    EXPECT_THAT(camera_mount(rng.uniform(-1, 1), rng.uniform(-1, 1)).matrix, IsRotation());
  });
}

TEST(Attitude, EulerAnglesComeBackAsTheyWentIn) {
  for_all(200, [](Rng& rng) {
    const Attitude in{rng.uniform(-kPi, kPi), rng.uniform(-1.5, 1.5), rng.uniform(-kPi, kPi)};
    const Attitude out = attitude_of(rotation_EB(in));
    EXPECT_NEAR(out.roll, in.roll, 1e-12);
    EXPECT_NEAR(out.pitch, in.pitch, 1e-12);
    EXPECT_NEAR(out.yaw, in.yaw, 1e-12);
  });
}

TEST(Attitude, AtGimbalLockTheRotationIsKeptAndRollIsZero) {
  for (const double pitch : {kPi / 2, -kPi / 2})
    for_all(50, [&](Rng& rng) {
      const RotationEB R = rotation_EB(Attitude{rng.uniform(-3, 3), pitch, rng.uniform(-3, 3)});
      const Attitude a = attitude_of(R);
      EXPECT_EQ(a.roll, 0.0);
      EXPECT_THAT(rotation_EB(a).matrix, IsNear(R.matrix, 1e-8));
    });
}

TEST(Attitude, SignsAreThoseOfTheConventions) {
  const Vector3d forward{1, 0, 0}, right{0, 1, 0};
  EXPECT_THAT(rotation_EB(Attitude{0, 0, kPi / 2}) * forward, IsNear(Vector3d{0, 1, 0}, 1e-15))
      << "yaw 90: east";
  EXPECT_LT((rotation_EB(Attitude{0, 0.1, 0}) * forward).z(), 0) << "nose up: the nose points up";
  EXPECT_GT((rotation_EB(Attitude{0.1, 0, 0}) * right).z(), 0)
      << "roll right: the right side points down";
}

TEST(Attitude, QuaternionAndMatrixAreTheSameRotation) {
  for_all(200, [](Rng& rng) {
    const Attitude a = any_attitude(rng, 1.5);
    EXPECT_THAT(rotation_EB(quaternion_of(a)).matrix, IsNear(rotation_EB(a).matrix, 1e-14));
  });
}

TEST(Attitude, IntegrationOfAConstantRateIsTheExactRotation) {
  for_all(200, [](Rng& rng) {
    const Quaternion q = quaternion_of(any_attitude(rng));
    const Vector3d axis = any_direction(rng);
    const double rate = rng.uniform(0, 8), seconds = 0.5;
    Quaternion stepped = q;
    for (int i = 0; i < 256; ++i) stepped = integrated(stepped, rate * axis, seconds / 256);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd{rate * seconds, axis}.toRotationMatrix();
    EXPECT_THAT(rotation_EB(stepped).matrix, IsNear(rotation_EB(q).matrix * turn, 1e-12));
    EXPECT_NEAR(stepped.w * stepped.w + stepped.x * stepped.x + stepped.y * stepped.y +
                    stepped.z * stepped.z,
                1.0, 1e-14);
  });
}

TEST(Attitude, NoRateOrNoTimeTurnsNothing) {
  const Quaternion q = quaternion_of({0.1, 0.2, 0.3});
  const auto R = rotation_EB(q).matrix;
  EXPECT_THAT(rotation_EB(integrated(q, Vector3d::Zero(), 1.0)).matrix, IsNear(R, 1e-15));
  EXPECT_THAT(rotation_EB(integrated(q, Vector3d{1, 2, 3}, 0.0)).matrix, IsNear(R, 1e-15));
  EXPECT_THAT(rotation_EB(integrated(q, Vector3d::Constant(1e-15), 1.0)).matrix, IsNear(R, 1e-14));
}

TEST(CameraMount, LooksForwardAndATiltLooksDown) {
  const Vector3d axis{0, 0, 1}, right{1, 0, 0}, down{0, 1, 0};
  EXPECT_THAT(camera_mount(0) * axis, IsNear(Vector3d{1, 0, 0}, 1e-15));
  EXPECT_THAT(camera_mount(0) * right, IsNear(Vector3d{0, 1, 0}, 1e-15));
  EXPECT_THAT(camera_mount(0) * down, IsNear(Vector3d{0, 0, 1}, 1e-15));
  const double tilt = 20 * kDegree;
  EXPECT_THAT(camera_mount(tilt) * axis,
              IsNear(Vector3d{std::cos(tilt), 0, std::sin(tilt)}, 1e-15));
}

TEST(Skew, IsTheCrossProduct) {
  for_all(200, [](Rng& rng) {
    const Vector3d a = any_vector3(rng, 3), b = any_vector3(rng, 3);
    EXPECT_THAT(skew(a) * b, IsNear(a.cross(b), 1e-14));
  });
}

}  // namespace
}  // namespace gatefly
