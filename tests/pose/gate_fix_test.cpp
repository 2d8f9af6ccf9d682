// SPDX-License-Identifier: Apache-2.0
#include "gatefly/pose/gate_fix.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/pose/ray_intersection.hpp"

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

RotationGB R_of(const View& view) { return {rotation_EB(view.attitude_GB).matrix}; }

TEST(FixFromCorners, IsExactForExactCornersAndAttitude) {
  const CameraRig rig = bebop_rig();
  for_all(200, [&](Rng& rng) {
    const View view = any_view(rng);
    const double side = rng.uniform(0.8, 1.5);
    const auto corners = corners_of(side, view, rig);
    if (!corners) return not_a_case();
    const auto fix = fix_from_corners(*corners, R_of(view), side, rig, {});
    ASSERT_TRUE(fix);
    EXPECT_TRUE(fix->has_height);
    EXPECT_THAT(fix->p_GB, IsNear(view.p_GB, 1e-6));
    EXPECT_THAT(fix->covariance, IsCovariance());
    EXPECT_NEAR(fix->yaw_error.value_or(0.0), 0.0, 1e-5);
  });
}

TEST(FixFromCorners, AMirroredViewGivesTheMirroredFix) {
  CameraRig rig = bebop_rig();  // symmetric about its own axis
  for_all(200, [&](Rng& rng) {
    const View view = any_view(rng);
    const auto corners = corners_of(1.0, view, rig);
    if (!corners) return not_a_case();
    const Quad seen = noisy(*corners, 1.0, rng);
    const double cx = 157;
    const auto mirror = [&](const Vector2d& p) { return Vector2d{2 * cx - p.x(), p.y()}; };
    const Quad mirrored{{mirror(seen[1]), mirror(seen[0]), mirror(seen[3]), mirror(seen[2])}};
    View other = view;
    other.attitude_GB.roll *= -1, other.attitude_GB.yaw *= -1;
    const auto a = fix_from_corners(seen, R_of(view), 1.0, rig, {}),
               b = fix_from_corners(mirrored, R_of(other), 1.0, rig, {});
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) return not_a_case();
    EXPECT_THAT(b->p_GB, IsNear(Vector3d{a->p_GB.x(), -a->p_GB.y(), a->p_GB.z()}, 1e-8));
    ASSERT_EQ(a->yaw_error.has_value(), b->yaw_error.has_value());
    EXPECT_NEAR(b->yaw_error.value_or(0.0), -a->yaw_error.value_or(0.0), 1e-8);
  });
}

// The yaw the filter assumed is off by `error`; the corners say so, with the sign that corrects it.
TEST(FixFromCorners, YawErrorIsWhatHasToBeAdded) {
  const CameraRig rig = bebop_rig();
  PoseParams params;
  params.max_misfit = 1e6;  // the question is the yaw, not the gate's
  for (const double error : {-0.10, -0.04, 0.04, 0.10})
    for (const double y : {-0.8, 0.0, 0.8}) {
      const View view{{-2.5, y, 0.1}, {0.05, -0.08, -0.2 * y}};
      const auto corners = corners_of(1.0, view, rig);
      ASSERT_TRUE(corners);
      View assumed = view;
      assumed.attitude_GB.yaw -= error;
      const auto fix = fix_from_corners(*corners, R_of(assumed), 1.0, rig, params);
      ASSERT_TRUE(fix && fix->yaw_error);
      EXPECT_NEAR(*fix->yaw_error, error, 0.002) << "y " << y;
    }
}

// The prior has been taken out of it: the whole error, although heading and corners were weighed
// against each other.
TEST(MapFixFromCorners, YawErrorIsWhatHasToBeAdded) {
  const CameraRig rig = bebop_rig();
  for (const double error : {-0.05, 0.05})
    for (const double y : {-0.8, 0.0, 0.8}) {
      const View view{{-2.5, y, 0.1}, {0.05, -0.08, -0.2 * y}};
      View assumed = view;
      assumed.attitude_GB.yaw -= error;
      const auto fix = map_fix_from_corners(*corners_of(1.0, view, rig), R_of(assumed), 1.0, rig,
                                            {.heading_sigma = 0.07});
      ASSERT_TRUE(fix && fix->yaw_error);
      EXPECT_NEAR(*fix->yaw_error, error, 0.2 * std::abs(error)) << "y " << y;
    }
}

