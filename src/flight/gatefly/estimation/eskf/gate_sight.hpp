// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "gatefly/estimation/eskf/params.hpp"
#include "gatefly/estimation/eskf/state.hpp"
#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly::eskf {

/// A corner of a gate or of its opening, or a side bar, as seen.
struct Feature {
  enum class Kind : std::uint8_t { kCorner, kOpening, kBar };
  Kind kind = Kind::kCorner;
  /// Corner: 0 to 3, clockwise from the top left one; bar: 0 left, 1 right, as they show.
  std::uint8_t which = 0;
  double late = 0.0;  ///< Exposed after the middle of the gate [s].
  Eigen::Vector3d bearing_C = Eigen::Vector3d::UnitZ();      ///< By the calibration as it is.
  Eigen::Vector2d from_middle_px = Eigen::Vector2d::Zero();  ///< From the middle of all of them.
};

/// One gate in one picture: any of its corners and bars.
struct GateSight {
  enum class Quality : std::uint8_t { kWhole, kPart };  ///< A whole gate, or one that is cut off.
  double time = 0.0;                                    ///< Exposure, by the configured delay [s].
  double jitter = 0.010;  ///< Standard deviation of `time` [s]. [a tick of a driver]
  Quality quality = Quality::kWhole;
  int slot = 0;         ///< Which gate it is taken for ...
  bool behind = false;  ///< ... seen from behind.
  FixedList<Feature, 4> features;
};

/// The map's own of a gate in a slot: what no state changes.
struct GateShape {
  double side = 1.0, bar = 0.05;  ///< [m]
  double near_face = 0.0;         ///< So far before its middle are the corners that show [m].
};

/// Place of the camera and its resolution.
struct CameraModel {
  Eigen::Vector3d p_BC = Eigen::Vector3d::Zero();  ///< [m]
  double radians_per_px = 0.006;                   ///< Near the axis.
};

/// A linearised sighting: rows of residual, of a Jacobian with few columns, of noise.
struct GateRows {
  static constexpr int kColumns = 23, kMaxRows = 8;
  using Residual = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, kColumns, 0, kMaxRows, kColumns>;
  using Noise = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxRows>;
  std::array<int, kColumns> states{};  ///< Which error each column of the Jacobian is of.
  Residual residual;
  Jacobian jacobian;  ///< Derivative of the predicted measurement.
  Noise noise;
};

/// Linearises `sight`, taken `offset` [s] after belief `x`. Nullopt: the gate is not before the
/// camera.
/// @param fresh  lasting errors of the corners are another gate's: they count as noise.
[[nodiscard]] std::optional<GateRows> gate_rows(const Nominal& x, const GateSight& sight,
                                                const GateShape& gate, double offset, bool fresh,
                                                const CameraModel& camera, const SightNoise& noise);

/// Squared Mahalanobis distance of a sighting, with what tells hypotheses apart.
struct Innovation {
  double nis = 0.0;      ///< rᵀ S⁻¹ r
  double log_det = 0.0;  ///< ln|S|, but for a constant.
  int rows = 0;
};

/// How well the best explanation of `sight` explains it, `prior` and P being what is believed.
///
/// Linearised again where the explanation led to, as the update is, where it matters: a gate 2 m away
/// shows a drone that is half a metre beside its belief 15 degrees aside, and the line through the
/// belief misses its corners by ten pixels. Nullopt: the gate is not before the camera.
[[nodiscard]] std::optional<Innovation> innovation(const Nominal& prior, const Covariance& P,
                                                   const GateSight& sight, const GateShape& gate,
                                                   double offset, bool fresh,
                                                   const CameraModel& camera,
                                                   const SightNoise& noise);

/// Iterated Kalman update: linearised again where it has led to. False: nothing has changed.
bool correct_by_gate(Nominal& x, Covariance& P, const GateSight& sight, const GateShape& gate,
                     double offset, const CameraModel& camera, const SightNoise& noise);

/// Which face of which gate: what Nominal::corner_of holds.
[[nodiscard]] inline int face_of(const GateSight& sight) {
  return 2 * sight.slot + (sight.behind ? 1 : 0);
}

}  // namespace gatefly::eskf
