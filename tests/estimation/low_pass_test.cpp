// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/low_pass.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/matchers.hpp"

namespace gatefly {
namespace {

using namespace test;
using Eigen::Vector3d;

// Amplitude of the answer to a unit sine, after it has settled.
double gain_at(double hz, LowPass filter, double sample_hz) {
  double sine = 0, cosine = 0;
  const int settle = 20'000, count = 40'000;
  for (int i = 0; i < settle + count; ++i) {
    const double phase = 2 * kPi * hz * i / sample_hz;
    const double y = filter.update(Vector3d::Constant(std::sin(phase))).x();
    if (i >= settle) sine += y * std::sin(phase), cosine += y * std::cos(phase);
  }
  return 2 * std::sqrt(sine * sine + cosine * cosine) / count;
}

TEST(LowPass, IsThreeDecibelsDownAtTheCutoff) {
  for (const double cutoff : {5.0, 20.0, 100.0})
    EXPECT_NEAR(20 * std::log10(gain_at(cutoff, LowPass{cutoff, 512}, 512)), -3.01, 0.03) << cutoff;
}

TEST(LowPass, PassesSlowAndStopsFast) {
  EXPECT_NEAR(gain_at(1, LowPass{20, 512}, 512), 1.0, 0.001);
  // Second order: -40 dB a decade, and more near the Nyquist rate.
  EXPECT_LT(gain_at(200, LowPass{20, 512}, 512), 0.01);
}

TEST(LowPass, AConstantComesOutUnchangedFromTheFirstSample) {
  LowPass filter{20, 512};
  const Vector3d x{1, -2, 9.81};
  for (int i = 0; i < 2000; ++i) EXPECT_THAT(filter.update(x), IsNear(x, 1e-10)) << i;
}

TEST(LowPass, AStepEndsAtItsHeightWithFourPercentOvershoot) {
  LowPass filter{20, 512};
  (void)filter.update(Vector3d::Zero());
  double peak = 0, last = 0;
  for (int i = 0; i < 2000; ++i) peak = std::max(peak, last = filter.update(Vector3d::Ones()).y());
  EXPECT_NEAR(last, 1.0, 1e-12);
  EXPECT_NEAR(peak, 1.0432, 0.005) << "Butterworth, second order";
}

TEST(LowPass, IsLinearAndItsAxesDoNotMeet) {
  LowPass a{11, 512, 0.7}, b{11, 512, 0.7};
  for (int i = 0; i < 300; ++i) {
    const Vector3d x{std::sin(0.1 * i), std::cos(0.3 * i), i % 7 == 0 ? 1.0 : 0.0};
    EXPECT_THAT(b.update(2 * x), IsNear(Vector3d{2 * a.update(x)}, 1e-12));
  }
}

}  // namespace
}  // namespace gatefly
