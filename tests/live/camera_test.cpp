// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/camera.hpp"

#include <algorithm>
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
#include "gatefly/live/gst_packets.hpp"
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

/// Four pictures of 8 x 4 by the real program: `gst-launch-1.0 -q videotestsrc is-live=true num-buffers=4 ! videoconvert ! videoscale !
/// video/x-raw,format=UYVY,width=8,height=4,colorimetry=1:4:0:0 ! gdppay ! fdsink fd=1 sync=false`, version 1.22.
std::string four_pictures() {
  return (support::source_folder() / "tests" / "live" / "four_pictures.gdp").string();
}

TEST(StreamCamera, PicturesOfAPipelineComeWholeInTheCamerasSize) {
  const FakeGStreamer gst{"echo 'it is a talkative camera'; cat " + four_pictures() +
                          " >&3; sleep 5"};
  StreamCamera camera{"videotestsrc pattern=\"smpte 75\"", {8, 4}};
  Picture picture;
  for (std::size_t i = 0; i < 4; ++i) {
    ASSERT_EQ(camera.next(picture, Clock::now() + 2s), Camera::Got::kPicture);
    EXPECT_EQ(picture.number, i);
    ASSERT_EQ(picture.pixels.size(), 64u);
    EXPECT_THAT(std::vector(picture.pixels.begin(), picture.pixels.begin() + 4),
                ElementsAre(0x48, 0xeb, 0x89, 0xd2))
        << "its white bar";
  }
  EXPECT_EQ(camera.next(picture, Clock::now() + 20ms), Camera::Got::kNothing) << "it has stalled";
  EXPECT_THAT(gst.words(), HasSubstr("-q videotestsrc pattern=smpte 75 ! videoconvert"));
  EXPECT_THAT(gst.words(),
              HasSubstr("format=UYVY,width=8,height=4,colorimetry=1:4:0:0 ! gdppay ! fdsink fd=3"));
}

TEST(StreamCamera, APacketSaysWhenItsPictureWasTaken) {
  const std::string bytes = files::read_file(four_pictures());
  std::vector<std::int64_t> stamps;
  for (std::size_t at = 0; at < bytes.size();) {
    PacketBytes header{};
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), header.size(), header.begin());
    const auto packet = packet_header(header);
    ASSERT_TRUE(packet) << "at byte " << at;
    if (packet->is_picture) stamps.push_back(packet->stamp.count());
    at += header.size() + packet->size;
  }
  EXPECT_THAT(stamps, ElementsAre(3'203'817, 36'537'150, 69'870'483, 103'203'817));
}

TEST(StreamCamera, APictureThatIsHeldUpIsCalledLate) {
  const FakeGStreamer gst{R"(exec python3 - <<'END'
import os, struct, time
start = time.monotonic()
for i in range(80):
    time.sleep(max(0, start + .03 * i + (.04 if i == 79 else 0) - time.monotonic()))
    header = struct.pack('>BBBBHIQQQQH14sHH', 1, 0, 1, 0, 1, 64, 30_000_000 * i, 0, 0, 0, 0, bytes(14), 0, 0)
    os.write(3, header + bytes(64))
time.sleep(5)
END
)"};
  StreamCamera camera{"videotestsrc", {8, 4}};
  Picture picture;
  for (int i = 0; i < 80; ++i)
    ASSERT_EQ(camera.next(picture, Clock::now() + 2s), Camera::Got::kPicture);
  EXPECT_GE(picture.late, 30ms);
  EXPECT_LT(picture.late, 200ms);
}

TEST(StreamCamera, OnePictureThatIsCutOffIsNone) {
  const FakeGStreamer gst{"head -c 1000 " + four_pictures() + " >&3"};
  StreamCamera camera{"videotestsrc", {8, 4}};
  Picture picture;
  EXPECT_EQ(camera.next(picture, Clock::now() + 2s), Camera::Got::kPicture);
  EXPECT_EQ(camera.next(picture, Clock::now() + 2s), Camera::Got::kEnded);
  EXPECT_EQ(camera.next(picture, Clock::now() + 2s), Camera::Got::kEnded) << "and remains so";
}

TEST(StreamCamera, OfTheRealProgramThePicturesThatAreHeldUpAreCalledLate) {
  if (std::system("gst-launch-1.0 -q videotestsrc num-buffers=1 ! netsim ! gdppay ! fakesink "
                  ">/dev/null 2>&1") != 0)
    GTEST_SKIP() << "needs gst-launch-1.0 with gdppay and netsim (gstreamer1.0-plugins-bad)";
  StreamCamera camera{
      "videotestsrc is-live=true ! video/x-raw,framerate=30/1 ! "
      "netsim delay-probability=0.2 min-delay=40 max-delay=50",
      {64, 48}};
  Picture picture;
  int late = 0, in_time = 0;
  for (int i = 0; i < 180; ++i) {
    ASSERT_EQ(camera.next(picture, Clock::now() + 5s), Camera::Got::kPicture) << camera.why();
    if (i < 75) continue;  // nothing can be told within two seconds
    late += picture.late >= 30ms;
    in_time += picture.late < 15ms;
  }
  EXPECT_GE(late, 5) << "one of five";
  EXPECT_GE(in_time, 60);
}

std::string error_of(const std::string& script, StoredSize size) {
  const FakeGStreamer gst{script};
  StreamCamera camera{"videotestsrc", size};
  Picture picture;
  try {
    (void)camera.next(picture, Clock::now() + 2s);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(StreamCamera, WhatIsNoPictureOfTheCamerasSizeIsRefused) {
  EXPECT_EQ(error_of("cat " + four_pictures() + " >&3; sleep 5", {8, 6}),
            "--camera: gst-launch-1.0 sends 64 bytes, a picture of the camera's size has 96");
  EXPECT_EQ(error_of("head -c 1600 /dev/zero >&3; sleep 5", {8, 4}),
            "--camera: gst-launch-1.0 sends what is not GStreamer's data protocol 1.0");
  EXPECT_EQ(
      error_of(R"(printf '\1\0\1\0\0\100\377\377\377\377' >&3; head -c 52 /dev/zero >&3; sleep 5)",
               {8, 4}),
      "--camera: gst-launch-1.0 sends 4294967295 bytes, a picture of the camera's size has 64");
}

std::string last_words_after(const std::string& message) {
  const FakeGStreamer gst{"echo '" + message + "' >&2; exit 1"};
  StreamCamera camera{"videotestsrc", {8, 4}};
  Picture picture;
  EXPECT_EQ(camera.next(picture, Clock::now() + 2s), Camera::Got::kEnded);
  return camera.why();
}

TEST(StreamCamera, AProgramThatEndsSaysWhy) {
  EXPECT_EQ(last_words_after("no such element"), "no such element");
  EXPECT_EQ(last_words_after("could not link videoscale0 to gdppay0"),
            "could not link videoscale0 to gdppay0");
}

TEST(StreamCamera, WithoutTheElementThatStampsItSaysWhatToInstall) {
  EXPECT_EQ(last_words_after("WARNING: erroneous pipeline: no element \"gdppay\""),
            "WARNING: erroneous pipeline: no element \"gdppay\" (apt-get install "
            "gstreamer1.0-plugins-bad)");
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
