// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

namespace gatefly {

/// g(r) = r (1 + k1 r² + k2 r⁴ + k3 r⁶ + k4 r⁸) from r = 0 to where it stops growing.
///
/// What polynomial lens models do to a radius or an angle. Beyond limit() g folds back, so that one
/// image point would have several directions: no lens does that, only its fitted polynomial.
class RadialPolynomial {
 public:
  using Coefficients = std::array<double, 4>;  ///< k1, k2, k3, k4.

  RadialPolynomial() : RadialPolynomial(Coefficients{}) {}
  /// Finds the limit: the one costly step. A coefficient that is not finite gives limit 0.
  /// @param margin  >= 0; the limit is where g'(r) falls to margin * r instead of 0.
  explicit RadialPolynomial(const Coefficients& k, double margin = 0.0);

  [[nodiscard]] const Coefficients& coefficients() const { return k_; }
  /// The smallest r > 0 with g'(r) = margin * r; 1e6 (nearer than that to 90° nothing shows)
  /// without one.
  [[nodiscard]] double limit() const { return limit_; }

  [[nodiscard]] double factor(double r_squared) const;        ///< g(r) / r.
  [[nodiscard]] double factor_slope(double r_squared) const;  ///< Its derivative by r².
  [[nodiscard]] double operator()(double r) const { return r * factor(r * r); }
  /// The r below the limit with g(r) = value >= 0; nullopt from g(limit) on.
  /// Newton, halving the bracket where Newton would leave it or dawdle: ends within 200 steps, most
  /// often 5. Allocates nothing.
  [[nodiscard]] std::optional<double> inverse(double value) const;

 private:
  Coefficients k_;
  double limit_;
};

}  // namespace gatefly
