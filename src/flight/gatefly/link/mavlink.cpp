// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/mavlink.hpp"

#include <tuple>

#include "gatefly/link/mavlink_commands.hpp"
#include "gatefly/link/mavlink_hil.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"

namespace gatefly::mavlink {
namespace {

using link::Look;

constexpr std::uint8_t kSigned = 0x01;  ///< The only incompatible flag that there is.

struct Known {
  std::uint32_t id = 0;
  std::uint8_t extra = 0;
};

template <class... Message>
constexpr std::array<Known, sizeof...(Message)> known_of(const std::tuple<Message...>*) {
  return {{{Message::kId, crc_extra_of<Message>()}...}};
}

using All = decltype(std::tuple_cat(Telemetry{}, Commands{}, HardwareInLoop{}));
constexpr auto kKnown = known_of(static_cast<const All*>(nullptr));

struct Header {
  std::uint8_t size, incompatible;
  Sender sender;
  std::uint32_t id;
};

Header header_in(Bytes frame) {
  link::ByteReader in{frame.subspan(1)};
  Header header{};
  header.size = in.take<std::uint8_t>();
  header.incompatible = in.take<std::uint8_t>();
  (void)in.take<std::uint8_t>();  // compatible flags
  header.sender.sequence = in.take<std::uint8_t>();
  header.sender.system = in.take<std::uint8_t>();
  header.sender.component = in.take<std::uint8_t>();
  header.id = in.take<std::uint16_t>();
  header.id |= std::uint32_t{in.take<std::uint8_t>()} << 16;
  return header;
}

std::uint16_t checksum_of(Bytes behind_start, std::uint8_t extra) {
  return link::crc16_of(Bytes{&extra, 1}, link::crc16_of(behind_start));
}

}  // namespace

std::optional<std::uint8_t> crc_extra(std::uint32_t id) {
  for (const Known& known : kKnown)
    if (known.id == id) return known.extra;
  return std::nullopt;
}

Look Protocol::look(Bytes bytes) {
  constexpr Look kNoFrame{Look::Verdict::kNoFrame, 0};
  constexpr Look kMore{Look::Verdict::kMore, 0};
  if (!bytes.empty() && bytes[0] != kStart) return kNoFrame;
  if (bytes.size() < kHeader) return kMore;
  const Header header = header_in(bytes);
  const auto extra = crc_extra(header.id);
  if (!extra || (header.incompatible & ~kSigned) != 0) return kNoFrame;
  const std::size_t covered = kHeader + header.size;
  const bool is_signed = (header.incompatible & kSigned) != 0;
  const std::size_t size = covered + kChecksum + (is_signed ? kSignature : 0);
  if (bytes.size() < covered + kChecksum) return kMore;
  link::ByteReader checksum{bytes.subspan(covered)};
  if (checksum.take<std::uint16_t>() != checksum_of(bytes.subspan(1, covered - 1), *extra))
    return kNoFrame;
  return bytes.size() < size ? kMore : Look{Look::Verdict::kFrame, size};
}

Frame Protocol::frame_in(Bytes bytes) {
  const Header header = header_in(bytes);
  return {header.id, header.sender, bytes.subspan(kHeader, header.size)};
}

std::size_t encode_frame(const Frame& frame, std::uint8_t extra, std::span<std::uint8_t> out) {
  Bytes payload = frame.payload;
  // At most once a byte.
  while (payload.size() > 1 && payload.back() == 0) payload = payload.first(payload.size() - 1);
  if (payload.empty() || payload.size() > kMostPayload) return 0;
  link::ByteWriter writer{out};
  writer.put(Protocol::kStart);
  writer.put(static_cast<std::uint8_t>(payload.size()));
  writer.put<std::uint8_t>(0);  // incompatible: not signed
  writer.put<std::uint8_t>(0);  // compatible
  writer.put(frame.sender.sequence);
  writer.put(frame.sender.system);
  writer.put(frame.sender.component);
  writer.put(static_cast<std::uint16_t>(frame.id));
  writer.put(static_cast<std::uint8_t>(frame.id >> 16));
  writer.put_bytes(payload);
  if (!writer.fits()) return 0;
  writer.put(checksum_of(writer.written().subspan(1), extra));
  return writer.size();
}

}  // namespace gatefly::mavlink
