// SPDX-License-Identifier: Apache-2.0
#include "gatefly/pose/map_pose.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/pose/reprojection.hpp"

#include "support/allocation_counter.hpp"
#include "support/central_difference.hpp"
#include "support/draw_gate.hpp"
#include "support/for_all.hpp"
#include "support/generators.hpp"
#include "support/matchers.hpp"
#include "support/views_of_a_gate.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

GateObservations corners_seen(const Quad& px, double sigma_px, double side = 1.0) {
  GateObservations seen;
  EXPECT_TRUE(add_corners(seen, px, side, sigma_px));
  return seen;
}

PosePrior prior_of(const Attitude& attitude, double sigma) {
  return {.attitude_GB = attitude, .roll_sigma = sigma, .pitch_sigma = sigma, .yaw_sigma = sigma};
}

Attitude off_by(const Attitude& attitude, double sigma, Rng& rng) {
  const double roll = attitude.roll + sigma * normal(rng),
               pitch = attitude.pitch + sigma * normal(rng);
  return {roll, pitch, attitude.yaw + sigma * normal(rng)};
}

// A point of a bar: somewhere along one of the four, drawn where it is, handed over as "on that
// bar".
void add_bar_point(GateObservations& seen, int bar, double along, const View& view,
                   const CameraRig& rig, double sigma_px) {
  const bool upright = bar % 2 == 0;
  const double across = bar < 2 ? -0.5 : 0.5;
  const Vector3d point = upright ? Vector3d{0, across, along} : Vector3d{0, along, across};
  if (const auto px = pixel_of(point, view, rig))
    seen.push_back({.px = *px,
                    .sigma_px = sigma_px,
                    .point_G = upright ? Vector3d{0, across, 0} : Vector3d{0, 0, across},
                    .along_G = upright ? Vector3d::UnitZ() : Vector3d::UnitY()});
}

// Pixels to 0.001 px and attitude to 1 mrad: the size prior then moves nothing.
TEST(MapPose, AnySubsetOfExactCornersGivesTheExactPose) {
  const CameraRig rig = bebop_rig();
  for_all(300, [&](Rng& rng) {
    const View view = any_view(rng);
    const auto corners = corners_of(1.0, view, rig);
    if (!corners) return not_a_case();
    const GateObservations all = corners_seen(*corners, 1e-3);
    for (unsigned subset = 1; subset < 16; ++subset) {
      GateObservations seen;
      for (std::size_t i = 0; i < 4; ++i)
        if (subset >> i & 1u) seen.push_back(all[i]);
      const auto answer = map_pose(seen, prior_of(view.attitude_GB, 1e-3), rig);
      if (seen.size() < 2) {
        EXPECT_EQ(answer.reason, NoPose::kTooFew);
        continue;
      }
      ASSERT_TRUE(answer.pose) << text_of(answer.reason);
      EXPECT_THAT(answer.pose->p_GB, IsNear(view.p_GB, 1e-4)) << subset;
      EXPECT_THAT(answer.pose->covariance, IsCovariance());
      EXPECT_EQ(answer.pose->dof, 2 * static_cast<int>(seen.size()) - 3);
      EXPECT_NEAR(answer.pose->chi2, 0.0, 1e-6);
      EXPECT_EQ(answer.pose->dropped, 0u);
    }
  });
}

// The attitude is off by 20° about each axis, or not known at all: four exact corners correct it.
TEST(MapPose, ExactCornersCorrectAPoorAttitude) {
  const CameraRig rig = bebop_rig();
  for (const double sigma : {0.3, kInfinite})
    for_all(200, [&](Rng& rng) {
      const View view = any_view(rng);
      const auto corners = corners_of(1.0, view, rig);
      if (!corners) return not_a_case();
      Attitude assumed = view.attitude_GB;
      assumed.roll += rng.uniform(-0.35, 0.35), assumed.pitch += rng.uniform(-0.35, 0.35),
          assumed.yaw += rng.uniform(-0.35, 0.35);
      const auto answer = map_pose(corners_seen(*corners, 1e-3), prior_of(assumed, sigma), rig);
      ASSERT_TRUE(answer.pose) << text_of(answer.reason);
      EXPECT_THAT(answer.pose->p_GB, IsNear(view.p_GB, 2e-3));
      EXPECT_NEAR(answer.pose->attitude_GB.yaw, view.attitude_GB.yaw, 2e-3);
      EXPECT_NEAR(answer.pose->attitude_GB.pitch, view.attitude_GB.pitch, 2e-3);
      EXPECT_NEAR(answer.pose->attitude_GB.roll, view.attitude_GB.roll, 2e-3);
    });
}

