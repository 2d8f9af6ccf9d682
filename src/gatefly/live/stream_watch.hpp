// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

namespace gatefly::live {

/// Notices that a stream of pictures has stalled: nothing for two periods and a little more, of a period that it learns.
class StreamWatch {
 public:
  void arrived(std::chrono::nanoseconds now) {
    if (count_++ > 0) {
      const auto gap = std::clamp<std::chrono::nanoseconds>(now - last_, kShortest, kLongest);
      // A lost picture lengthens a gap and hardly anything shortens one, so the period rises slowly.
      period_ = gap < period_ ? period_ + (gap - period_) / 4 : period_ + (gap - period_) / 16;
    }
    last_ = now;
  }
  /// Since the last picture; before the first since the beginning.
  [[nodiscard]] std::chrono::nanoseconds age(std::chrono::nanoseconds now) const {
    return now - last_;
  }
  [[nodiscard]] std::chrono::nanoseconds period() const { return period_; }
  /// An age that says so.
  [[nodiscard]] std::chrono::nanoseconds limit() const { return 2 * period_ + kSlack; }
  /// An age at which it is taken for gone: so many pictures in a row are not lost by a camera that works.
  [[nodiscard]] std::chrono::nanoseconds gone() const { return 4 * period_ + kSlack; }
  [[nodiscard]] bool stalled(std::chrono::nanoseconds now) const {
    return count_ > 0 && age(now) > limit();
  }

 private:
  static constexpr std::chrono::nanoseconds kShortest = std::chrono::milliseconds{4},
                                            kLongest = std::chrono::milliseconds{200},
                                            kSlack = std::chrono::milliseconds{10};
  std::chrono::nanoseconds last_{0}, period_ = std::chrono::milliseconds{40};
  long count_ = 0;
};

}  // namespace gatefly::live
