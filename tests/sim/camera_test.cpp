// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/camera.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sensing/image.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/sim/solids.hpp"

#include "support/matchers.hpp"

namespace gatefly::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Path = std::function<BodyPose(double t)>;

const Vector3d kOrange{0.95, 0.40, 0.12}, kBlue{0.05, 0.10, 0.90}, kBluish{0.15, 0.25, 0.50},
    kGrey{0.25, 0.25, 0.25};

BodyPose pose_at(const Vector3d& p_EB, const Attitude& attitude, double t = 0.0) {
  const Quaternion q = quaternion_of(attitude);
  return {t, p_EB, {q.w, q.x, q.y, q.z}};
}

/// In the middle of the room, looking north.
const BodyPose kMiddle = pose_at({-1.5, 0, -1.5}, {});

std::vector<BodyPose> history_of(const Path& path) {
  std::vector<BodyPose> history;
  for (int i = -5; i <= 60; ++i) history.push_back(path(1e-3 * i));
  return history;
}

/// Projection by a lens: a point of the earth frame, seen from a pose.
std::optional<Vector2d> projected(const world::CameraTruth& camera, const BodyPose& pose,
                                  const Vector3d& p_E) {
  const Eigen::Matrix3d R_EB =
      rotation_EB(Quaternion{pose.q_EB(0), pose.q_EB(1), pose.q_EB(2), pose.q_EB(3)}).matrix;
  const Eigen::Matrix3d R_EC = R_EB * camera_mount(camera.tilt_down).matrix;
  return camera.lens.project(R_EC.transpose() * (p_E - pose.p_EB - R_EB * camera.p_BC));
}

/// The point that shows at a pixel, so far from the eye.
Vector3d point_at(const world::CameraTruth& camera, const BodyPose& pose, const Vector2d& px,
                  double distance) {
  const Eigen::Matrix3d R_EB =
      rotation_EB(Quaternion{pose.q_EB(0), pose.q_EB(1), pose.q_EB(2), pose.q_EB(3)}).matrix;
  const Eigen::Matrix3d R_EC = R_EB * camera_mount(camera.tilt_down).matrix;
  return pose.p_EB + R_EB * camera.p_BC + R_EC * (distance * camera.lens.bearing(px).value());
}

/// A square sheet that faces the pose.
world::Decoy sheet(const Vector3d& p_E, const BodyPose& seen_from, const Vector3d& color,
                   double side = 0.10) {
  const Vector2d along = (p_E - seen_from.p_EB).head<2>();
  return {{.center = p_E.head<2>(),
           .size = {0.002, side},
           .heading = std::atan2(along.y(), along.x()),
           .bottom = -p_E.z() - 0.5 * side,
           .top = -p_E.z() + 0.5 * side},
          color};
}

/// A world, and the same with the thing that is looked for.
struct Pair {
  world::World without, with;
};

/// Bluish sheets before larger grey ones: what is behind makes no difference, and where both share a
/// pixel, its colour is nearly the mean of theirs.
Pair with_sheets(const world::World& world, const BodyPose& pose,
                 const std::vector<Vector3d>& places) {
  Pair pair{world, {}};
  for (const Vector3d& p_E : places) {
    const Vector3d away = (p_E - pose.p_EB).normalized();
    pair.without.decoys.push_back(sheet(p_E + 0.02 * away, pose, kGrey, 0.25));
  }
  pair.with = pair.without;
  for (const Vector3d& p_E : places) pair.with.decoys.push_back(sheet(p_E, pose, kBluish));
  return pair;
}

/// A picture and its upright pixels.
struct Picture {
  std::vector<std::uint8_t> bytes;
  int stored_width, stored_height;
  [[nodiscard]] Yuv at(int u, int v) const {
    return Image{bytes.data(), PixelFormat::kUyvy, stored_width, stored_height, 90}.at(u, v);
  }
  [[nodiscard]] double mean_y() const {
    double sum = 0.0;
    for (std::size_t i = 1; i < bytes.size(); i += 2) sum += bytes[i];
    return sum / (0.5 * static_cast<double>(bytes.size()));
  }
};

