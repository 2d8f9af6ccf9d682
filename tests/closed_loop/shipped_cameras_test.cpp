// SPDX-License-Identifier: Apache-2.0
// Each camera that is shipped draws a gate where its lens model says.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "gatefly/config/config.hpp"
#include "gatefly/config/derived.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/files/shipped_files.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sensing/image.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/camera.hpp"

namespace gatefly::sim {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kGrey = 0.25;  // albedo

std::vector<fs::path> shipped_cameras() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(files::shipped_dir() / "cameras"))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  return files;
}

world::CameraTruth camera_of(const fs::path& file) {
  const std::vector<fs::path> files{file};
  const config::Config config = config::load_config(files);
  return config::simulator_config(config,
                                  config::read_track(config::find_track("oval"), config.gate))
      .camera;
}

/// A pose whose optical axis is level, towards north.
BodyPose level_pose(const world::CameraTruth& camera, double t = 0.0, double yaw = 0.0) {
  return {t, {0, 0, -3.0}, q_EB_of({0.0, camera.tilt_down, yaw})};
}

struct Eyes {
  Eigen::Matrix3d R_EC;
  Vector3d p_EC;
};
Eyes eyes_of(const world::CameraTruth& camera, const BodyPose& pose) {
  const Eigen::Matrix3d R_EB = R_EB_of(pose.q_EB);
  return {R_EB * camera_mount(camera.tilt_down).matrix, pose.p_EB + R_EB * camera.p_BC};
}

/// Straight ahead of the camera, half as large as the picture is high; outer corners of the face
/// that is seen.
struct Target {
  world::WorldGate gate;
  std::array<Vector3d, 4> corners_E;  // TL, TR, BR, BL
};
Target target_before(const world::CameraTruth& camera, const BodyPose& pose) {
  const Eyes eyes = eyes_of(camera, pose);
  // The lower edge is below the optical axis: the lower bar's underside is not seen.
  const double axis = camera.lens.project(Vector3d{0, 0, 1})->y();
  const double v0 = 0.25 * camera.height(),
               v1 = std::max(0.72 * camera.height(), axis + 0.06 * camera.height()),
               u = 0.5 * camera.width();
  const auto up = camera.lens.bearing({u, v0}), down = camera.lens.bearing({u, v1});
  constexpr double kDistance = 2.5;
  const Vector3d high = *up / up->z(), low = *down / down->z();
  Target target;
  target.gate.side = kDistance * (low.y() - high.y());
  target.gate.bar = 0.2 * target.gate.side;
  const Vector3d middle_C{kDistance * 0.5 * (low.x() + high.x()),
                          kDistance * 0.5 * (low.y() + high.y()), kDistance};
  const Vector3d face = eyes.p_EC + eyes.R_EC * middle_C;
  target.gate.p_EG = face + Vector3d{0.5 * target.gate.depth, 0, 0};
  const double h = 0.5 * target.gate.side;
  target.corners_E = {face + Vector3d{0, -h, -h}, face + Vector3d{0, h, -h},
                      face + Vector3d{0, h, h}, face + Vector3d{0, -h, h}};
  return target;
}

/// A grey room's end with a gate of that brightness before it, or none.
world::World wall_with(const std::optional<world::WorldGate>& gate, double brightness) {
  world::World world;
  world.room_size = {16, 16, 6};
  world.decoys = {
      {{.center = {3.6, 0}, .size = {0.1, 14.0}, .top = 5.9}, Vector3d::Constant(kGrey)}};
  if (!gate) return world;
  world.gates = {*gate};
  world.gates[0].color = Vector3d::Constant(kGrey * brightness);
  return world;
}

