// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "gatefly/sim/sight.hpp"
#include "gatefly/world/sim_config.hpp"

namespace gatefly::sim {

/// Pose of the body at one moment.
struct BodyPose {
  double t = 0.0;  ///< [s]
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();
  Eigen::Vector4d q_EB{1, 0, 0, 0};  ///< w, x, y, z; body to earth.
};

/// The pose at `t` between the two nearest ones (the quaternion not normalised); ends are held.
[[nodiscard]] BodyPose interpolated(std::span<const BodyPose> history, double t);

/// Casts the lens's pixels into the world and pushes the light through a sensor model.
///
/// Rolling shutter (one time per stored line), motion blur (one time and pose per sample), baked
/// light map for the static room, direct shading of what a seed moves, auto-exposure with a lag,
/// shot and read noise, clipping, white balance, gamma, chroma subsampling to UYVY.
class CameraRenderer final : public Sight {
 public:
  /// Builds the scene. The light map of the static room (walls, obstacles, clutter; one per light
  /// group, independent of the seed) is baked, or read from `cache_dir` under a hash of the scene.
  /// @param while_baking  called some twenty times a second; may throw to stop; may be empty.
  /// @throws std::runtime_error when Embree cannot start.
  CameraRenderer(const world::World& world, const world::CameraTruth& camera,
                 const world::LightConditions& light, std::uint64_t seed,
                 const std::filesystem::path& cache_dir, int bake_threads,
                 const std::function<void()>& while_baking = {});
  ~CameraRenderer() override;

  /// One frame, `stored_width * stored_height * 2` bytes of UYVY.
  ///
  /// @param t_start  when the first stored line begins its exposure [s]; the last line's exposure
  ///     ends at t_start + readout + exposure.
  /// @param history  body poses, ascending in t, covering that span; interpolated between.
  /// Same arguments, same bytes: no clock, random numbers by (frame, pixel, sample).
  void render(std::uint32_t frame, double t_start, std::span<const BodyPose> history,
              std::vector<std::uint8_t>& uyvy);

  /// The next picture meters its own light, as the first does: for pictures that do not follow each
  /// other.
  void meter_anew();

  /// Which gate's coloured frame is in the middle of each pixel of such a frame, upright, line by
  /// line: 1 for the world's first gate, 255 for a false one, 0 for everything else.
  [[nodiscard]] std::vector<std::uint8_t> gate_mask(double t_start,
                                                    std::span<const BodyPose> history) const;

  [[nodiscard]] bool occluded(const Eigen::Vector3d& from_E,
                              const Eigen::Vector3d& to_E) const override;
  [[nodiscard]] double range(const Eigen::Vector3d& from_E, const Eigen::Vector3d& direction_E,
                             double max) const override;

  /// How long each line of the last frame was exposed [s].
  [[nodiscard]] double exposure() const;

  /// Seconds the bake took; 0 when it came from the cache.
  [[nodiscard]] double bake_seconds() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gatefly::sim
