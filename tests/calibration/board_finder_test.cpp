// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/board_finder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "gatefly/files/image_file.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/tasks/calibration/calibration.hpp"
#include "gatefly/tasks/calibration/lens_fit.hpp"

#include "support/real_data.hpp"

namespace gatefly::calibration {
namespace {

constexpr int kWidth = 480, kHeight = 360;
const Pinhole kLens{{400.0, 400.0}, {240.0, 180.0}};
const BoardPattern kPattern{7, 5, 0.03};  // of 8x6 squares; its first inner corner is the origin

/// A drawn picture of the board: every pixel's ray meets the board's plane.
struct Drawing {
  std::vector<std::uint8_t> rgb;
  [[nodiscard]] Image image() const {
    return Image(rgb.data(), PixelFormat::kRgb, kWidth, kHeight);
  }
};

const BoardPose kPose{{0.35, -0.3, 0.1, -0.08, -0.06, 0.28}};

Drawing draw() {
  const Eigen::Vector3d turn = kPose.head<3>(), t = kPose.tail<3>();
  const Eigen::Matrix3d R = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  Drawing drawing;
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) {
      const Eigen::Vector3d ray = *kLens.bearing({u, v});
      const double distance = R.col(2).dot(t) / R.col(2).dot(ray);
      const Eigen::Vector3d p_W = R.transpose() * (distance * ray - t) / kPattern.square;
      const bool on_board =
          p_W.x() > -1.0 && p_W.x() < kPattern.columns && p_W.y() > -1.0 && p_W.y() < kPattern.rows;
      // a square in pixels: edges are 1 px wide
      const double edge = kPattern.square * kLens.focal_px.x() / distance;
      const double checker = edge * std::sin(kPi * p_W.x()) * std::sin(kPi * p_W.y()) / kPi;
      const double grey = on_board ? 128.0 + 100.0 * std::clamp(2.0 * checker, -1.0, 1.0) : 228.0;
      drawing.rgb.insert(drawing.rgb.end(), 3, static_cast<std::uint8_t>(std::lround(grey)));
    }
  return drawing;
}

TEST(FindBoard, CornersAreFoundToATenthOfAPixel) {
  const Drawing drawing = draw();
  const BoardSearch search = find_board(drawing.image(), "a.png", kPattern);
  ASSERT_TRUE(search.view) << search.reason;
  ASSERT_EQ(search.view->corners.size(), 35U);
  std::vector<Eigen::Vector2d> truth;
  for (int i = 0; i < 35; ++i)
    truth.push_back(
        *kLens.project(in_camera(kPose, {kPattern.square * (i % 7), kPattern.square * (i / 7)})));
  for (const BoardCorner& corner : search.view->corners) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& px : truth) nearest = std::min(nearest, (px - corner.px).norm());
    EXPECT_LT(nearest, 0.1);
  }
}

TEST(FindBoard, ThePatternCountsInEitherDirection) {
  const Drawing drawing = draw();
  EXPECT_TRUE(find_board(drawing.image(), "a.png", {5, 7, 0.03}).view);
}

TEST(FindBoard, AnotherPatternIsNamed) {
  const Drawing drawing = draw();
  for (const BoardPattern& wrong : {BoardPattern{6, 5, 0.03}, BoardPattern{6, 4, 0.03},
                                    BoardPattern{8, 6, 0.03}, BoardPattern{9, 5, 0.03}}) {
    const BoardSearch search = find_board(drawing.image(), "a.png", wrong);
    EXPECT_FALSE(search.view) << wrong.text();
    ASSERT_TRUE(search.other) << wrong.text() << ": " << search.reason;
    EXPECT_EQ(search.other->text(), "7x5");
    EXPECT_NE(search.reason.find("7x5"), std::string::npos) << search.reason;
  }
}

TEST(FindBoard, APictureThatShowsNothingIsSaidTo) {
  const Drawing empty{
      std::vector<std::uint8_t>(static_cast<std::size_t>(kWidth * kHeight * 3), 90)};
  EXPECT_NE(find_board(empty.image(), "a.png", kPattern).reason.find("shows nothing"),
            std::string::npos);
}

TEST(FindBoard, AHopelesslyBlurredPictureIsSaidToBe) {
  const Drawing sharp = draw();
  Drawing drawing = sharp;
  constexpr int kHalf = 30;  // a motion over 61 px: the squares are 45 px wide
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) {
      int sum = 0;
      for (int du = -kHalf; du <= kHalf; ++du)
        sum += sharp.image().at(std::clamp(u + du, 0, kWidth - 1), v).y;
      for (int k = 0; k < 3; ++k)
        drawing.rgb[static_cast<std::size_t>(3 * (v * kWidth + u) + k)] =
            static_cast<std::uint8_t>(sum / (2 * kHalf + 1));
    }
  const BoardSearch search = find_board(drawing.image(), "a.png", kPattern);
  EXPECT_FALSE(search.view);
  EXPECT_NE(search.reason.find("blurred"), std::string::npos) << search.reason;
}

TEST(FindBoard, RealFisheyePicturesGiveALensToHalfAPixel) {
  const auto folder = support::real_data() / "fisheye_calibration/gopro_hero3_15x9";
  if (!std::filesystem::is_directory(folder))
    GTEST_SKIP() << "no real pictures at " << folder << " (set GATEFLY_DATA)";
  BoardViews views;
  const auto files = files::picture_files(folder);
  for (std::size_t i = 0; i < files.size(); i += 2) {
    const files::ImageFile file = files::read_image(files[i]);
    if (auto search = find_board(file.view(0), files[i].filename().string(), {15, 9, 0.026});
        search.view)
      views.push_back(*search.view);
  }
  EXPECT_GE(views.size(), 9U);
  const Calibration answer = calibrate(views, {1000, 750});
  EXPECT_LE(answer.best().rms_px, 0.5);
  EXPECT_EQ(name_of(answer.best().fit.model), "kannala-brandt");
}

}  // namespace
}  // namespace gatefly::calibration
