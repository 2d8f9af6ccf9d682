// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>

namespace gatefly::live {

/// Header of each packet of GStreamer's data protocol 1.0, which its element gdppay writes: big endian.
struct PacketHeader {
  bool is_picture = false;  ///< A buffer; else what a format or an event is told by.
  std::size_t size = 0;     ///< Bytes of payload that follow.
  /// Of its source, by the pipeline's clock: of exposure, or of arrival there; -1: none.
  std::chrono::nanoseconds stamp{-1};
};

/// Bytes as they come.
using PacketBytes = std::array<std::uint8_t, 62>;

/// @return nullopt: it is not one, or of another version.
[[nodiscard]] inline std::optional<PacketHeader> packet_header(
    std::span<const std::uint8_t, std::tuple_size_v<PacketBytes>> bytes) {
  const auto number = [&](std::size_t from, std::size_t size) {
    std::uint64_t value = 0;
    for (const std::uint8_t byte : bytes.subspan(from, size)) value = value << 8 | byte;
    return value;
  };
  constexpr std::uint64_t kVersion1 = 0x0100, kBuffer = 1, kFormat = 2, kFirstEvent = 64;
  const std::uint64_t type = number(4, 2);
  const bool known = type == kBuffer || type == kFormat || type >= kFirstEvent;
  if (number(0, 2) != kVersion1 || !known) return std::nullopt;
  return PacketHeader{.is_picture = type == kBuffer,
                      .size = number(6, 4),
                      .stamp = std::chrono::nanoseconds{static_cast<std::int64_t>(number(10, 8))}};
}

}  // namespace gatefly::live
