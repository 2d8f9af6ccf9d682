// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "gatefly/sensing/image.hpp"
#include "gatefly/sensing/imu.hpp"

namespace gatefly {

/// Why a reading is not used.
enum class SensorFault { kNone, kNotFinite, kOutOfRange, kStuck };

/// Judges a sample by itself: whether it is a number, and one that a sensor can read.
[[nodiscard]] SensorFault fault_of(const Imu& imu);

/// The same of a range to what is below, in (0, 100) m, and of a height by pressure, within 1000 m.
[[nodiscard]] SensorFault fault_of_sonar(double range);
[[nodiscard]] SensorFault fault_of_baro(double height);

/// A number that two pictures share only if they are the same, bit for bit; 0 where nothing is in it
/// by which it could be told: an empty one, or one of a single colour.
///
/// Ours: FNV-1a over up to 256 pieces of 8 bytes, spread over the picture. A picture from a camera
/// has noise in each of them.
[[nodiscard]] std::uint64_t fingerprint_of(const Image& image);

/// How long a reading has been the same, bit for bit.
class Standstill {
 public:
  /// @param same     whether this reading equals the one before.
  /// @param watched  false: equal readings mean nothing now, and it begins anew.
  void update(bool same, bool watched, double time) {
    if (same && watched) {
      equal_ += equal_ < kMany;
    } else {
      equal_ = 0, since_ = time;
    }
    time_ = time;
  }
  /// Whether at least so many in a row equal the one before them, over at least so long [s].
  [[nodiscard]] bool is(int equal, double seconds) const {
    return equal_ >= equal && time_ - since_ >= seconds;
  }

 private:
  static constexpr int kMany = 1'000'000;
  int equal_ = 0;
  double since_ = 0.0, time_ = 0.0;
};

/// Watches one IMU: rejects what is no sample, and a sensor that says the same again and again.
///
/// In flight rotors shake every sample of every IMU; on the ground a coarse one may say the same for
/// long, so that standing still counts only where rotors turn. Allocates nothing.
class ImuWatch {
 public:
  /// @param time         of the sample [s].
  /// @param rotors_turn  whether equal samples are a fault.
  /// @return what is wrong with it.
  [[nodiscard]] SensorFault judge(const Imu& imu, double time, bool rotors_turn);

  /// Whether the last sample that was judged was one of a sensor that is stuck.
  [[nodiscard]] bool stuck() const { return stuck_; }
  /// Whether it is at the end of the sensor's range: a large value comes twice, bit for bit, while
  /// others of the sample go on.
  [[nodiscard]] bool saturated() const { return saturated_; }

 private:
  Imu last_;
  Standstill same_;
  bool stuck_ = false, saturated_ = false;
};

/// Watches one sensor of heights: the same, after two seconds.
class HeightWatch {
 public:
  /// @param fault        what the reading alone shows.
  /// @param rotors_turn  whether equal readings are a fault.
  [[nodiscard]] SensorFault judge(double height, SensorFault fault, double time, bool rotors_turn);

 private:
  double last_ = 0.0;
  Standstill same_;
};

}  // namespace gatefly
