// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/intake.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace gatefly {
namespace {

Imu no_reading() {
  const auto nothing = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  return {nothing, nothing};
}

// Detections are told apart by their corners, as pictures by their bytes.
std::uint64_t fingerprint_of(const SeenGates& seen) {
  constexpr std::uint64_t kPrime = 0x100000001b3;
  std::uint64_t hash = 0;
  for (const GateDetection& gate : seen.gates)
    for (const Eigen::Vector2d& corner : gate.corners_px)
      for (const double px : corner) hash = (hash ^ std::bit_cast<std::uint64_t>(px)) * kPrime;
  return hash;
}

}  // namespace

const Sensors& Intake::take(const Sensors& sensors, bool rotors_turn) {
  taken_ = sensors;
  const SampleClock::Reading reading = clock_.next(sensors.time);
  taken_.time = reading.time;
  time_ = std::chrono::duration<double>(reading.time).count();
  take_imu(sensors, reading.taken, rotors_turn);
  take_heights(rotors_turn);
  if (sensors.image || sensors.seen) take_picture();
  health_.clock_jumps = clock_.jumps(), health_.imu_stale = clock_.refused();
  return taken_;
}

void Intake::take_imu(const Sensors& sensors, bool fresh, bool rotors_turn) {
  if (sensors.navigation_imu) {
    has_slow_ = true;
    if (counts(slow_.judge(*sensors.navigation_imu, time_, rotors_turn)))
      taken_.navigation_imu.reset();
  }
  if (!fresh) {
    taken_.imu = no_reading();
    return;
  }
  // Beside an autopilot's own samples this one is the last of them, held.
  if (counts(imu_.judge(sensors.imu, time_, rotors_turn && !has_slow_))) taken_.imu = no_reading();
  health_.imu_saturated += imu_.saturated();
}

void Intake::take_heights(bool rotors_turn) {
  const auto refuse = [&](std::optional<double>& height, SensorFault fault) {
    if (fault == SensorFault::kNone) return;
    ++(fault == SensorFault::kStuck ? health_.heights_stuck : health_.heights_refused);
    height.reset();
  };
  if (auto& sonar = taken_.sonar)
    refuse(sonar, sonar_.judge(*sonar, fault_of_sonar(*sonar), time_, rotors_turn));
  if (auto& baro = taken_.baro)
    refuse(baro, baro_.judge(*baro, fault_of_baro(*baro), time_, rotors_turn));
}

void Intake::take_picture() {
  constexpr double kMostLate = 1.0;  // a stamp that says more is of another clock [s]. [estimate]
  constexpr int kMean = 32;  // of so many intervals, one standard deviation is a sixth. [estimate]
  if (has_picture_) {
    intervals_ = std::min(intervals_ + 1, kMean);
    interval_ += (time_ - picture_at_ - interval_) / intervals_;
  }
  has_picture_ = true, picture_at_ = time_;
  if (!(taken_.picture_late > 0.0 && taken_.picture_late <= kMostLate)) taken_.picture_late = 0.0;
  const std::uint64_t picture =
      taken_.seen ? fingerprint_of(*taken_.seen) : gatefly::fingerprint_of(*taken_.image);
  if (picture != 0 && picture == picture_) {
    ++health_.pictures_repeated;
    taken_.seen.reset();
    taken_.image = Image{};
  }
  picture_ = picture;
}

double Intake::picture_interval() const {
  constexpr double kSigmas = 2.0;  // pictures that are lost at random: a mean of n errs by 1 / √n
  return intervals_ > 0 ? interval_ * (1.0 + kSigmas / std::sqrt(intervals_)) : 0.0;
}

// True where a sample is not to be used.
bool Intake::counts(SensorFault fault) {
  health_.imu_not_finite += fault == SensorFault::kNotFinite;
  health_.imu_out_of_range += fault == SensorFault::kOutOfRange;
  health_.imu_stuck += fault == SensorFault::kStuck;
  return fault != SensorFault::kNone;
}

}  // namespace gatefly
