// SPDX-License-Identifier: Apache-2.0
#pragma once

// Our own, as those of math.hpp are: a libm's last bit is not the same everywhere.
namespace gatefly {

/// e to the power of x, to 1e-15 of it; 0 below -708, infinity above 709.78.
[[nodiscard]] double exp(double x);
/// Natural logarithm, to 1 in the last place; -infinity of 0, NaN below.
[[nodiscard]] double log(double x);
/// Logarithm to base 2; exact for powers of two.
[[nodiscard]] double log2(double x);
/// Cube root, also of negative numbers.
[[nodiscard]] double cbrt(double x);

}  // namespace gatefly