class ShippedCameras : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    cache = fs::temp_directory_path() / ("gatefly-cameras-test-" + std::to_string(getpid()));
  }
  static void TearDownTestSuite() {
    std::error_code ignored;
    fs::remove_all(cache, ignored);
  }

  static CameraRenderer renderer_of(const world::World& world, const world::CameraTruth& camera) {
    world::LightConditions light;
    light.noise_scale = 0.0;
    return {world, camera, light, 1, cache, 1};
  }
  static std::vector<std::uint8_t> picture(const world::World& world,
                                           const world::CameraTruth& camera, const BodyPose& pose) {
    CameraRenderer renderer = renderer_of(world, camera);
    std::vector<std::uint8_t> bytes;
    renderer.render(1, 0.0, std::vector<BodyPose>{pose}, bytes);
    return bytes;
  }
  static fs::path cache;
};
fs::path ShippedCameras::cache;

/// Straight line through points, by least squares.
struct Line {
  double slope = 0.0, offset = 0.0;
  [[nodiscard]] double at(double x) const { return offset + slope * x; }
};
Line line_through(const std::vector<Vector2d>& points) {
  Vector2d mean{0, 0};
  for (const auto& p : points) mean += p / static_cast<double>(points.size());
  double xx = 0, xy = 0;
  for (const auto& p : points)
    xx += (p.x() - mean.x()) * (p.x() - mean.x()), xy += (p.x() - mean.x()) * (p.y() - mean.y());
  return {xy / xx, mean.y() - xy / xx * mean.x()};
}

/// Edges of a mask's pixels and of a gate, pose by pose.
struct Edges {
  const world::CameraTruth& camera;
  const Target& target;
  std::array<std::vector<Vector2d>, 4> errors{};  // top, right, bottom, left: along, off [px]

  /// @param across  0: the edge is upright, and u is measured; 1: level, v.
  /// @param inside  +1 where the gate lies at larger u or v.
  void add(std::size_t side, const std::vector<std::uint8_t>& mask, const BodyPose& pose,
           const Vector3d& from_E, const Vector3d& to_E, int across, int inside) {
    const Eyes eyes = eyes_of(camera, pose);
    const auto drawn = [&](double part) {
      return *camera.lens.project(eyes.R_EC.transpose() *
                                  (from_E + part * (to_E - from_E) - eyes.p_EC));
    };
    const double first = drawn(0.0)[1 - across], last = drawn(1.0)[1 - across];
    for (int along = static_cast<int>(first) + 4; along < last - 4; along += 3) {
      double low = 0.0, high = 1.0;  // of the edge, where it crosses this line of pixels
      for (int i = 0; i < 40; ++i)
        (drawn(0.5 * (low + high))[1 - across] < along ? low : high) = 0.5 * (low + high);
      const double expected = drawn(low)[across];
      const auto is_gate = [&](int x) {
        return mask[static_cast<std::size_t>(across == 0 ? along * camera.width() + x
                                                         : x * camera.width() + along)] == 1;
      };
      int x = static_cast<int>(std::lround(expected)) - 4 * inside;
      for (int i = 0; i < 9 && !is_gate(x); ++i) x += inside;
      errors[side].push_back({static_cast<double>(along), x - 0.5 * inside - expected});
    }
  }
};

// The four outer edges of a gate, line of pixels by line of pixels, in the pictures of a camera that is
// turned by parts of a pixel, so that what falls between pixel centres averages out; a corner is where
// two edges meet.
TEST_F(ShippedCameras, DrawAGatesCornersWithinATenthOfAPixelOfTheirLens) {
  constexpr int kTurns = 9;  // each way
  for (const fs::path& file : shipped_cameras()) {
    const world::CameraTruth camera = camera_of(file);
    const BodyPose middle = level_pose(camera);
    const Target target = target_before(camera, middle);
    const auto& c = target.corners_E;
    CameraRenderer renderer = renderer_of(wall_with(target.gate, 1.0), camera);
    Edges edges{camera, target};
    const Vector2d centre{0.5 * camera.width(), 0.5 * camera.height()};
    const double pixel =
        std::acos(camera.lens.bearing(centre)->dot(*camera.lens.bearing(centre + Vector2d{1, 0})));
    for (int i = 0; i < kTurns; ++i)
      for (int j = 0; j < kTurns; ++j) {
        BodyPose pose = middle;
        pose.q_EB = q_EB_of({0.0, camera.tilt_down + pixel * ((i + 0.5) / kTurns - 0.5),
                             pixel * ((j + 0.5) / kTurns - 0.5)});
        const auto mask = renderer.gate_mask(0.0, std::vector<BodyPose>{pose});
        edges.add(0, mask, pose, c[0], c[1], 1, 1), edges.add(1, mask, pose, c[1], c[2], 0, -1);
        edges.add(2, mask, pose, c[3], c[2], 1, -1), edges.add(3, mask, pose, c[0], c[3], 0, 1);
      }
    const Eyes eyes = eyes_of(camera, middle);
    std::array<Line, 4> lines;
    for (std::size_t i = 0; i < 4; ++i) {
      ASSERT_GT(edges.errors[i].size(), 1000u);
      lines[i] = line_through(edges.errors[i]);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector2d px = *camera.lens.project(eyes.R_EC.transpose() * (c[i] - eyes.p_EC));
      const Vector2d off{lines[i == 0 || i == 3 ? 3 : 1].at(px.y()),
                         lines[i < 2 ? 0 : 2].at(px.x())};
      EXPECT_LT(off.norm(), 0.1) << file.filename() << ", corner " << i << ": " << off.transpose();
    }
  }
}

