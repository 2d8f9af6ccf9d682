// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>

namespace gatefly::live {

/// How late something stamped by another clock came, against the quickest of the last second.
///
/// Ours. The quickest of a second tells how the clocks stand, if it stands as the quickest of a few seconds ago did: else the other clock goes faster or slower,
/// has jumped, or stands, and says nothing. The delay that all have in common cannot be told from the clocks' offset: of pictures it is the camera's latency,
/// which the calibration knows and the filter corrects.
class StampedArrivals {
 public:
  /// One arrives at `arrival` that the other clock stamped `stamp`. @return 0 or more; 0 also while nothing can be told.
  std::chrono::nanoseconds late(std::chrono::nanoseconds arrival, std::chrono::nanoseconds stamp);

 private:
  struct Arrived {
    std::chrono::nanoseconds at{0}, took{0};  ///< Arrival less stamp.
  };
  static constexpr std::size_t kKept = 512;  ///< Four seconds at 120 Hz. Ours.

  std::array<Arrived, kKept> last_{};
  std::size_t count_ = 0;
};

}  // namespace gatefly::live