enum class Chroma { kCb, kCr };

/// Excess of a chroma in one picture over another, about a point.
struct Blob {
  double weight = 0.0;
  Vector2d centre = Vector2d::Zero(), variance = Vector2d::Zero();  ///< [px], [px²]
};

Blob difference(const Picture& with, const Picture& without, Chroma chroma, const Vector2d& about,
                const Vector2d& reach) {
  const auto each = [&](auto&& visit) {
    const int u0 = static_cast<int>(std::lround(about.x() - reach.x())),
              u1 = static_cast<int>(std::lround(about.x() + reach.x())),
              // whole pairs of the stored lines, which are upright columns
        v0 = static_cast<int>(std::lround(about.y() - reach.y())) / 2 * 2,
              v1 = static_cast<int>(std::lround(about.y() + reach.y())) / 2 * 2 + 1;
    for (int u = std::max(u0, 0); u <= std::min(u1, with.stored_height - 1); ++u)
      for (int v = std::max(v0, 0); v <= std::min(v1, with.stored_width - 1); ++v) {
        const Yuv a = with.at(u, v), b = without.at(u, v);
        visit(Vector2d{u, v}, chroma == Chroma::kCr ? a.v - b.v : a.u - b.u);
      }
  };
  double most = 0.0;
  each([&](const Vector2d&, double more) { most = std::max(most, more); });
  Blob blob;
  if (most < 5.0) return blob;  // glare and rounding
  Vector2d sum2 = Vector2d::Zero();
  each([&](const Vector2d& px, double more) {
    const double weight = more > 0.05 * most ? more : 0.0;
    blob.weight += weight;
    blob.centre += weight * px;
    sum2 += weight * px.cwiseAbs2();
  });
  blob.centre /= blob.weight;
  blob.variance = sum2 / blob.weight - blob.centre.cwiseAbs2();
  return blob;
}

/// A small hall whose light is baked once for all tests. Pictures without noise unless asked for.
class CameraRendererTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    cache = std::filesystem::temp_directory_path() /
            ("gatefly-camera-test-" + std::to_string(getpid()));
  }
  static void TearDownTestSuite() {
    std::error_code ignored;
    std::filesystem::remove_all(cache, ignored);
  }

  static world::World room() {
    world::World world;
    world.room_size = {8, 8, 3.2};
    world.paint = {.width = 1.0, .blue = 1.0, .wear = 0.0};
    return world;
  }
  static world::World room_with(std::vector<world::WorldGate> gates) {
    world::World world = room();
    world.gates = std::move(gates);
    return world;
  }

  Picture picture(const world::World& world, const Path& path, std::uint32_t frame = 1,
                  std::uint64_t seed = 1) const {
    CameraRenderer renderer{world, camera, light, seed, cache, 1};
    Picture result{{}, camera.stored_width, camera.stored_height};
    renderer.render(frame, 0.0, history_of(path), result.bytes);
    return result;
  }
  Picture picture(const world::World& world, const BodyPose& pose) const {
    return picture(world, [&](double t) {
      BodyPose still = pose;
      still.t = t;
      return still;
    });
  }

  /// Without what the Bebop's image processing does to colours: where things are is asked here.
  world::CameraTruth camera = [] {
    world::CameraTruth plain;
    plain.imaging = {
        .footprint_px = 2.4, .red_shift_px = 0.0, .chroma_smoothing = 1, .saturation = 1.1};
    return plain;
  }();
  world::LightConditions light = [] {
    world::LightConditions quiet;
    quiet.noise_scale = 0.0;
    return quiet;
  }();
  static std::filesystem::path cache;
};

std::filesystem::path CameraRendererTest::cache;

/// Places 2 m away, all over the picture.
std::vector<Vector3d> places_in_view(const world::CameraTruth& camera, const BodyPose& pose) {
  std::vector<Vector3d> places;
  for (const double u : {40.0, 120.0, 200.0, 275.0})
    for (const double v : {30.0, 80.0, 130.0})
      places.push_back(point_at(camera, pose, {u, v}, 2.0));
  return places;
}

