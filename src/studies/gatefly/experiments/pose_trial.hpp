// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <optional>

#include <Eigen/Core>

#include "gatefly/detection/quad.hpp"
#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/kneip.hpp"
#include "gatefly/experiments/pnp.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/pose/gate_fix.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::experiments {

/// The camera of all simulated pose studies, as Li18's authors had it: a straight lens without
/// border, pitched down, in the body's origin. Facts of their analysis code: f 168 px, 20°.
inline constexpr double kStudyFocalPx = 168.0;
[[nodiscard]] CameraRig study_rig();

/// The outer corners of a 1 m gate seen from `p_GB`; the caller keeps them before the camera.
[[nodiscard]] Quad corners_seen_from(const Eigen::Vector3d& p_GB, const Attitude& attitude_GB,
                                     const CameraRig& rig);

/// Li18's least squares over all four corners, without the limits that flight puts on it.
[[nodiscard]] std::optional<Eigen::Vector3d> by_rays(const Quad& px, const Attitude& attitude_GB,
                                                     const CameraRig& rig, double side);
/// A baseline through the same lens; sees no attitude.
[[nodiscard]] std::optional<Eigen::Vector3d> by_pnp(Pnp method, const Quad& px,
                                                    const CameraRig& rig, double side);
/// The authors' P3P through the same lens; needs no OpenCV.
[[nodiscard]] std::optional<Eigen::Vector3d> by_kneip(const KneipRule& rule, const Quad& px,
                                                      const CameraRig& rig, double side);

/// Root mean square of errors.
struct Rmse {
  Eigen::Vector3d squares = Eigen::Vector3d::Zero(), sum = Eigen::Vector3d::Zero();
  int n = 0, none = 0;  ///< Answers, and trials without one.

  void add(const std::optional<Eigen::Vector3d>& found, const Eigen::Vector3d& truth);
  [[nodiscard]] double axis(int i) const {
    return n > 0 ? std::sqrt(squares(i) / n) : std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] double all() const {
    return n > 0 ? std::sqrt(squares.sum() / n) : std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] double bias(int i) const {
    return n > 0 ? sum(i) / n : std::numeric_limits<double>::quiet_NaN();
  }
};

/// Whether `ours` is within 10 % or 2 mm of `paper`, whichever is larger.
[[nodiscard]] bool reproduced(double ours, double paper);

/// work(i) for every i below `count` on all cores, in pieces between which `options` are asked and
/// told.
void in_pieces(std::size_t count, const Options& options,
               const std::function<void(std::size_t)>& work);

/// A legend's word for the rings of a plot, whose colours are those of our curves.
[[nodiscard]] inline drawing::PlotSeries paper_marks() {
  return {.name = "paper", .color = drawing::kLight.ink, .line = false, .rings = true};
}

}  // namespace gatefly::experiments
