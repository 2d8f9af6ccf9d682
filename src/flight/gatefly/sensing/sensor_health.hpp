// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace gatefly {

/// Counts the readings that were refused or are doubtful, by kind, since the pilot was made.
struct SensorHealth {
  std::uint64_t imu_not_finite = 0;     ///< Samples with NaN or infinity: the last one goes on.
  std::uint64_t imu_out_of_range = 0;   ///< Samples that no sensor reads: the same.
  std::uint64_t imu_stuck = 0;          ///< Samples equal to those before for too long: the same.
  std::uint64_t imu_stale = 0;          ///< Stamped like an earlier one, or before it: the same.
  std::uint64_t imu_saturated = 0;      ///< Samples at the end of the sensor's range: used.
  std::uint64_t clock_jumps = 0;        ///< So often the IMU's stamps went on from another time.
  std::uint64_t heights_refused = 0;    ///< No number, or one that no sensor reads.
  std::uint64_t heights_stuck = 0;      ///< Equal to those before for too long: refused, too.
  std::uint64_t pictures_repeated = 0;  ///< The same picture again: nothing is looked for in it.
};

/// One of the counts above, for who reports them.
struct SensorCount {
  const char* key;   ///< As summaries name it.
  const char* what;  ///< In words, before the number.
  std::uint64_t SensorHealth::*count;
};

/// All of them.
inline constexpr std::array<SensorCount, 9> kSensorCounts{{
    {"imu_not_finite", "IMU samples that are no numbers", &SensorHealth::imu_not_finite},
    {"imu_out_of_range", "IMU samples out of range", &SensorHealth::imu_out_of_range},
    {"imu_stuck", "IMU samples stuck", &SensorHealth::imu_stuck},
    {"imu_stale", "IMU samples stale", &SensorHealth::imu_stale},
    {"imu_saturated", "IMU samples saturated", &SensorHealth::imu_saturated},
    {"clock_jumps", "jumps of the clock", &SensorHealth::clock_jumps},
    {"heights_refused", "heights refused", &SensorHealth::heights_refused},
    {"heights_stuck", "heights stuck", &SensorHealth::heights_stuck},
    {"pictures_repeated", "pictures repeated", &SensorHealth::pictures_repeated},
}};

}  // namespace gatefly
