// SPDX-License-Identifier: Apache-2.0
#include "gatefly/pose/ray_intersection.hpp"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/attitude.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector3d;

std::vector<Vector3d> unit_gate_corners() {
  return {{0, -.5, -.5}, {0, .5, -.5}, {0, .5, .5}, {0, -.5, .5}};
}

std::vector<Ray> rays_from(const Vector3d& camera) {
  std::vector<Ray> rays;
  for (const Vector3d& corner : unit_gate_corners())
    rays.push_back({corner, (corner - camera).normalized()});
  return rays;
}

Vector3d any_place_of_camera(Rng& rng) {
  return {rng.uniform(-5, -1), rng.uniform(-2, 2), rng.uniform(-1, 1)};
}

double squared_distances(const std::vector<Ray>& rays, const Vector3d& t) {
  double sum = 0;
  for (const auto& [p, v] : rays) sum += (t - p).squaredNorm() - std::pow(v.dot(t - p), 2);
  return sum;
}

TEST(NearestPoint, RecoversTheCameraWhenRaysAreExact) {
  for_all(200, [](Rng& rng) {
    const Vector3d camera = any_place_of_camera(rng);
    const auto found = nearest_point(rays_from(camera));
    ASSERT_TRUE(found);
    EXPECT_THAT(*found, IsNear(camera, 1e-9));
  });
}

TEST(NearestPoint, IsTheLeastSumOfSquaredDistances) {
  for_all(200, [](Rng& rng) {
    auto rays = rays_from(any_place_of_camera(rng));
    for (auto& ray : rays) ray.direction = (ray.direction + any_vector3(rng, 0.02)).normalized();
    const auto found = nearest_point(rays);
    ASSERT_TRUE(found);
    const double least = squared_distances(rays, *found);
    for (int i = 0; i < 10; ++i)
      EXPECT_GE(squared_distances(rays, *found + any_vector3(rng, 0.05)), least - 1e-12);
  });
}

TEST(NearestPoint, MovesAndTurnsWithItsRays) {
  for_all(200, [](Rng& rng) {
    auto rays = rays_from(any_place_of_camera(rng));
    for (auto& ray : rays) ray.direction = (ray.direction + any_vector3(rng, 0.02)).normalized();
    const auto found = nearest_point(rays);
    ASSERT_TRUE(found);
    const Eigen::Matrix3d R = rotation_EB(any_attitude(rng)).matrix;
    const Vector3d shift = any_vector3(rng, 10);
    for (auto& ray : rays) ray = {R * ray.point + shift, R * ray.direction};
    const auto moved = nearest_point(rays);
    ASSERT_TRUE(moved);
    EXPECT_THAT(*moved, IsNear(R * *found + shift, 1e-7));
  });
}

TEST(NearestPoint, IsTheSameWhateverTheOrderAndWhereverOnTheRay) {
  const Vector3d camera{-3, 0.4, 0.2};
  auto rays = rays_from(camera);
  std::swap(rays[0], rays[2]);
  rays[1].point += 0.3 * rays[1].direction;
  EXPECT_THAT(*nearest_point(rays), IsNear(camera, 1e-9));
}

TEST(NearestPoint, TwoRaysAreEnough) {
  const Vector3d camera{-2, 0.1, 0.3};
  auto rays = rays_from(camera);
  rays.resize(2);
  EXPECT_THAT(*nearest_point(rays), IsNear(camera, 1e-9));
}

TEST(NearestPoint, TooFewOrParallelRaysHaveNoAnswer) {
  EXPECT_FALSE(nearest_point({}));
  const std::vector<Ray> one{{Vector3d::Zero(), Vector3d::UnitX()}};
  EXPECT_FALSE(nearest_point(one));
  std::vector<Ray> parallel;
  for (const Vector3d& corner : unit_gate_corners())
    parallel.push_back({corner, Vector3d::UnitX()});
  EXPECT_FALSE(nearest_point(parallel));
  const std::vector<Ray> same{{Vector3d::Zero(), Vector3d::UnitX()},
                              {Vector3d::Zero(), Vector3d::UnitX()}};
  EXPECT_FALSE(nearest_point(same));
}

TEST(NearestPoint, PointsBehindTheCameraHaveNoAnswer) {
  auto rays = rays_from({-3, 0, 0});
  for (auto& ray : rays) ray.direction *= -1;
  EXPECT_FALSE(nearest_point(rays)) << "all behind";
  rays = rays_from({-3, 0, 0});
  rays[2].direction *= -1;
  EXPECT_FALSE(nearest_point(rays)) << "one behind";
}

TEST(NearestPoint, NotANumberHasNoAnswer) {
  auto rays = rays_from({-3, 0, 0});
  rays[1].direction.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(nearest_point(rays));
  rays = rays_from({-3, 0, 0});
  rays[1].point.x() = std::numeric_limits<double>::quiet_NaN();
  const auto found = nearest_point(rays);
  EXPECT_FALSE(found.has_value()) << "a NaN point";
}

}  // namespace
}  // namespace gatefly