TEST_F(CameraRendererTest, ThingsAppearWhereTheLensProjectsThem) {
  const std::vector<AnyCamera> lenses{
      {DhaneFisheye{}},
      {Pinhole{}},
      {BrownConrady{{168, 168}, {157, 124}, {-0.25, 0.08, 0.001, 0.002, -0.01}}},
      {KannalaBrandt{.radial = RadialPolynomial{{-0.05, 0.01, 0, 0}}}}};
  const std::vector<BodyPose> poses{kMiddle, pose_at({-1, 0.5, -1.6}, {0.2, -0.15, 0.5}),
                                    pose_at({0.5, 0, -1.4}, {-0.15, 0.1, 2.5})};
  for (std::size_t lens = 0; lens < lenses.size(); ++lens)
    for (std::size_t k = 0; k < poses.size(); ++k) {
      if (lens > 0 && k != lens - 1)
        continue;  // all poses with the first, one with each other lens
      camera.lens = lenses[lens];
      const auto places = places_in_view(camera, poses[k]);
      const Pair sheets = with_sheets(room(), poses[k], places);
      const Picture with = picture(sheets.with, poses[k]),
                    without = picture(sheets.without, poses[k]);
      for (const Vector3d& p_E : places) {
        const Vector2d expected = projected(camera, poses[k], p_E).value();
        const Blob blob = difference(with, without, Chroma::kCb, expected, {9, 9});
        ASSERT_GT(blob.weight, 0.0);
        EXPECT_THAT(blob.centre, test::IsNear(expected, 0.25)) << "lens " << lens << ", pose " << k;
      }
    }
}

// The middle line of each bar, measured across it at four places.
TEST_F(CameraRendererTest, AGatesBarsAppearWhereTheLensProjectsThem) {
  const std::vector<world::WorldGate> gates{
      {.p_EG = {1.5, 0.0, -1.5}, .yaw_EG = 0.0, .bar = 0.03},
      {.p_EG = {1.2, 0.4, -1.3}, .yaw_EG = 0.5, .side = 1.2, .bar = 0.03},
      {.p_EG = {2.0, -0.5, -1.4}, .yaw_EG = -0.4, .bar = 0.03}};
  for (const world::WorldGate& gate : gates) {
    Pair pair{room(), room_with({gate})};  // before a grey wall
    for (world::World* world : {&pair.without, &pair.with})
      world->decoys = {{{.center = {3.0, 0}, .size = {0.1, 7.0}, .top = 3.1}, kGrey}};
    const Picture with = picture(pair.with, kMiddle), without = picture(pair.without, kMiddle);
    const double off = 0.5 * (gate.side - gate.bar);
    const auto point = [&](double y, double z) {
      return projected(camera, kMiddle, gate.p_EG + rotation_z(gate.yaw_EG) * Vector3d{0, y, z})
          .value();
    };
    for (const double side : {-1.0, 1.0})
      for (const double along : {-0.8, -0.3, 0.3, 0.8}) {  // the pole meets the lower bar at 0
        // Upright bars are measured along the line of pixels, level ones along the column.
        const Vector2d upright = point(side * off, along * off),
                       level = point(along * off, side * off);
        EXPECT_NEAR(difference(with, without, Chroma::kCr, upright, {7, 0.4}).centre.x(),
                    upright.x(), 0.5);
        EXPECT_NEAR(difference(with, without, Chroma::kCr, level, {0.4, 7}).centre.y(), level.y(),
                    0.5);
      }
    // Nothing of its colour in the opening.
    const Vector2d middle = point(0, 0);
    EXPECT_EQ(difference(with, without, Chroma::kCr, middle, {8, 8}).weight, 0.0);
  }
}

