// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/mavlink_listener.hpp"

#include <algorithm>
#include <cmath>

#include "gatefly/link/mavlink_axes.hpp"
#include "gatefly/live/ts002_introduction.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr std::uint8_t kInAir = 4;  // MAV_STATE_ACTIVE: not landed
constexpr std::uint16_t kUnknownVoltage = 65535;
constexpr nanoseconds kBeatEvery = 500ms, kClockEvery = 200ms;
constexpr nanoseconds kAskAgain = 500ms;   ///< Interval for repeating a request without answer.
constexpr nanoseconds kFineImuGone = 1s;   ///< Then the coarse one will do.
constexpr nanoseconds kAttitudeGone = 1s;  ///< Then roll and pitch follow from the IMU ...
constexpr int kRestSamples = 60;           ///< ... of which it has seen so many at rest.
/// For so long a heartbeat of TS-002 tells whether it is armed, as long as anything else comes.
constexpr nanoseconds kBeatHolds = 3s;

nanoseconds interval_of(double hz) { return nanoseconds{std::llround(1e9 / hz)}; }

/// Whether one of that stamp comes after the last one: not a second time, nor late. A clock that jumps back by more than a second has begun anew.
template <class Stamp>
bool is_next(std::optional<Stamp>& last, Stamp stamp, Stamp second) {
  const bool late = last && stamp <= *last && *last - stamp < second;
  if (!late) last = stamp;
  return !late;
}

/// As four sticks, so that what it flies by can be compared with what was sent: mrad/s from the middle, thousandths of the thrust.
msp::Sticks sticks_of(const Eigen::Vector3d& rates_B, double thrust) {
  const auto channel = [](double value) {
    return static_cast<std::uint16_t>(
        std::lround(std::isfinite(value) ? std::clamp(value, 0.0, 3000.0) : 0.0));
  };
  return {.roll = channel(1500 + 1e3 * rates_B.x()),
          .pitch = channel(1500 - 1e3 * rates_B.y()),
          .yaw = channel(1500 + 1e3 * rates_B.z()),
          .throttle = channel(1000 + 1e3 * thrust)};
}

Ahrs levelled(const MavlinkListener::Params& params) {
  AhrsParams ahrs;
  ahrs.imu_hz = params.imu_hz;
  Ahrs level{ahrs};
  level.start(0.0);
  return level;
}

}  // namespace

msp::Sticks mavlink_sticks(const mavlink::SetAttitudeTarget& target) {
  return sticks_of({target.body_roll_rate, target.body_pitch_rate, target.body_yaw_rate},
                   target.thrust);
}

MavlinkListener::MavlinkListener(const Params& params)
    : params_{params},
      words_{params.system},
      others_{words_},
      taken_{interval_of(params.imu_hz)},
      wishes_{{{mavlink::Heartbeat::kId, interval_of(params.status_hz)},
               {mavlink::Attitude::kId, interval_of(params.attitude_hz)},
               {mavlink::SysStatus::kId, interval_of(params.battery_hz)},
               {mavlink::AttitudeTarget::kId, interval_of(params.target_hz)},
               {mavlink::HighresImu::kId, interval_of(params.imu_hz)},
               {mavlink::RawImu::kId, interval_of(params.imu_hz)}}},
      level_{levelled(params)} {}

void MavlinkListener::ask_clock(link::ByteWriter& out, nanoseconds now, bool beside_set_point) {
  // The question's own time comes back with the answer: its last bit tells what it was asked for.
  const std::int64_t tagged = (now.count() & ~std::int64_t{1}) | (beside_set_point ? 1 : 0);
  words_.ask_clock(out, nanoseconds{tagged});
  clock_asked_at_ = now;
}

bool MavlinkListener::wanted(Wishes which, nanoseconds now) const {
  const Wish& wish = wishes_[which];
  // A PX4 sends one heartbeat a second and refuses another interval: each further one has to be asked for.
  if (which == kBeat && params_.px4) return now - wish.asked >= wish.interval;
  // A PX4's is in counts, whose size nobody tells.
  if (which == kCoarseImu && params_.px4) return false;
  if (which == kCoarseImu && now - std::max(started_, wishes_[kFineImu].heard) < kFineImuGone)
    return false;
  // Heartbeats come without being asked, but once a second; so a wish is not fulfilled by any.
  const bool comes = now - wish.heard < 3 * wish.interval;
  return !comes && now - wish.asked >= kAskAgain;
}

link::Bytes MavlinkListener::request(nanoseconds now) {
  if (started_ < 0ns) started_ = now;
  link::ByteWriter out{room_};
  if (now - beat_at_ >= kBeatEvery) words_.heartbeat(out), beat_at_ = now;
  if (to_be_told_) words_.answer_clock(out, *to_be_told_), to_be_told_.reset();
  if (now - clock_asked_at_ >= kClockEvery) ask_clock(out, now, false);
  if (params_.ts002) return out.written();
  for (const Wishes which : {kBeat, kAttitude, kBattery, kTarget, kFineImu, kCoarseImu}) {
    if (!wanted(which, now)) continue;
    Wish& wish = wishes_[which];
    if (which == kBeat && params_.px4)
      words_.ask_once(out, wish.message);
    else
      words_.ask_for(out, wish.message,
                     std::chrono::duration_cast<std::chrono::microseconds>(wish.interval));
    wish.asked = now;
    ++state_.asked;
  }
  return out.written();
}

bool MavlinkListener::take(link::Bytes bytes, nanoseconds now) {
  sampled_ = false;
  stream_.feed(bytes, [&](const mavlink::Frame& frame) { take_frame(frame, now); });
  return sampled_;
}

