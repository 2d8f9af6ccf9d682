// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

// Little-endian numbers in bytes, on machines of either order; no pointer is cast.

namespace gatefly::link {

using Bytes = std::span<const std::uint8_t>;

/// A number as it stands on the wire.
template <class T>
concept WireNumber = std::integral<T> ||(std::floating_point<T> && sizeof(T) <= 8);

/// The unsigned integer that has the bits of a T.
template <WireNumber T>
using BitsOf = std::conditional_t<
    sizeof(T) == 1, std::uint8_t,
    std::conditional_t<sizeof(T) == 2, std::uint16_t,
                       std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;

static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559);

/// Takes numbers from the front of bytes. What is not there reads as zero, and complete() says so.
class ByteReader {
 public:
  constexpr explicit ByteReader(Bytes bytes) : rest_{bytes} {}

  template <WireNumber T>
  constexpr T take() {
    BitsOf<T> bits = 0;
    if (rest_.size() < sizeof(T)) {
      complete_ = false;
      rest_ = {};
      return std::bit_cast<T>(bits);
    }
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bits = static_cast<BitsOf<T>>(bits | static_cast<BitsOf<T>>(BitsOf<T>{rest_[i]} << (8 * i)));
    rest_ = rest_.subspan(sizeof(T));
    return std::bit_cast<T>(bits);
  }
  template <WireNumber T, std::size_t N>
  constexpr std::array<T, N> take_array() {
    std::array<T, N> values{};
    for (T& value : values) value = take<T>();
    return values;
  }
  /// The next `count` bytes; fewer, and not complete, when there are not so many.
  constexpr Bytes take_bytes(std::size_t count) {
    if (count > rest_.size()) complete_ = false, count = rest_.size();
    const Bytes taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }

  /// Nothing was asked for that was not there.
  [[nodiscard]] constexpr bool complete() const { return complete_; }
  [[nodiscard]] constexpr Bytes rest() const { return rest_; }

 private:
  Bytes rest_;
  bool complete_ = true;
};

/// Puts numbers into bytes, front to back. What does not fit is left out, and fits() says so.
class ByteWriter {
 public:
  constexpr explicit ByteWriter(std::span<std::uint8_t> out) : out_{out} {}

  template <WireNumber T>
  constexpr void put(T value) {
    if (out_.size() - size_ < sizeof(T)) {
      fits_ = false;
      return;
    }
    const auto bits = std::bit_cast<BitsOf<T>>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i)
      out_[size_++] = static_cast<std::uint8_t>(bits >> (8 * i));
  }
  constexpr void put_bytes(Bytes bytes) {
    for (const std::uint8_t byte : bytes) put(byte);
  }

  [[nodiscard]] constexpr bool fits() const { return fits_; }
  /// Bytes written so far; 0 when something did not fit.
  [[nodiscard]] constexpr std::size_t size() const { return fits_ ? size_ : 0; }
  [[nodiscard]] constexpr Bytes written() const { return Bytes{out_.data(), size()}; }

 private:
  std::span<std::uint8_t> out_;
  std::size_t size_ = 0;
  bool fits_ = true;
};

}  // namespace gatefly::link
