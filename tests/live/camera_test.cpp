// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/camera.hpp"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "gatefly/files/jpeg_writer.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/live/slice_camera.hpp"
#include "gatefly/live/stream_camera.hpp"

#include "support/real_data.hpp"
#include "support/temp_folder.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

/// A program called gst-launch-1.0, first in PATH, that writes what a script says.
class FakeGStreamer {
 public:
  explicit FakeGStreamer(const std::string& script) : before_{std::getenv("PATH")} {
    const auto path =
        folder_.file("gst-launch-1.0", "#!/bin/sh\necho \"$@\" > " +
                                           (folder_.path() / "words").string() + "\n" + script);
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    setenv("PATH", (folder_.path().string() + ":" + before_).c_str(), 1);
  }
  ~FakeGStreamer() { setenv("PATH", before_.c_str(), 1); }
  std::string words() const { return files::read_file(folder_.path() / "words"); }

 private:
  test::TempFolder folder_;
  std::string before_;
};

TEST(StreamCamera, PicturesOfAPipelineComeWholeInTheCamerasSize) {
  const FakeGStreamer gst{"head -c 1600 /dev/zero; sleep 5"};
  StreamCamera camera{"videotestsrc pattern=\"smpte 75\"", {20, 20}};
  Picture picture;
  EXPECT_EQ(camera.next(picture, Clock::now() + 2s), Camera::Got::kPicture);
  EXPECT_EQ(picture.pixels.size(), 800u);
  EXPECT_EQ(picture.number, 0u);
  EXPECT_EQ(camera.next(picture, Clock::now() + 1s), Camera::Got::kPicture);
  EXPECT_EQ(camera.next(picture, Clock::now() + 20ms), Camera::Got::kNothing) << "it has stalled";
  EXPECT_THAT(gst.words(), HasSubstr("-q videotestsrc pattern=smpte 75 ! videoconvert"));
  EXPECT_THAT(gst.words(),
              HasSubstr("format=UYVY,width=20,height=20,colorimetry=1:4:0:0 ! fdsink"));
}

TEST(StreamCamera, AProgramThatEndsSaysWhy) {
  const FakeGStreamer gst{"echo 'no such element' >&2; exit 1"};
  StreamCamera camera{"wrong", {20, 20}};
  Picture picture;
  EXPECT_EQ(camera.next(picture, Clock::now() + 2s), Camera::Got::kEnded);
  EXPECT_EQ(camera.why(), "no such element");
}

TEST(StreamCamera, WordsAreSplitAsAShellDoes) {
  EXPECT_THAT(words_of_pipeline("a  b=\"c d\" 'e ! f' !"), ElementsAre("a", "b=c d", "e ! f", "!"));
}

std::vector<std::uint8_t> jpeg_of_a_flight() {
  const std::string file = files::read_file(support::source_folder() / "tests" / "replay" /
                                            "oval_flight" / "img_00016.jpg");
  return {file.begin(), file.end()};
}

TEST(SliceCamera, APictureInSlicesIsDecodedAndKept) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_DGRAM, 0, ends), 0);
  SliceCamera camera{Port{ends[0], "slices"}, {160, 315}};
  std::array<std::uint8_t, 1000> room{};
  const std::vector<std::uint8_t> jpeg = jpeg_of_a_flight();
  (void)jpeg_slices::each_slice(jpeg, 7, 0ns, room, [&](link::Bytes slice) {
    (void)::write(ends[1], slice.data(), slice.size());
  });
  Picture picture;
  EXPECT_EQ(camera.next(picture, Clock::now() + 1s), Camera::Got::kPart);
  ASSERT_EQ(camera.next(picture, Clock::now() + 1s), Camera::Got::kPicture);
  EXPECT_EQ(picture.stored_width, 160);
  EXPECT_EQ(picture.file, jpeg);
  ::close(ends[1]);
}

TEST(SliceCamera, APictureThatIsHeldUpIsCalledLate) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_DGRAM, 0, ends), 0);
  SliceCamera camera{Port{ends[0], "slices"}, {160, 315}};
  std::vector<std::uint8_t> room(60'000);
  const std::vector<std::uint8_t> jpeg = jpeg_of_a_flight();
  const Moment start = Clock::now();
  constexpr std::chrono::nanoseconds kPeriod = 30ms, kHeldUp = 40ms;
  Picture picture;
  for (std::uint32_t i = 0; i < 80; ++i) {
    const bool last = i == 79;
    std::this_thread::sleep_until(start + i * kPeriod + (last ? kHeldUp : 0ms));
    (void)jpeg_slices::each_slice(jpeg, i, 7h + i * kPeriod, room, [&](link::Bytes slice) {
      (void)::write(ends[1], slice.data(), slice.size());
    });
    ASSERT_EQ(camera.next(picture, Clock::now() + 1s), Camera::Got::kPicture);
  }
  EXPECT_GE(picture.late, kHeldUp - 10ms);
  ::close(ends[1]);
}

TEST(SliceCamera, APictureOfWhichASliceIsLostIsAPartAndNoPicture) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_DGRAM, 0, ends), 0);
  SliceCamera camera{Port{ends[0], "slices"}, {160, 315}};
  std::array<std::uint8_t, 100> room{};
  const std::vector<std::uint8_t> jpeg(300, 1);
  int sent = 0;
  (void)jpeg_slices::each_slice(jpeg, 7, 0ns, room, [&](link::Bytes slice) {
    if (sent++ != 1) (void)::write(ends[1], slice.data(), slice.size());
  });
  Picture picture;
  EXPECT_EQ(camera.next(picture, Clock::now() + 1s), Camera::Got::kPart);
  EXPECT_EQ(camera.next(picture, Clock::now() + 20ms), Camera::Got::kNothing) << "said once";
  ::close(ends[1]);
}

}  // namespace
}  // namespace gatefly::live