TEST(MapPose, PointsOnBarsGiveTheExactPose) {
  const CameraRig rig = bebop_rig();
  for_all(200, [&](Rng& rng) {
    const View view = any_view(rng);
    GateObservations seen;
    for (int bar = 0; bar < 4; ++bar)
      for (int i = 0; i < 3; ++i) add_bar_point(seen, bar, rng.uniform(-0.5, 0.5), view, rig, 1e-3);
    if (seen.size() < 12) return not_a_case();
    const auto answer = map_pose(seen, prior_of(view.attitude_GB, 1e-3), rig);
    ASSERT_TRUE(answer.pose) << text_of(answer.reason);
    EXPECT_THAT(answer.pose->p_GB, IsNear(view.p_GB, 1e-4));
    EXPECT_EQ(answer.pose->dof, 12 - 3);
  });
}

TEST(MapPose, TwoBarsAndAHeightAgreeWithThePapersSolution) {
  const CameraRig rig = bebop_rig();
  for_all(200, [&](Rng& rng) {
    const View view{{rng.uniform(-1.7, -0.6), rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3)},
                    {rng.uniform(-0.3, 0.3), rng.uniform(-0.2, 0.1), rng.uniform(-0.3, 0.3)}};
    const auto left = pixel_of({0, -0.475, rng.uniform(-0.3, 0.3)}, view, rig);
    const auto right = pixel_of({0, 0.475, rng.uniform(-0.3, 0.3)}, view, rig);
    if (!left || !right) return not_a_case();
    const auto paper =
        fix_from_bars({*left, *right}, {rotation_EB(view.attitude_GB).matrix}, 0.95, rig, {});
    if (!paper) return not_a_case();
    GateObservations seen;
    EXPECT_TRUE(add_bars(seen, {*left, *right}, 0.95, 1e-3));
    PosePrior prior = prior_of(view.attitude_GB, 1e-3);
    EXPECT_EQ(map_pose(seen, prior, rig).reason, NoPose::kTooFew) << "no height";
    prior.z = view.p_GB.z(), prior.z_sigma = 1e-3;
    const auto answer = map_pose(seen, prior, rig);
    ASSERT_TRUE(answer.pose) << text_of(answer.reason);
    EXPECT_THAT(answer.pose->p_GB.head<2>(), IsNear(paper->p_GB.head<2>(), 1e-4));
  });
}

TEST(MapPose, AMirroredViewGivesTheMirroredPose) {
  const CameraRig rig = bebop_rig();
  for_all(200, [&](Rng& rng) {
    const View view = any_view(rng);
    const auto corners = corners_of(1.0, view, rig);
    if (!corners) return not_a_case();
    const Quad seen = noisy(*corners, 1.5, rng);
    const auto mirror = [](const Vector2d& p) { return Vector2d{2 * 157 - p.x(), p.y()}; };
    const Quad mirrored{{mirror(seen[1]), mirror(seen[0]), mirror(seen[3]), mirror(seen[2])}};
    Attitude attitude = off_by(view.attitude_GB, 0.03, rng);
    const auto a = map_pose(corners_seen(seen, 1.5), prior_of(attitude, 0.03), rig);
    attitude.roll *= -1, attitude.yaw *= -1;
    const auto b = map_pose(corners_seen(mirrored, 1.5), prior_of(attitude, 0.03), rig);
    ASSERT_EQ(a.reason, b.reason);
    if (!a.pose) return not_a_case();
    EXPECT_THAT(b.pose->p_GB,
                IsNear(Vector3d{a.pose->p_GB.x(), -a.pose->p_GB.y(), a.pose->p_GB.z()}, 1e-3));
    EXPECT_NEAR(b.pose->chi2, a.pose->chi2, 1e-4);
  });
}