TEST_F(CameraRendererTest, AGateShowsItsOwnColour) {
  // The hue of a colour beside that of a grey gate in the same place, as an angle in (Cb, Cr).
  const auto chroma_of = [&](const Vector3d& color) {
    const world::WorldGate gate{.p_EG = {0.7, 0, -1.5}, .bar = 0.1, .color = color};
    const Picture seen = picture(room_with({gate}), kMiddle);
    const Vector2d px = projected(camera, kMiddle, gate.p_EG + Vector3d{-0.05, -0.45, 0}).value();
    const Yuv yuv = seen.at(static_cast<int>(px.x() + 0.5), static_cast<int>(px.y() + 0.5));
    return Vector2d{yuv.u, yuv.v};
  };
  const Vector2d grey = chroma_of({0.4, 0.4, 0.4});
  for (const Vector3d& color :
       {kOrange, kBlue, Vector3d{0.75, 0.07, 0.07}, Vector3d{0.10, 0.60, 0.12},
        Vector3d{0.90, 0.75, 0.08}, Vector3d{0.80, 0.08, 0.55}}) {
    const Eigen::Vector3d root = color.cwiseSqrt();
    const double y = 0.299 * root[0] + 0.587 * root[1] + 0.114 * root[2];
    const Vector2d expected{0.564 * (root[2] - y), 0.713 * (root[0] - y)},
        seen = chroma_of(color) - grey;
    EXPECT_GT(seen.norm(), 20.0) << color.transpose();
    const double angle = std::acos(seen.normalized().dot(expected.normalized())) / kDegree;
    EXPECT_LT(angle, 30.0) << color.transpose() << ": " << seen.transpose();
  }
}

// Red lies above green and blue by that much, and smoothing spreads colour along upright lines.
TEST_F(CameraRendererTest, RedIsDisplacedAndColourSmoothedAsAsked) {
  const Vector3d p_E = point_at(camera, kMiddle, {120, 90}, 2.0);
  world::World with = room();
  with.decoys = {sheet(p_E, kMiddle, kOrange)};
  const auto blob = [&] {
    return difference(picture(with, kMiddle), picture(room(), kMiddle), Chroma::kCr, {120, 90},
                      {9, 9});
  };
  const Vector2d plain = blob().centre;
  camera.imaging.red_shift_px = 0.6;
  const Vector2d shifted = blob().centre;
  EXPECT_LT(shifted.y(), plain.y() - 0.2);
  EXPECT_NEAR(shifted.x(), plain.x(), 0.1);
  camera.imaging.red_shift_px = 0.0;
  camera.imaging.chroma_smoothing = 3;
  EXPECT_NEAR((blob().centre - plain).norm(), 0.0, 0.3);
}

TEST_F(CameraRendererTest, WornPaintIsUnevenAndNarrowPaintShowsLessColour) {
  const world::WorldGate gate{.p_EG = {1.5, 0.0, -1.5}};
  const auto reds = [&](const world::GatePaint& paint) {
    world::World world = room_with({gate});
    world.paint = paint;
    const Picture seen = picture(world, kMiddle);
    double sum = 0.0, steps = 0.0, last = 0.0;
    for (double z = -0.4; z <= 0.4; z += 0.01) {
      const Vector2d px =
          projected(camera, kMiddle, gate.p_EG + Vector3d{-0.025, -0.475, z}).value();
      const double cr = seen.at(static_cast<int>(px.x() + 0.5), static_cast<int>(px.y() + 0.5)).v;
      sum += cr, steps += z > -0.4 ? std::abs(cr - last) : 0.0, last = cr;
    }
    return std::pair{sum / 81.0, steps};
  };
  const auto [fresh, fresh_steps] = reds({.width = 1.0, .blue = 1.0, .wear = 0.0});
  const auto [worn, worn_steps] = reds({.width = 1.0, .blue = 1.0, .wear = 0.8});
  const auto [narrow, narrow_steps] = reds({.width = 0.3, .blue = 1.0, .wear = 0.0});
  EXPECT_LT(worn, fresh);
  EXPECT_GT(worn_steps, 1.5 * fresh_steps);
  EXPECT_LT(narrow, fresh - 3.0);
}