// Gates in a row: the lower bar and a side of the near one with the other side of one 3 m behind
// it.
TEST(MapFixFromCorners, AFrameOfTwoGatesIsNoGate) {
  const CameraRig rig = bebop_rig();
  const View view{{-2.5, 0.1, 0.0}, {0.0, -0.05, 0.0}}, behind{{-5.5, 0.1, 0.0}, {0.0, -0.05, 0.0}};
  Quad mixed = *corners_of(1.0, view, rig);
  ASSERT_TRUE(map_fix_from_corners(mixed, R_of(view), 1.0, rig, {}));
  const Quad far = *corners_of(1.0, behind, rig);
  mixed[0] = far[0], mixed[3] = {far[3].x(), mixed[3].y()};
  EXPECT_FALSE(map_fix_from_corners(mixed, R_of(view), 1.0, rig, {}));
}

// 2000 trials, seed 11, 2.5 px: mean within 4 standard errors of 0, variance as reported within 15
// %.
TEST(FixFromCorners, YawErrorIsUnbiasedAndAsUncertainAsItSays) {
  const CameraRig rig = bebop_rig();
  const View view{{-2.5, 0.5, 0.1}, {0, -0.08, -0.1}};
  const Quad truth = *corners_of(1.0, view, rig);
  PoseParams params;
  params.max_misfit = 1e6;
  Rng rng{11};
  double sum = 0, squares = 0, reported = 0;
  int n = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto fix = fix_from_corners(noisy(truth, 2.5, rng), R_of(view), 1.0, rig, params);
    if (!fix || !fix->yaw_error) continue;
    ++n, sum += *fix->yaw_error, squares += *fix->yaw_error * *fix->yaw_error,
        reported += fix->yaw_variance;
  }
  ASSERT_GT(n, 1900);
  const double mean = sum / n, variance = squares / n - mean * mean;
  EXPECT_NEAR(mean, 0, 4 * std::sqrt(variance / n));
  EXPECT_NEAR(variance / (reported / n), 1.0, 0.15)
      << "measured " << std::sqrt(variance) << " reported " << std::sqrt(reported / n);
}

// 2000 trials, seed 21, 3 m, 2.5 px on each coordinate, attitude as noisy as params says. NEES has
// 3 degrees of freedom: its mean is 3 with a standard error of sqrt(6/2000) = 0.055; 10 % for the
// linearisation.
TEST(FixFromCorners, CovarianceIsConsistentAtThreeMetres) {
  const CameraRig rig = bebop_rig();
  const View view{{-3.0, 0.3, 0.1}, {0.0, -0.08, 0.05}};
  const Quad truth = *corners_of(1.0, view, rig);
  PoseParams params;
  params.max_misfit = 1e6;
  Rng rng{21};
  double nees = 0;
  Vector3d squares = Vector3d::Zero(), reported = Vector3d::Zero();
  int n = 0;
  for (int i = 0; i < 2000; ++i) {
    const Quad seen = noisy(truth, params.corner_sigma_px, rng);
    // Small rotation about the gate's axes: what "attitude_sigma" and "heading_sigma" stand for.
    const Vector3d turn{params.attitude_sigma * normal(rng), params.attitude_sigma * normal(rng),
                        params.heading_sigma * normal(rng)};
    const Eigen::Matrix3d off =
        Eigen::AngleAxisd{turn.norm(), turn.normalized()}.toRotationMatrix();
    const auto fix = fix_from_corners(seen, {off * R_of(view).matrix}, 1.0, rig, params);
    if (!fix) continue;
    ++n;
    const Vector3d error = fix->p_GB - view.p_GB;
    nees += error.dot(fix->covariance.inverse() * error);
    squares += error.cwiseAbs2();
    reported += fix->covariance.diagonal();
  }
  ASSERT_GT(n, 1950);
  EXPECT_NEAR(nees / n, 3.0, 0.3 + 4 * 0.055);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(std::sqrt(squares(axis) / reported(axis)), 1.0, 0.15)
        << "axis " << axis << ": rmse " << std::sqrt(squares(axis) / n);
}

struct TableRow {
  double distance, rmse_x, rmse_y;
};
class TruePixelNoise : public ::testing::TestWithParam<TableRow> {};

