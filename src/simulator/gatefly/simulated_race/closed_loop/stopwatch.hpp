// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "gatefly/simulated_race/closed_loop/race.hpp"

namespace gatefly::simulated_race {

/// Wall-clock of one stage, for the summary's `timings`; nothing in the race depends on it. Of a flight
/// of hours the last minutes count.
class Stopwatch {
 public:
  explicit Stopwatch(std::string stage) : stage_{std::move(stage)} { samples_.reserve(kMost); }
  template <class Work>
  auto time(Work&& work) {
    const auto from = std::chrono::steady_clock::now();
    struct AtEnd {
      Stopwatch* self;
      std::chrono::steady_clock::time_point from;
      ~AtEnd() {
        self->add(std::chrono::duration<float, std::micro>(std::chrono::steady_clock::now() - from)
                      .count());
      }
    } at_end{this, from};
    return work();
  }
  /// Time of the latest sample [s]; before the first: 0.
  [[nodiscard]] double latest() const { return 1e-6 * static_cast<double>(latest_); }
  [[nodiscard]] StageTime result() {
    if (samples_.empty()) return {stage_};
    std::sort(samples_.begin(), samples_.end());
    const auto at = [&](double q) {
      return static_cast<double>(
          samples_[static_cast<std::size_t>(q * static_cast<double>(samples_.size() - 1))]);
    };
    return {stage_, at(0.5), at(0.99), at(1.0)};
  }

 private:
  static constexpr std::size_t kMost = 1 << 17;  // 256 s at 512 Hz: the longest race

  void add(float microseconds) {
    latest_ = microseconds;
    if (samples_.size() < kMost)
      samples_.push_back(microseconds);
    else
      samples_[next_++ % kMost] = microseconds;
  }

  std::string stage_;
  std::vector<float> samples_;
  std::size_t next_ = 0;  ///< To be overwritten, once there are kMost.
  float latest_ = 0.0F;
};

}  // namespace gatefly::simulated_race
