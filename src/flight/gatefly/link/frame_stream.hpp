// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "gatefly/link/bytes.hpp"

namespace gatefly::link {

/// A protocol's verdict on bytes that may begin a frame.
struct Look {
  enum class Verdict { kMore, kNoFrame, kFrame };
  Verdict verdict = Verdict::kNoFrame;
  std::size_t size = 0;  ///< Size of the frame [bytes].
};

/// Frames from bytes as they arrive, in pieces of any size, with anything in between.
///
/// Bytes that looked like a frame and were none are searched again from the second one on: a frame is
/// found whatever comes before it, unless it lies inside another frame whose checksum is right.
/// `Protocol` has kStart (a frame's first byte), kLongest (bytes of the longest frame), look(bytes)
/// and Frame frame_in(bytes), which are pure; look() settles whatever has kLongest bytes.
/// Cost: at most kLongest bytes are looked at again for each byte, and but few as a rule; allocates nothing.
template <class Protocol>
class FrameStream {
 public:
  /// Calls on_frame(const Frame&) for each frame that `bytes` complete; the frame's payload is
  /// valid during the call.
  template <class OnFrame>
  void feed(Bytes bytes, OnFrame&& on_frame) {
    for (const std::uint8_t byte : bytes) {
      buffer_[size_++] = byte;
      settle(on_frame);
    }
  }

  /// Bytes that belonged to no frame.
  [[nodiscard]] std::uint64_t skipped() const { return skipped_; }
  /// Forgets a frame that has begun: after a pause, or for another peer.
  void restart() { skipped_ += size_, size_ = 0; }

 private:
  template <class OnFrame>
  void settle(OnFrame& on_frame) {
    // At most once a byte held: each time at least one of them is dropped.
    while (size_ > 0) {
      const Bytes held{buffer_.data(), size_};
      const Look look = Protocol::look(held);
      if (look.verdict == Look::Verdict::kMore && size_ < buffer_.size()) return;
      if (look.verdict == Look::Verdict::kFrame) {
        on_frame(Protocol::frame_in(held.first(look.size)));
        drop(look.size);
      } else {
        const auto next = std::find(held.begin() + 1, held.end(), Protocol::kStart);
        const auto lost = static_cast<std::size_t>(next - held.begin());
        skipped_ += lost;
        drop(lost);
      }
    }
  }
  void drop(std::size_t count) {
    count = std::min(count, size_);  // who was given the frame may have restarted
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(count),
              buffer_.begin() + static_cast<std::ptrdiff_t>(size_), buffer_.begin());
    size_ -= count;
  }

  std::array<std::uint8_t, Protocol::kLongest> buffer_{};
  std::size_t size_ = 0;
  std::uint64_t skipped_ = 0;
};

}  // namespace gatefly::link
