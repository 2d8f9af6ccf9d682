// SPDX-License-Identifier: Apache-2.0
#include "gatefly/drawing/video_file.hpp"

#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gatefly/files/text.hpp"

#include "support/temp_folder.hpp"

namespace gatefly::drawing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class VideoFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::error_of(files::require_ffmpeg).empty()) GTEST_SKIP() << "there is no ffmpeg";
  }
  [[nodiscard]] bool nothing_left() const { return std::filesystem::is_empty(folder_.path()); }

  test::TempFolder folder_;
  Canvas picture_{64, 48, kDark.gate_solid};
};

TEST_F(VideoFileTest, AppearsUnderItsNameOnlyWhenWhole) {
  const auto path = folder_.path() / "a.mp4";
  VideoFile video(path, 64, 48, 20);
  for (int i = 0; i < 5; ++i) video.add(picture_);
  EXPECT_FALSE(std::filesystem::exists(path));
  video.finish();
  EXPECT_THAT(files::read_file(path).substr(0, 12), HasSubstr("ftyp"));
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".partial"));
}

TEST_F(VideoFileTest, AnInterruptedOneIsRemoved) {
  {
    VideoFile video(folder_.path() / "a.mp4", 64, 48, 20);
    for (int i = 0; i < 5; ++i) video.add(picture_);
  }
  EXPECT_TRUE(nothing_left());
}

TEST_F(VideoFileTest, WhenFfmpegGivesUpItIsOneLineWithItsReason) {
  const auto film = [&](const std::filesystem::path& path, int width) {
    return test::error_of([&] {
      VideoFile video(path, width, 48, 20);
      for (int i = 0; i < 2000; ++i) video.add(picture_);  // more than any pipe holds
      video.finish();
    });
  };
  EXPECT_THAT(film(folder_.path() / "missing" / "a.mp4", 64),
              AllOf(HasSubstr("a.mp4: cannot be written: ffmpeg: "), HasSubstr("No such file"),
                    Not(HasSubstr("\n"))));
  EXPECT_THAT(film(folder_.path() / "odd.mp4", 63),
              AllOf(HasSubstr("odd.mp4: cannot be written: ffmpeg: "), Not(HasSubstr("\n"))));
  EXPECT_TRUE(nothing_left());
}

TEST_F(VideoFileTest, WithoutFfmpegItIsOneLineAndNothingIsLeft) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", folder_.path().c_str(), 1);
  const std::string asked = test::error_of(files::require_ffmpeg);
  const std::string started =
      test::error_of([&] { VideoFile video(folder_.path() / "a.mp4", 64, 48, 20); });
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(asked, AllOf(HasSubstr("ffmpeg: No such file"), Not(HasSubstr("\n"))));
  EXPECT_THAT(started, AllOf(HasSubstr("ffmpeg: No such file"), Not(HasSubstr("\n"))));
  EXPECT_TRUE(nothing_left());
}

}  // namespace
}  // namespace gatefly::drawing
