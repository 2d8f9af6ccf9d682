// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "gatefly/sim/camera.hpp"
#include "gatefly/sim/detector_statistics.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/sim/sight.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::sim {

/// A gate in a picture, as a perfect detector would mark it.
struct GateView {
  int gate = 0;                     ///< Index into the world's gates.
  double distance = 0.0;            ///< From the camera to its centre [m].
  bool whole = false;               ///< All four corners are in the picture and in sight.
  bool only_lower_corners = false;  ///< The lower two are, the upper two are above the picture.
  std::array<Eigen::Vector2d, 4> corners_px{};  ///< Outer ones, clockwise from top-left as seen.
  std::array<bool, 4> seen{};                   ///< In the picture, and nothing before it.
  /// Middle of the left and right bar's part in view.
  std::optional<std::array<Eigen::Vector2d, 2>> bars_px;
};

/// What an ideal detector gives for one picture.
struct SeenPicture {
  struct Gate {
    std::array<Eigen::Vector2d, 4> corners_px;
    double fitness = 1.0;
  };
  struct Pair {
    Eigen::Vector2d left_px, right_px;
  };
  std::vector<Gate> gates;    ///< Nearest first, then what is no gate.
  std::optional<Pair> lower;  ///< The outer lower corners of a gate cut off above.
  std::optional<Pair> bars;   ///< A near gate's side bars.
};

/// Which gates the camera sees, and where. Each corner at the time its own column is exposed.
///
/// @param t_start  when the first column begins its exposure [s].
/// @param history  body poses, ascending in t, covering the exposure.
[[nodiscard]] std::vector<GateView> gates_in_view(const World& world, const CameraTruth& camera,
                                                  const Sight& sight, double t_start,
                                                  std::span<const BodyPose> history);

/// Whether a whole gate is big and square enough for the detector to be asked for it.
[[nodiscard]] bool detectable(const std::array<Eigen::Vector2d, 4>& corners_px);

/// Detections without pictures: what is in view, with the misses, errors and false alarms of a
/// detector.
///
/// Blind to gates of a colour that the pilot does not look for. One picture is independent of the next: a real detector's misses come in rows
/// (docs/simulation.md).
class IdealVision {
 public:
  /// @param sight  must live as long.
  IdealVision(const World& world, const CameraTruth& camera, const IdealVisionParams& params,
              std::uint64_t seed, const Sight& sight);

  [[nodiscard]] SeenPicture look(double t_start, std::span<const BodyPose> history);

 private:
  [[nodiscard]] Eigen::Vector2d noisy(const Eigen::Vector2d& px, double sigma_px);
  [[nodiscard]] Eigen::Vector2d outlier();
  [[nodiscard]] std::vector<GateView> with_outliers(std::vector<GateView> views, double t_start,
                                                    std::span<const BodyPose> history);
  void add_whole_gates(const std::vector<GateView>& views, SeenPicture& seen);
  void add_parts(const std::vector<GateView>& views, SeenPicture& seen);
  void add_false_alarm(SeenPicture& seen);

  World world_;
  CameraTruth camera_;
  DetectorStatistics statistics_;
  double outliers_;
  const Sight& sight_;
  Stream stream_;
};

}  // namespace gatefly::sim
