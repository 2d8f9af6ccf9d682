// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/msp.hpp"

namespace gatefly::msp {
namespace {

using link::Look;

constexpr std::size_t kDirectionAt = 2;  ///< Behind '$' and 'M' or 'X'.
constexpr std::uint8_t kLongSize = 255;  ///< Version 1: the size follows the id.

/// Places of the parts of a frame. `known` is false while the bytes do not say it yet.
struct Extent {
  bool known = false;
  std::uint16_t id = 0;
  std::size_t payload_at = 0, payload_size = 0;
  [[nodiscard]] std::size_t checksum_at() const { return payload_at + payload_size; }
};

Extent extent_of(Bytes frame) {
  link::ByteReader in{frame.subspan(kDirectionAt + 1)};
  Extent extent;
  if (frame[1] == 'X') {
    (void)in.take<std::uint8_t>();
    extent.id = in.take<std::uint16_t>();
    extent.payload_size = in.take<std::uint16_t>();
  } else {
    const auto size = in.take<std::uint8_t>();
    extent.id = in.take<std::uint8_t>();
    extent.payload_size = size == kLongSize ? in.take<std::uint16_t>() : size;
  }
  extent.known = in.complete();
  extent.payload_at = frame.size() - in.rest().size();
  return extent;
}

std::uint8_t checksum_of(bool version_2, Bytes header_and_payload) {
  return version_2 ? link::crc8_of(header_and_payload) : link::xor_of(header_and_payload);
}

bool is_direction(std::uint8_t byte) { return byte == '<' || byte == '>' || byte == '!'; }

}  // namespace

Look Protocol::look(Bytes bytes) {
  constexpr Look kNoFrame{Look::Verdict::kNoFrame, 0};
  constexpr Look kMore{Look::Verdict::kMore, 0};
  if (!bytes.empty() && bytes[0] != kStart) return kNoFrame;
  if (bytes.size() > 1 && bytes[1] != 'M' && bytes[1] != 'X') return kNoFrame;
  if (bytes.size() > kDirectionAt && !is_direction(bytes[kDirectionAt])) return kNoFrame;
  if (bytes.size() <= kDirectionAt) return kMore;
  const Extent extent = extent_of(bytes);
  if (!extent.known) return kMore;
  if (extent.payload_size > kMostPayload) return kNoFrame;
  const std::size_t end = extent.checksum_at();
  if (bytes.size() <= end) return kMore;
  const Bytes covered = bytes.subspan(kDirectionAt + 1, end - kDirectionAt - 1);
  if (checksum_of(bytes[1] == 'X', covered) != bytes[end]) return kNoFrame;
  return {Look::Verdict::kFrame, end + 1};
}

Frame Protocol::frame_in(Bytes bytes) {
  const Extent extent = extent_of(bytes);
  return {extent.id, bytes.subspan(extent.payload_at, extent.payload_size),
          static_cast<Direction>(bytes[kDirectionAt]), bytes[1] == 'X' ? Version::k2 : Version::k1};
}

std::size_t encode_frame(const Frame& frame, std::span<std::uint8_t> out) {
  const bool version_2 = frame.version == Version::k2;
  if (frame.payload.size() > kMostPayload || (!version_2 && frame.id > 0xFF)) return 0;
  const auto size = static_cast<std::uint16_t>(frame.payload.size());
  link::ByteWriter writer{out};
  writer.put(Protocol::kStart);
  writer.put<std::uint8_t>(version_2 ? 'X' : 'M');
  writer.put(static_cast<std::uint8_t>(frame.direction));
  if (version_2) {
    writer.put<std::uint8_t>(0);  // flags: none is defined
    writer.put(frame.id);
    writer.put(size);
  } else {
    writer.put(size < kLongSize ? static_cast<std::uint8_t>(size) : kLongSize);
    writer.put(static_cast<std::uint8_t>(frame.id));
    if (size >= kLongSize) writer.put(size);
  }
  writer.put_bytes(frame.payload);
  if (!writer.fits()) return 0;
  writer.put(checksum_of(version_2, writer.written().subspan(kDirectionAt + 1)));
  return writer.size();
}

}  // namespace gatefly::msp
