// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/math.hpp"

#include <cmath>
#include <limits>

namespace gatefly {
namespace {

// Taylor series on |x| <= pi/4: the first term left out is below 1e-18.
double sin_small(double x) {
  const double x2 = x * x;
  double sum = 0.0;
  for (int n = 17; n >= 3; n -= 2) sum = (1.0 + sum) * (-x2 / (n * (n - 1)));
  return x + x * sum;
}

double cos_small(double x) {
  const double x2 = x * x;
  double sum = 0.0;
  for (int n = 18; n >= 2; n -= 2) sum = (1.0 + sum) * (-x2 / (n * (n - 1)));
  return 1.0 + sum;
}

// Series on |x| <= tan(pi/16) = 0.199.
double atan_small(double x) {
  const double x2 = x * x;
  double sum = 0.0;
  for (int n = 25; n >= 1; n -= 2) sum = 1.0 / n - x2 * sum;
  return x * sum;
}

// x in [0, 1]: turned back by 0, pi/8 or pi/4 into the range of the series.
double atan_unit(double x) {
  constexpr double kTanPi8 = 0.41421356237309504880;   // tan(pi/8)
  constexpr double kTanPi16 = 0.19891236737965800691;  // tan(pi/16)
  constexpr double kTan3Pi16 = 0.66817863791929891999;
  if (x < kTanPi16) return atan_small(x);
  if (x < kTan3Pi16) return kPi / 8 + atan_small((x - kTanPi8) / (1.0 + x * kTanPi8));
  return kPi / 4 + atan_small((x - 1.0) / (x + 1.0));
}

}  // namespace

SinCos sincos(double angle) {
  // pi/2 in two parts, so that the reduction keeps the low bits.
  constexpr double kHalfPiHigh = 1.5707963267341256;     // 33 bits
  constexpr double kHalfPiLow = 6.0771005065061922e-11;  // the rest
  static_assert(kHalfPiHigh * 0x1p32 ==
                static_cast<double>(static_cast<long long>(kHalfPiHigh * 0x1p32)));
  const double turns = std::floor(angle * (2.0 / kPi) + 0.5);
  // NaN, infinity, and angles so large that whole turns take all their digits: no angle.
  constexpr double kNoAngle = std::numeric_limits<double>::quiet_NaN();
  if (!(std::abs(turns) < 1e9)) return {kNoAngle, kNoAngle};
  const double x = (angle - turns * kHalfPiHigh) - turns * kHalfPiLow;
  const double s = sin_small(x);
  const double c = cos_small(x);
  switch (static_cast<long long>(turns) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

double sin(double angle) { return sincos(angle).sin; }
double cos(double angle) { return sincos(angle).cos; }

double tan(double angle) {
  const auto [s, c] = sincos(angle);
  return s / c;
}

double atan2(double y, double x) {
  const double ax = std::abs(x);
  const double ay = std::abs(y);
  if (ax == 0.0 && ay == 0.0) return 0.0;
  double angle = ay <= ax ? atan_unit(ay / ax) : kPi / 2 - atan_unit(ax / ay);
  if (x < 0.0) angle = kPi - angle;
  return y < 0.0 ? -angle : angle;
}

double atan(double slope) { return atan2(slope, 1.0); }

double asin(double sine) {
  if (sine >= 1.0) return kPi / 2;
  if (sine <= -1.0) return -kPi / 2;
  return atan2(sine, std::sqrt((1.0 - sine) * (1.0 + sine)));
}

double acos(double cosine) { return kPi / 2 - asin(cosine); }

double wrap_angle(double angle) {
  const double wrapped = angle - 2 * kPi * std::floor(angle / (2 * kPi) + 0.5);
  return wrapped <= -kPi ? wrapped + 2 * kPi : wrapped;
}

}  // namespace gatefly
