// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "gatefly/sim/camera.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::simulated_race {

/// How a seed's pictures are stored.
enum class Stored { kJpeg, kMjpegLow };

/// Makes a seed look unlike any other: domain randomisation, on top of level `hard`.
///
/// Lamps (colour, brightness), surfaces, gates (hue, saturation, width of bars), clutter of any
/// colour, camera (tilt, focal length, exposure time), sensor (exposure, noise, white balance,
/// sharpness). Bounds: docs/simulation.md. Each has its own stream of random numbers. What the
/// labels say follows: they are computed from the same `config`.
/// @param config  changed; its flight is over, as things now stand elsewhere.
/// @param keep_clear  where the camera will be: clutter keeps 0.7 m off.
void vary(world::SimConfig& config, std::uint64_t seed,
          const std::vector<Eigen::Vector3d>& keep_clear);

/// How that seed's pictures are recorded: each in half of the seeds.
[[nodiscard]] Stored varied_recording(std::uint64_t seed);

}  // namespace gatefly::simulated_race
