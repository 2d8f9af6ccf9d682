// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "gatefly/link/bytes.hpp"
#include "gatefly/link/checksums.hpp"
#include "gatefly/link/frame_stream.hpp"
#include "gatefly/link/layout.hpp"

/// MSP, the MultiWii serial protocol, as Betaflight speaks it: frames, versions 1 and 2.
///
///   v1   $ M direction  size u8  id u8               payload  xor of size … payload
///   v1   $ M direction  255  id u8  size u16         payload  xor              (255 bytes and more)
///   v2   $ X direction  flags u8  id u16  size u16   payload  CRC-8 of flags … payload
namespace gatefly::msp {

using link::Bytes;

enum class Version : std::uint8_t { k1, k2 };

/// The third byte of a frame.
enum class Direction : std::uint8_t {
  kToController = '<',
  kFromController = '>',
  kRefused = '!',  ///< From the controller: it does not know the message, or will not do it.
};

/// One frame; `payload` belongs to whoever gave the bytes.
struct Frame {
  std::uint16_t id = 0;  ///< Version 1 has one byte for it.
  Bytes payload;
  Direction direction = Direction::kToController;
  Version version = Version::k2;
};

/// Ours: no controller answers with more. What claims to be longer is taken for garbage.
inline constexpr std::size_t kMostPayload = 1024;
/// Bytes of a frame beside its payload, at most.
inline constexpr std::size_t kFrameOverhead = 9;

/// Writes a frame into `out`; returns its size, 0 when it does not fit there or into its version.
[[nodiscard]] std::size_t encode_frame(const Frame& frame, std::span<std::uint8_t> out);

/// For link::FrameStream.
struct Protocol {
  using Frame = msp::Frame;
  static constexpr std::uint8_t kStart = '$';
  static constexpr std::size_t kLongest = kMostPayload + kFrameOverhead;
  [[nodiscard]] static link::Look look(Bytes bytes);
  [[nodiscard]] static Frame frame_in(Bytes bytes);
};

using Stream = link::FrameStream<Protocol>;

/// A message of fixed layout as the payload of a frame; returns the frame's size, 0 when it does not fit.
template <class Message>
[[nodiscard]] std::size_t encode_message(const Message& message, Direction direction,
                                         std::span<std::uint8_t> out,
                                         Version version = Version::k2) {
  std::array<std::uint8_t, link::sizes_of<Message>().all()> payload{};
  link::ByteWriter writer{payload};
  link::encode(message, writer);
  return encode_frame({Message::kId, writer.written(), direction, version}, out);
}

/// A question without payload.
[[nodiscard]] inline std::size_t encode_request(std::uint16_t id, std::span<std::uint8_t> out,
                                                Version version = Version::k2) {
  return encode_frame({id, {}, Direction::kToController, version}, out);
}

}  // namespace gatefly::msp
