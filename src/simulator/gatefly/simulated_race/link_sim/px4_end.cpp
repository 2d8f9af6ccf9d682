// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/px4_end.hpp"

#include <array>
#include <cmath>

#include "gatefly/geometry/math.hpp"
#include "gatefly/link/mavlink_commands.hpp"
#include "gatefly/link/mavlink_telemetry.hpp"
#include "gatefly/live/clock.hpp"

namespace gatefly::link_sim {
namespace {

constexpr int kStepsASample = 4, kSamplesAFix = 25;  ///< IMU at 250 Hz, satellites at 10 Hz.
constexpr double kSampleTime = 4e-3;                 ///< [s]
constexpr int kSwitchIsOn = 1700;
constexpr double kProgramSpeaks = 2.0;  ///< One that has said nothing for longer is gone [s].

/// Earth's magnetic field where betaflight_sitl::Origin is: north, east, down [gauss]; and a sensor's noise, of which PX4 sees that it lives.
const Eigen::Vector3d kField{0.192, 0.008, 0.452};
constexpr double kFieldNoise = 1e-3;
constexpr double kWarm = 25.0;  ///< Of the barometer [°C].

constexpr std::uint16_t kSetMode = 176, kArmOrDisarm = 400;
constexpr float kCustomMode = 1.0F, kForced = 21196.0F;
constexpr float kAuto = 4.0F, kHold = 3.0F;  ///< PX4's main mode, and of it the sub mode.
constexpr double kStationBeats = 1.0, kSaysAgain = 0.25;  ///< [s]
constexpr mavlink::Sender kStation{255, 190, 0};
constexpr std::uint8_t kStationType = 6, kNoAutopilot = 8, kIsActive = 4, kMavlink2 = 3;

float narrowed(double value) { return static_cast<float>(value); }

/// By the standard atmosphere [hPa], at a height above the sea [m].
double pressure_at(double height) { return 1013.25 * std::pow(1.0 - 2.25577e-5 * height, 5.25588); }

mavlink::HilGps fix_of(const betaflight_sitl::State& is) {
  constexpr double kRadius = 6371e3;  // [m]
  const betaflight_sitl::Origin origin;
  const double north = is.p_EB.x() / kRadius / kDegree,
               east = is.p_EB.y() / kRadius / kDegree / std::cos(origin.latitude_deg * kDegree);
  const auto whole = [](double value) { return static_cast<std::int32_t>(std::lround(value)); };
  const auto cm = [](double value) { return static_cast<std::int16_t>(std::lround(1e2 * value)); };
  mavlink::HilGps fix;
  fix.time_usec = static_cast<std::uint64_t>(is.time.count() / 1000);
  fix.lat = whole(1e7 * (origin.latitude_deg + north));
  fix.lon = whole(1e7 * (origin.longitude_deg + east));
  fix.alt = whole(-1e3 * is.p_EB.z());
  fix.eph = 50, fix.epv = 80;  // [cm]
  fix.vel = static_cast<std::uint16_t>(cm(is.v_E.norm()));
  fix.vn = cm(is.v_E.x()), fix.ve = cm(is.v_E.y()), fix.vd = cm(is.v_E.z());
  fix.cog = 65535;  // not known
  fix.fix_type = 3, fix.satellites_visible = 12;
  return fix;
}

}  // namespace

template <class Message>
void GroundStation::say(const Message& message) {
  std::array<std::uint8_t, mavlink::kLongestFrame> frame{};
  const std::size_t size =
      mavlink::encode_message(message, {kStation.system, kStation.component, sequence_++}, frame);
  line_.send(link::Bytes{frame}.first(size));
}

void GroundStation::command(const mavlink::CommandLong& command) {
  mavlink::CommandLong said = command;
  said.target_system = 1, said.target_component = 1;
  say(said);
}

void GroundStation::Switch::move(bool to) {
  if (to == on) return;
  on = to, done = false;
  said_at.reset();
}

bool GroundStation::Switch::is_to_be_said(double now) {
  if (done || (said_at && now - *said_at < kSaysAgain)) return false;
  said_at = now;
  return true;
}

void GroundStation::heard(const mavlink::Heartbeat& beat) {
  is_armed_ = beat.is_armed();
  if (is_armed_ == arm_.on) arm_.done = true;
  if (mavlink::is_offboard(beat.custom_mode) == offboard_.on) offboard_.done = true;
}

void GroundStation::step(double now, bool armed, bool offboard) {
  if (!beaten_at_ || now - *beaten_at_ >= kStationBeats) {
    beaten_at_ = now;
    say(mavlink::Heartbeat{.type = kStationType,
                           .autopilot = kNoAutopilot,
                           .system_status = kIsActive,
                           .mavlink_version = kMavlink2});
  }
  arm_.move(armed), offboard_.move(offboard);
  if (arm_.is_to_be_said(now))
    command(
        {.param1 = armed ? 1.0F : 0.0F, .param2 = armed ? 0.0F : kForced, .command = kArmOrDisarm});
  // Armed first: a program that finds the mode chosen before does not fly.
  if (offboard && !is_armed_) return;
  if (offboard_.is_to_be_said(now))
    command({.param1 = kCustomMode,
             .param2 = offboard ? narrowed(mavlink::kPx4Offboard) : kAuto,
             .param3 = offboard ? 0.0F : kHold,
             .command = kSetMode});
}

Px4End::Px4End(const Params& params, const world::SimConfig& config)
    : door_{params.simulator},
      companion_{Datagrams::at(params.companion)},
      program_{Datagrams::to(params.port), params.network, {config.seed, "network of set points"}},
      station_{params.station},
      baro_{config.sensors, config.seed},
      magnetometer_{config.seed, "magnetometer"} {}

template <class Message>
void Px4End::say(const Message& message) {
  if (!px4_) return;
  std::array<std::uint8_t, mavlink::kLongestFrame> frame{};
  const std::size_t size = mavlink::encode_message(message, {1, 200, sequence_++}, frame);
  // Its buffer holds seconds: one that is full, or closed, is of a PX4 that has gone.
  if (!px4_->write(link::Bytes{frame}.first(size), live::Clock::now())) px4_.reset();
}

void Px4End::listen(double now) {
  now_ = now;
  if (std::optional<live::Port> caller = door_.caller()) {
    px4_.emplace(std::move(*caller));
    motors_told_.restart();
  }
  hear_motors();
  relay();
  armed_ = armed_ && px4_.has_value();
  stop_if_silent(now);
}

void Px4End::hear_motors() {
  std::array<std::uint8_t, 4096> room{};
  while (px4_) {
    const auto got = px4_->read(room, live::Clock::now());
    if (!got) px4_.reset();
    if (!got || *got == 0) return;
    motors_told_.feed(link::Bytes{room}.first(*got), [this](const mavlink::Frame& frame) {
      const auto is = mavlink::message_in<mavlink::HilActuatorControls>(frame);
      if (!is) return;
      armed_ = (is->mode & mavlink::Heartbeat::kArmedBit) != 0;
      std::array<double, 4> pulses{};
      for (std::size_t i = 0; i < 4; ++i) pulses[i] = 1000.0 + 1000.0 * double(is->controls[i]);
      // PX4 counts front right, rear left, front left, rear right.
      told(std::span<const double>{pulses}, {2, 0, 3, 1}, now_);
    });
  }
}

void Px4End::relay() {
  std::array<std::uint8_t, 2048> room{};
  while (const auto bytes = companion_.receive(room)) {
    said_by_px4_.feed(*bytes, [this](const mavlink::Frame& frame) {
      const auto beat = mavlink::message_in<mavlink::Heartbeat>(frame);
      if (beat && beat->autopilot == mavlink::Heartbeat::kPx4) station_.heard(*beat);
    });
    if (!cut_) program_.send(*bytes);
  }
  while (const auto bytes = program_.receive()) {
    if (cut_) continue;
    said_by_program_.feed(*bytes, [this](const mavlink::Frame& frame) {
      if (frame.id == mavlink::Heartbeat::kId) heard_at_ = now_;
      if (frame.id == mavlink::SetAttitudeTarget::kId) set_point_at_ = now_;
    });
    companion_.answer(*bytes);
  }
}

mavlink::HilSensor Px4End::sensors(const betaflight_sitl::State& is, const sim::BodyState& body) {
  // The mean since the last one: between two of them its sensors felt all of it.
  const Eigen::Vector3d gyro = gyro_ / felt_, accel = accel_ / felt_;
  const Eigen::Vector3d noise{magnetometer_.normal(), magnetometer_.normal(),
                              magnetometer_.normal()};
  const Eigen::Vector3d field = sim::R_EB_of(body.q_EB).transpose() * kField + kFieldNoise * noise;
  const double height = baro_.measure(body, kSampleTime);
  return {.time_usec = static_cast<std::uint64_t>(is.time.count() / 1000),
          .xacc = narrowed(accel.x()),
          .yacc = narrowed(accel.y()),
          .zacc = narrowed(accel.z()),
          .xgyro = narrowed(gyro.x()),
          .ygyro = narrowed(gyro.y()),
          .zgyro = narrowed(gyro.z()),
          .xmag = narrowed(field.x()),
          .ymag = narrowed(field.y()),
          .zmag = narrowed(field.z()),
          .abs_pressure = narrowed(pressure_at(height)),
          .pressure_alt = narrowed(height),
          .temperature = narrowed(kWarm),
          .fields_updated = 0x1FFF};
}

void Px4End::feel(const betaflight_sitl::State& is, const sim::BodyState& body) {
  gyro_ += is.imu.gyro_B, accel_ += is.imu.accel_B;
  if (++felt_ < kStepsASample) return;
  say(sensors(is, body));
  if (sent_++ % kSamplesAFix == 0) say(fix_of(is));
  gyro_.setZero(), accel_.setZero(), felt_ = 0;
}

void Px4End::hear_radio(std::chrono::nanoseconds, const msp::Sticks&,
                        const std::array<std::uint16_t, 12>& switches) {
  station_.step(now_, switches[0] > kSwitchIsOn, switches[4] > kSwitchIsOn);
}

bool Px4End::called() const { return heard_at_ && now_ - *heard_at_ < kProgramSpeaks; }

double Px4End::held_for() const { return set_point_at_ ? now_ - *set_point_at_ : 0.0; }

}  // namespace gatefly::link_sim