TEST_F(CameraRendererTest, WhatIsBehindTheCameraIsNotSeen) {
  world::World behind = room_with({{.p_EG = {-3.0, 0, -1.5}}});
  behind.decoys = {sheet({-2.5, 1, -1.5}, kMiddle, kOrange)};
  EXPECT_EQ(picture(behind, kMiddle).bytes, picture(room(), kMiddle).bytes);
}

TEST_F(CameraRendererTest, AGateBehindABoxIsNotSeen) {
  world::World hidden = room();
  hidden.obstacles = {{{0.5, 0}, {0.2, 3.0}, 0.0, 0.0, 2.6, false}};
  const Picture without = picture(hidden, kMiddle);
  hidden.gates = {{.p_EG = {2.0, 0, -1.5}}};
  EXPECT_EQ(picture(hidden, kMiddle).bytes, without.bytes);
  hidden.gates[0].p_EG.x() = 0.0;
  EXPECT_NE(picture(hidden, kMiddle).bytes, without.bytes) << "before it, it is";
}

TEST_F(CameraRendererTest, DecoysAreSeenInTheirColour) {
  world::World world = room();
  world.decoys = {{{.center = {1.0, -0.6}, .size = {0.2, 0.2}, .top = 1.5}, kOrange},
                  {{.center = {1.0, 0.6}, .size = {0.2, 0.2}, .top = 1.5, .pole = true}, kOrange}};
  const Picture with = picture(world, kMiddle), without = picture(room(), kMiddle);
  for (const world::Decoy& decoy : world.decoys) {
    const Vector2d px =
        projected(camera, kMiddle, {decoy.shape.center.x(), decoy.shape.center.y(), -1.2}).value();
    EXPECT_GT(difference(with, without, Chroma::kCr, px, {3, 3}).weight, 50 * 20.0);
  }
}

/// How far a moving camera draws sheets from where the lens puts them at the time of their column.
struct Drawn {
  double off = 0.0;        ///< Worst [px].
  double off_still = 0.0;  ///< From where they would be in a still picture.
};

// Exposed for half a millisecond, so that blur does not matter; the stored lines, upright columns,
// are read one after the other from t = 0 on.
TEST_F(CameraRendererTest, AMovingCameraDrawsEachColumnAtItsOwnTime) {
  camera.exposure = 5e-4;
  light.group_gain = {10, 10, 10};  // or it is too dark for the gain
  const std::vector<std::pair<const char*, Path>> paths{
      {"yaw",
       [](double t) {
         return pose_at(kMiddle.p_EB, {0, 0, 2.0 * t}, t);
       }},
      {"pitch",
       [](double t) {
         return pose_at(kMiddle.p_EB, {0, -1.5 * t, 0}, t);
       }},
      {"roll",
       [](double t) {
         return pose_at(kMiddle.p_EB, {2.0 * t, 0, 0}, t);
       }},
      {"climb", [](double t) {
         return pose_at(kMiddle.p_EB - Vector3d{0, 0, 3.0 * t}, {}, t);
       }}};
  for (const auto& [name, path] : paths) {
    const auto places = places_in_view(camera, path(0.010));
    const Pair sheets = with_sheets(room(), path(0.010), places);
    const Picture with = picture(sheets.with, path), without = picture(sheets.without, path);
    double off = 0.0, off_still = 0.0;
    for (const Vector3d& p_E : places) {
      const Vector2d still = projected(camera, path(0.0), p_E).value();
      Vector2d expected = still;
      for (int i = 0; i < 5; ++i)
        expected = projected(camera,
                             path(camera.readout * expected.x() / (camera.stored_height - 1) +
                                  0.5 * camera.exposure),
                             p_E)
                       .value();
      const Blob blob = difference(with, without, Chroma::kCb, expected, {9, 9});
      off = std::max(off, (blob.centre - expected).norm());
      off_still = std::max(off_still, (blob.centre - still).norm());
    }
    EXPECT_LT(off, 0.3) << name;
    EXPECT_GT(off_still, 3.0) << name;
  }
}

