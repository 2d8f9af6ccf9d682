// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace gatefly::c_interface {

/// Stamps of 32 bits, which wrap after 71.6 minutes, as a time that only runs forwards [µs].
///
/// A stamp that is not later than the last, or by more than kLongestGap, is refused. A clock that was
/// set is followed once kAgreeing stamps in a row follow each other: the time goes on as if the first
/// of them had come right after the last that was taken.
class MicrosecondClock {
 public:
  static constexpr std::int64_t kLongestGap = 500'000;  ///< [µs] [ours: 250 samples of 512 Hz]
  static constexpr int kAgreeing = 3;                   ///< One or two may be garbage. [estimate]

  /// The time of the next sample; nullopt: refused.
  [[nodiscard]] std::optional<std::uint64_t> next(std::uint32_t stamp);

  /// How long before the last sample (negative: after it) a stamp of the same clock is [µs]; nullopt
  /// without any sample.
  [[nodiscard]] std::optional<std::int64_t> age_of(std::uint32_t stamp) const;

  /// How many in a row were refused.
  [[nodiscard]] int refused_in_a_row() const { return in_a_row_; }
  /// Time passes without a stamp [µs]: of a clock that stands.
  std::uint64_t pass(std::uint64_t period) { return time_ += period; }

  [[nodiscard]] std::uint64_t jumps() const { return jumps_; }
  [[nodiscard]] std::uint64_t wraps() const { return wraps_; }

 private:
  std::uint64_t take(std::uint32_t stamp, std::int64_t step);

  bool started_ = false;
  std::uint32_t last_ = 0;     ///< Stamp of the last sample that was taken.
  std::uint64_t time_ = 0;     ///< Its time [µs].
  std::uint32_t refused_ = 0;  ///< Stamp of the last one that was not ...
  int agreeing_ = 0;           ///< ... and how many such follow each other.
  int in_a_row_ = 0;
  std::uint64_t jumps_ = 0, wraps_ = 0;
};

}  // namespace gatefly::c_interface
