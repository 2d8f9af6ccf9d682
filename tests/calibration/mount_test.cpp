// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/mount.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"

#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::calibration {
namespace {

using namespace gatefly::test;

constexpr double kTilt = 17.0 * kDegree, kRoll = -1.5 * kDegree;
const AnyCamera kMountedLens{DhaneFisheye{}};

/// A 1 m gate whose middle is at p_BG of a level drone, as the tilted camera sees it.
Quad seen(const Eigen::Vector3d& p_BG, double heading, double noise_px, Rng& rng) {
  Quad quad;
  const Eigen::Matrix3d R_BC = camera_mount(kTilt, kRoll).matrix;
  for (std::size_t k = 0; k < 4; ++k) {
    const double right = k == 1 || k == 2 ? 0.5 : -0.5, down = k >= 2 ? 0.5 : -0.5;
    const auto px = kMountedLens.project(
        R_BC.transpose() * (p_BG + rotation_z(heading) * Eigen::Vector3d{0.0, right, down}));
    quad[k] = px.value() + noise_px * Eigen::Vector2d{normal(rng), normal(rng)};
  }
  return quad;
}

std::vector<Quad> pictures(double distance, double noise_px, Rng& rng) {
  std::vector<Quad> gates;
  for (int i = 0; i < 12; ++i)
    gates.push_back(
        seen({distance * rng.uniform(0.9, 1.1), rng.uniform(-0.4, 0.4), rng.uniform(-0.2, 0.2)},
             rng.uniform(-0.5, 0.5), noise_px, rng));
  return gates;
}

TEST(MountFromLevel, ExactCornersGiveTheExactMount) {
  Rng rng{1};
  const Mount mount = mount_from_level(pictures(1.6, 0.0, rng), kMountedLens, 1.0);
  EXPECT_NEAR(mount.tilt_down, kTilt, 1e-6);
  EXPECT_NEAR(mount.roll, kRoll, 1e-6);
  EXPECT_LT(mount.rms_px, 1e-6);
}

TEST(MountFromLevel, TheAnswerIsWithinItsStandardDeviation) {
  for_all(20, [](Rng& rng) {
    const Mount mount = mount_from_level(pictures(1.6, 1.0, rng), kMountedLens, 1.0);
    EXPECT_LT(std::abs(mount.tilt_down - kTilt), 3.0 * mount.tilt_sigma);
    EXPECT_LT(std::abs(mount.roll - kRoll), 3.0 * mount.roll_sigma);
    EXPECT_LE(mount.tilt_sigma, 3.0 * kDegree);
  });
}

TEST(MountFromLevel, AFarGateIsRefusedUnlessItsHeightIsGiven) {
  Rng rng{1};
  std::vector<Quad> gates;
  for (int i = 0; i < 5; ++i) gates.push_back(seen({5.0, 0.1 * i, -1.2}, 0.0, 0.5, rng));
  EXPECT_NE(
      error_of([&] { (void)mount_from_level(gates, kMountedLens, 1.0); }).find("--gate-height-m"),
      std::string::npos);
  const Mount mount = mount_from_level(gates, kMountedLens, 1.0, 1.2);
  EXPECT_LT(std::abs(mount.tilt_down - kTilt), 3.0 * mount.tilt_sigma);
}

TEST(MountFromLevel, TooFewPicturesAreRefused) {
  Rng rng{1};
  EXPECT_NE(error_of([&] {
              (void)mount_from_level(std::vector{seen({2, 0, 0}, 0, 0, rng)}, kMountedLens, 1.0);
            }).find("at least 3"),
            std::string::npos);
}

/// A flight past a gate: the log's heading is off, its pictures are late.
TEST(MountFromFlight, TiltHeadingTimeAndGateComeBack) {
  Rng rng{1};
  constexpr double kHeading = 8.0 * kDegree, kLate = 0.020;
  const Eigen::Vector3d p_EG{5.0, 0.5, -1.4}, p_BC{0.1, 0.0, 0.0};
  const auto position = [](double t) {
    return Eigen::Vector3d{1.2 * t, 0.3 * std::sin(2.0 * t), t < 0.01 ? 0.0 : -1.3};
  };
  const auto attitude = [](double t) {
    return Attitude{0.15 * std::sin(3.0 * t), -0.08 + 0.1 * std::cos(4.0 * t), 0.05 * std::sin(t)};
  };
  flight_log::FlightFolder flight;
  files::Labels labels;
  for (int i = 0; i <= 3000; ++i) {
    flight_log::FlightSample sample;
    sample.time = std::chrono::milliseconds{i};
    sample.true_p_EB = position(1e-3 * i);
    sample.ahrs = attitude(1e-3 * i);
    sample.ahrs->yaw -= kHeading;
    flight.samples.push_back(sample);
  }
  for (int i = 0; i < 20; ++i) {
    const double taken = 0.1 + 0.12 * i;
    const std::string name = "img_" + std::to_string(i) + ".jpg";
    flight.images.push_back(
        {name, std::chrono::milliseconds{std::llround(1e3 * (taken + kLate))}, 0});
    const Eigen::Matrix3d R_EC =
        rotation_EB(attitude(taken)).matrix * camera_mount(kTilt, kRoll).matrix;
    const Eigen::Vector3d p_EC = position(taken) + rotation_EB(attitude(taken)).matrix * p_BC;
    Quad quad;
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector3d corner{0.0, k == 1 || k == 2 ? 0.5 : -0.5, k >= 2 ? 0.5 : -0.5};
      quad[k] = kMountedLens.project(R_EC.transpose() * (p_EG + corner - p_EC)).value() +
                0.5 * Eigen::Vector2d{normal(rng), normal(rng)};
    }
    labels.pictures.push_back(
        {.image = name, .gates = {quad}, .true_distance = 0.0, .first_identical = ""});
  }
  const Mount mount = mount_from_flight(flight, labels, kMountedLens, 1.0, p_BC);
  EXPECT_EQ(mount.pictures, 20U);
  EXPECT_LT(std::abs(mount.tilt_down - kTilt), 3.0 * mount.tilt_sigma + 0.1 * kDegree);
  EXPECT_LT(mount.tilt_sigma, 1.0 * kDegree);
  EXPECT_NEAR(mount.heading_offset, kHeading, 1.0 * kDegree);
  EXPECT_NEAR(mount.time_offset, -kLate, 0.0051);
  EXPECT_LT((mount.p_EG - p_EG).norm(), 0.05);
  labels.pictures.clear();
  EXPECT_NE(error_of([&] {
              (void)mount_from_flight(flight, labels, kMountedLens, 1.0, p_BC);
            }).find("at least 3"),
            std::string::npos);
}

}  // namespace
}  // namespace gatefly::calibration
