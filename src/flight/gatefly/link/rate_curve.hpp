// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "gatefly/link/msp_axes.hpp"
#include "gatefly/link/msp_messages.hpp"

namespace gatefly::msp {

/// How fast a stick makes a drone turn: one axis of a Betaflight rate profile.
///
/// Source: Betaflight's documented rates of type BETAFLIGHT and ACTUAL; with x the stick in −1 … 1,
///   BETAFLIGHT  200 r (x (1 − e) + x |x|³ e) / (1 − |x| s)   [°/s], r = rc_rate / 100 (beyond 2 it grows by
///               15.54 for each), e = expo / 100, s = super_rate / 100
///   ACTUAL      x c + (m − c) |x| (x (1 − e) + x⁵ e)         [°/s], c = 10 rc_rate, m = 10 super_rate, at least c
/// A straight line through its ends has a loop gain of 0.4 to 1.6 of what was meant: it is never one.
struct RateCurve {
  enum class Type : std::uint8_t { kBetaflight = 0, kActual = 3 };
  Type type = Type::kBetaflight;
  double rc_rate = 100.0, super_rate = 70.0, expo = 0.0;  ///< As they are set and sent.
  double limit_deg_per_s = 1998.0;
  int mid = 1500, deadband = 0;  ///< [µs]

  /// Turn rate with the stick at `stick` [µs], positive above the middle [rad/s].
  [[nodiscard]] double rate(int stick) const;
  /// The stick, 1000 … 2000 µs, whose rate is nearest to `rate` [rad/s], the one nearest to the middle where
  /// several have it; a rate out of reach is met as far as possible, what is not finite is the middle.
  [[nodiscard]] int stick(double rate) const;
};

/// All three. There is no other way to sticks from rates.
struct RateProfile {
  RateCurve roll, pitch, yaw;

  /// nullopt when the drone has rates of another type, or what no drone has: it must not be flown by a guess.
  [[nodiscard]] static std::optional<RateProfile> from(const RcTuning& tuning,
                                                       const RcDeadband& deadband,
                                                       const RxConfig& receiver);
  /// Sticks for rates about front, right, down [rad/s]; the throttle is left at its least.
  [[nodiscard]] Sticks sticks(const Eigen::Vector3d& rates_B) const;
  /// Rates about front, right, down that the sticks ask for [rad/s].
  [[nodiscard]] Eigen::Vector3d rates(const Sticks& sticks) const;
};

}  // namespace gatefly::msp
