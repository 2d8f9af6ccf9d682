// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/camera_file.hpp"

#include <gtest/gtest.h>

#include "gatefly/config/config.hpp"

#include "calibration/synthetic_board.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::calibration {
namespace {

using gatefly::test::error_of;
using gatefly::test::TempFolder;
using test::kSize;
using test::typical_lens;

void expect_same(const CameraFile& a, const CameraFile& b) {
  EXPECT_EQ(a.size_px, b.size_px);
  const LensParameters left = parameters_of(a.lens), right = parameters_of(b.lens);
  EXPECT_EQ(name_of(left.model), name_of(right.model));
  EXPECT_EQ(left.parameters, right.parameters);
}

/// @returns what is read from a file with this text.
CameraFile read(const TempFolder& folder, const std::string& name, const std::string& text,
                const std::string& camera = "") {
  return read_camera(folder.file(name, text), camera);
}

const CameraFile kKannalaBrandtCamera{typical_lens(LensModel::kKannalaBrandt), kSize, 0, {}};
const CameraFile kPinholeCamera{typical_lens(LensModel::kPinhole), kSize, 0, {}};
const CameraFile kBrownCamera{typical_lens(LensModel::kBrownConrady), kSize, 0, {}};
const CameraFile kRadtanCamera{
    {BrownConrady{{400.0, 405.0}, {322.0, 236.0}, {-0.28, 0.09, 0.001, -0.0008, 0.0}}},
    kSize,
    0,
    {}};
const CameraFile kDhaneCamera{typical_lens(LensModel::kDhane), kSize, 90, 0.3490658503988659};

TEST(CameraFile, EveryFormatGivesBackWhatItCanHold) {
  const TempFolder folder;
  for (const CameraFile& camera : {kKannalaBrandtCamera, kPinholeCamera, kRadtanCamera}) {
    expect_same(read(folder, "kalibr.yaml", camera_text(camera, CameraFormat::kKalibr)), camera);
    expect_same(read(folder, "ros.yaml", camera_text(camera, CameraFormat::kRos)), camera);
    expect_same(read(folder, "ours.toml", camera_text(camera, CameraFormat::kToml)), camera);
  }
  expect_same(read(folder, "ros.yaml", camera_text(kBrownCamera, CameraFormat::kRos)),
              kBrownCamera);
  expect_same(read(folder, "ours.toml", camera_text(kBrownCamera, CameraFormat::kToml)),
              kBrownCamera);
  const CameraFile back =
      read(folder, "ours.toml", camera_text(kDhaneCamera, CameraFormat::kToml, {"A comment."}));
  expect_same(back, kDhaneCamera);
  EXPECT_EQ(back.stored_rotation_deg, 90);
  ASSERT_TRUE(back.tilt_down);
  EXPECT_NEAR(*back.tilt_down, *kDhaneCamera.tilt_down, 1e-7);
}

TEST(CameraFile, OursIsAConfiguration) {
  const TempFolder folder;
  const auto path =
      folder.file("camera.toml", camera_text(kKannalaBrandtCamera, CameraFormat::kToml));
  const config::Config config = config::load_config(std::vector{path});
  EXPECT_EQ(config.camera.width, 640);
  EXPECT_EQ(config.camera.stored_rotation_deg, 0);
  EXPECT_EQ(parameters_of(config.pilot.camera.lens).parameters,
            parameters_of(kKannalaBrandtCamera.lens).parameters);
}

TEST(CameraFile, ALensThatAFormatHasNoPlaceForIsRefused) {
  const auto refusal = [](const CameraFile& camera, CameraFormat format) {
    return error_of([&] { (void)camera_text(camera, format); });
  };
  EXPECT_NE(refusal(kDhaneCamera, CameraFormat::kKalibr).find("Dhane"), std::string::npos);
  EXPECT_NE(refusal(kDhaneCamera, CameraFormat::kRos).find("Dhane"), std::string::npos);
  EXPECT_NE(refusal(kBrownCamera, CameraFormat::kKalibr).find("k3"), std::string::npos);
  EXPECT_EQ(refusal(kBrownCamera, CameraFormat::kRos), "");
}

// As Kalibr writes it, with what we do not need.
constexpr auto kCamchain = R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0002, 1.8e-05]
  distortion_model: radtan
  intrinsics: [458.6, 457.3, 367.2, 248.4]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.11]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [0.01, -0.02, 0.03, -0.004]
  distortion_model: equidistant
  intrinsics: [457.5, 456.1, 379.9, 255.2]
  resolution: [752, 480]
)";

