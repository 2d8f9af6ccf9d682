// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/throttle_curve.hpp"

#include <algorithm>

namespace gatefly::msp {
namespace {

constexpr int kFullStick = 2000;  ///< [µs]
constexpr int kFull = 1000;       ///< Full stick and throttle, in thousandths.

int tenth(int i, int mid, int expo) {
  const int d = 10 * i - mid;
  const int y = std::max(1, d > 0 ? 100 - mid : mid);
  return 10 * mid + d * (100 - expo + expo * d * d / (y * y)) / 10;
}

}  // namespace

std::optional<ThrottleCurve> ThrottleCurve::from(const RcTuning& tuning, const RxConfig& receiver) {
  const bool known = tuning.throttle_hover == RcTuning::kNoHover && tuning.throttle_limit == 0 &&
                     tuning.throttle_mid <= 100 && tuning.throttle_expo <= 100 &&
                     receiver.min_check >= 750 && receiver.min_check < kFullStick;
  if (!known) return std::nullopt;
  return ThrottleCurve{tuning.throttle_mid, tuning.throttle_expo, receiver.min_check};
}

ThrottleCurve::ThrottleCurve(int mid, int expo, int min_check) : min_check_{min_check} {
  for (std::size_t i = 0; i < tenths_.size(); ++i)
    tenths_[i] = tenth(static_cast<int>(i), mid, expo);
}

int ThrottleCurve::throttle(int stick) const {
  const int above = std::clamp(stick, min_check_, kFullStick) - min_check_;
  const int t = above * kFull / (kFullStick - min_check_);
  const auto i = static_cast<std::size_t>(std::min(t / 100, 9));
  const int along = t - 100 * static_cast<int>(i);
  return tenths_[i] + along * (tenths_[i + 1] - tenths_[i]) / 100;
}

int ThrottleCurve::stick(int throttle_wanted) const {
  int low = min_check_, high = kFullStick;
  // At most eleven times: each halves what is left of 2,000 places.
  while (low < high) {
    const int middle = (low + high) / 2;
    if (throttle(middle) < throttle_wanted)
      low = middle + 1;
    else
      high = middle;
  }
  return high;
}

}  // namespace gatefly::msp
