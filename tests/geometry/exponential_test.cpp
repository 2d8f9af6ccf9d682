// SPDX-License-Identifier: Apache-2.0
#include "gatefly/geometry/exponential.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "gatefly/geometry/rng.hpp"

namespace gatefly {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The largest error over random arguments, in units of the last place of the true value.
double worst_ulp(const std::function<double(double)>& ours,
                 const std::function<long double(long double)>& truth,
                 const std::function<double(Rng&)>& draw) {
  Rng rng{1};
  double worst = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const double x = draw(rng);
    const long double wanted = truth(x);
    const double near = static_cast<double>(wanted);
    const double ulp = std::nextafter(std::abs(near), kInfinity) - std::abs(near);
    worst = std::max(worst, std::abs(static_cast<double>(ours(x) - wanted)) / ulp);
  }
  return worst;
}

double between(Rng& rng, double low, double high) { return rng.uniform(low, high); }

TEST(Exponential, ExpIsRightToTheLastPlace) {
  const auto truth = [](long double x) { return std::exp(x); };
  EXPECT_LT(worst_ulp(gatefly::exp, truth, [](Rng& r) { return between(r, -1.0, 1.0); }), 1.0);
  EXPECT_LT(worst_ulp(gatefly::exp, truth, [](Rng& r) { return between(r, -700.0, 700.0); }), 1.1);
}

TEST(Exponential, LogarithmsAreRightToTheLastPlace) {
  const auto wide = [](Rng& r) { return std::exp2(between(r, -1000.0, 1000.0)); };
  const auto near_one = [](Rng& r) { return between(r, 0.5, 2.0); };
  const auto ln = [](long double x) { return std::log(x); };
  EXPECT_LT(worst_ulp(gatefly::log, ln, wide), 1.0);
  EXPECT_LT(worst_ulp(gatefly::log, ln, near_one), 1.5);
  const auto lb = [](long double x) { return std::log2(x); };
  EXPECT_LT(worst_ulp(gatefly::log2, lb, wide), 1.5);
  EXPECT_LT(worst_ulp(gatefly::log2, lb, near_one), 2.5);
}

TEST(Exponential, CubeRootsAreRightToTheLastPlace) {
  const auto truth = [](long double x) { return std::cbrt(x); };
  EXPECT_LT(worst_ulp(gatefly::cbrt, truth, [](Rng& r) { return between(r, -100.0, 100.0); }), 1.5);
  EXPECT_LT(worst_ulp(gatefly::cbrt, truth,
                      [](Rng& r) { return std::exp2(between(r, -1000.0, 1000.0)); }),
            1.5);
}

TEST(Exponential, ExactValuesAreExact) {
  EXPECT_EQ(gatefly::exp(0.0), 1.0);
  EXPECT_EQ(gatefly::log(1.0), 0.0);
  for (int k = -1074; k < 1024; k += 7) EXPECT_EQ(gatefly::log2(std::ldexp(1.0, k)), k);
  for (const double whole : {1.0, 2.0, -3.0, 10.0})
    EXPECT_EQ(gatefly::cbrt(whole * whole * whole), whole);
}

TEST(Exponential, TheEndsOfNumbersAreInfinityZeroOrNone) {
  EXPECT_EQ(gatefly::exp(-kInfinity), 0.0);
  EXPECT_EQ(gatefly::exp(-1e9), 0.0);
  EXPECT_EQ(gatefly::exp(710.0), kInfinity);
  EXPECT_EQ(gatefly::exp(kInfinity), kInfinity);
  EXPECT_TRUE(std::isfinite(gatefly::exp(709.7)));
  EXPECT_EQ(gatefly::log(0.0), -kInfinity);
  EXPECT_EQ(gatefly::log2(0.0), -kInfinity);
  EXPECT_EQ(gatefly::log(kInfinity), kInfinity);
  EXPECT_EQ(gatefly::cbrt(-kInfinity), -kInfinity);
  EXPECT_EQ(gatefly::cbrt(0.0), 0.0);
  for (const double none : {-1.0, std::nan("")}) {
    EXPECT_TRUE(std::isnan(gatefly::log(none)));
    EXPECT_TRUE(std::isnan(gatefly::log2(none)));
  }
  EXPECT_TRUE(std::isnan(gatefly::exp(std::nan(""))));
}

}  // namespace
}  // namespace gatefly
