// SPDX-License-Identifier: Apache-2.0
#include "gatefly/pose/bearing_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/rotation_vector.hpp"

#include "support/central_difference.hpp"
#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using Eigen::Vector3d;
using test::central_difference;
using test::for_all;
using test::IsNear;

CameraPose any_camera(Rng& rng) {
  CameraPose camera;
  camera.p_EB = test::any_vector3(rng, 3.0);
  camera.R_EB = rotation_EB(test::any_attitude(rng)).matrix;
  camera.R_BC = camera_mount(rng.uniform(-0.2, 0.5)).matrix;
  camera.p_BC = test::any_vector3(rng, 0.1);
  camera.focal = rng.uniform(-0.05, 0.05), camera.bend = rng.uniform(-0.05, 0.05);
  return camera;
}

// A point up to 45° off the axis, and a bearing that is up to 2° beside it.
Vector3d any_point(Rng& rng, const CameraPose& camera) {
  const double z = rng.uniform(0.5, 8.0);
  const Vector3d p_C{z * rng.uniform(-1.0, 1.0), z * rng.uniform(-1.0, 1.0), z};
  return camera.p_EB + camera.R_EB * (camera.p_BC + camera.R_BC * p_C);
}

using Unknowns = Eigen::Matrix<double, 11, 1>;  // point, turn, mount, focal, bend

CameraPose moved(CameraPose camera, const Unknowns& u) {
  camera.R_EB = rotation_of(u.segment<3>(3)) * camera.R_EB;
  camera.R_BC = camera.R_BC * rotation_of(u.segment<3>(6));
  camera.focal += u(9), camera.bend += u(10);
  return camera;
}

TEST(PointBearing, JacobiansMatchCentralDifferences) {
  for_all(200, [](Rng& rng) {
    const CameraPose camera = any_camera(rng);
    const Vector3d point = any_point(rng, camera);
    const Vector3d truly =
        (camera.R_BC.transpose() * (camera.R_EB.transpose() * (point - camera.p_EB) - camera.p_BC))
            .normalized();
    const Vector3d seen = (truly + test::any_vector3(rng, 0.03)).normalized();
    const auto at = point_bearing(point, seen, camera);
    ASSERT_TRUE(at.has_value());
    const auto residual = [&](const Unknowns& u) -> Eigen::Vector2d {
      return point_bearing(point + u.head<3>(), seen, moved(camera, u))->residual;
    };
    Eigen::Matrix<double, 2, 11> J;
    J << at->by_point, at->by_turn, at->by_mount, at->by_focal, at->by_bend;
    EXPECT_THAT(-J, IsNear(central_difference(residual, Unknowns(Unknowns::Zero())), 1e-7));
  });
}

TEST(PointBearing, IsZeroWhereThePointIsAndNothingBehindTheCamera) {
  CameraPose camera;
  camera.R_BC = camera_mount(0.0).matrix;
  const Vector3d ahead{3, 0.4, -0.2};
  const auto seen = point_bearing(ahead, (camera.R_BC.transpose() * ahead).normalized(), camera);
  ASSERT_TRUE(seen.has_value());
  EXPECT_THAT(seen->residual, IsNear(Eigen::Vector2d{0, 0}, 1e-12));
  EXPECT_FALSE(point_bearing({-3, 0, 0}, Vector3d::UnitZ(), camera).has_value());
}

// The derivatives leave out what is of second order in the residual: on the line there is none.
TEST(LineBearing, JacobiansMatchCentralDifferencesOnTheLine) {
  for_all(200, [](Rng& rng) {
    CameraPose camera = any_camera(rng);
    camera.focal = camera.bend = 0.0;  // the ray goes through the lens as it is told
    const Vector3d point = any_point(rng, camera);
    const Vector3d along = Vector3d::UnitZ();
    const Vector3d seen =
        (camera.R_BC.transpose() * (camera.R_EB.transpose() * (point - camera.p_EB) - camera.p_BC))
            .normalized();
    const Vector3d elsewhere = point + rng.uniform(-0.5, 0.5) * along;  // where on it is not known
    const auto at = line_bearing(elsewhere, along, seen, camera);
    if (!at) return test::not_a_case();
    EXPECT_NEAR(at->residual, 0.0, 1e-9);
    using Vector9 = Eigen::Matrix<double, 9, 1>;
    const auto residual = [&](const Vector9& u) -> Eigen::Matrix<double, 1, 1> {
      Unknowns all = Unknowns::Zero();
      all.head<9>() = u;
      return Eigen::Matrix<double, 1, 1>{
          line_bearing(elsewhere + u.head<3>(), along, seen, moved(camera, all))->residual};
    };
    Eigen::Matrix<double, 1, 9> J;
    J << at->by_point, at->by_turn, at->by_mount;
    EXPECT_THAT(-J, IsNear(central_difference(residual, Vector9(Vector9::Zero())), 1e-6));
  });
}

TEST(LineBearing, DoesNotAskWhereOnTheLineItWasSeen) {
  CameraPose camera;
  camera.R_BC = camera_mount(0.3).matrix;
  const Vector3d foot{4, 0.5, 1.0};
  for (const double height : {-1.5, -0.5, 0.4}) {
    const Vector3d there = foot + height * Vector3d::UnitZ();
    const auto seen = line_bearing(foot, Vector3d::UnitZ(),
                                   (camera.R_BC.transpose() * there).normalized(), camera);
    ASSERT_TRUE(seen.has_value());
    EXPECT_NEAR(seen->residual, 0.0, 1e-12) << height;
    EXPECT_NEAR(seen->distance, there.norm(), 1e-9);
  }
}

}  // namespace
}  // namespace gatefly