// re-simulated from the paper: "with a true 3.5 px Gaussian", least squares, f = 168, no fisheye,
// camera 20° down, head-on. 5000 trials, seed 31: an RMSE's standard error is 1 %; the table has
// two or three digits.
TEST_P(TruePixelNoise, GivesTheRecomputedTable) {
  Pinhole lens;
  const CameraRig rig{AnyCamera{lens}, camera_mount(20 * kDegree), Vector3d::Zero()};
  const View view{{-GetParam().distance, 0, 0}, {}};
  const Quad truth = *corners_of(1.0, view, rig);
  PoseParams params;
  params.max_misfit = 1e6;
  Rng rng{31};
  double x2 = 0, y2 = 0;
  int n = 0;
  for (int i = 0; i < 5000; ++i) {
    const auto fix = fix_from_corners(noisy(truth, 3.5, rng), R_of(view), 1.0, rig, params);
    if (!fix) continue;
    const Vector3d error = fix->p_GB - view.p_GB;
    ++n, x2 += error.x() * error.x(), y2 += error.y() * error.y();
  }
  ASSERT_GT(n, 4950);
  EXPECT_NEAR(std::sqrt(x2 / n), GetParam().rmse_x, 0.06 * GetParam().rmse_x + 0.0005);
  EXPECT_NEAR(std::sqrt(y2 / n), GetParam().rmse_y, 0.06 * GetParam().rmse_y + 0.0005);
}
INSTANTIATE_TEST_SUITE_P(Facts3, TruePixelNoise,
                         ::testing::Values(TableRow{1.87, .047, .018}, TableRow{2.87, .114, .028}));

TEST(FixFromCorners, MoreNoiseMeansMoreCovariance) {
  const CameraRig rig = bebop_rig();
  const View near{{-2, 0, 0.1}, {0, -0.08, 0}}, far{{-4, 0, 0.1}, {0, -0.08, 0}};
  PoseParams rough;
  rough.corner_sigma_px *= 2;
  const auto a = fix_from_corners(*corners_of(1, near, rig), R_of(near), 1, rig, {});
  const auto b = fix_from_corners(*corners_of(1, near, rig), R_of(near), 1, rig, rough);
  const auto c = fix_from_corners(*corners_of(1, far, rig), R_of(far), 1, rig, {});
  ASSERT_TRUE(a && b && c);
  EXPECT_GT(b->covariance(0, 0), a->covariance(0, 0));
  EXPECT_GT(c->covariance(0, 0), a->covariance(0, 0));
  EXPECT_GT(c->covariance(1, 1), a->covariance(1, 1));
}

