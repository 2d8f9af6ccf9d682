// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

#include "gatefly/live/camera.hpp"
#include "gatefly/live/gst_packets.hpp"
#include "gatefly/live/port.hpp"
#include "gatefly/live/stamped_arrivals.hpp"

namespace gatefly::live {

/// Pictures of a GStreamer pipeline: gst-launch-1.0 beside us writes them into a pipe, scaled to the camera's size, UYVY of full range, each with
/// the time that its source stamped it with. When it hangs or dies, we do not.
class StreamCamera : public Camera {
 public:
  /// @throws std::runtime_error one line: there is no gst-launch-1.0.
  StreamCamera(const std::string& pipeline, StoredSize size);
  ~StreamCamera() override;
  StreamCamera(const StreamCamera&) = delete;
  StreamCamera& operator=(const StreamCamera&) = delete;

  /// @throws std::runtime_error one line: what comes is not what the pipeline's last element writes, or no picture of the camera's size; nothing more can be read then.
  Got next(Picture& picture, Moment deadline) override;
  [[nodiscard]] std::string why() const override;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  /// Fills `room` from the pipe, from where it was left.
  Got fill(std::span<std::uint8_t> room, Moment deadline);
  [[nodiscard]] PacketHeader checked(const std::optional<PacketHeader>& header) const;

  StoredSize size_;
  std::unique_ptr<std::FILE, Close> messages_;  ///< Its messages, in an unnamed file.
  std::optional<Port> pipe_;
  pid_t program_ = -1;
  PacketBytes header_{};
  std::optional<PacketHeader> packet_;  ///< The one whose payload is being read.
  std::vector<std::uint8_t> payload_;
  std::size_t filled_ = 0, count_ = 0;
  StampedArrivals stamps_;
};

/// The words of a pipeline as a shell would give them, quotes taken off.
[[nodiscard]] std::vector<std::string> words_of_pipeline(const std::string& pipeline);

}  // namespace gatefly::live