// A gate twice as large, twice as far off: the same picture, every length doubled.
TEST(MapPose, ScalesWithTheGate) {
  CameraRig rig = bebop_rig();
  rig.p_BC.setZero();
  for_all(200, [&](Rng& rng) {
    View view = any_view(rng);
    view.p_GB *= 0.6;  // doubled it must stay within reach
    const auto corners = corners_of(1.0, view, rig);
    if (!corners) return not_a_case();
    const Quad seen = noisy(*corners, 1.5, rng);
    const PosePrior prior = prior_of(off_by(view.attitude_GB, 0.03, rng), 0.03);
    const auto one = map_pose(corners_seen(seen, 1.5, 1.0), prior, rig),
               two = map_pose(corners_seen(seen, 1.5, 2.0), prior, rig);
    ASSERT_EQ(one.reason, two.reason);
    if (!one.pose) return not_a_case();
    EXPECT_THAT(two.pose->p_GB, IsNear(2.0 * one.pose->p_GB, 1e-3));
    EXPECT_NEAR(two.pose->covariance(0, 0) / one.pose->covariance(0, 0), 4.0, 0.02);
  });
}

TEST(MapPose, TheOrderOfWhatIsSeenDoesNotMatter) {
  const CameraRig rig = bebop_rig();
  const View view{{-2.5, 0.4, 0.1}, {0.1, -0.1, -0.1}};
  Rng rng{3};
  GateObservations seen = corners_seen(noisy(*corners_of(1.0, view, rig), 2.0, rng), 2.0);
  add_bar_point(seen, 0, 0.2, view, rig, 2.0);
  add_bar_point(seen, 3, -0.1, view, rig, 2.0);
  GateObservations turned_list;
  for (std::size_t i = 0; i < seen.size(); ++i) turned_list.push_back(seen[(i + 3) % seen.size()]);
  const auto a = map_pose(seen, prior_of(view.attitude_GB, 0.03), rig),
             b = map_pose(turned_list, prior_of(view.attitude_GB, 0.03), rig);
  ASSERT_TRUE(a.pose && b.pose);
  EXPECT_THAT(b.pose->p_GB, IsNear(a.pose->p_GB, 1e-6));
  EXPECT_NEAR(b.pose->chi2, a.pose->chi2, 1e-6);
}

TEST(Reprojection, GradientIsTheCentralDifferenceOfTheCost) {
  const CameraRig rig = bebop_rig();
  for_all(50, [&](Rng& rng) {
    const View view = any_view(rng);
    const auto corners = corners_of(1.0, view, rig);
    if (!corners) return not_a_case();
    GateObservations seen = corners_seen(noisy(*corners, 1.0, rng), 1.0);
    PosePrior prior = prior_of(off_by(view.attitude_GB, 0.1, rng), 0.1);
    prior.z = 0.3, prior.z_sigma = 0.2;
    const auto sights = reprojection::sights_of(seen, rig);
    ASSERT_TRUE(sights);
    const auto at = [](const Eigen::Matrix<double, 6, 1>& x) {
      return reprojection::Pose{x.head<3>(), x.tail<3>()};
    };
    const auto cost = [&](const Eigen::Matrix<double, 6, 1>& x) {
      return Eigen::Matrix<double, 1, 1>{
          reprojection::normal_at(at(x), *sights, 15u, prior, rig)->cost};
    };
    Eigen::Matrix<double, 6, 1> x;
    const Attitude& a = view.attitude_GB;
    x << rotation_EB(a).matrix.transpose() * view.p_GB, a.roll, a.pitch, a.yaw;
    const auto normal = reprojection::normal_at(at(x), *sights, 15u, prior, rig);
    ASSERT_TRUE(normal);
    Eigen::Matrix<double, 6, 1> gradient;
    gradient << normal->a, normal->c;
    EXPECT_THAT(2.0 * gradient, IsNear(central_difference(cost, x).transpose().eval(),
                                       1e-3 * (1.0 + gradient.norm())));
  });
}

struct NoiseCase {
  View view;
  double attitude_deg, px;
};
class Noise : public ::testing::TestWithParam<NoiseCase> {};

