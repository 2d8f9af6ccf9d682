// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/bench/camera_stages.hpp"

#include <cstdint>
#include <memory>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/body_state.hpp"
#include "gatefly/sim/camera.hpp"

namespace gatefly::bench {
namespace {

using History = std::vector<sim::BodyPose>;

/// Flying at 1.7 m/s towards a gate, turning a little.
History history_before(const world::WorldGate& gate, double distance) {
  constexpr double kSpeed = 1.7, kTurn = 0.6;  // [m/s], [rad/s]
  const Eigen::Vector3d along{cos(gate.yaw_EG), sin(gate.yaw_EG), 0.0};
  History history;
  for (int i = 0; i <= 60; i += 2) {
    const double t = 1e-3 * i;
    history.push_back({t, gate.p_EG + (kSpeed * t - distance) * along,
                       sim::q_EB_of({0.0, -5.0 * kDegree, gate.yaw_EG + kTurn * t})});
  }
  return history;
}

}  // namespace

std::vector<Stage> camera_stages(const world::SimConfig& config,
                                 const std::function<void()>& while_baking) {
  auto histories = std::make_shared<std::vector<History>>();
  for (const world::WorldGate& gate : config.world.gates)
    for (const double distance : {1.0, 2.0, 3.0, 4.0, 6.0})
      histories->push_back(history_before(gate, distance));
  const auto stage = [&](const char* name, const char* what, bool fast, const char* baseline) {
    world::CameraTruth camera = config.camera;
    camera.fast = fast;
    const auto renderer =
        std::make_shared<sim::CameraRenderer>(config.world, camera, config.light, config.seed,
                                              config.cache_dir, config.bake_threads, while_baking);
    const auto bytes = std::make_shared<std::vector<std::uint8_t>>();
    return Stage{.name = name,
                 .what = what,
                 .inputs = histories->size(),
                 .call =
                     [=](std::size_t i) {
                       renderer->render(static_cast<std::uint32_t>(i), 0.0, (*histories)[i],
                                        *bytes);
                     },
                 .baseline = baseline};
  };
  return {stage("frame", "a rendered frame, all effects", false, ""),
          stage("frame_fast", "the same with sim.camera_quality = \"fast\"", true, "frame")};
}

}  // namespace gatefly::bench
