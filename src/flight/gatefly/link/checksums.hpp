// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "gatefly/link/bytes.hpp"

namespace gatefly::link {

/// The exclusive or of all bytes: MSP v1.
[[nodiscard]] constexpr std::uint8_t xor_of(Bytes bytes, std::uint8_t start = 0) {
  for (const std::uint8_t byte : bytes) start = static_cast<std::uint8_t>(start ^ byte);
  return start;
}

/// CRC-8/DVB-S2, polynomial 0xD5: MSP v2.
[[nodiscard]] constexpr std::uint8_t crc8_of(Bytes bytes, std::uint8_t start = 0) {
  unsigned crc = start;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit)
      crc = ((crc << 1) ^ ((crc & 0x80u) != 0 ? 0xD5u : 0u)) & 0xFFu;
  }
  return static_cast<std::uint8_t>(crc);
}

/// CRC-16/MCRF4XX, polynomial 0x1021 reflected, from 0xFFFF: MAVLink.
[[nodiscard]] constexpr std::uint16_t crc16_of(Bytes bytes, std::uint16_t start = 0xFFFF) {
  unsigned crc = start;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0x8408u : 0u);
  }
  return static_cast<std::uint16_t>(crc);
}

}  // namespace gatefly::link
