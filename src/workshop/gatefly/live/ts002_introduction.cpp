// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/ts002_introduction.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>
#include <string>

#include "gatefly/live/clock.hpp"
#include "gatefly/live/mavlink_words.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;

constexpr auto kStartsWithin = 5s;   ///< A simulator that has just been started is slow.
constexpr auto kAskedAgain = 300ms;  ///< A question that is not answered is asked again.
constexpr auto kOthers = 1200ms;     ///< Any other program sends a heartbeat each second.
constexpr std::uint8_t kUnknownMake = 0, kNoMake = 8;

}  // namespace

std::optional<std::string_view> autopilot_in(const mavlink::Heartbeat& beat) {
  if (beat.autopilot == mavlink::Heartbeat::kArduPilot) return "an ArduPilot";
  if (beat.autopilot == mavlink::Heartbeat::kPx4) return "a PX4";
  if (beat.autopilot != kUnknownMake && beat.autopilot != kNoMake)
    return "an autopilot of a known make";
  return std::nullopt;
}

Ts002Introduction ts002_introduction_of(Port& port, int system) {
  MavlinkWords words{system};
  OtherSpeakers others{words};
  mavlink::Stream stream;
  std::array<std::uint8_t, 512> room{};
  std::array<std::uint8_t, 2048> incoming{};
  Ts002Introduction said;
  bool beat_heard = false, imu_heard = false;
  const RunClock clock;
  Moment again = Clock::now();
  const auto complete = [&] { return beat_heard && imu_heard && said.clock; };
  while (clock.now() < kStartsWithin && (!complete() || clock.now() < kOthers)) {
    if (Clock::now() >= again) {
      link::ByteWriter out{room};
      words.heartbeat(out);
      words.ask_clock(out, clock.now());
      (void)port.write(out.written(), Clock::now() + 200ms);
      again = Clock::now() + kAskedAgain;
    }
    const auto got = port.read(incoming, std::min(again, Clock::now() + 20ms));
    if (!got) throw std::runtime_error(port.name() + ": has closed the connection");
    stream.feed(link::Bytes{incoming}.first(*got), [&](const mavlink::Frame& frame) {
      others.heard(frame);
      if (!words.is_drone(frame.sender)) return;
      if (const auto beat = mavlink::message_in<mavlink::Heartbeat>(frame)) {
        beat_heard = true;
        said.armed = beat->is_armed();
        said.autopilot = autopilot_in(*beat);
      }
      if (mavlink::message_in<mavlink::HighresImu>(frame)) imu_heard = true;
      const auto time = mavlink::message_in<mavlink::Timesync>(frame);
      if (time && mavlink::clock_offset(*time, clock.now())) said.clock = true;
    });
  }
  if (!beat_heard)
    throw std::runtime_error(port.name() + ": no MAVLink 2 from system " + std::to_string(system));
  if (!imu_heard) throw std::runtime_error(port.name() + ": sends no HIGHRES_IMU");
  said.other_client = others.other_client();
  return said;
}

}  // namespace gatefly::live
