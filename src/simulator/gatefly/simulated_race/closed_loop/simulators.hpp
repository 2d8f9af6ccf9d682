// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "gatefly/race/messages.hpp"
#include "gatefly/sim/body.hpp"
#include "gatefly/sim/camera.hpp"
#include "gatefly/sim/ideal_vision.hpp"
#include "gatefly/sim/twin_body.hpp"
#include "gatefly/world/sim_config.hpp"

// The two simulators a race can be flown in: one interface, told apart at compile time.

namespace gatefly::simulated_race {

/// MuJoCo's body, and pictures.
struct RenderedSimulator {
  RenderedSimulator(const world::SimConfig& config, const std::function<void()>& while_baking)
      : truth{config.camera},
        renderer{config.world,     config.camera,       config.light, config.seed,
                 config.cache_dir, config.bake_threads, while_baking},
        body{config} {}

  [[nodiscard]] const sim::Sight& sight() const { return renderer; }
  [[nodiscard]] double bake_seconds() const { return renderer.bake_seconds(); }
  void expose(std::uint32_t frame, double t_start, std::span<const sim::BodyPose> history) {
    renderer.render(frame, t_start, history, bytes);
  }
  void deliver(Sensors& sensors) const {
    sensors.image = Image{bytes.data(), PixelFormat::kUyvy, truth.stored_width, truth.stored_height,
                          truth.stored_rotation};
  }
  [[nodiscard]] std::span<const std::uint8_t> picture() const { return bytes; }

  world::CameraTruth truth;
  sim::CameraRenderer renderer;
  sim::Body body;
  std::vector<std::uint8_t> bytes;
};

/// The twin body, and detections without pictures.
struct IdealSimulator {
  IdealSimulator(const world::SimConfig& config, const std::function<void()>& /*bakes nothing*/)
      : body{config},
        vision{config.world, config.camera, config.ideal_vision, config.seed, body.sight()},
        width{config.camera.width()},
        height{config.camera.height()},
        lamps_out{config.light.out} {}
  IdealSimulator(const IdealSimulator&) = delete;
  IdealSimulator& operator=(const IdealSimulator&) = delete;

  [[nodiscard]] const sim::Sight& sight() const { return body.sight(); }
  [[nodiscard]] double bake_seconds() const { return 0.0; }
  void expose(std::uint32_t, double t_start, std::span<const sim::BodyPose> history) {
    seen = vision.look(t_start, history);
    if (world::within(lamps_out, t_start)) seen = {};
  }
  void deliver(Sensors& sensors) const {
    SeenGates& gates = sensors.seen.emplace();
    gates.image_width = width, gates.image_height = height;
    for (const auto& gate : seen.gates)
      (void)gates.gates.push_back({gate.corners_px, gate.fitness});
    if (seen.lower)
      gates.lower_corners = LowerCorners{seen.lower->left_px, seen.lower->right_px, 1.0};
    if (seen.bars) gates.bars = GateBars{seen.bars->left_px, seen.bars->right_px};
    if (!seen.cut) return;
    GateDetection& cut = gates.cut.emplace(GateDetection{.corners_px = seen.cut->corners_px});
    cut.fitness = 1.0, cut.whole = false;
    for (std::size_t i = 0; i < 4; ++i) cut.corner_fitness[i] = seen.cut->seen[i] ? 1.0 : 0.0;
  }
  [[nodiscard]] std::span<const std::uint8_t> picture() const { return {}; }

  sim::TwinBody body;
  sim::IdealVision vision;
  int width, height;
  world::During lamps_out;
  sim::SeenPicture seen;
};

}  // namespace gatefly::simulated_race