TEST(CameraFile, ACamchainsCamerasAreToldApart) {
  const TempFolder folder;
  EXPECT_NE(error_of([&] { (void)read(folder, "c.yaml", kCamchain); }).find("cam0, cam1"),
            std::string::npos);
  EXPECT_NE(error_of([&] { (void)read(folder, "c.yaml", kCamchain, "cam2"); }).find("cam2"),
            std::string::npos);
  EXPECT_TRUE(
      std::holds_alternative<BrownConrady>(read(folder, "c.yaml", kCamchain, "cam0").lens.model));
  const auto fisheye =
      std::get<KannalaBrandt>(read(folder, "c.yaml", kCamchain, "cam1").lens.model);
  EXPECT_EQ(fisheye.center_px, Eigen::Vector2d(379.9, 255.2));
  EXPECT_EQ(fisheye.radial.coefficients()[3], -0.004);
}

TEST(CameraFile, ARosMessageIsReadAsWell) {
  const TempFolder folder;
  const auto camera =
      read(folder, "m.yaml",
           "header: {frame_id: cam}\nheight: 480\nwidth: 640\ndistortion_model: plumb_bob\n"
           "d: [-0.3, 0.1, 0.001, 0.002, 0.0]\nk: [400.0, 0.0, 320.0, 0.0, 401.0, 240.0, 0.0, 0.0, "
           "1.0]\n");
  EXPECT_EQ(camera.size_px, kSize);
  EXPECT_EQ(std::get<BrownConrady>(camera.lens.model).distortion()[1], 0.1);
}

TEST(CameraFile, WhatIsWrongIsNamed) {
  const TempFolder folder;
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = camera_text(kBrownCamera, CameraFormat::kRos);
    text.replace(text.find(from), from.size(), to);
    return error_of([&] { (void)read(folder, "x.yaml", text); });
  };
  EXPECT_NE(with("plumb_bob", "rational_polynomial").find("rational_polynomial"),
            std::string::npos);
  EXPECT_NE(with("image_width: 640", "image_width: wide").find("image_width"), std::string::npos);
  EXPECT_NE(with("400.0, 0.0", "400.0, 0.5").find("skew"), std::string::npos);
  EXPECT_NE(with("[-0.28, 0.09, ", "[").find("distortion_coefficients"), std::string::npos);
  EXPECT_NE(with("[400.0", "[-400.0").find("above 0"), std::string::npos);
  EXPECT_NE(with("[400.0", "[.nan").find("camera_matrix"), std::string::npos);
  EXPECT_NE(error_of([&] {
              (void)read(folder, "x.yaml", "cam0: {camera_model: omni, intrinsics: [1, 2]}");
            }).find("omni"),
            std::string::npos);
  EXPECT_NE(error_of([&] { (void)read(folder, "x.yaml", "[1, 2"); }).find("no YAML"),
            std::string::npos);
  EXPECT_NE(error_of([&] { (void)read(folder, "x.yaml", "a: 1"); }).find("neither"),
            std::string::npos);
  EXPECT_NE(error_of([&] { (void)read(folder, "x.yaml", ""); }).find("neither"), std::string::npos);
  EXPECT_NE(error_of([&] {
              (void)read(folder, "x.toml", "[camera]\nmodel = \"pinhole\"\n");
            }).find("size_px"),
            std::string::npos);
}

}  // namespace
}  // namespace gatefly::calibration
