// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "gatefly/link/bytes.hpp"

namespace gatefly::guard {

/// Notices a second client of a controller: answers to what was not asked. Two at once hang a Betaflight 4.4.
class AnswerWatch {
 public:
  void asked(std::uint16_t id);
  /// An answer or a refusal has come.
  void answered(std::uint16_t id);
  /// Ours: one may be a garbled one; of two somebody else has asked.
  [[nodiscard]] bool other_client() const { return strange_ >= 2; }

 private:
  /// Questions without an answer; more were lost. A controller that is behind answers late, not to somebody else: a second and
  /// more of stick frames.
  static constexpr std::uint8_t kMostOpen = 60;
  std::array<std::uint8_t, 256> open_{};
  int strange_ = 0;
};

/// How old a sensor's samples are. One that repeats itself to the bit is stuck, not fresh: a gyro has noise.
class SampleWatch {
 public:
  /// A sample arrived; its bytes.
  void arrived(link::Bytes sample, std::chrono::nanoseconds now);
  /// Since the last one that was new; nullopt before the first.
  [[nodiscard]] std::optional<std::chrono::nanoseconds> age(std::chrono::nanoseconds now) const;

 private:
  std::optional<std::chrono::nanoseconds> changed_;
  std::uint64_t fingerprint_ = 0;
};

}  // namespace gatefly::guard
