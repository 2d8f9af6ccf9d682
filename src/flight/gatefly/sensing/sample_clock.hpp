// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

namespace gatefly {

/// Stamps of a clock that may jump or stand, as a time that only goes on.
///
/// Ours. A stamp that is not later than the last one is refused, and no time passes. A step of more
/// than 50 ms (or five periods), forward or back, is no step but another time: it is counted, taken
/// as an offset from then on, and one period passes. So does a clock that was set back by less, once
/// three stamps in a row follow each other. Where the clock stands for 0.1 s, a period passes with
/// each stamp that is refused, so that whoever waits for samples notices. Where no stamp jumps, times
/// are stamps, to the bit. Allocates nothing, total for every input.
class SampleClock {
 public:
  /// @param nominal_hz  samples a second, > 0.
  explicit SampleClock(double nominal_hz);

  struct Reading {
    std::chrono::nanoseconds time{0};  ///< Never before that of the reading before.
    bool taken = false;                ///< False: the sample is not newer than one that was taken.
  };
  /// The next sample's stamp.
  [[nodiscard]] Reading next(std::chrono::nanoseconds stamp);

  [[nodiscard]] std::uint64_t jumps() const { return jumps_; }
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  Reading take(std::chrono::nanoseconds stamp, std::chrono::nanoseconds step);

  std::chrono::nanoseconds period_, longest_;
  int stands_;                        ///< So many refused in a row: the clock stands.
  std::chrono::nanoseconds last_{0};  ///< Stamp of the last sample that was taken ...
  std::chrono::nanoseconds time_{0};  ///< ... and its time.
  std::chrono::nanoseconds last_refused_{0};
  int following_ = 0;  ///< So many refused stamps follow each other ...
  int in_a_row_ = 0;   ///< ... of those that were refused since one was taken.
  bool started_ = false;
  std::uint64_t jumps_ = 0, refused_ = 0;
};

}  // namespace gatefly