// Columns from left to right take the read-out time: level lines are sheared by the pitch rate.
TEST_F(CameraRendererTest, PitchingShearsLevelLinesByReadoutTimesRate) {
  camera.exposure = 5e-4;
  const double rate = 1.0;
  const Path path = [&](double t) { return pose_at(kMiddle.p_EB, {0, rate * (t - 0.010), 0}, t); };
  const BodyPose level = path(0.010);
  // As far left of the lens's centre as right of it.
  const std::vector<Vector2d> still{{97, 124}, {217, 124}};
  std::vector<Vector3d> places;
  for (const Vector2d& px : still) places.push_back(point_at(camera, level, px, 2.0));
  const Pair sheets = with_sheets(room(), level, places);
  const Picture with = picture(sheets.with, path), without = picture(sheets.without, path);
  const Vector2d left = difference(with, without, Chroma::kCb, still[0], {9, 9}).centre,
                 right = difference(with, without, Chroma::kCb, still[1], {9, 9}).centre;
  // Nose up: what is drawn later stands lower, by focal length times angle about the axis.
  const double later = camera.readout * (right.x() - left.x()) / (camera.stored_height - 1);
  EXPECT_NEAR(right.y() - left.y(), 168.0 * rate * later, 0.25);
}

// A way of l pixels, evenly, adds l² / 12 to the variance along it; the tone curve, steep in the
// dark, some more. The samples of one column share their times, so that single columns differ: the
// mean of six sheets.
TEST_F(CameraRendererTest, MotionBlurWidensAlongTheMotionByTheWayOfTheExposure) {
  camera.readout = 0.0;
  camera.exposure = 0.004;  // shorter than the room asks for: gain does the rest
  const double rate = 7.5;
  std::vector<Vector3d> places;
  for (const double u : {87.0, 115.0, 143.0, 171.0, 199.0, 227.0})
    places.push_back(point_at(camera, kMiddle, {u, 124}, 2.0));
  const Pair sheets = with_sheets(room(), kMiddle, places);

  struct Seen {
    Vector2d variance = Vector2d::Zero(), way2 = Vector2d::Zero();  // [px²]
  };
  const auto seen = [&](const Attitude& rates) {
    const Path path = [&](double t) {  // through kMiddle's attitude in mid-exposure
      const double part = t - 0.5 * camera.exposure;
      return pose_at(kMiddle.p_EB, {0, rates.pitch * part, rates.yaw * part}, t);
    };
    const Picture with = picture(sheets.with, path), without = picture(sheets.without, path);
    Seen sum;
    const double share = 1.0 / static_cast<double>(places.size());
    for (const Vector3d& p_E : places) {
      const Vector2d from = projected(camera, path(0.0), p_E).value(),
                     to = projected(camera, path(camera.exposure), p_E).value();
      sum.way2 += share * (to - from).cwiseAbs2();
      sum.variance +=
          share * difference(with, without, Chroma::kCb, 0.5 * (from + to), {12, 12}).variance;
    }
    return sum;
  };
  const Seen still = seen({});
  for (const Attitude& rates : {Attitude{.yaw = rate}, Attitude{.pitch = rate}}) {
    const Seen turning = seen(rates);
    const Vector2d added = turning.variance - still.variance, expected = turning.way2 / 12.0;
    EXPECT_GT(expected.maxCoeff(), 1.5);
    EXPECT_THAT(added, test::IsNear(expected, 0.3 * expected.maxCoeff())) << rates.yaw;
  }
}

