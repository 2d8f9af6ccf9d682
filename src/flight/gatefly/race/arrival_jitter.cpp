// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/arrival_jitter.hpp"

#include <algorithm>
#include <cmath>

namespace gatefly {
namespace {

template <class List>
double median_of(List& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void ArrivalJitter::arrived(double time) {
  constexpr double kSigmaOfMad = 1.0483;  // 1.4826 of a normal number, by √2 of a difference
  const double interval = time - last_;
  last_ = time;
  if (!(interval > 0.0 && interval < kPause)) return;
  if (intervals_.size() < kKept) {
    (void)intervals_.push_back(interval);
  } else {
    intervals_[oldest_] = interval;
    oldest_ = (oldest_ + 1) % kKept;
  }
  if (intervals_.size() < kEnough) return;
  auto sorted = intervals_;
  interval_ = median_of(sorted);
  for (double& one : sorted) one = std::abs(one - interval_);
  sigma_ = std::clamp(kSigmaOfMad * median_of(sorted), kLeast, kMost);
}

}  // namespace gatefly