// 1000 trials, seed 17: the mean of NEES/3 has a standard error of 0.026.
TEST_P(Noise, CovarianceIsConsistent) {
  const auto [view, attitude_deg, px] = GetParam();
  const CameraRig rig = bebop_rig();
  const double sigma = attitude_deg * kDegree;
  Rng rng{17};
  double nees = 0, chi2_per_dof = 0;
  int n = 0;
  for (int i = 0; i < 1000; ++i) {
    const Quad seen = noisy(*corners_of(1.0, view, rig), px, rng);
    const auto answer = map_pose(corners_seen(seen, px),
                                 prior_of(off_by(view.attitude_GB, sigma, rng), sigma), rig);
    if (!answer.pose) continue;
    const Vector3d error = answer.pose->p_GB - view.p_GB;
    const Eigen::Matrix3d P = answer.pose->covariance.topLeftCorner<3, 3>();
    ++n, nees += error.dot(P.inverse() * error) / 3.0,
        chi2_per_dof += answer.pose->chi2 / answer.pose->dof;
  }
  ASSERT_GT(n, 990);
  EXPECT_GT(nees / n, 0.8);
  EXPECT_LT(nees / n, 1.25);
  EXPECT_NEAR(chi2_per_dof / n, 1.0, 0.15);
}
INSTANTIATE_TEST_SUITE_P(
    Slice, Noise,
    ::testing::Values(NoiseCase{{{-1.5, 0.1, 0}, {0, -0.08, 0}}, 0.0, 2.5},
                      NoiseCase{{{-1.5, 0.1, 0}, {0, -0.08, 0}}, 5.0, 3.5},
                      NoiseCase{{{-3, 0.5, 0.2}, {0.1, -0.08, -0.1}}, 2.0, 2.5},
                      NoiseCase{{{-3, 1.5, 0.2}, {0.0, -0.08, -0.4}}, 5.0, 1.0},
                      NoiseCase{{{-5, 0, 0}, {0, -0.08, 0}}, 5.0, 3.5}));

// 300 trials, seed 23: one corner is 15-40 px off, the others 1.5 px.
TEST(MapPose, SurvivesOneGrossOutlier) {
  const CameraRig rig = bebop_rig();
  const View view{{-2, 0.3, 0.1}, {0.1, -0.08, -0.1}};
  Rng rng{23};
  double ours = 0, without = 0, rays = 0;
  int found = 0, n = 0;
  for (int i = 0; i < 300; ++i) {
    Quad px = noisy(*corners_of(1.0, view, rig), 1.5, rng);
    const int bad = rng.uniform_index(4);
    const double angle = rng.uniform(-kPi, kPi), size = rng.uniform(15, 40);
    px[static_cast<std::size_t>(bad)] += size * Vector2d{gatefly::cos(angle), gatefly::sin(angle)};
    const GateObservations seen = corners_seen(px, 1.5);
    GateObservations good;
    for (std::size_t k = 0; k < 4; ++k)
      if (static_cast<int>(k) != bad) good.push_back(seen[k]);
    const PosePrior prior = prior_of(off_by(view.attitude_GB, 0.02, rng), 0.02);
    const auto answer = map_pose(seen, prior, rig), oracle = map_pose(good, prior, rig);
    PoseParams careless;
    careless.max_misfit = 1e9;
    const auto fix =
        fix_from_corners(px, {rotation_EB(prior.attitude_GB).matrix}, 1.0, rig, careless);
    if (!answer.pose || !oracle.pose || !fix) continue;
    ++n, found += answer.pose->dropped == 1u << bad;
    ours += (answer.pose->p_GB - view.p_GB).squaredNorm(),
        without += (oracle.pose->p_GB - view.p_GB).squaredNorm();
    rays += (fix->p_GB - view.p_GB).squaredNorm();
  }
  ASSERT_GT(n, 285);
  EXPECT_GT(found, 0.9 * n);
  EXPECT_LT(std::sqrt(ours / without), 1.2);
  EXPECT_GT(std::sqrt(rays / without), 2.0) << "it must have mattered";
}

// 1 m before the gate with an attitude to 5° any three of four corners fit well, each with another
// position. To an attitude prior of 15°, a corner that is far off may look like a turn:
// better no answer than a wrong one with a small covariance.
TEST(MapPose, IsRarelySureOfAPoseThatAnOutlierMade) {
  const CameraRig rig = bebop_rig();
  const double yaw = -30.0 * kDegree;
  const View view{rotation_z(yaw) * Vector3d{-3, 0, 0}, {0, 0, yaw}};
  Rng rng{7};
  int answers = 0, wrong = 0;
  for (int i = 0; i < 400; ++i) {
    Quad px = noisy(*corners_of(1.0, view, rig), 1.0, rng);
    const double angle = rng.uniform(-kPi, kPi), size = rng.uniform(10, 40);
    px[static_cast<std::size_t>(rng.uniform_index(4))] +=
        size * Vector2d{gatefly::cos(angle), gatefly::sin(angle)};
    const auto answer =
        map_pose(corners_seen(px, 1.0),
                 prior_of(off_by(view.attitude_GB, 15 * kDegree, rng), 15 * kDegree), rig);
    if (!answer.pose) continue;
    const Vector3d error = answer.pose->p_GB - view.p_GB;
    ++answers,
        wrong += error.dot(answer.pose->covariance.topLeftCorner<3, 3>().inverse() * error) > 25.0;
  }
  EXPECT_GT(answers, 80);
  EXPECT_LT(wrong, 0.05 * answers);
}

