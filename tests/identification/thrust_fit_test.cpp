// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/identification/thrust_fit.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rng.hpp"

#include "support/generators.hpp"

namespace gatefly::identification {
namespace {

struct ThrustDrone {
  double hover = 0.25, exponent = 1.6, lag = 0.05, bias = -0.3;
  double swing = 0.1;  ///< Swing of the throttle, relative.
  double noise = 0.5;  ///< Noise of the accelerometer [m/s²].
  double sag = 0.0;    ///< Loss of thrust with the throttle: a battery's under more load.
  double gust = 0.1;   ///< Slow changes, like air that goes up [m/s²].
};

/// So many seconds at 100 Hz, throttle to and fro.
std::vector<ThrustPoint> flown(const ThrustDrone& drone, double seconds, Rng& rng) {
  std::vector<ThrustPoint> points;
  double v_down = 0.0, air = 0.0;
  const double phase = rng.uniform(0.0, 6.0);
  const auto throttle = [&](double t) {
    return drone.hover *
           (1.0 + drone.swing * std::sin(2.1 * t + phase) + 0.5 * drone.swing * std::sin(0.7 * t));
  };
  for (int i = 0; i < static_cast<int>(100.0 * seconds); ++i) {
    const double t = 0.01 * i;
    air += 0.01 * (-air / 1.5) + 0.1 * drone.gust * std::sqrt(2.0 / 1.5) * test::normal(rng);
    const double asked = throttle(t - drone.lag) / drone.hover;
    const double accel =
        kGravity * std::pow(asked, drone.exponent) * (1.0 - drone.sag * (asked - 1.0)) + air;
    v_down += 0.01 * (kGravity - accel);
    points.push_back({.t = t,
                      .command = throttle(t),
                      .accel = accel - drone.bias + drone.noise * test::normal(rng),
                      .upright = 1.0,
                      .v_down = v_down});
  }
  return points;
}

TEST(ThrustFit, FindsHoverExponentLagAndBiasOfAFlight) {
  Rng rng{1001};
  const auto fit = fit_thrust(flown({}, 30.0, rng));
  ASSERT_TRUE(fit && fit->exponent);
  EXPECT_NEAR(fit->hover.value, 0.25, 0.005);
  EXPECT_NEAR(fit->exponent->value, 1.6, 0.1);
  EXPECT_NEAR(fit->lag, 0.05, 0.03);
  EXPECT_NEAR(fit->accel_bias, -0.3, 0.05);
  EXPECT_LT(fit->exponent->sigma, 0.15);
}

TEST(ThrustFit, ItsSigmasHoldInOneHundredFlights) {
  int exponent = 0, hover = 0, said = 0;
  double exponent2 = 0.0;
  for (std::uint64_t seed = 1001; seed < 1101; ++seed) {
    Rng rng{seed};
    const ThrustDrone drone{.hover = rng.uniform(0.2, 0.3),
                            .exponent = rng.uniform(1.2, 2.0),
                            .sag = 0.1 * test::normal(rng)};
    const auto fit = fit_thrust(flown(drone, 25.0, rng));
    ASSERT_TRUE(fit);
    hover += std::abs(fit->hover.value - drone.hover) < 3.0 * fit->hover.sigma;
    if (!fit->exponent) continue;
    ++said;
    const double z = (fit->exponent->value - drone.exponent) / fit->exponent->sigma;
    exponent += std::abs(z) < 3.0, exponent2 += z * z;
  }
  EXPECT_GE(hover, 95);
  EXPECT_GE(said, 95);
  EXPECT_GE(exponent, said * 95 / 100);
  EXPECT_GT(exponent2 / said, 0.3);  // not wider than they need be
  EXPECT_LT(exponent2 / said, 2.0);
}

TEST(ThrustFit, WhoOnlyHoversLearnsHoverAndNoExponent) {
  Rng rng{1002};
  const auto fit = fit_thrust(flown({.swing = 0.002}, 20.0, rng));
  ASSERT_TRUE(fit);
  EXPECT_FALSE(fit->exponent);
  EXPECT_NEAR(fit->hover.value, 0.25, 3.0 * fit->hover.sigma);
}

TEST(ThrustFit, AMomentIsTooShort) {
  Rng rng{1003};
  EXPECT_FALSE(fit_thrust(flown({}, 2.0, rng)));
  EXPECT_FALSE(fit_thrust({}));
}

}  // namespace
}  // namespace gatefly::identification
