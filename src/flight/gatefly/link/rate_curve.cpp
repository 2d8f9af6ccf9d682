// SPDX-License-Identifier: Apache-2.0
#include "gatefly/link/rate_curve.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/geometry/math.hpp"

namespace gatefly::msp {
namespace {

constexpr int kLeastStick = 1000, kMostStick = 2000;
constexpr double kHalfTravel = 500.0;  ///< [µs]

/// Degrees a second at `x`, 0 … 1 of the stick's way.
double betaflight_rate(const RateCurve& curve, double x) {
  const double e = curve.expo / 100.0;
  double r = curve.rc_rate / 100.0;
  if (r > 2.0) r += 14.54 * (r - 2.0);
  const double bent = x * (1.0 - e) + x * x * x * x * e;
  return 200.0 * r * bent / std::clamp(1.0 - x * curve.super_rate / 100.0, 0.01, 1.0);
}

double actual_rate(const RateCurve& curve, double x) {
  const double e = curve.expo / 100.0;
  const double center = 10.0 * curve.rc_rate;
  const double more = std::max(0.0, 10.0 * curve.super_rate - center);
  return x * center + more * x * (x * (1.0 - e) + x * x * x * x * x * e);
}

/// Rate of a stick `away` µs from the middle, which is not negative [rad/s].
double rate_away(const RateCurve& curve, int away) {
  const double moved = std::max(0.0, std::min(double(away), kHalfTravel) - curve.deadband);
  const double x = moved / (kHalfTravel - curve.deadband);
  const double rate =
      curve.type == RateCurve::Type::kActual ? actual_rate(curve, x) : betaflight_rate(curve, x);
  return kDegree * std::min(rate, curve.limit_deg_per_s);
}

RateCurve curve_of(const RcTuning& tuning, int rc_rate, int super_rate, int expo, int limit,
                   int deadband, int mid) {
  return {.type = static_cast<RateCurve::Type>(tuning.rates_type),
          .rc_rate = double(rc_rate),
          .super_rate = double(super_rate),
          .expo = double(expo),
          .limit_deg_per_s = double(limit),
          .mid = mid,
          .deadband = deadband};
}

std::uint16_t in_channel(int stick) { return static_cast<std::uint16_t>(stick); }

}  // namespace

double RateCurve::rate(int stick) const {
  const int away = std::clamp(stick, kLeastStick, kMostStick) - mid;
  return away < 0 ? -rate_away(*this, -away) : rate_away(*this, away);
}

int RateCurve::stick(double rate) const {
  if (!std::isfinite(rate)) return mid;
  const double wanted = std::abs(rate);
  const int sign = rate < 0.0 ? -1 : 1;
  // The curve never falls: the first place that is fast enough, or the one before.
  int slow = 0, fast = sign < 0 ? mid - kLeastStick : kMostStick - mid;
  // At most ten times: each halves what is left of a thousand places.
  while (slow < fast) {
    const int middle = (slow + fast) / 2;
    if (rate_away(*this, middle) < wanted)
      slow = middle + 1;
    else
      fast = middle;
  }
  if (fast > 0 && wanted - rate_away(*this, fast - 1) < rate_away(*this, fast) - wanted) --fast;
  // The curve is flat at the middle and at the limit: the stick nearest to the middle is taken, at
  // most a thousand places on.
  while (fast > 0 && rate_away(*this, fast - 1) == rate_away(*this, fast)) --fast;
  return mid + sign * fast;
}

std::optional<RateProfile> RateProfile::from(const RcTuning& tuning, const RcDeadband& deadband,
                                             const RxConfig& receiver) {
  const auto type = static_cast<RateCurve::Type>(tuning.rates_type);
  if (type != RateCurve::Type::kBetaflight && type != RateCurve::Type::kActual) return std::nullopt;
  const int mid = receiver.mid;
  if (mid <= kLeastStick || mid >= kMostStick) return std::nullopt;
  // Beyond 100 % a curve would fall somewhere; no controller lets it be set.
  if (std::max({tuning.roll_expo, tuning.pitch_expo, tuning.yaw_expo}) > 100) return std::nullopt;
  if (std::min({tuning.rate_limit[0], tuning.rate_limit[1], tuning.rate_limit[2]}) == 0)
    return std::nullopt;
  return RateProfile{curve_of(tuning, tuning.roll_rc_rate, tuning.super_rate[0], tuning.roll_expo,
                              tuning.rate_limit[0], deadband.roll_and_pitch, mid),
                     curve_of(tuning, tuning.pitch_rc_rate, tuning.super_rate[1], tuning.pitch_expo,
                              tuning.rate_limit[1], deadband.roll_and_pitch, mid),
                     curve_of(tuning, tuning.yaw_rc_rate, tuning.super_rate[2], tuning.yaw_expo,
                              tuning.rate_limit[2], deadband.yaw, mid)};
}

Sticks RateProfile::sticks(const Eigen::Vector3d& rates_B) const {
  const Eigen::Vector3d wanted = stick_rates(rates_B);
  return {.roll = in_channel(roll.stick(wanted.x())),
          .pitch = in_channel(pitch.stick(wanted.y())),
          .yaw = in_channel(yaw.stick(wanted.z()))};
}

Eigen::Vector3d RateProfile::rates(const Sticks& sticks) const {
  return body_rates({roll.rate(sticks.roll), pitch.rate(sticks.pitch), yaw.rate(sticks.yaw)});
}

}  // namespace gatefly::msp
