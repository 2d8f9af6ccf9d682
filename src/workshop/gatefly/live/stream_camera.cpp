// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/stream_camera.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "gatefly/files/subprocess.hpp"

namespace gatefly::live {

std::vector<std::string> words_of_pipeline(const std::string& pipeline) {
  std::vector<std::string> words;
  std::string word;
  bool inside = false;
  char quote = 0;
  for (const char c : pipeline) {
    if (quote != 0) {
      if (c == quote)
        quote = 0;
      else
        word += c;
    } else if (c == '"' || c == '\'') {
      quote = c, inside = true;
    } else if (c == ' ' || c == '\t') {
      if (inside) words.push_back(word);
      word.clear(), inside = false;
    } else {
      word += c, inside = true;
    }
  }
  if (inside) words.push_back(word);
  return words;
}

namespace {

/// Longest payload of a packet that is no picture: a few hundred bytes. Ours.
constexpr std::size_t kMostOfAnother = 1 << 20;

std::size_t bytes_of(StoredSize size) {
  return image_bytes(PixelFormat::kUyvy, size.width, size.height);
}

}  // namespace

StreamCamera::StreamCamera(const std::string& pipeline, StoredSize size)
    : size_{size}, messages_{std::tmpfile()}, payload_(std::max(kMostOfAnother, bytes_of(size))) {
  if (size.width % 2 != 0)
    throw std::runtime_error(
        "--camera: pictures of a stream must have an even width, the camera's is " +
        std::to_string(size.width) + " as stored (camera.size_px)");
  int ends[2] = {-1, -1};
  if (!messages_ || pipe2(ends, O_CLOEXEC) != 0)
    throw std::runtime_error(std::string{"--camera: "} + std::strerror(errno));
  std::vector<std::string> words = words_of_pipeline(pipeline);
  words.insert(words.begin(), {"gst-launch-1.0", "-q"});
  // Full range BT.601, as a JPEG has it: what detector and film take a picture for.
  const std::string caps = "video/x-raw,format=UYVY,width=" + std::to_string(size.width) +
                           ",height=" + std::to_string(size.height) + ",colorimetry=1:4:0:0";
  for (const std::string& word :
       {std::string{"!"}, std::string{"videoconvert"}, std::string{"!"}, std::string{"videoscale"},
        std::string{"!"}, caps, std::string{"!"}, std::string{"gdppay"}, std::string{"!"},
        std::string{"fdsink"}, std::string{"fd=3"}, std::string{"sync=false"}})
    words.push_back(word);
  // A file of its own: some sources print onto stdout what they do.
  const int error =
      files::start(words, {.errors = fileno(messages_.get()), .third = ends[1]}, program_);
  ::close(ends[1]);
  pipe_.emplace(ends[0], "gst");
  fcntl(ends[0], F_SETPIPE_SZ, 1 << 20);  // a picture whole; refused, it is but slower
  if (error != 0)
    throw std::runtime_error(std::string{"--camera: gst-launch-1.0 cannot be started: "} +
                             std::strerror(error) + " (apt-get install gstreamer1.0-tools)");
}

StreamCamera::~StreamCamera() {
  if (program_ <= 0) return;
  kill(program_, SIGKILL);
  files::wait_for(program_);
}

Camera::Got StreamCamera::fill(std::span<std::uint8_t> room, Moment deadline) {
  while (filled_ < room.size()) {
    const auto got = pipe_->read(room.subspan(filled_), deadline);
    if (!got) return Got::kEnded;
    if (*got == 0) return Got::kNothing;
    filled_ += *got;
  }
  filled_ = 0;
  return Got::kPicture;
}

PacketHeader StreamCamera::checked(const std::optional<PacketHeader>& header) const {
  if (!header)
    throw std::runtime_error(
        "--camera: gst-launch-1.0 sends what is not GStreamer's data protocol 1.0");
  const std::size_t size = bytes_of(size_);
  if (header->is_picture ? header->size != size : header->size > kMostOfAnother)
    throw std::runtime_error("--camera: gst-launch-1.0 sends " + std::to_string(header->size) +
                             " bytes, a picture of the camera's size has " + std::to_string(size));
  return *header;
}

Camera::Got StreamCamera::next(Picture& picture, Moment deadline) {
  do {
    if (!packet_) {
      if (const Got got = fill(header_, deadline); got != Got::kPicture) return got;
      packet_ = checked(packet_header(header_));
    }
    const std::span payload = std::span{payload_}.first(packet_->size);
    if (const Got got = fill(payload, deadline); got != Got::kPicture) return got;
    const PacketHeader packet = *std::exchange(packet_, std::nullopt);
    if (!packet.is_picture) continue;
    picture.late = stamps_.late(Clock::now().time_since_epoch(), packet.stamp);
    picture.pixels.assign(payload.begin(), payload.end());
    picture.file.clear();
    picture.format = PixelFormat::kUyvy;
    picture.stored_width = size_.width, picture.stored_height = size_.height;
    picture.number = count_++;
    return Got::kPicture;
  } while (Clock::now() < deadline);
  return Got::kNothing;
}

std::string StreamCamera::why() const {
  const std::string last = files::last_line(messages_.get());
  // The element's name; one that there is would be gdppay0.
  const auto missing = last.find("gdppay");
  const bool is_missing = missing != std::string::npos && last.compare(missing, 7, "gdppay0") != 0;
  return is_missing ? last + " (apt-get install gstreamer1.0-plugins-bad)" : last;
}

}  // namespace gatefly::live
