// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/stamped_arrivals.hpp"

#include <algorithm>

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

// Ours, all of them.
constexpr nanoseconds kSecond = 1s;
constexpr nanoseconds kCompared = 4s;  ///< The two quickest are of the ends of so long a time, ...
constexpr nanoseconds kAtLeast = 2s;   ///< ... or of this, at the beginning.
constexpr nanoseconds kSame = 5ms;  ///< They stand alike: what jitter leaves of a difference, ...
constexpr int kSlow = 200;          ///< ... and a clock that is so little off, 0.5 %.
constexpr nanoseconds kAnotherClock = 1s;  ///< No picture is that late: a sender has begun anew.
/// No clock that counts nanoseconds shows more than 146 years; so that differences do not overflow.
constexpr nanoseconds kLatest{nanoseconds::max() / 2};

}  // namespace

nanoseconds StampedArrivals::late(nanoseconds arrival, nanoseconds stamp) {
  if (stamp < 0ns || stamp > kLatest) return 0ns;
  const nanoseconds took = arrival - stamp;
  last_[count_++ % kKept] = {arrival, took};
  const std::size_t known = std::min(count_, kKept);
  nanoseconds oldest = arrival;
  for (std::size_t i = 0; i < known; ++i)
    if (arrival - last_[i].at <= kCompared) oldest = std::min(oldest, last_[i].at);
  nanoseconds quickest = took, before = nanoseconds::max();
  for (std::size_t i = 0; i < known; ++i) {
    const Arrived& each = last_[i];
    if (arrival - each.at <= kSecond) quickest = std::min(quickest, each.took);
    if (each.at >= oldest && each.at - oldest <= kSecond) before = std::min(before, each.took);
  }
  const nanoseconds late = took - quickest, span = arrival - oldest;
  if (late > kAnotherClock) count_ = 0;
  const bool alike = std::chrono::abs(quickest - before) <= kSame + (span - kSecond) / kSlow;
  return late <= kAnotherClock && span >= kAtLeast && alike ? late : 0ns;
}

}  // namespace gatefly::live
