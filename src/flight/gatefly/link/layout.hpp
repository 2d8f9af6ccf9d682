// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "gatefly/link/bytes.hpp"

// How messages lie in bytes. A message is a plain struct with one function
//
//   template <class Self, class Visit>
//   static constexpr void layout(Self& m, Visit& visit) {
//     visit("time_boot_ms", m.time_boot_ms, "ms since start");
//     visit.later();  // what follows is not in every version of the message
//     ...
//   }
//
// which names its fields in the order of the wire, with unit, axis and sign. Decoder, encoder,
// MAVLink's CRC_EXTRA and the tables of docs/link.md are all made from it: there is no second place.

namespace gatefly::link {

/// Name of a type where layouts are written down: uint8_t, float, ...
template <WireNumber T>
[[nodiscard]] constexpr std::string_view wire_name() {
  if constexpr (std::same_as<T, char>) return "char";
  if constexpr (std::same_as<T, float>) return "float";
  if constexpr (std::same_as<T, double>) return "double";
  if constexpr (std::unsigned_integral<T>) {
    constexpr std::array<std::string_view, 4> kNames{"uint8_t", "uint16_t", "uint32_t", "uint64_t"};
    return kNames[std::bit_width(sizeof(T)) - 1];
  }
  constexpr std::array<std::string_view, 4> kNames{"int8_t", "int16_t", "int32_t", "int64_t"};
  return kNames[std::bit_width(sizeof(T)) - 1];
}

/// Reads each field; one that is missing behind later() keeps its default.
class FieldDecoder {
 public:
  constexpr explicit FieldDecoder(Bytes bytes) : in_{bytes} {}

  template <WireNumber T>
  constexpr void operator()(std::string_view, T& field, std::string_view) {
    if (!gone_on(sizeof(T))) return;
    field = in_.take<T>();
  }
  template <WireNumber T, std::size_t N>
  constexpr void operator()(std::string_view, std::array<T, N>& field, std::string_view) {
    if (!gone_on(N * sizeof(T))) return;
    field = in_.take_array<T, N>();
  }
  constexpr void later() { later_ = true; }
  [[nodiscard]] constexpr bool complete() const { return in_.complete(); }

 private:
  [[nodiscard]] constexpr bool gone_on(std::size_t size) {
    if (later_ && in_.rest().size() < size) ended_ = true;
    return !ended_;
  }
  ByteReader in_;
  bool later_ = false, ended_ = false;
};

/// Writes each field.
class FieldEncoder {
 public:
  constexpr explicit FieldEncoder(ByteWriter& out) : out_{out} {}

  template <WireNumber T>
  constexpr void operator()(std::string_view, const T& field, std::string_view) {
    out_.put(field);
  }
  template <WireNumber T, std::size_t N>
  constexpr void operator()(std::string_view, const std::array<T, N>& field, std::string_view) {
    for (const T& value : field) out_.put(value);
  }
  constexpr void later() {}

 private:
  ByteWriter& out_;
};

/// Counts the bytes of all fields, and of those that every version has.
class FieldSizes {
 public:
  template <WireNumber T>
  constexpr void operator()(std::string_view, const T&, std::string_view) {
    add(sizeof(T));
  }
  template <WireNumber T, std::size_t N>
  constexpr void operator()(std::string_view, const std::array<T, N>&, std::string_view) {
    add(N * sizeof(T));
  }
  constexpr void later() { later_ = true; }
  [[nodiscard]] constexpr std::size_t all() const { return all_; }
  [[nodiscard]] constexpr std::size_t least() const { return least_; }

 private:
  constexpr void add(std::size_t size) {
    all_ += size;
    if (!later_) least_ += size;
  }
  std::size_t all_ = 0, least_ = 0;
  bool later_ = false;
};

template <class Message>
[[nodiscard]] constexpr FieldSizes sizes_of() {
  FieldSizes sizes;
  const Message message{};
  Message::layout(message, sizes);
  return sizes;
}

/// The message in `bytes`; nullopt when a field is missing that every version has. Longer ones,
/// of versions to come, are read as far as they are known.
template <class Message>
[[nodiscard]] constexpr std::optional<Message> decoded(Bytes bytes) {
  Message message;
  FieldDecoder decoder{bytes};
  Message::layout(message, decoder);
  if (!decoder.complete()) return std::nullopt;
  return message;
}

template <class Message>
constexpr void encode(const Message& message, ByteWriter& out) {
  FieldEncoder encoder{out};
  Message::layout(message, encoder);
}

}  // namespace gatefly::link