void MavlinkListener::take_sample(const Imu& imu, std::uint64_t stamp_us, nanoseconds now) {
  if (!imu.gyro_B.allFinite() || !imu.accel_B.allFinite()) return;
  const std::optional<std::uint64_t> before = stamp_;
  if (!is_next<std::uint64_t>(stamp_, stamp_us, 1'000'000)) return;
  // An IMU that repeats itself is stuck, whatever its stamp says.
  std::array<std::uint8_t, 6 * sizeof(double)> values{};
  link::ByteWriter out{values};
  for (const Eigen::Vector3d& part : {imu.gyro_B, imu.accel_B})
    for (int i = 0; i < 3; ++i) out.put(part[i]);
  imu_watch_.arrived(values, now);
  const bool goes_on = before && stamp_us > *before && stamp_us - *before < 1'000'000;
  state_.imu_taken =
      goes_on ? taken_.take(now, std::chrono::microseconds{stamp_us - *before}) : taken_.take(now);
  state_.imu = imu;
  state_.imu_at = now;
  state_.imu_changed_at = now - imu_watch_.age(now).value_or(0ns);
  level_by(imu,
           goes_on ? std::optional{1e-6 * static_cast<double>(stamp_us - *before)} : std::nullopt,
           now);
  ++state_.samples;
  sampled_ = true;
}

// Not of a real drone: its own attitude is the one that it flies by, and while it does not come no turn is commanded.
void MavlinkListener::level_by(const Imu& imu, std::optional<double> since_last, nanoseconds now) {
  if (!params_.ts002 || heard_beat_at_ < 0ns) return;
  if (!state_.armed)
    level_.update_at_rest(imu);
  else if (since_last)
    level_.update(imu, Eigen::Vector3d::Zero(), *since_last);
  // One that hears it only in the air does not know what was level.
  if (level_.rest_samples() < kRestSamples) return;
  if (now - std::max(started_, wishes_[kAttitude].heard) < kAttitudeGone) return;
  state_.attitude = level_.attitude();
  state_.attitude_at = now;
}

void MavlinkListener::take_clock(const mavlink::Timesync& message, nanoseconds now) {
  if (const auto answer = mavlink::clock_answer(message, now)) {
    to_be_told_ = answer;
  } else if (message.tc1 != 0 && message.ts1 > 0 && message.ts1 <= now.count() + 1) {
    if (const auto offset = mavlink::clock_offset(message, now)) clock_.take(*offset, now);
    const bool once = message.ts1 > last_answered_;
    if ((message.ts1 & 1) != 0 && once) ++state_.acknowledged, last_answered_ = message.ts1;
  }
}

bool MavlinkListener::override_in(const mavlink::Heartbeat& beat) const {
  if (params_.ts002) return beat.is_armed();
  return params_.px4 ? mavlink::is_offboard(beat.custom_mode)
                     : beat.custom_mode == mavlink::kGuidedNoGps;
}

void MavlinkListener::take_frame(const mavlink::Frame& frame, nanoseconds now) {
  others_.heard(frame);
  state_.other_client = others_.other_client() || (params_.ts002 && is_real_);
  if (!words_.is_drone(frame.sender)) return;
  for (Wish& wish : wishes_)
    if (wish.message == frame.id) wish.heard = now;
  if (const auto beat = mavlink::message_in<mavlink::Heartbeat>(frame)) {
    const bool was_armed = state_.armed;
    state_.armed = beat->is_armed();
    if (was_armed && !state_.armed) level_ = levelled(params_);
    // A real drone's autopilot is somebody else's to fly.
    is_real_ = is_real_ || autopilot_in(*beat);
    state_.override_on = override_in(*beat);
    // An armed PX4 says the same of itself on the floor: who looks on at it needs --carried.
    state_.lifted = state_.armed && !params_.px4 && beat->system_status >= kInAir;
    heard_beat_at_ = now;
  } else if (const auto fine = mavlink::message_in<mavlink::HighresImu>(frame)) {
    take_sample(mavlink::imu_of(*fine), fine->time_usec, now);
  } else if (const auto coarse = mavlink::message_in<mavlink::RawImu>(frame)) {
    if (!params_.px4 && now - wishes_[kFineImu].heard >= kFineImuGone)
      take_sample(mavlink::ardupilot_imu_of(*coarse), coarse->time_usec, now);
  } else if (const auto attitude = mavlink::message_in<mavlink::Attitude>(frame)) {
    const gatefly::Attitude is = mavlink::attitude_of(*attitude);
    if (!std::isfinite(is.roll) || !std::isfinite(is.pitch) || !std::isfinite(is.yaw)) return;
    if (!is_next<std::uint32_t>(attitude_stamp_, attitude->time_boot_ms, 1000)) return;
    const std::chrono::milliseconds stamp{attitude->time_boot_ms};
    state_.attitude = is;
    state_.attitude_at = now - clock_.age(stamp, now).value_or(0ns);
  } else if (const auto status = mavlink::message_in<mavlink::SysStatus>(frame)) {
    const bool known = status->voltage_battery != kUnknownVoltage;
    state_.battery_v = known ? 1e-3 * status->voltage_battery : 0.0;
  } else if (const auto target = mavlink::message_in<mavlink::AttitudeTarget>(frame)) {
    if (!is_next<std::uint32_t>(target_stamp_, target->time_boot_ms, 1000)) return;
    state_.sticks = sticks_of(
        {target->body_roll_rate, target->body_pitch_rate, target->body_yaw_rate}, target->thrust);
    state_.sticks_at = now;
  } else if (const auto clock = mavlink::message_in<mavlink::Timesync>(frame)) {
    take_clock(*clock, now);
  }
  const bool holds = now - heard_beat_at_ <= (params_.ts002 ? kBeatHolds : 0ns);
  if (holds) state_.status_at = now;
}

}  // namespace gatefly::live
