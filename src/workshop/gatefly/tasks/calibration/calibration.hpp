// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/tasks/calibration/board_view.hpp"
#include "gatefly/tasks/calibration/lens_fit.hpp"

namespace gatefly::calibration {

/// One model's answer.
struct ModelResult {
  LensFit fit;  ///< Over the views that were kept, in their order.
  /// Root mean square distance of all kept corners.
  double rms_px = std::numeric_limits<double>::infinity();
  /// The same in views that the lens was not fitted to.
  double held_out_px = std::numeric_limits<double>::infinity();
  std::vector<double> held_out_px2;  ///< Mean squared distance, view by view.
  std::string failure;               ///< Why it cannot be used; "" when it can.
};

/// Outcome of one view.
struct ViewResult {
  std::string image;
  std::size_t corners = 0, dropped = 0;
  double rms_px = 0.0, max_px = 0.0;  ///< Over the kept corners, chosen model.
  std::string reason;                 ///< Why the whole view was left out; "" when it was not.
};

struct Calibration {
  Eigen::Vector2i size_px;
  std::vector<ModelResult> models;  ///< In the order of kLensModels.
  std::size_t recommended = 0;      ///< Index in models.
  std::size_t chosen = 0;           ///< The same, unless another was asked for.
  std::vector<ViewResult> views;    ///< All, in their order.
  BoardViews kept;                  ///< Views and corners that the lenses were fitted to.
  /// Farthest kept corner from the picture's middle / half its diagonal.
  double coverage = 0.0;

  [[nodiscard]] const ModelResult& best() const { return models[chosen]; }
};

struct CalibrationOptions {
  std::optional<LensModel> model;  ///< Asked for; else the recommended one.
  /// Distortion coefficients that stay 0, in every model that has them.
  std::vector<std::string> zero;
  int folds = 5;  ///< Held out in turn.
  std::function<void(double part, const std::string& text)> progress = [](double,
                                                                          const std::string&) {};
};

/// Fits every lens to pictures of a flat board, leaves corners and pictures out that contradict the
/// rest, and recommends the lens with the fewest parameters whose held-out residual is within one
/// standard error of the best's.
///
/// Held out: every lens is fitted to four fifths of the views; in the others only the board's pose
/// is.
///
/// @param views  at least 5, corners in the upright picture of `size_px`.
/// @throws std::runtime_error one line, why no camera comes out: too few views, all alike, no flat
///     board.
[[nodiscard]] Calibration calibrate(BoardViews views, const Eigen::Vector2i& size_px,
                                    const CalibrationOptions& options = {});

}  // namespace gatefly::calibration