TEST(FixFromCorners, RefusesWhatNoGateCanHaveDrawn) {
  const CameraRig rig = bebop_rig();
  const View view{{-3, 0, 0.1}, {0, -0.08, 0}};
  const Quad truth = *corners_of(1, view, rig);
  const auto fix = [&](const Quad& q) { return fix_from_corners(q, R_of(view), 1.0, rig, {}); };
  ASSERT_TRUE(fix(truth));
  EXPECT_FALSE(fix({{truth[0], truth[0], truth[0], truth[0]}})) << "a point";
  EXPECT_FALSE(fix({{truth[2], truth[3], truth[0], truth[1]}})) << "upside down";
  Quad stretched = truth;
  stretched[1].x() += 40, stretched[2].x() += 40;
  EXPECT_FALSE(fix(stretched)) << "twice as wide as high";
  Quad nan = truth;
  nan[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(fix(nan));
  Quad outside = truth;
  outside[1] = {5000, 5000};
  EXPECT_FALSE(fix(outside)) << "outside the lens";
  const View too_far{{-12, 0, 0.1}, {0, -0.08, 0}};
  EXPECT_FALSE(fix_from_corners(*corners_of(1, too_far, rig), R_of(too_far), 1.0, rig, {}));
}

TEST(FixFromLowerCorners, IsExactForExactCornersAndHasAConsistentCovariance) {
  const CameraRig rig = bebop_rig();
  for_all(200, [&](Rng& rng) {
    const View view{{rng.uniform(-3, -1.2), rng.uniform(-0.4, 0.4), rng.uniform(-0.3, 0.3)},
                    {rng.uniform(-0.3, 0.3), rng.uniform(-0.2, 0.1), rng.uniform(-0.2, 0.2)}};
    const auto corners = corners_of(1.0, view, rig);
    if (!corners) return not_a_case();
    const auto two =
        fix_from_lower_corners({(*corners)[3], (*corners)[2], 1.0}, R_of(view), 1.0, rig, {});
    const auto four = fix_from_corners(*corners, R_of(view), 1.0, rig, {});
    ASSERT_TRUE(two && four);
    EXPECT_THAT(two->p_GB, IsNear(view.p_GB, 1e-6));
    EXPECT_THAT(two->covariance, IsCovariance());
    EXPECT_GT(two->covariance.trace(), four->covariance.trace())
        << "two corners know less than four";
    EXPECT_FALSE(two->yaw_error);
  });
}

// 2000 trials, seed 41, 1.8 m; as CovarianceIsConsistentAtThreeMetres.
TEST(FixFromLowerCorners, CovarianceIsConsistent) {
  const CameraRig rig = bebop_rig();
  const View view{{-1.8, 0.2, 0.1}, {0.0, -0.08, 0.05}};
  const Quad truth = *corners_of(1.0, view, rig);
  PoseParams params;
  params.max_misfit = 1e6;
  Rng rng{41};
  double nees = 0;
  int n = 0;
  for (int i = 0; i < 2000; ++i) {
    const Quad seen = noisy(truth, params.corner_sigma_px, rng);
    const Vector3d turn{params.attitude_sigma * normal(rng), params.attitude_sigma * normal(rng),
                        params.heading_sigma * normal(rng)};
    const Eigen::Matrix3d off =
        Eigen::AngleAxisd{turn.norm(), turn.normalized()}.toRotationMatrix();
    const auto fix = fix_from_lower_corners({seen[3], seen[2], 1.0}, {off * R_of(view).matrix}, 1.0,
                                            rig, params);
    if (!fix) continue;
    ++n;
    const Vector3d error = fix->p_GB - view.p_GB;
    nees += error.dot(fix->covariance.inverse() * error);
  }
  ASSERT_GT(n, 1950);
  EXPECT_NEAR(nees / n, 3.0, 0.3 + 4 * 0.055);
}

// Bars at y = ±s/2; each seen at some height, not the same one.
TEST(FixFromBars, IsExactForExactBars) {
  const CameraRig rig = bebop_rig();
  for_all(200, [&](Rng& rng) {
    const View view{{rng.uniform(-1.7, -0.6), rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3)},
                    {rng.uniform(-0.3, 0.3), rng.uniform(-0.2, 0.1), rng.uniform(-0.3, 0.3)}};
    const double s = 0.95;
    const auto left = pixel_of({0, -s / 2, rng.uniform(-0.3, 0.3)}, view, rig);
    const auto right = pixel_of({0, s / 2, rng.uniform(-0.3, 0.3)}, view, rig);
    if (!left || !right) return not_a_case();
    const auto fix = fix_from_bars({*left, *right}, R_of(view), s, rig, {});
    const double before = -(view.p_GB + R_of(view) * rig.p_BC).x();
    if (before < 0.31 || before > 1.79) return not_a_case();
    ASSERT_TRUE(fix);
    EXPECT_FALSE(fix->has_height);
    EXPECT_NEAR(fix->p_GB.x(), view.p_GB.x(), 1e-9);
    EXPECT_NEAR(fix->p_GB.y(), view.p_GB.y(), 1e-9);
    EXPECT_EQ(fix->p_GB.z(), 0.0);
    EXPECT_THAT(fix->covariance, IsCovariance());
  });
}

TEST(FixFromBars, RefusesSwappedCoincidingAndDistantBars) {
  const CameraRig rig = bebop_rig();
  const View view{{-1.2, 0.1, 0}, {0, -0.08, 0}};
  const Vector2d left = *pixel_of({0, -.475, 0}, view, rig),
                 right = *pixel_of({0, .475, 0}, view, rig);
  ASSERT_TRUE(fix_from_bars({left, right}, R_of(view), 0.95, rig, {}));
  EXPECT_FALSE(fix_from_bars({right, left}, R_of(view), 0.95, rig, {}));
  EXPECT_FALSE(fix_from_bars({left, left}, R_of(view), 0.95, rig, {}));
  EXPECT_FALSE(fix_from_bars({left, Vector2d::Constant(std::numeric_limits<double>::quiet_NaN())},
                             R_of(view), 0.95, rig, {}));
  const View far{{-3, 0, 0}, {0, -0.08, 0}};
  EXPECT_FALSE(
      fix_from_bars({*pixel_of({0, -.475, 0}, far, rig), *pixel_of({0, .475, 0}, far, rig)},
                    R_of(far), 0.95, rig, {}));
  View turned = view;
  turned.attitude_GB.yaw = 2.0;
  EXPECT_FALSE(fix_from_bars({left, right}, R_of(turned), 0.95, rig, {})) << "looking away";
}

}  // namespace
}  // namespace gatefly
