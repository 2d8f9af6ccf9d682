// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/ts002_end.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "gatefly/geometry/math.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"

namespace gatefly::link_sim {
namespace {

constexpr double kStep = 1e-3;                                       ///< A step of the physics [s].
constexpr double kImuHz = 120.0, kAttitudeHz = 60.0, kBeatHz = 2.0;  ///< TS-002: physics at 120 Hz.
constexpr double kLetsGo = 0.5;  ///< A set point that is older is none. Ours [s].
constexpr double kSpeaks = 2.0;  ///< A pilot that has said nothing for longer is gone [s].
constexpr int kSwitchedOn = 1700;
constexpr mavlink::Sender kDrone{1, 1, 0};

/// Whether something that comes `hz` times a second is due in step number `step`.
bool is_due(long step, double hz) {
  return std::floor(hz * kStep * static_cast<double>(step)) >
         std::floor(hz * kStep * static_cast<double>(step - 1));
}

float f(double value) { return static_cast<float>(value); }

}  // namespace

Ts002End::Ts002End(const Params& params, const world::SimConfig& config)
    : params_{params},
      line_{Datagrams::to(params.port), params.network, {config.seed, "network of set points"}},
      curves_{config.autopilot},
      autopilot_{config.autopilot, config.vehicle},
      highest_{config.vehicle.max_speed},
      hover_{config.vehicle.mass * kGravity /
             (4 * config.vehicle.thrust_coefficient * highest_ * highest_)},
      gyro_{config.sensors.autopilot_gyro_cutoff},
      accel_{config.sensors.autopilot_accel_cutoff} {}

template <class Message>
void Ts002End::say(const Message& message) {
  std::array<std::uint8_t, mavlink::kLongestFrame> frame{};
  const std::size_t size =
      mavlink::encode_message(message, {kDrone.system, kDrone.component, sequence_++}, frame);
  line_.send(link::Bytes{frame}.first(size));
}

// One that was overtaken on its way is none; a clock that jumps back by more than a second has begun anew.
template <class SetPoint>
void Ts002End::take_set_point(const SetPoint& target) {
  constexpr std::uint32_t kSecond = 1000;  // [ms]
  if (target.time_boot_ms < stamp_ && stamp_ - target.time_boot_ms < kSecond) return;
  stamp_ = target.time_boot_ms;
  set_point_ = target, set_point_at_ = now_;
}

void Ts002End::listen(double now) {
  now_ = now;
  while (const auto bytes = line_.receive())
    if (!cut_) stream_.feed(*bytes, [this](const mavlink::Frame& frame) { take(frame); });
}

void Ts002End::take(const mavlink::Frame& frame) {
  if (frame.id == mavlink::Heartbeat::kId) heard_at_ = now_;
  const std::chrono::nanoseconds time{std::llround(1e9 * now_)};
  if (const auto question = mavlink::message_in<mavlink::Timesync>(frame)) {
    if (const auto answer = mavlink::clock_answer(*question, time)) say(*answer);
  } else if (const auto attitude = mavlink::message_in<mavlink::SetAttitudeTarget>(frame)) {
    take_set_point(*attitude);
  } else if (const auto place = mavlink::message_in<mavlink::SetPositionTargetLocalNed>(frame)) {
    take_set_point(*place);
  }
}

RatesAndThrust Ts002End::wanted(const betaflight_sitl::State& is) const {
  if (!set_point_at_ || now_ - *set_point_at_ > kLetsGo) return {};
  const Known known{{is.p_EB - start_, is.v_E}, is.attitude, hover_};
  return std::visit([&](const auto& target) { return wanted_of(target, known); }, set_point_);
}

void Ts002End::feel(const betaflight_sitl::State& is, const sim::BodyState&) {
  if (steps_++ == 0) start_ = is.p_EB;
  const RatesAndThrust wish = wanted(is);
  msp::Sticks sticks = curves_.rates.sticks(wish.rates_B);
  const double speed = highest_ * std::sqrt(wish.thrust);
  sticks.throttle =
      static_cast<std::uint16_t>(curves_.throttle.stick(sim::throttle_of(speed, highest_)));
  const std::array<double, 4> speeds = autopilot_.step({sticks, armed_}, is.imu, kStep);
  std::array<double, 4> pulses{};
  for (std::size_t i = 0; i < pulses.size(); ++i)
    pulses[i] = 1000.0 + (armed_ ? 1000.0 * speeds[i] / highest_ : 0.0);
  told(std::span<const double>{pulses}, {0, 1, 2, 3}, now_);
  transmit({.time = is.time,
            .imu = {gyro_.update(is.imu.gyro_B, kStep), accel_.update(is.imu.accel_B, kStep)},
            .attitude = is.attitude});
}

void Ts002End::transmit(const betaflight_sitl::State& is) {
  if (cut_) return;
  if (is_due(steps_, kBeatHz) || armed_ != told_armed_) {
    told_armed_ = armed_;
    say(mavlink::Heartbeat{.type = 2,
                           .base_mode = static_cast<std::uint8_t>(armed_ ? 128 : 0),
                           .system_status = static_cast<std::uint8_t>(armed_ ? 4 : 3),
                           .mavlink_version = 3});
  }
  if (is_due(steps_, kImuHz)) {
    const auto us = static_cast<std::uint64_t>(is.time.count() / 1000);
    const Eigen::Vector3d &a = is.imu.accel_B, &g = is.imu.gyro_B;
    mavlink::HighresImu imu{us, f(a.x()), f(a.y()), f(a.z()), f(g.x()), f(g.y()), f(g.z())};
    imu.fields_updated = 0x3F;
    say(imu);
  }
  if (params_.tells_attitude && is_due(steps_, kAttitudeHz)) {
    const auto ms = static_cast<std::uint32_t>(is.time.count() / 1'000'000);
    say(mavlink::Attitude{ms, f(is.attitude.roll), f(is.attitude.pitch), f(is.attitude.yaw),
                          f(is.imu.gyro_B.x()), f(is.imu.gyro_B.y()), f(is.imu.gyro_B.z())});
  }
}

void Ts002End::hear_radio(std::chrono::nanoseconds, const msp::Sticks&,
                          const std::array<std::uint16_t, 12>& switches) {
  armed_ = switches[0] > kSwitchedOn;
}

bool Ts002End::called() const { return heard_at_ && now_ - *heard_at_ < kSpeaks; }

double Ts002End::held_for() const { return set_point_at_ ? now_ - *set_point_at_ : 0.0; }

}  // namespace gatefly::link_sim
