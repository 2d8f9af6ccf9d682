// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/geometry/fixed_list.hpp"

namespace gatefly {

/// How often pictures arrive and how irregularly: what one arrival errs by, one standard deviation.
///
/// Ours. From the median absolute deviation of the last intervals, so that lost pictures and pauses
/// count for nothing; an interval has the errors of two arrivals.
class ArrivalJitter {
 public:
  static constexpr double kLeast = 0.010;  ///< [s] [a tick of a driver: what nobody can see]
  static constexpr double kMost = 0.060;   ///< [s] [two pictures' time at 30 Hz]
  static constexpr double kPause = 1.0;    ///< A longer time is no interval [s].

  /// A picture arrived at `time` [s].
  void arrived(double time);
  /// Within kLeast and kMost; kLeast while too little is known.
  [[nodiscard]] double sigma() const { return sigma_; }
  /// From one picture to the next, the median [s]; kPause while too little is known.
  [[nodiscard]] double interval() const { return interval_; }

 private:
  static constexpr std::size_t kKept = 31, kEnough = 8;
  FixedList<double, kKept> intervals_;
  std::size_t oldest_ = 0;
  double last_ = -1e3, sigma_ = kLeast, interval_ = kPause;
};

}  // namespace gatefly