// The mask, whose rays go through the pixels' centres, ends where the lens says, too.
TEST_F(ShippedCameras, MaskAGateWhereTheirLensPutsIt) {
  for (const fs::path& file : shipped_cameras()) {
    const world::CameraTruth camera = camera_of(file);
    const BodyPose pose = level_pose(camera);
    const Target target = target_before(camera, pose);
    CameraRenderer renderer = renderer_of(wall_with(target.gate, 1.0), camera);
    const auto mask = renderer.gate_mask(0.0, std::vector<BodyPose>{pose});
    ASSERT_EQ(mask.size(), static_cast<std::size_t>(camera.width() * camera.height()));
    const Eyes eyes = eyes_of(camera, pose);
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector2d px =
          *camera.lens.project(eyes.R_EC.transpose() * (target.corners_E[i] - eyes.p_EC));
      const Vector2d in{i == 0 || i == 3 ? 1.0 : -1.0, i < 2 ? 1.0 : -1.0};
      const auto at = [&](const Vector2d& p) {
        return mask[static_cast<std::size_t>(std::lround(p.y()) * camera.width() +
                                             std::lround(p.x()))];
      };
      EXPECT_EQ(at(px + 3.0 * in), 1) << file.filename() << ", corner " << i;
      EXPECT_EQ(at(px - 3.0 * in), 0) << file.filename() << ", corner " << i;
    }
  }
}

// Upright rows are exposed one after the other where pictures are stored upright: a bar leans while
// the drone yaws, and with a global shutter it does not.
TEST_F(ShippedCameras, ReadRowsOneAfterTheOtherWhereTheyAreStoredUpright) {
  constexpr double kRate = 2.0;  // [rad/s]
  const auto lean = [&](const char* name) {
    const world::CameraTruth camera = camera_of(files::shipped_dir() / "cameras" / name);
    const Target target = target_before(camera, level_pose(camera));
    CameraRenderer renderer = renderer_of(wall_with(target.gate, 1.0), camera);
    std::vector<BodyPose> history;
    for (int i = -20; i <= 80; ++i)
      history.push_back(level_pose(camera, 1e-3 * i, kRate * (1e-3 * i - 0.5 * camera.readout)));
    const auto mask = renderer.gate_mask(0.0, history);
    const auto left_end = [&](int v) {
      int u = 0;
      while (mask[static_cast<std::size_t>(v * camera.width() + u)] == 0) ++u;
      return u;
    };
    const int top = static_cast<int>(0.30 * camera.height()),
              bottom = static_cast<int>(0.66 * camera.height());
    return left_end(bottom) - left_end(top);
  };
  // 0.36 of 25 ms at 2 rad/s and about 220 px a radian there: 4 px; nose right moves things left.
  EXPECT_LE(lean("wide-usb.toml"), -3);
  EXPECT_NEAR(lean("grandprix.toml"), 0, 1);
}

}  // namespace
}  // namespace gatefly::sim
