// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace gatefly {

/// When samples were taken that come without stamps, from when they arrive.
///
/// Ours: a phase-locked loop of second order. What the way here takes, now more, now less, moves a
/// sample by a seventh of it, and never for long: intervals add up to the time that passes, so that
/// what is integrated over them stays right. The mean way is not seen; a camera's delay, which a
/// filter finds, has it in it. No clock of its own, no libm.
class ArrivalClock {
 public:
  /// @param nominal_hz  about how many come in a second; their own rate is found, within 1/4 and 2.5.
  explicit ArrivalClock(double nominal_hz) : nominal_{1.0 / nominal_hz}, period_{nominal_} {}

  /// A sample arrived at `time` [s], later than the one before.
  void arrived(double time);

  [[nodiscard]] bool runs() const { return time_.has_value(); }
  /// When the last one was taken: never after its arrival, and after the one before [s].
  [[nodiscard]] double time() const { return time_.value_or(0.0); }
  /// Between the last two [s]; 0 while there is one.
  [[nodiscard]] double interval() const { return interval_; }

 private:
  double nominal_, period_;  ///< [s]
  std::optional<double> time_;
  double interval_ = 0.0;
};

}  // namespace gatefly
