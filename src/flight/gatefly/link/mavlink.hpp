// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "gatefly/link/bytes.hpp"
#include "gatefly/link/checksums.hpp"
#include "gatefly/link/frame_stream.hpp"
#include "gatefly/link/layout.hpp"

/// MAVLink 2, without signatures.
///
///   FD  size u8  incompatible u8  compatible u8  sequence u8  system u8  component u8  id u24
///   payload without the zeros at its end; of nothing but zeros one is sent, though some send none
///   CRC-16 u16 of everything behind FD, and of a byte that the message's definition makes (CRC_EXTRA)
namespace gatefly::mavlink {

using link::Bytes;

/// The sender, and its count of frames.
struct Sender {
  std::uint8_t system = 0, component = 0, sequence = 0;
};

/// One frame; `payload` belongs to whoever gave the bytes.
struct Frame {
  std::uint32_t id = 0;
  Sender sender;
  Bytes payload;  ///< Zeros at its end are not sent.
};

inline constexpr std::size_t kMostPayload = 255;
inline constexpr std::size_t kHeader = 10, kChecksum = 2, kSignature = 13;
/// A frame without a signature, at most: what a datagram or a buffer must hold.
inline constexpr std::size_t kLongestFrame = kHeader + kMostPayload + kChecksum;

/// Computes CRC_EXTRA, the byte that stands for a message's name and its fields, from its layout.
class DefinitionChecksum {
 public:
  template <link::WireNumber T>
  constexpr void operator()(std::string_view name, const T&, std::string_view) {
    add_field<T>(name);
  }
  template <link::WireNumber T, std::size_t N>
  constexpr void operator()(std::string_view name, const std::array<T, N>&, std::string_view) {
    add_field<T>(name);
    if (!later_) add(static_cast<std::uint8_t>(N));
  }
  constexpr void later() { later_ = true; }
  constexpr void add_word(std::string_view word) {
    for (const char c : word) add(static_cast<std::uint8_t>(c));
    add(' ');
  }
  [[nodiscard]] constexpr std::uint8_t value() const {
    return static_cast<std::uint8_t>((crc_ & 0xFF) ^ (crc_ >> 8));
  }

 private:
  template <class T>
  constexpr void add_field(std::string_view name) {
    if (later_) return;
    add_word(link::wire_name<T>());
    add_word(name);
  }
  constexpr void add(std::uint8_t byte) { crc_ = link::crc16_of(Bytes{&byte, 1}, crc_); }

  std::uint16_t crc_ = 0xFFFF;
  bool later_ = false;
};

template <class Message>
[[nodiscard]] constexpr std::uint8_t crc_extra_of() {
  DefinitionChecksum checksum;
  checksum.add_word(Message::kName);
  const Message message{};
  Message::layout(message, checksum);
  return checksum.value();
}

/// CRC_EXTRA of a message that is known here; nullopt of any other.
[[nodiscard]] std::optional<std::uint8_t> crc_extra(std::uint32_t id);

/// For link::FrameStream. A frame whose message is not known cannot be checked, and is none; a signed one is
/// taken without looking at its signature.
struct Protocol {
  using Frame = mavlink::Frame;
  static constexpr std::uint8_t kStart = 0xFD;
  static constexpr std::size_t kLongest = kLongestFrame + kSignature;
  [[nodiscard]] static link::Look look(Bytes bytes);
  [[nodiscard]] static Frame frame_in(Bytes bytes);
};

using Stream = link::FrameStream<Protocol>;

/// Writes a frame of a known message into `out`, without zeros at the payload's end; returns its size, 0 when
/// it does not fit.
[[nodiscard]] std::size_t encode_frame(const Frame& frame, std::uint8_t extra,
                                       std::span<std::uint8_t> out);

template <class Message>
[[nodiscard]] std::size_t encode_message(const Message& message, const Sender& sender,
                                         std::span<std::uint8_t> out) {
  constexpr std::uint8_t kExtra = crc_extra_of<Message>();
  std::array<std::uint8_t, link::sizes_of<Message>().all()> payload{};
  link::ByteWriter writer{payload};
  link::encode(message, writer);
  return encode_frame({Message::kId, sender, writer.written()}, kExtra, out);
}

/// The message of a frame; nullopt when it is another one. What was not sent is zero.
template <class Message>
[[nodiscard]] std::optional<Message> message_in(const Frame& frame) {
  if (frame.id != Message::kId) return std::nullopt;
  std::array<std::uint8_t, kMostPayload> whole{};
  const Bytes sent = frame.payload.first(std::min(frame.payload.size(), whole.size()));
  std::copy(sent.begin(), sent.end(), whole.begin());
  return link::decoded<Message>(whole);
}

}  // namespace gatefly::mavlink
