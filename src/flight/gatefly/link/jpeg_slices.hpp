// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gatefly/link/bytes.hpp"
#include "gatefly/link/layout.hpp"

/// Pictures in slices over UDP, as the AI Grand Prix's virtual qualifier sends them [TS-002].
namespace gatefly::jpeg_slices {

using link::Bytes;

/// Header of each slice, little endian.
struct Header {
  std::uint32_t frame_id = 0;
  std::uint16_t chunk_id = 0, total_chunks = 0;
  std::uint32_t jpeg_size = 0, payload_size = 0;
  std::uint64_t sim_time_ns = 0;
  template <class Self, class Visit>
  static constexpr void layout(Self& m, Visit& visit) {
    visit("frame_id", m.frame_id, "counts pictures");
    visit("chunk_id", m.chunk_id, "from 0");
    visit("total_chunks", m.total_chunks, "of this picture");
    visit("jpeg_size", m.jpeg_size, "bytes of the whole picture");
    visit("payload_size", m.payload_size, "bytes that follow");
    visit("sim_time_ns", m.sim_time_ns, "ns, the simulator's clock");
  }
};
inline constexpr std::size_t kHeaderSize = link::sizes_of<Header>().all();
static_assert(kHeaderSize == 24);

/// A picture that is complete; `jpeg` is valid until the next datagram.
struct Picture {
  std::uint32_t frame_id = 0;
  std::chrono::nanoseconds sim_time{0};
  Bytes jpeg;
};

struct AssemblerParams {
  std::size_t pictures = 4;  ///< Begun at the same time. Ours: 130 ms at 30 Hz.
  std::size_t most_bytes =
      512 * 1024;  ///< Largest JPEG accepted. Ours: 640 × 360 of the best quality has 300 kB.
  std::size_t most_chunks = 1024;  ///< Ours: of 512 bytes each.
  std::uint32_t restart =
      30;  ///< A picture that is older than the newest by more is a new sender's. Ours: 1 s.
};

/// Puts pictures together from slices that may be lost, doubled, late and in any order.
///
/// Pictures come out in the order of their numbers, each once; one that is not complete when a later one is, is
/// given up. Slices need not have the same size. Memory is fixed: all of it is allocated at the start.
class Assembler {
 public:
  explicit Assembler(const AssemblerParams& params = {});

  /// Takes a datagram; the picture that it completes, if it does.
  [[nodiscard]] std::optional<Picture> take(Bytes datagram);

  struct Counts {
    std::uint64_t pictures = 0;  ///< Complete.
    std::uint64_t begun = 0;     ///< Of which a slice has come.
    std::uint64_t given_up = 0;  ///< Begun, never complete.
    std::uint64_t refused =
        0;  ///< Datagrams that are no slice, or contradict others of their picture.
    std::uint64_t late =
        0;  ///< Slices of a picture already delivered, or older than one delivered.
    std::uint64_t doubled = 0;
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  struct Slice {
    std::uint32_t at = 0, size = 0;
    bool here = false;
  };
  struct Begun {
    bool used = false;
    Header header;  ///< Header of its first slice.
    std::size_t bytes = 0, slices = 0;
    std::uint64_t touched = 0;       ///< When its last slice came, in slices.
    std::vector<std::uint8_t> data;  ///< In order of arrival.
    std::vector<Slice> slice;        ///< By chunk_id.
  };
  [[nodiscard]] bool is_slice(const Header& header, Bytes payload) const;
  [[nodiscard]] bool is_over(std::uint32_t frame_id) const;
  Begun& place_for(const Header& header);
  Picture completed(Begun& begun);
  void give_up(Begun& begun);
  void forget();

  AssemblerParams params_;
  std::vector<Begun> begun_;
  std::vector<std::uint8_t> jpeg_;       ///< The last one that was complete.
  std::optional<std::uint32_t> newest_;  ///< Number of the newest picture that came out.
  std::uint64_t taken_ = 0;
  Counts counts_;
};

/// Calls on_datagram(Bytes) for each slice of a picture, in order; false, and nothing called, when it has no bytes or would need
/// more than 65,535 slices. `room` holds one datagram and says how large they become.
template <class OnDatagram>
bool each_slice(Bytes jpeg, std::uint32_t frame_id, std::chrono::nanoseconds sim_time,
                std::span<std::uint8_t> room, OnDatagram&& on_datagram) {
  if (jpeg.empty() || jpeg.size() > 0xFFFFFFFF || room.size() <= kHeaderSize) return false;
  const std::size_t most = room.size() - kHeaderSize;
  const std::size_t total = (jpeg.size() + most - 1) / most;
  if (total > 0xFFFF) return false;
  for (std::size_t i = 0; i < total; ++i) {
    const Bytes payload = jpeg.subspan(i * most, std::min(most, jpeg.size() - i * most));
    const Header header{.frame_id = frame_id,
                        .chunk_id = static_cast<std::uint16_t>(i),
                        .total_chunks = static_cast<std::uint16_t>(total),
                        .jpeg_size = static_cast<std::uint32_t>(jpeg.size()),
                        .payload_size = static_cast<std::uint32_t>(payload.size()),
                        .sim_time_ns = static_cast<std::uint64_t>(sim_time.count())};
    link::ByteWriter out{room};
    link::encode(header, out);
    out.put_bytes(payload);
    on_datagram(out.written());
  }
  return true;
}

}  // namespace gatefly::jpeg_slices
