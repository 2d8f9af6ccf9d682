// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/palette.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"

namespace gatefly::drawing {
namespace {

using ::testing::HasSubstr;

TEST(Palette, IsThatOfTheViewer) {
  const std::string css =
      files::read_file(std::string{std::getenv("GATEFLY_SOURCE_DIR")} + "/viewer/src/style.css");
  const std::size_t dark = css.find("prefers-color-scheme: dark"), end = css.find("* {");
  ASSERT_LT(dark, end);
  const auto expect_in = [](const std::string& part, const Palette& palette) {
    std::string ours = css_of(palette);
    ours.replace(ours.find("--page:"), 7, "--ground-page:");  // --page is another thing there
    for (std::size_t at = 0; at < ours.size();) {
      const std::size_t stop = ours.find(';', at);
      std::string one = ours.substr(at, stop - at + 1);
      one.insert(one.find(':') + 1, " ");
      EXPECT_THAT(part, HasSubstr(one));
      at = stop + 1;
    }
  };
  expect_in(css.substr(0, dark), kLight);
  expect_in(css.substr(dark, end - dark), kDark);
}

TEST(Palette, IsWrittenAsStyleSheetsWantIt) {
  EXPECT_EQ(css_of(color_of(0x0a90ff)), "#0a90ff");
  EXPECT_THAT(css_of(kLight), HasSubstr("--gate-solid:#f28a1d;"));
}

Eigen::Vector3d linear(const Color& c) {
  const auto of = [](double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  return {of(c.r), of(c.g), of(c.b)};
}

/// WCAG 2.
double contrast(const Color& a, const Color& b) {
  const Eigen::Vector3d weights{0.2126, 0.7152, 0.0722};
  const double x = weights.dot(linear(a)), y = weights.dot(linear(b));
  return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

TEST(Palette, LettersCanBeRead) {
  for (const Palette& p : {kLight, kDark})
    for (const Color& ground : {p.page, p.panel, p.well})
      for (const Color& letters : {p.ink, p.muted, p.gate, p.found, p.good, p.bad, p.warn})
        EXPECT_GE(contrast(letters, ground), 4.3) << css_of(letters) << " on " << css_of(ground);
}

/// CIELAB, D65, as somebody sees it whose eyes lack one kind of cones (Machado 2009, severity 1).
Eigen::Vector3d lab(const Color& color, const Eigen::Matrix3d& eyes) {
  const Eigen::Matrix3d to_xyz{
      {0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};
  Eigen::Vector3d xyz = to_xyz * (eyes * linear(color)).cwiseMax(0.0).cwiseMin(1.0);
  xyz = xyz.cwiseQuotient(Eigen::Vector3d{0.9505, 1.0, 1.089});
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
  return {116.0 * f(xyz.y()) - 16.0, 500.0 * (f(xyz.x()) - f(xyz.y())),
          200.0 * (f(xyz.y()) - f(xyz.z()))};
}

TEST(Palette, ColourBlindPeopleTellTheCurvesOfAPlotApart) {
  const std::array<Eigen::Matrix3d, 4> eyes{Eigen::Matrix3d::Identity(),
                                            Eigen::Matrix3d{{0.152286, 1.052583, -0.204868},
                                                            {0.114503, 0.786281, 0.099216},
                                                            {-0.003882, -0.048116, 1.051998}},
                                            Eigen::Matrix3d{{0.367322, 0.860646, -0.227968},
                                                            {0.280085, 0.672501, 0.047413},
                                                            {-0.011820, 0.042940, 0.968881}},
                                            Eigen::Matrix3d{{1.255528, -0.076749, -0.178779},
                                                            {-0.078411, 0.930809, 0.147602},
                                                            {0.004733, 0.691367, 0.303900}}};
  // Further curves have marks of their own, too.
  const std::array<Color, 3> curves{kLight.found, kLight.gate_solid, kLight.ink};
  for (const Eigen::Matrix3d& eye : eyes)
    for (std::size_t i = 0; i < curves.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_GT((lab(curves[i], eye) - lab(curves[j], eye)).norm(), 25.0)
            << css_of(curves[i]) << " " << css_of(curves[j]);
}

}  // namespace
}  // namespace gatefly::drawing
