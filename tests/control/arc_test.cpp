// SPDX-License-Identifier: Apache-2.0
#include "gatefly/control/arc.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDt = 1.0 / 512;

ArcParams without_drag(double radius, double pitch) {
  ArcParams p;
  p.radius = radius, p.pitch = pitch, p.drag.setZero();
  return p;
}

// Li18 Eq. (28) without drag: tan φ = v² cos θ / (r g).
TEST(Arc, WithoutDragTheRollIsTheCoordinatedOne) {
  for_all(200, [](Rng& rng) {
    const double v = rng.uniform(0.5, 2.2),
                 r = rng.uniform(1.2, 3.0) * (rng.uniform_index(2) ? 1 : -1);
    const double pitch = rng.uniform(-0.15, 0.05);
    Arc arc{.v_F = {v, 0, 0}};
    const AttitudeCommand c = step(arc, kDt, without_drag(r, pitch));
    EXPECT_NEAR(c.roll, std::atan(v * v * std::cos(pitch) / (r * 9.81)), 1e-12);
    EXPECT_NEAR(c.yaw_rate, v / r, 1e-12);
    EXPECT_NEAR(c.thrust, 9.81 / (std::cos(pitch) * std::cos(c.roll)), 1e-12);
    EXPECT_EQ(c.pitch, pitch);
  });
}

TEST(Arc, ARightTurnRollsRightAndTheMirroredOneMirrored) {
  for_all(200, [](Rng& rng) {
    const double v = rng.uniform(0.5, 2.2), v_y = rng.uniform(-0.2, 0.2), yaw = rng.uniform(-1, 1);
    ArcParams right, left;
    right.radius = rng.uniform(1.0, 3.0), left.radius = -right.radius;
    Arc a{.yaw = yaw, .v_F = {v, v_y, 0.1}}, b{.yaw = -yaw, .v_F = {v, -v_y, 0.1}};
    for (int i = 0; i < 100; ++i) {
      const AttitudeCommand ca = step(a, kDt, right), cb = step(b, kDt, left);
      EXPECT_NEAR(ca.roll, -cb.roll, 1e-12);
      EXPECT_NEAR(ca.yaw, -cb.yaw, 1e-12);
      EXPECT_NEAR(ca.thrust, cb.thrust, 1e-12);
    }
    EXPECT_GT(a.roll, 0.0);
    EXPECT_THAT(b.v_F, IsNear(Vector3d{a.v_F.x(), -a.v_F.y(), a.v_F.z()}, 1e-12));
  });
}

TEST(Arc, RadiusZeroIsStraightAhead) {
  Arc arc{.yaw = 0.7, .v_F = {1.5, 0, 0}};
  ArcParams params;
  params.radius = 0.0;
  for (int i = 0; i < 200; ++i) {
    const AttitudeCommand c = step(arc, kDt, params);
    EXPECT_NEAR(c.roll, 0, 1e-12);
    EXPECT_NEAR(c.yaw, 0.7, 1e-12);
  }
  EXPECT_NEAR(arc.v_F.y(), 0, 1e-12);
}

// Level and slip-free is what the law promises: v_y and v_z stay where they began, at zero.
TEST(Arc, StaysLevelAndSlipFree) {
  Arc arc{.v_F = {1.6, 0, 0}};
  ArcParams params;
  for (int i = 0; i < 3 * 512; ++i) {
    (void)step(arc, kDt, params);
    EXPECT_NEAR(arc.v_F.y(), 0, 0.02);
    EXPECT_NEAR(arc.v_F.z(), 0, 0.02);
  }
}

// At v = g tan|θ| / |k| (level, drag along the heading) pull and drag balance and the track is a
// circle of radius r.
TEST(Arc, DescribesACircleOfItsRadius) {
  ArcParams params;
  params.radius = 1.5;
  Arc arc{.v_F = {1.6, 0, 0}};
  for (int i = 0; i < 20 * 512; ++i) (void)step(arc, kDt, params);  // until the speed is steady
  const double start = arc.yaw;
  Vector2d p{0, 0}, farthest{0, 0};
  double turned = 0;
  for (int i = 0; i < 8 * 512 && turned < kPi; ++i) {
    const auto [s, c] = sincos(arc.yaw);
    p += kDt * Vector2d{c * arc.v_F.x() - s * arc.v_F.y(), s * arc.v_F.x() + c * arc.v_F.y()};
    const double before = arc.yaw;
    (void)step(arc, kDt, params);
    turned += wrap_angle(arc.yaw - before);
    if (p.norm() > farthest.norm()) farthest = p;
  }
  EXPECT_NEAR(turned, kPi, 0.01);
  EXPECT_NEAR(p.norm(), 3.0, 0.05) << "half a circle on, one diameter away";
  const Vector2d right{-gatefly::sin(start), gatefly::cos(start)};
  EXPECT_GT(right.dot(p), 2.9) << "to the right";
}

TEST(Arc, RollNeverExceedsItsLimitAndNoTimeChangesNothing) {
  ArcParams params;
  params.radius = 0.2;
  Arc arc{.yaw = 0.1, .v_F = {3, 0, 0}};
  EXPECT_LE(std::abs(step(arc, 0.0, params).roll), params.max_roll);
  EXPECT_EQ(arc.yaw, 0.1);
  EXPECT_EQ(arc.v_F, Vector3d(3, 0, 0));
}

TEST(DragF, IsAlongTheVelocityWhenDragIsTheSameOnAllAxes) {
  for_all(200, [](Rng& rng) {
    const Vector3d v = any_vector3(rng, 3);
    EXPECT_THAT(drag_F(v, rng.uniform(-0.6, 0.6), rng.uniform(-0.3, 0.3), Vector3d::Constant(-0.5)),
                IsNear(Vector3d{-0.5 * v}, 1e-12));
    EXPECT_LE(drag_F(v, rng.uniform(-0.6, 0.6), rng.uniform(-0.3, 0.3), {-0.5, -0.4, 0}).dot(v),
              1e-12)
        << "drag brakes";
  });
}

// Level arc, drag in F: a_y = (k_y - k_z) v sin φ cos φ sin θ, a_z = v sin θ cos θ (-k_x + k_y sin²
// φ + k_z cos² φ).
TEST(DragF, HasTheClosedFormOfForwardFlight) {
  for_all(200, [](Rng& rng) {
    const double v = rng.uniform(0, 3), phi = rng.uniform(-0.6, 0.6),
                 theta = rng.uniform(-0.3, 0.3);
    const Vector3d k{-0.5, -0.45, -0.1};
    const Vector3d a = drag_F({v, 0, 0}, phi, theta, k);
    const double sp = std::sin(phi), cp = std::cos(phi), st = std::sin(theta), ct = std::cos(theta);
    EXPECT_NEAR(a.y(), (k.y() - k.z()) * v * sp * cp * st, 1e-12);
    EXPECT_NEAR(a.z(), v * st * ct * (-k.x() + k.y() * sp * sp + k.z() * cp * cp), 1e-12);
  });
}

}  // namespace
}  // namespace gatefly
