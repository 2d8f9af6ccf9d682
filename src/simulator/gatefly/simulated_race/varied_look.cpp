// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/varied_look.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include <Eigen/Geometry>

#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::simulated_race {
namespace {

using sim::Stream;

/// A factor between 1 / `most` and `most`, as often above 1 as below.
double factor(Stream& stream, double most) {
  return std::exp(std::log(most) * stream.uniform(-1.0, 1.0));
}

void vary_lamps(world::LightConditions& light, std::uint64_t seed) {
  Stream stream{seed, "varied lamps"};
  for (std::size_t group = 0; group < light.group_gain.size(); ++group) {
    light.group_gain[group] *= factor(stream, 2.5);
    // From bulbs (about 3000 K) to a clear sky (9000 K), and fluorescent tubes' green.
    const double warm = stream.uniform(-1.0, 1.0), green = stream.uniform(-1.0, 1.0);
    light.group_color[group] = {1.0 + 0.30 * warm, 1.0 + 0.06 * green, 1.0 - 0.35 * warm};
  }
}

/// Farther from grey, or nearer to it, by the same hue.
Eigen::Vector3d saturated(const Eigen::Vector3d& color, double by) {
  const double grey = color.mean();
  const Eigen::Vector3d other =
      Eigen::Vector3d::Constant(grey) + by * (color.array() - grey).matrix();
  return other.cwiseMax(0.01).cwiseMin(1.0);
}

/// Turned about the grey axis.
Eigen::Vector3d turned(const Eigen::Vector3d& color, double angle) {
  const auto [s, c] = sincos(angle);
  const Eigen::Vector3d axis = Eigen::Vector3d::Ones() / std::sqrt(3.0);
  const Eigen::Vector3d other =
      c * color + s * axis.cross(color) + (1 - c) * axis * axis.dot(color);
  return other.cwiseMax(0.01).cwiseMin(1.0);
}

void vary_gates(world::World& world, std::uint64_t seed) {
  Stream stream{seed, "varied gates"};
  const double angle = stream.uniform(-15.0, 15.0) * kDegree, saturation = stream.uniform(0.6, 1.1),
               value = stream.uniform(0.5, 1.0), bars = stream.uniform(0.6, 1.4);
  const auto painted = [&](const Eigen::Vector3d& color) {
    return Eigen::Vector3d{value * saturated(turned(color, angle), saturation)};
  };
  for (auto* gates : {&world.gates, &world.false_gates})
    for (world::WorldGate& gate : *gates) gate.color = painted(gate.color), gate.bar *= bars;
  for (world::Decoy& decoy : world.decoys) decoy.color = painted(decoy.color);
}

/// Boxes and poles of any colour, standing anywhere but where the camera goes or a gate stands.
void add_clutter(world::World& world, std::uint64_t seed,
                 const std::vector<Eigen::Vector3d>& keep_clear) {
  constexpr double kClear = 0.7, kFromGate = 0.9;  // [m]
  Stream stream{seed, "varied clutter"};
  const int count = static_cast<int>(stream.uniform(0.0, 16.0));
  const Eigen::Vector2d half = 0.5 * world.room_size.head<2>() - Eigen::Vector2d::Constant(0.4);
  for (int i = 0; i < count; ++i) {
    world::Decoy thing;
    thing.shape.center = world.room_center + Eigen::Vector2d{stream.uniform(-half.x(), half.x()),
                                                             stream.uniform(-half.y(), half.y())};
    thing.shape.pole = stream.uniform() < 0.4;
    const double a = stream.uniform(0.05, 0.8), b = stream.uniform(0.05, 0.8);
    thing.shape.size = thing.shape.pole ? Eigen::Vector2d{0.4 * a, 0.4 * a} : Eigen::Vector2d{a, b};
    thing.shape.heading = stream.uniform(-kPi, kPi);
    thing.shape.top = stream.uniform(0.3, std::min(2.5, 0.9 * world.room_size.z()));
    for (int c = 0; c < 3; ++c) thing.color[c] = 0.02 + 0.85 * std::pow(stream.uniform(), 2.0);
    const double reach = 0.5 * thing.shape.size.norm();
    const auto near = [&](const Eigen::Vector3d& p, double clear) {
      return (p.head<2>() - thing.shape.center).norm() < reach + clear;
    };
    const bool in_the_way =
        std::any_of(keep_clear.begin(), keep_clear.end(),
                    [&](const auto& p) { return near(p, kClear); }) ||
        std::any_of(world.gates.begin(), world.gates.end(),
                    [&](const auto& gate) { return near(gate.p_EG, kFromGate); });
    if (!in_the_way) world.decoys.push_back(thing);
  }
}

void vary_camera(world::CameraTruth& camera, std::uint64_t seed) {
  Stream stream{seed, "varied camera"};
  camera.tilt_down += stream.uniform(-5.0, 5.0) * kDegree;
  const double zoom = factor(stream, 1.05);
  std::visit([&](auto& lens) { lens.focal_px *= zoom; }, camera.lens.model);
  camera.exposure *= stream.uniform(0.2, 1.0);  // what is not exposed is not blurred
}

void vary_sensor(world::LightConditions& light, std::uint64_t seed) {
  Stream stream{seed, "varied sensor"};
  light.exposure_target *= factor(stream, 1.6);
  light.noise_scale *= factor(stream, 2.0);
  light.blur *= factor(stream, 1.8);
  for (double& gain : light.white_balance) gain *= factor(stream, 1.15);
}

}  // namespace

void vary(world::SimConfig& config, std::uint64_t seed,
          const std::vector<Eigen::Vector3d>& keep_clear) {
  vary_lamps(config.light, seed);
  vary_sensor(config.light, seed);
  vary_gates(config.world, seed);
  add_clutter(config.world, seed, keep_clear);
  vary_camera(config.camera, seed);
  config.light.surfaces = seed + 1;  // 0 would leave them as they are
}

Stored varied_recording(std::uint64_t seed) {
  Stream stream{seed, "varied recording"};
  return stream.uniform() < 0.5 ? Stored::kJpeg : Stored::kMjpegLow;
}

}  // namespace gatefly::simulated_race
