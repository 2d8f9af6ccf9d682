// SPDX-License-Identifier: Apache-2.0
#include "gatefly/files/pictures.hpp"

#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/detection/gate_detector.hpp"
#include "gatefly/drawing/video_file.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/video_reader.hpp"

#include "support/draw_gate.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::files {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::string text_of_bytes(const std::vector<std::uint8_t>& bytes) {
  return {bytes.begin(), bytes.end()};
}

/// The same picture as RGB: JFIF back.
std::string ppm_of(const test::Canvas& canvas) {
  std::string ppm =
      "P6\n" + std::to_string(canvas.width()) + " " + std::to_string(canvas.height()) + "\n255\n";
  const auto yuv = canvas.yuv444();
  const auto byte = [](double x) {
    return static_cast<char>(std::clamp(std::lround(x), 0l, 255l));
  };
  for (std::size_t i = 0; i < yuv.size(); i += 3) {
    const double y = yuv[i], cb = yuv[i + 1] - 128.0, cr = yuv[i + 2] - 128.0;
    ppm += {byte(y + 1.402 * cr), byte(y - 0.344136 * cb - 0.714136 * cr), byte(y + 1.772 * cb)};
  }
  return ppm;
}

TEST(Pictures, AFolderMeansItsPicturesSortedWithoutRawFrames) {
  const test::TempFolder folder;
  for (const char* name : {"b.ppm", "a.JPG", "c.jpeg", "d.png", "e.uyvy", "f.avi", "labels.csv"})
    (void)folder.file(name, "x");
  fs::create_directory(folder.path() / "below");
  std::vector<std::string> names;
  for (const auto& path : picture_files(folder.path())) names.push_back(path.filename().string());
  EXPECT_THAT(names, ElementsAre("a.JPG", "b.ppm", "c.jpeg", "d.png"));
  EXPECT_THAT(picture_files(folder.path() / "e.uyvy"), ElementsAre(folder.path() / "e.uyvy"));
  EXPECT_THAT(test::error_of([&] { (void)picture_files(folder.path() / "below"); }),
              HasSubstr("below: holds no .jpg"));
  EXPECT_THAT(test::error_of([&] { (void)picture_files(folder.path() / "none"); }),
              HasSubstr("none: there is no such"));
}

TEST(Pictures, DataIsFoundBelowTheFolderThatIsNamed) {
  const test::TempFolder folder;
  const auto path = folder.file("a.jpg", "x");
  EXPECT_EQ(find_data("a.jpg", folder.path().string()), path);
  // the error names what was typed
  EXPECT_EQ(find_data("no-such.jpg", folder.path().string()), "no-such.jpg");
  EXPECT_EQ(find_data(path, ""), path);
  EXPECT_THAT(test::error_of([&] { (void)find_data("a.jpg", path.string() + "/x"); }),
              HasSubstr("--data"));
}

TEST(Pictures, ARawFrameAndItsPpmShowTheSameGate) {
  const CameraRig rig = test::bebop_rig();
  test::Canvas canvas(314, 160);
  canvas.draw_gate({.p_GB = {-2.5, 0.1, 0.2}}, rig);
  const test::TempFolder folder;
  const ImageFile raw = read_image(folder.file("a.uyvy", text_of_bytes(canvas.uyvy())), 314, 160);
  const ImageFile ppm = read_image(folder.file("a.ppm", ppm_of(canvas)));
  GateDetector in_raw, in_ppm;
  const ColorModel orange = ColorModel::described({1.0, 0.4, 0.0});
  const auto a = in_raw.look(raw.view(0), orange, {.gates = LookFor::Gates::kAll}).gates,
             b = in_ppm.look(ppm.view(0), orange, {.gates = LookFor::Gates::kAll}).gates;
  ASSERT_EQ(a.size(), 1u);
  ASSERT_EQ(b.size(), 1u);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_LT((a[0].corners_px[i] - b[0].corners_px[i]).norm(), 1.0);
}

TEST(VideoReader, EveryPictureOfAFilmInItsOrderInJfifColours) {
  if (!test::error_of(require_ffmpeg).empty()) GTEST_SKIP() << "there is no ffmpeg";
  const test::TempFolder folder;
  const fs::path path = folder.path() / "a 'film'.mp4";
  drawing::VideoFile film(path, 64, 48, 10);
  for (int i = 0; i < 7; ++i) {
    drawing::Canvas picture(64, 48);
    picture.fill({.x = 0, .y = 0, .width = 64, .height = 48}, {0.9, 0.1 * i, 0.2});
    film.add(picture);
  }
  film.finish();

  VideoReader reader(path);
  for (int i = 0; i < 7; ++i) {
    const auto picture = reader.next();
    ASSERT_TRUE(picture) << i;
    EXPECT_EQ(picture->view(90).width(), 48);
    const Yuv seen = picture->view(0).at(32, 24);
    const Yuv drawn = yuv_of_rgb(230, static_cast<std::uint8_t>(25.5 * i), 51);
    EXPECT_NEAR(seen.y, drawn.y, 4) << i;  // through limited range, BT.709, H.264 and back
    EXPECT_NEAR(seen.u, drawn.u, 4) << i;
    EXPECT_NEAR(seen.v, drawn.v, 4) << i;
  }
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.next());
}

TEST(VideoReader, WhatIsNoFilmIsOneLineWithThePath) {
  if (!test::error_of(require_ffmpeg).empty()) GTEST_SKIP() << "there is no ffmpeg";
  const test::TempFolder folder;
  for (const char* name : {"a.avi", "notes.txt", "-i.mp4"})  // ffmpeg would paint a text file
    EXPECT_THAT(
        test::error_of([&] { (void)VideoReader(folder.file(name, "hello\nworld\n")).next(); }),
        AllOf(HasSubstr(name), HasSubstr("neither a picture nor a video"), Not(HasSubstr("\n"))));
  EXPECT_THAT(test::error_of([&] { (void)VideoReader(folder.file("e.avi", "")).next(); }),
              HasSubstr("e.avi"));
  EXPECT_THAT(test::error_of([] { VideoReader reader("nowhere.avi"); }),
              HasSubstr("nowhere.avi: cannot be read"));
}

TEST(VideoReader, AReaderMayBeLeftBeforeTheEnd) {
  if (!test::error_of(require_ffmpeg).empty()) GTEST_SKIP() << "there is no ffmpeg";
  const test::TempFolder folder;
  drawing::VideoFile film(folder.path() / "a.mp4", 320, 240, 10);
  for (int i = 0; i < 30; ++i) film.add(drawing::Canvas(320, 240));
  film.finish();
  VideoReader reader(folder.path() / "a.mp4");
  EXPECT_TRUE(reader.next());
}

}  // namespace
}  // namespace gatefly::files
