// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include "gatefly/estimation/ahrs.hpp"
#include "gatefly/guard/answer_watch.hpp"
#include "gatefly/link/mavlink.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"
#include "gatefly/live/arrival_clock.hpp"
#include "gatefly/live/dialect.hpp"
#include "gatefly/live/mavlink_words.hpp"
#include "gatefly/live/peer_clock.hpp"

namespace gatefly::live {

/// A set point as sticks are, in ControllerState::sticks, too: mrad/s from 1500, pitch as a stick has it, thousandths of the thrust
/// from 1000.
[[nodiscard]] msp::Sticks mavlink_sticks(const mavlink::SetAttitudeTarget& target);

/// Asks an autopilot over MAVLink 2 to send what a pilot needs, again when it does not come, and reads it. Bytes in, bytes out: it
/// opens no port.
///
/// HIGHRES_IMU, of those that do not have it RAW_IMU, whose stamps are the autopilot's own: samples go to the pilot as regularly as
/// they were taken. TIMESYNC questions tell that both ways of the line are there, and how old an attitude is that a slow line has held up.
/// Messages that arrive twice or out of order, as datagrams may, are not taken. Only the drone's autopilot is heard, and who else might fly
/// it. Roll and pitch of a TS-002 simulator that tells no attitude follow from its IMU, if it was heard at rest before it was armed.
class MavlinkListener : public Listener {
 public:
  struct Params {
    int system = 1;
    double imu_hz = 50.0;
    double attitude_hz = 50.0, status_hz = 10.0, battery_hz = 2.0, target_hz = 20.0;  ///< Ours.
    bool px4 = false;  ///< A PX4; else an ArduCopter, or:
    /// A simulator that speaks TS-002, and no real drone: it is armed for nobody but us, sends what it sends without being asked, perhaps a
    /// heartbeat a second and no attitude.
    bool ts002 = false;
  };
  explicit MavlinkListener(const Params& params);

  [[nodiscard]] link::Bytes request(std::chrono::nanoseconds now) override;
  bool take(link::Bytes bytes, std::chrono::nanoseconds now) override;
  [[nodiscard]] const ControllerState& state() const override { return state_; }

 protected:
  [[nodiscard]] MavlinkWords& words() { return words_; }
  /// Asks for the clock; an answer acknowledges the set point that went with the question.
  void ask_clock(link::ByteWriter& out, std::chrono::nanoseconds now, bool beside_set_point);

 private:
  /// Messages that it is to send by itself.
  struct Wish {
    std::uint32_t message = 0;
    std::chrono::nanoseconds interval{0}, heard = ControllerState::kNever,
                                          asked = ControllerState::kNever;
  };
  enum Wishes { kBeat, kAttitude, kBattery, kTarget, kFineImu, kCoarseImu };

  void take_frame(const mavlink::Frame& frame, std::chrono::nanoseconds now);
  void take_sample(const Imu& imu, std::uint64_t stamp_us, std::chrono::nanoseconds now);
  void level_by(const Imu& imu, std::optional<double> since_last, std::chrono::nanoseconds now);
  void take_clock(const mavlink::Timesync& message, std::chrono::nanoseconds now);
  [[nodiscard]] bool override_in(const mavlink::Heartbeat& beat) const;
  [[nodiscard]] bool wanted(Wishes which, std::chrono::nanoseconds now) const;

  Params params_;
  MavlinkWords words_;
  OtherSpeakers others_;
  mavlink::Stream stream_;
  ControllerState state_;
  guard::SampleWatch imu_watch_;
  ArrivalClock taken_;
  std::array<Wish, 6> wishes_;
  std::chrono::nanoseconds beat_at_ = ControllerState::kNever,
                           clock_asked_at_ = ControllerState::kNever,
                           started_ = ControllerState::kNever,
                           heard_beat_at_ = ControllerState::kNever;
  std::optional<std::uint64_t> stamp_;                          ///< Stamp of the last sample [µs].
  std::optional<std::uint32_t> attitude_stamp_, target_stamp_;  ///< Stamps of the last ones [ms].
  std::int64_t last_answered_ = 0;  ///< Time of the last question of a set point that was answered.
  PeerClock clock_;
  Ahrs level_;  ///< Roll and pitch of a TS-002 simulator by its IMU.
  std::optional<mavlink::Timesync> to_be_told_;  ///< It has asked for our clock.
  bool sampled_ = false, is_real_ = false;
  std::array<std::uint8_t, 512> room_{};
};

}  // namespace gatefly::live
