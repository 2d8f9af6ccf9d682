// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sensing/radial_polynomial.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace gatefly {
namespace {

constexpr double kFarthest = 1e6;  // as camera.cpp's kMinForward: 1e-6 rad from the lens plane
// Halving 1e6 down to the last bit of 1e-3 takes 83: 30 to the size of 1e-3, 53 to its last bit.
constexpr int kMaxSteps = 200;
static_assert(kFarthest / 1e-3 < 1 << 30 && 30 + std::numeric_limits<double>::digits <= kMaxSteps);
constexpr std::size_t kSlopeDegree = 8;  // of g'
static_assert(kSlopeDegree == 2 * std::tuple_size_v<RadialPolynomial::Coefficients>);

double value_of(std::span<const double> c, double r) {
  double sum = 0.0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * r + c[i];
  return sum;
}

struct Roots {
  std::array<double, kSlopeDegree> at{};
  std::size_t count = 0;
};

/// The r in (0, end) at which c[0] + c[1] r + ... changes its sign, ascending.
/// Between two roots of the derivative there is at most one, and halving cannot miss it.
Roots sign_changes(std::span<const double> c, double end) {
  Roots roots;
  if (c.size() < 2) return roots;
  std::array<double, kSlopeDegree> derivative{};
  for (std::size_t i = 1; i < c.size(); ++i) derivative[i - 1] = static_cast<double>(i) * c[i];
  const Roots turns = sign_changes({derivative.data(), c.size() - 1}, end);

  double from = 0.0;
  for (std::size_t i = 0; i <= turns.count; ++i) {
    const double to = i < turns.count ? turns.at[i] : end;
    double low = from, high = to;
    from = to;
    const bool positive = value_of(c, low) > 0.0;
    if (positive == (value_of(c, high) > 0.0)) continue;
    for (int step = 0; step < kMaxSteps; ++step) {
      const double middle = 0.5 * (low + high);
      ((value_of(c, middle) > 0.0) == positive ? low : high) = middle;
    }
    roots.at[roots.count++] = low;
  }
  return roots;
}

}  // namespace

RadialPolynomial::RadialPolynomial(const Coefficients& k, double margin)
    : k_{k}, limit_{kFarthest} {
  // g'(r) - margin r
  const std::array<double, kSlopeDegree + 1> c{1.0, -margin,  3 * k[0], 0.0,     5 * k[1],
                                               0.0, 7 * k[2], 0.0,      9 * k[3]};
  const Roots roots = sign_changes(c, kFarthest);
  if (roots.count > 0) limit_ = roots.at[0];
  if (!std::all_of(c.begin(), c.end(), [](double each) { return std::isfinite(each); }))
    limit_ = 0.0;
}

double RadialPolynomial::factor(double r_squared) const {
  const double s = r_squared;
  return 1.0 + s * (k_[0] + s * (k_[1] + s * (k_[2] + s * k_[3])));
}

double RadialPolynomial::factor_slope(double r_squared) const {
  const double s = r_squared;
  return k_[0] + s * (2 * k_[1] + s * (3 * k_[2] + s * 4 * k_[3]));
}

std::optional<double> RadialPolynomial::inverse(double value) const {
  if (!(value >= 0.0 && value < (*this)(limit_))) return std::nullopt;
  double low = 0.0, high = limit_, r = std::min(value, 0.5 * limit_), last = high;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double error = (*this)(r)-value;
    (error > 0.0 ? high : low) = r;
    const double slope = factor(r * r) + 2.0 * r * r * factor_slope(r * r);
    double next = r - error / slope;
    const bool dawdles = !(std::abs(next - r) < 0.5 * last);
    if (!(next >= low && next <= high) || dawdles) next = 0.5 * (low + high);
    last = std::abs(next - r);
    r = next;
    if (last <= 1e-16 * r || error == 0.0) break;
  }
  return r;
}

}  // namespace gatefly
