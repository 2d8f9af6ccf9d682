// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>

namespace gatefly::live {

/// Notices that a stream of pictures has stalled: nothing for two periods and a little more, of a period that it learns.
class StreamWatch {
 public:
  void arrived(std::chrono::nanoseconds now) {
    if (count_ > 0) {
      gaps_[static_cast<std::size_t>(count_ - 1) % gaps_.size()] =
          std::clamp<std::chrono::nanoseconds>(now - last_, kShortest, kLongest);
      learn();
    }
    ++count_;
    last_ = part_ = now;
  }
  /// Something of a new picture came which is not whole yet: the camera works, whatever the network loses.
  void part_arrived(std::chrono::nanoseconds now) { part_ = std::max(part_, now); }
  /// Since the last picture; before the first since the beginning.
  [[nodiscard]] std::chrono::nanoseconds age(std::chrono::nanoseconds now) const {
    return now - last_;
  }
  [[nodiscard]] std::chrono::nanoseconds period() const { return period_; }
  /// An age that says so.
  [[nodiscard]] std::chrono::nanoseconds limit() const { return 2 * period_ + kSlack; }
  /// An age at which it is taken for gone: so many pictures in a row are not lost by a camera that works.
  [[nodiscard]] std::chrono::nanoseconds gone() const { return 4 * period_ + kSlack; }
  /// The same now; twice that while parts of pictures still come, as a network that loses one slice of fifty tears every
  /// eighth picture.
  [[nodiscard]] std::chrono::nanoseconds gone(std::chrono::nanoseconds now) const {
    return now - part_ <= gone() ? 2 * gone() : gone();
  }
  [[nodiscard]] bool stalled(std::chrono::nanoseconds now) const {
    return count_ > 0 && age(now) > limit();
  }

 private:
  /// The median of the last gaps: it does not see a lost picture, nor one that is early after one that was late.
  void learn() {
    const auto known =
        static_cast<std::ptrdiff_t>(std::min(static_cast<std::size_t>(count_), gaps_.size()));
    auto sorted = gaps_;
    std::nth_element(sorted.begin(), sorted.begin() + known / 2, sorted.begin() + known);
    period_ = sorted[static_cast<std::size_t>(known / 2)];
  }

  static constexpr std::chrono::nanoseconds kShortest = std::chrono::milliseconds{4},
                                            kLongest = std::chrono::milliseconds{200},
                                            kSlack = std::chrono::milliseconds{10};
  std::array<std::chrono::nanoseconds, 15> gaps_{};
  std::chrono::nanoseconds last_{0}, part_{0}, period_ = std::chrono::milliseconds{40};
  long count_ = 0;
};

}  // namespace gatefly::live
