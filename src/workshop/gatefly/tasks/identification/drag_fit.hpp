// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "gatefly/flight_log/flight_folder.hpp"

namespace gatefly::identification {

/// Rows [first, last) of a flight between two heights.
struct Airborne {
  std::size_t first = 0, last = 0;
};

/// From the first row above 0.9 m to the last one above 0.6 m. Empty when the log has no truth up
/// there.
[[nodiscard]] Airborne airborne(const flight_log::FlightFolder& flight);

/// Equation of a piece of flight: displacement = M (1/k_x, −b_x/k_x, 1/k_y, −b_y/k_y), on the floor
/// plan [m].
struct Displacement {
  Eigen::Matrix<double, 2, 4> M;
  Eigen::Vector2d moved;
};

/// Pieces of `length` seconds, one every 0.1 s. Li18 Eq. (14) integrated: v = K⁻¹ (a − b) in B,
/// turned by the log's own attitude with `heading_offset` [rad] added; the vertical part comes from
/// the true vertical velocity.
[[nodiscard]] std::vector<Displacement> displacements(const flight_log::FlightFolder& flight,
                                                      const Airborne& rows, double heading_offset,
                                                      double length);

struct DragFit {
  double heading_offset = 0.0;                           ///< To add to the log's heading [rad].
  Eigen::Vector2d drag = Eigen::Vector2d::Zero();        ///< k_x, k_y [1/s].
  Eigen::Vector2d drag_sigma = Eigen::Vector2d::Zero();  ///< Standard errors.
  Eigen::Vector2d bias = Eigen::Vector2d::Zero();        ///< Accelerometer's, x, y [m/s²].
  double rms = 0.0;                                      ///< Misfit of a piece's displacement [m].
  std::size_t pieces = 0;
};

/// Drag, bias and heading offset of one flight; nullopt when it has less than a second in the air.
///
/// k_y is hardly excited by straight flight: the authors' flown −0.47 1/s weighs as a third of a
/// piece.
[[nodiscard]] std::optional<DragFit> fit_drag(const flight_log::FlightFolder& flight);

/// The heading offset alone, drag known; the bias may differ a little from `fit.bias` [rad].
[[nodiscard]] double fit_heading(const flight_log::FlightFolder& flight, const DragFit& fit);

/// Mean of several flights' fits, each counting once. @param left_out  index that is not in it.
[[nodiscard]] DragFit mean_of(std::span<const DragFit> fits,
                              std::optional<std::size_t> left_out = std::nullopt);

}  // namespace gatefly::identification
