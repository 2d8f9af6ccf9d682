// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gatefly {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDegree = kPi / 180.0;  ///< 5 * kDegree is five degrees in radians.
inline constexpr double kGravity = 9.81;        ///< [m/s²]

struct SinCos {
  double sin, cos;
};

/// Sine and cosine of `angle` [rad], to 1e-15 for |angle| < 1e5.
///
/// Our own, because libm's differ in the last bit from one system to the next and a race that is
/// replayed elsewhere must come out the same. Only +, -, * and floor are used.
[[nodiscard]] SinCos sincos(double angle);
[[nodiscard]] double sin(double angle);
[[nodiscard]] double cos(double angle);
[[nodiscard]] double tan(double angle);

/// Angle of the point (x, y) in (-pi, pi]; 0 at the origin.
[[nodiscard]] double atan2(double y, double x);
[[nodiscard]] double atan(double slope);
/// Arguments beyond ±1 are taken as ±1: rounding must not turn into NaN.
[[nodiscard]] double asin(double sine);
[[nodiscard]] double acos(double cosine);

/// `angle` brought into (-pi, pi] by whole turns.
[[nodiscard]] double wrap_angle(double angle);

}  // namespace gatefly
