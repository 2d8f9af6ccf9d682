// SPDX-License-Identifier: Apache-2.0
#include "microsecond_clock.hpp"

#include <algorithm>

namespace gatefly::c_interface {
namespace {

// Modulo 2^32, the shorter way round.
std::int64_t difference(std::uint32_t later, std::uint32_t earlier) {
  return static_cast<std::int32_t>(later - earlier);
}

bool follows(std::int64_t step) { return step > 0 && step <= MicrosecondClock::kLongestGap; }

}  // namespace

std::optional<std::uint64_t> MicrosecondClock::next(std::uint32_t stamp) {
  if (!started_) {
    started_ = true;
    last_ = stamp, time_ = stamp;
    return time_;
  }
  const std::int64_t step = difference(stamp, last_);
  if (follows(step)) return take(stamp, step);
  const std::int64_t after_refused = difference(stamp, refused_);
  agreeing_ = agreeing_ > 0 && follows(after_refused) ? agreeing_ + 1 : 1;
  refused_ = stamp;
  in_a_row_ = std::min(in_a_row_ + 1, 1'000'000);
  if (agreeing_ < kAgreeing) return std::nullopt;
  ++jumps_;
  // As long as since the sample before: what passed while samples were refused nobody knows.
  return take(stamp, after_refused);
}

std::uint64_t MicrosecondClock::take(std::uint32_t stamp, std::int64_t step) {
  const bool jumped = agreeing_ >= kAgreeing;
  if (stamp < last_ && !jumped) ++wraps_;
  agreeing_ = in_a_row_ = 0;
  last_ = stamp;
  time_ += static_cast<std::uint64_t>(step);
  return time_;
}

std::optional<std::int64_t> MicrosecondClock::age_of(std::uint32_t stamp) const {
  if (!started_) return std::nullopt;
  return difference(last_, stamp);
}

}  // namespace gatefly::c_interface
