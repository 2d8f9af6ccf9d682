// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>

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
  /// The same now; while parts of pictures still come, longer by what the network loses: one slice of fifty is every other picture of
  /// thirty slices, and many in a row.
  [[nodiscard]] std::chrono::nanoseconds gone(std::chrono::nanoseconds now) const {
    return now - part_ <= gone() ? std::max(2 * gone(), torn_for_) : gone();
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
    learn_losses(known);
  }
  /// For so long a network that loses pictures as it has so far loses all of them, once in a million pictures.
  void learn_losses(std::ptrdiff_t known) {
    constexpr double kOnceInAMillion = -13.8, kSlowly = 1.0 / 64;  // log; of the last two seconds
    auto sorted = gaps_;
    std::nth_element(sorted.begin(), sorted.begin() + known / 4, sorted.begin() + known);
    // Between two pictures of which none is lost, as a quarter of the gaps are at least.
    const double each = static_cast<double>(sorted[static_cast<std::size_t>(known / 4)].count());
    const double gap =
        static_cast<double>(gaps_[static_cast<std::size_t>(count_ - 1) % gaps_.size()].count());
    pictures_in_gap_ +=
        std::max(kSlowly, 1.0 / static_cast<double>(count_)) * (gap / each - pictures_in_gap_);
    const double lost = 1.0 - 1.0 / std::max(1.0, pictures_in_gap_);
    const double in_a_row = lost > 0.0 ? kOnceInAMillion / std::log(lost) : 0.0;
    torn_for_ = std::min(kLongestTorn,
                         std::chrono::nanoseconds{static_cast<std::int64_t>(in_a_row * each)});
  }

  static constexpr std::chrono::nanoseconds kShortest = std::chrono::milliseconds{4},
                                            kLongest = std::chrono::milliseconds{200},
                                            kSlack = std::chrono::milliseconds{10},
                                            kLongestTorn = std::chrono::seconds{1};
  std::array<std::chrono::nanoseconds, 15> gaps_{};
  std::chrono::nanoseconds last_{0}, part_{0}, period_ = std::chrono::milliseconds{40},
                                               torn_for_{0};
  double pictures_in_gap_ = 1.0;  ///< In the mean: 2 when every other one is lost.
  long count_ = 0;
};

}  // namespace gatefly::live
