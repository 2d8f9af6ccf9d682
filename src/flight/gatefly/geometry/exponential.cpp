// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/exponential.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace gatefly {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kLog2E = 1.44269504088896340736;
// ln 2 in two parts: whole multiples of the first up to 2^11 are exact.
constexpr double kLn2High = 0x1.62e42fep-1;
constexpr double kLn2Low = 1.8206359985041462e-09;
constexpr double kSmallest = std::numeric_limits<double>::min();

constexpr int kBias = 1023, kDigits = 52;

/// 2^k, k in -1022..1023.
double power_of_two(int k) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(k + kBias) << kDigits);
}

/// x = mantissa 2^exponent with a mantissa in [0.7071, 1.4143).
struct Parts {
  double mantissa;
  int exponent;
};

/// Mantissa and exponent of a positive, finite number.
Parts parts_of(double x) {
  int shifted = 0;
  if (x < kSmallest) x *= 0x1p54, shifted = -54;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  int exponent = static_cast<int>(bits >> kDigits) - kBias;
  constexpr std::uint64_t kFraction = (std::uint64_t{1} << kDigits) - 1;
  double mantissa =
      std::bit_cast<double>((bits & kFraction) | std::uint64_t{kBias} << kDigits);  // [1, 2)
  if (mantissa > 1.41421356237309504880) mantissa *= 0.5, ++exponent;
  return {mantissa, exponent + shifted};
}

/// ln(1 + f) for 1 + f in [0.7071, 1.4143): with s = f / (2 + f) it is 2 s + 2 s³/3 + 2 s⁵/5 + ...
double log_near_one(double f) {
  const double s = f / (2.0 + f), s2 = s * s;
  double sum = 0.0;
  for (int n = 23; n >= 3; n -= 2) sum = (sum + 2.0 / n) * s2;
  // 2 s = f - s f: what is rounded is the small part.
  return f - s * (f - sum);
}

}  // namespace

double exp(double x) {
  if (!(x > -708.0)) return x == x ? 0.0 : x;
  if (x > 709.78) return kInfinity;
  const double k = std::floor(x * kLog2E + 0.5);
  const double r = (x - k * kLn2High) - k * kLn2Low;  // |r| <= ln 2 / 2
  // Taylor series: the first term left out is below 1e-17.
  double sum = 0.0;
  for (int n = 13; n >= 2; --n) sum = (1.0 + sum) * (r / n);
  const double value = 1.0 + (r + r * sum);
  // In two steps: 2^1024 is no number.
  const int whole = static_cast<int>(k), half = whole / 2;
  return value * power_of_two(half) * power_of_two(whole - half);
}

double log(double x) {
  if (!(x > 0.0)) return x == 0.0 ? -kInfinity : kNoNumber;
  if (x == kInfinity) return x;
  const auto [mantissa, exponent] = parts_of(x);
  return exponent * kLn2High + (log_near_one(mantissa - 1.0) + exponent * kLn2Low);
}

double log2(double x) {
  if (!(x > 0.0)) return x == 0.0 ? -kInfinity : kNoNumber;
  if (x == kInfinity) return x;
  const auto [mantissa, exponent] = parts_of(x);
  return exponent + log_near_one(mantissa - 1.0) * kLog2E;
}

double cbrt(double x) {
  if (x == 0.0 || !std::isfinite(x)) return x;
  const auto [mantissa, exponent] = parts_of(std::abs(x));
  // mantissa 2^exponent = y 2^(3 third), y in [0.7071, 5.66).
  const int third = exponent >= 0 ? exponent / 3 : -((2 - exponent) / 3);
  const double y = mantissa * power_of_two(exponent - 3 * third);
  // Newton's method; a straight line is within 0.2 to begin with, each step squares that.
  double root = 0.75 + 0.19 * y;
  for (int step = 0; step < 6; ++step) root -= (root - y / (root * root)) / 3.0;
  return std::copysign(root * power_of_two(third), x);
}

}  // namespace gatefly