TEST(MapPose, RefusesWhenWhatIsLeftOutDecidesWhereTheGateIs) {
  const CameraRig rig = bebop_rig();
  const View view{{-1.1, 0, 0.1}, {0, -0.08, 0}};
  Rng rng{29};
  int ambiguous = 0, right = 0, wrong = 0;
  for (int i = 0; i < 300; ++i) {
    Quad px = noisy(*corners_of(1.0, view, rig), 1.0, rng);
    const double angle = rng.uniform(-kPi, kPi);
    px[static_cast<std::size_t>(rng.uniform_index(4))] +=
        15.0 * Vector2d{gatefly::cos(angle), gatefly::sin(angle)};
    const auto answer =
        map_pose(corners_seen(px, 1.0), prior_of(off_by(view.attitude_GB, 0.087, rng), 0.087), rig);
    ambiguous += answer.reason == NoPose::kAmbiguous;
    if (answer.pose) ++((answer.pose->p_GB - view.p_GB).norm() < 0.15 ? right : wrong);
  }
  EXPECT_GT(ambiguous, 30);
  EXPECT_GT(right, 10 * wrong);
}

TEST(MapPose, RefusesAFrameMadeOfTheBarsOfTwoGates) {
  const CameraRig rig = bebop_rig();
  Rng rng{5};
  const View view{{-3, 0, 0.1}, {0, -0.08, 0}}, farther{{-6, 0, 0.1}, {0, -0.08, 0}};
  int refused = 0;
  for (int i = 0; i < 100; ++i) {
    const Quad near = noisy(*corners_of(1.0, view, rig), 1.5, rng),
               far = noisy(*corners_of(1.0, farther, rig), 1.5, rng);
    const PosePrior prior = prior_of(view.attitude_GB, 0.04);
    const Quad left_right{{near[0], far[1], far[2], near[3]}};
    const auto answer = map_pose(corners_seen(left_right, 1.5), prior, rig);
    refused += !answer.pose && answer.reason == NoPose::kMisfit;
    ASSERT_TRUE(map_pose(corners_seen(near, 1.5), prior, rig).pose) << "the near gate itself";
    ASSERT_TRUE(map_pose(corners_seen(far, 1.5), prior, rig).pose) << "the far gate itself";
  }
  EXPECT_GE(refused, 98);
}

TEST(MapPose, SaysWhyThereIsNone) {
  const CameraRig rig = bebop_rig();
  const View view{{-3, 0, 0.1}, {0, -0.08, 0}};
  const Quad px = *corners_of(1.0, view, rig);
  const PosePrior prior = prior_of(view.attitude_GB, 0.02);
  const auto reason = [&](const Quad& quad) {
    return map_pose(corners_seen(quad, 2.0), prior, rig).reason;
  };
  EXPECT_EQ(reason(px), NoPose::kNone);
  EXPECT_EQ(map_pose({}, prior, rig).reason, NoPose::kTooFew);
  EXPECT_EQ(reason({{px[0], px[1], px[2], {kNan, 3}}}), NoPose::kNotANumber);
  EXPECT_EQ(reason({{px[0], {5000, 5000}, px[2], px[3]}}), NoPose::kOutsideLens);
  EXPECT_EQ(reason({{px[2], px[3], px[0], px[1]}}), NoPose::kBehind) << "upside down";
  EXPECT_NE(reason({{px[1], px[0], px[3], px[2]}}), NoPose::kNone) << "mirrored";
  EXPECT_EQ(reason({{px[0], px[1] + Vector2d{40, 0}, px[2] + Vector2d{40, 0}, px[3]}}),
            NoPose::kMisfit)
      << "too wide";
  const View distant{{-14, 0, 0.1}, {0, -0.08, 0}};
  EXPECT_EQ(map_pose(corners_seen(*corners_of(1.0, distant, rig), 0.1), prior, rig).reason,
            NoPose::kTooFar);
  const View sideways{{-0.3, 3, 0.1}, {0, -0.08, -1.4}};
  EXPECT_EQ(map_pose(corners_seen(*corners_of(1.0, sideways, rig), 0.5),
                     prior_of(sideways.attitude_GB, 0.02), rig)
                .reason,
            NoPose::kEdgeOn);
  for (const NoPose each : {NoPose::kNone, NoPose::kMisfit}) EXPECT_NE(text_of(each), nullptr);
}