TEST_F(CameraRendererTest, TheSameSeedAndFrameGiveTheSameBytesAndOthersOtherNoise) {
  light.noise_scale = 1.0;
  const world::World world = room_with({{.p_EG = {1.5, 0, -1.5}}});
  const Path still = [](double t) { return pose_at(kMiddle.p_EB, {}, t); };
  const Picture one = picture(world, still, 4, 7);
  EXPECT_EQ(one.bytes.size(), 2u * 160 * 315);
  EXPECT_EQ(one.bytes, picture(world, still, 4, 7).bytes);
  for (const Picture& other : {picture(world, still, 4, 8), picture(world, still, 5, 7)}) {
    int differ = 0;
    double sum = 0.0;
    for (std::size_t i = 0; i < one.bytes.size(); ++i) {
      differ += one.bytes[i] != other.bytes[i];
      sum += one.bytes[i] - other.bytes[i];
    }
    EXPECT_GT(differ, 20'000);
    EXPECT_NEAR(sum / static_cast<double>(one.bytes.size()), 0.0, 0.1) << "the same scene";
  }
}

TEST_F(CameraRendererTest, AutoExposureMakesADimRoomAsBrightAsABrightOne) {
  const double nominal = picture(room(), kMiddle).mean_y();
  EXPECT_NEAR(nominal, 117, 12);  // the meter sees one pixel in 36, and cuts bright places
  for (const double gain : {0.7, 3.0}) {
    light.group_gain = {gain, gain, gain};
    EXPECT_NEAR(picture(room(), kMiddle).mean_y(), nominal, 2) << gain;
  }
  light.group_gain = {0.1, 0.1, 0.1};
  EXPECT_LT(picture(room(), kMiddle).mean_y(), nominal - 20) << "beyond the reach of the gain";
  light.group_gain = {1, 1, 1};
  light.exposure_target = 0.5;
  EXPECT_LT(picture(room(), kMiddle).mean_y(), nominal - 8);
}

TEST_F(CameraRendererTest, FastShowsTheSameSceneAsBrightWithoutBlurAndAlwaysTheSame) {
  const world::World world = room_with({{.p_EG = {1.5, 0, -1.5}}});
  const Picture full = picture(world, kMiddle);
  camera.fast = true;
  const Picture fast = picture(world, kMiddle);
  EXPECT_EQ(fast.bytes, picture(world, kMiddle).bytes);
  EXPECT_NEAR(fast.mean_y(), full.mean_y(), 3.0);
  double off = 0.0, sharper = 0.0;
  for (std::size_t i = 1; i + 2 < full.bytes.size(); i += 2) {
    off += std::abs(full.bytes[i] - fast.bytes[i]);
    sharper +=
        std::abs(fast.bytes[i + 2] - fast.bytes[i]) - std::abs(full.bytes[i + 2] - full.bytes[i]);
  }
  EXPECT_LT(off / (0.5 * static_cast<double>(full.bytes.size())), 6.0) << "grey levels a pixel";
  EXPECT_GT(sharper, 0.0);
}

TEST_F(CameraRendererTest, LampsColourTheRoomAndOtherSurfacesChangeItButNotItsGates) {
  const world::World world = room_with({{.p_EG = {1.5, 0, -1.5}}});
  const auto mean_red = [](const Picture& seen) {
    double sum = 0.0;
    for (int u = 0; u < 315; u += 5)
      for (int v = 0; v < 160; v += 5) sum += seen.at(u, v).v - seen.at(u, v).u;
    return sum / (63 * 32);
  };
  const Picture nominal = picture(world, kMiddle);
  light.group_color = {{{1.3, 1, 0.7}, {1.3, 1, 0.7}, {1.3, 1, 0.7}}};
  EXPECT_GT(mean_red(picture(world, kMiddle)), mean_red(nominal) + 5.0);
  light.group_color = {{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  light.surfaces = 5;
  const CameraRenderer renderer{world, camera, light, 1, cache, 1};
  const auto mask = renderer.gate_mask(0.0, std::vector{kMiddle});
  const Picture other = picture(world, kMiddle);
  EXPECT_NE(other.bytes, nominal.bytes);
  EXPECT_EQ(other.bytes, picture(world, kMiddle).bytes);
  light.surfaces = 0;
  const CameraRenderer as_it_is{world, camera, light, 1, cache, 1};
  EXPECT_EQ(mask, as_it_is.gate_mask(0.0, std::vector{kMiddle})) << "they stand where they stood";
}

TEST_F(CameraRendererTest, AMaskCoversTheBarsWhereTheLensProjectsThem) {
  const world::WorldGate gate{.p_EG = {1.5, 0.2, -1.5}, .yaw_EG = 0.3, .bar = 0.1};
  const CameraRenderer renderer{room_with({gate}), camera, light, 1, cache, 1};
  const auto mask = renderer.gate_mask(0.0, std::vector{kMiddle});
  const auto at = [&](double y, double z) {
    const Vector2d px =
        projected(camera, kMiddle, gate.p_EG + rotation_z(gate.yaw_EG) * Vector3d{-0.05, y, z})
            .value();
    return mask[static_cast<std::size_t>(std::lround(px.y()) * 315 + std::lround(px.x()))];
  };
  for (const double side : {-0.45, 0.45})
    for (const double along : {-0.4, -0.2, 0.2, 0.4}) {
      EXPECT_EQ(at(side, along), 1);
      EXPECT_EQ(at(along, side), 1);
    }
  EXPECT_EQ(at(0, 0), 0);
  EXPECT_EQ(at(0.6, 0), 0);
}

TEST_F(CameraRendererTest, SightAndRangeAgreeWithTheWorldOfThePhysics) {
  world::World world =
      room_with({{.p_EG = {2.0, 1.0, -0.51}, .yaw_EG = 0.6}});  // stands on the floor
  world.obstacles = {{{1.0, -3.0}, {1.5, 0.6}, 0.5, 0.0, 1.9, false},
                     {{0.0, 3.0}, {2.0, 1.0}, 1.0, 1.0, 1.3, false}};
  world.decoys = {{{{-3.0, -2.0}, {0.5, 0.1}, 0.2, 0.3, 1.6, false}}};
  const CameraRenderer renderer{world, camera, light, 1, cache, 1};
  const SolidSight solids{world};
  Stream draw{7, "rays"};
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d from{draw.uniform(-3.5, 3.5), draw.uniform(-3.5, 3.5), draw.uniform(-3.0, -0.1)},
        along = Vector3d{draw.normal(), draw.normal(), draw.normal()}.normalized();
    const double range = solids.range(from, along, 3.0);
    if (range == 0.0) continue;  // from inside something
    EXPECT_NEAR(renderer.range(from, along, 3.0), range, 1e-4) << i;
    hits += range < 3.0;
    for (const double part : {0.99, 1.01})
      EXPECT_EQ(renderer.occluded(from, from + part * range * along),
                solids.occluded(from, from + part * range * along))
          << i;
  }
  EXPECT_GT(hits, 1000);
}

TEST(InterpolatedPose, RunsEvenlyBetweenTwoAndHoldsTheEnds) {
  const std::vector<BodyPose> history{{1.0, {1, 0, 0}, {1, 0, 0, 0}},
                                      {2.0, {3, 4, 0}, {0, 0, 0, -1}},
                                      {3.0, {3, 4, 8}, {0, 0, 0, 1}}};
  EXPECT_EQ(interpolated(history, 0.5).p_EB, history[0].p_EB);
  EXPECT_EQ(interpolated(history, 9.0).p_EB, history[2].p_EB);
  EXPECT_THAT(interpolated(history, 1.25).p_EB, test::IsNear(Vector3d{1.5, 1, 0}, 1e-12));
  EXPECT_THAT(interpolated(history, 2.0).p_EB, test::IsNear(history[1].p_EB, 1e-12));
  // The nearer of q and -q: the same attitude stays.
  EXPECT_THAT(interpolated(history, 2.5).q_EB.cwiseAbs(),
              test::IsNear(Eigen::Vector4d{0, 0, 0, 1}, 1e-12));
  EXPECT_EQ(interpolated({}, 1.0).p_EB, Vector3d::Zero());
}

}  // namespace
}  // namespace gatefly::sim
