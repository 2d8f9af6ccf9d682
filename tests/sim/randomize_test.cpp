// SPDX-License-Identifier: Apache-2.0
#include "gatefly/sim/randomize.hpp"

#include <variant>

#include <gtest/gtest.h>

namespace gatefly::sim {
namespace {

SimConfig with(const AnyCamera& lens) {
  SimConfig config;
  config.camera.lens = lens;
  return config;
}

Randomize lens_only() {
  Randomize sigma;
  sigma.camera_focal = 0.01, sigma.camera_center_px = 2.0, sigma.camera_k = 0.02;
  return sigma;
}

TEST(Randomize, WithoutSizesLeavesEveryLensAlone) {
  const RadialPolynomial radial{{-0.3, 0.1, 0.02, 0}};
  for (const AnyCamera& lens :
       {AnyCamera{DhaneFisheye{}}, AnyCamera{Pinhole{}},
        AnyCamera{BrownConrady{{168, 168}, {157, 124}, {-0.3, 0.1, 0.001, 0.002, 0.02}}},
        AnyCamera{KannalaBrandt{.radial = radial}}})
    EXPECT_EQ(drawn(with(lens), {}, 7).camera.lens.project({0.3, 0.2, 1}),
              lens.project({0.3, 0.2, 1}));
}

TEST(Randomize, DrawsFocalLengthCentreAndFirstCoefficientOfPolynomialLenses) {
  const BrownConrady nominal{{168, 168}, {157, 124}, {-0.3, 0.1, 0.001, 0.002, 0.02}};
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto real =
        std::get<BrownConrady>(drawn(with({nominal}), lens_only(), seed).camera.lens.model);
    const auto k = real.distortion();
    EXPECT_NE(k[0], -0.3);
    EXPECT_NEAR(k[0], -0.3, 0.3 * 0.02 * 2.5) << "a part of itself, cut at 2.5 sigma";
    EXPECT_EQ(k, (BrownConrady::Coefficients{k[0], 0.1, 0.001, 0.002, 0.02}));
    EXPECT_NE(real.focal_px, nominal.focal_px);
    EXPECT_NEAR(real.focal_px.x(), 168, 168 * 0.025 + 1e-9);
    EXPECT_NE(real.center_px, nominal.center_px);
  }
}

TEST(Randomize, GivesEveryModelTheSameDayButItsOwnDistortion) {
  const auto dhane =
      std::get<DhaneFisheye>(drawn(with({DhaneFisheye{}}), lens_only(), 3).camera.lens.model);
  const auto fisheye = std::get<KannalaBrandt>(
      drawn(with({KannalaBrandt{.radial = RadialPolynomial{{0.1, 0, 0, 0}}}}), lens_only(), 3)
          .camera.lens.model);
  EXPECT_EQ(dhane.focal_px, fisheye.focal_px);
  EXPECT_EQ(dhane.center_px, fisheye.center_px);
  EXPECT_NEAR(fisheye.radial.coefficients()[0], 0.1 * (1.0 + dhane.k - DhaneFisheye{}.k), 1e-15);
}

}  // namespace
}  // namespace gatefly::sim