// Any number of any field may be anything: an answer is finite, or there is none.
TEST(MapPose, StaysFiniteWhateverComesIn) {
  const CameraRig rig = bebop_rig();
  const std::array<double, 9> poison{kNan,   kInfinite, -kInfinite, 0.0, -1.0,
                                     1e-300, 1e300,     1e-8,       1e8};
  for_all(3000, [&](Rng& rng) {
    const View view = any_view(rng);
    const auto corners = corners_of(1.0, view, rig);
    if (!corners) return not_a_case();
    GateObservations seen = corners_seen(*corners, 2.0);
    add_bar_point(seen, 0, 0.1, view, rig, 2.0);
    PosePrior prior = prior_of(view.attitude_GB, rng.uniform(0, 0.5));
    for (int i = 0; i < 2; ++i) {
      const double bad = poison[static_cast<std::size_t>(rng.uniform_index(9))];
      GateObservation& one = seen[static_cast<std::size_t>(rng.uniform_index(5))];
      const std::array<double*, 15> fields{&one.px.x(),
                                           &one.px.y(),
                                           &one.sigma_px,
                                           &one.point_G.x(),
                                           &one.point_G.y(),
                                           &one.point_G.z(),
                                           &one.along_G.x(),
                                           &one.along_G.z(),
                                           &prior.attitude_GB.roll,
                                           &prior.attitude_GB.pitch,
                                           &prior.attitude_GB.yaw,
                                           &prior.roll_sigma,
                                           &prior.yaw_sigma,
                                           &prior.z,
                                           &prior.z_sigma};
      *fields[static_cast<std::size_t>(rng.uniform_index(15))] = bad;
    }
    const auto answer = map_pose(seen, prior, rig);
    EXPECT_EQ(answer.pose.has_value(), answer.reason == NoPose::kNone);
    if (!answer.pose) return;
    EXPECT_TRUE(answer.pose->p_GB.allFinite());
    EXPECT_TRUE(answer.pose->covariance.allFinite());
    EXPECT_TRUE(std::isfinite(answer.pose->chi2) && std::isfinite(answer.pose->attitude_GB.yaw));
  });
}

TEST(MapPose, AllocatesNothing) {
  const CameraRig rig = bebop_rig();
  const View view{{-2, 0.3, 0.1}, {0.1, -0.08, -0.1}};
  Quad px = *corners_of(1.0, view, rig);
  {
    const NothingAllocated guard;
    for (const double sigma : {0.02, 0.3})
      (void)map_pose(corners_seen(px, 2.0), prior_of(view.attitude_GB, sigma), rig);
    px[2].x() += 30.0;  // with an outlier to look for
    for (const double sigma : {0.02, 0.3})
      (void)map_pose(corners_seen(px, 2.0), prior_of(view.attitude_GB, sigma), rig);
  }
  test::expect_that_allocations_are_counted();
}

TEST(MapPose, AFullListTakesNoMore) {
  GateObservations seen;
  const Quad px{{{1, 1}, {2, 1}, {2, 2}, {1, 2}}};
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(add_corners(seen, px, 1.0, 1.0));
  EXPECT_FALSE(add_corners(seen, px, 1.0, 1.0));
  EXPECT_FALSE(add_bars(seen, {px[0], px[1]}, 1.0, 1.0));
  EXPECT_EQ(seen.size(), GateObservations::kCapacity);
}

// Published quantiles of the chi-square distribution: 97.725 % is two standard deviations of the
// normal one.
TEST(NormalDeviate, IsTheNormalDeviateOfTheChiSquare) {
  EXPECT_NEAR(normal_deviate(0.455, 1), 0.0, 0.05);  // medians
  EXPECT_NEAR(normal_deviate(4.351, 5), 0.0, 0.01);
  EXPECT_NEAR(normal_deviate(11.070, 5), 1.645, 0.02);  // 95 %
  EXPECT_NEAR(normal_deviate(20.515, 5), 3.09, 0.04);   // 99.9 %
}

}  // namespace
}  // namespace gatefly
