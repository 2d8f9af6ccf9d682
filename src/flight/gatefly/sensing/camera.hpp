// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <optional>
#include <variant>

#include <Eigen/Core>

#include "gatefly/sensing/radial_polynomial.hpp"

namespace gatefly {

/// Maps between pixels (u right, v down, upright picture) [px] and the camera frame C (right, down,
/// forward).
///
/// - project: point in C [m] to pixel; nullopt behind the lens or outside the model's field of
///   view. The picture's border is not the model's business.
/// - bearing: pixel to unit vector in C; nullopt outside the model's field of view.
template <class Model>
concept Camera = requires(const Model& model, const Eigen::Vector3d& p_C,
                          const Eigen::Vector2d& px) {
  { model.project(p_C) } -> std::same_as<std::optional<Eigen::Vector2d>>;
  { model.bearing(px) } -> std::same_as<std::optional<Eigen::Vector3d>>;
};

/// Li18 Eq. (2)-(5): a straight lens.
struct Pinhole {
  Eigen::Vector2d focal_px{168.0, 168.0};
  Eigen::Vector2d center_px{157.0, 124.0};
  [[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_C) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> bearing(const Eigen::Vector2d& px) const;
};

/// The Bebop's fisheye: one parameter on the sine of the angle. Dhane et al. 2012; Li18 §3.2.
///
/// A straight lens would draw a point at radius R, this one at r:
///   R = f tan(asin(k sin(atan(r/f)))), r = f tan(asin(sin(atan(R/f)) / k)).
/// k > 1 sees wider than straight; k = 1 is the pinhole. Undefined once k sin(atan(r/f)) >= 1, that
/// is, 90° from the axis: both directions answer nullopt there.
struct DhaneFisheye {
  Eigen::Vector2d focal_px{168.0, 168.0};  ///< [Li18 flight code]
  /// 35 px above the lower border. [fit on flights 3, 4, 10]
  Eigen::Vector2d center_px{157.0, 124.0};
  double k = 1.08;  ///< [fit on flights 3, 4, 10: 1.03-1.08]
  [[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_C) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> bearing(const Eigen::Vector2d& px) const;
};

/// A straight lens with radial and tangential distortion: most cameras' calibration. Brown 1966;
/// OpenCV's calib3d, Kalibr's radtan (k3 = 0), Matlab's cameraParameters (pixels there count from
/// 1).
///
/// With (x, y) = (X/Z, Y/Z), r² = x² + y², a = 1 + k1 r² + k2 r⁴ + k3 r⁶:
///   x_d = a x + 2 p1 x y + p2 (r² + 2 x²), y_d = a y + p1 (r² + 2 y²) + 2 p2 x y.
/// Nothing shows from limit() on, where a r stops growing, a little earlier for the tangential
/// part; both directions answer nullopt there.
struct BrownConrady {
  using Coefficients = std::array<double, 5>;  ///< k1, k2, p1, p2, k3, in OpenCV's order.

  BrownConrady() = default;
  /// Finds the limit; later changes of focal length and centre leave it as it is.
  BrownConrady(const Eigen::Vector2d& focal, const Eigen::Vector2d& center,
               const Coefficients& distortion);

  Eigen::Vector2d focal_px{168.0, 168.0};
  Eigen::Vector2d center_px{157.0, 124.0};
  [[nodiscard]] Coefficients distortion() const;
  [[nodiscard]] double limit() const { return radial_.limit(); }  ///< Largest r.
  [[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_C) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> bearing(const Eigen::Vector2d& px) const;

 private:
  RadialPolynomial radial_;
  Eigen::Vector2d tangential_ = Eigen::Vector2d::Zero();
};

/// A fisheye with a polynomial of the angle θ from the axis. Kannala and Brandt 2006; OpenCV's
/// cv::fisheye, Kalibr's equidistant: θ_d = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸), drawn at f θ_d.
///
/// Nothing shows from where θ_d stops growing (radial.limit()), nor from 90° on.
struct KannalaBrandt {
  Eigen::Vector2d focal_px{168.0, 168.0};
  Eigen::Vector2d center_px{157.0, 124.0};
  RadialPolynomial radial;  ///< k1, k2, k3, k4, of θ.
  [[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_C) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> bearing(const Eigen::Vector2d& px) const;
};

static_assert(Camera<Pinhole>);
static_assert(Camera<DhaneFisheye>);
static_assert(Camera<BrownConrady>);
static_assert(Camera<KannalaBrandt>);

/// Whichever lens the configuration names, still without allocation.
struct AnyCamera {
  std::variant<DhaneFisheye, Pinhole, BrownConrady, KannalaBrandt> model;
  [[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_C) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> bearing(const Eigen::Vector2d& px) const;
};

static_assert(Camera<AnyCamera>);

/// The vanishing point of lines of direction `direction_C`, as a straight lens of the same focal
/// length would draw it; usually far outside. nullopt when they run (almost) parallel to the
/// picture.
[[nodiscard]] std::optional<Eigen::Vector2d> vanishing_point_px(const AnyCamera& lens,
                                                                const Eigen::Vector3d& direction_C);

}  // namespace gatefly
