// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/px4_introduction.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include "gatefly/link/mavlink_axes.hpp"
#include "gatefly/live/autopilot_questions.hpp"

namespace gatefly::live {

Px4Introduction px4_introduction_of(Port& port, int system) {
  return AutopilotQuestions<Px4Introduction>{port, system, guard::kPx4Parameters,
                                             mavlink::px4_value_of}
      .answers();
}

bool is_px4(Port& port, int system) {
  using namespace std::chrono_literals;
  MavlinkWords words{system};
  mavlink::Stream stream;
  std::array<std::uint8_t, 2048> room{};
  std::array<std::uint8_t, 64> call{};
  std::optional<bool> is;
  Moment again = Clock::now();
  for (const Moment end = Clock::now() + 5s; !is && Clock::now() < end;) {
    if (Clock::now() >= again) {
      // One that is called by datagrams says nothing before.
      link::ByteWriter out{call};
      words.heartbeat(out);
      (void)port.write(out.written(), Clock::now() + 200ms);
      again = Clock::now() + 300ms;
    }
    const auto got = port.read(room, Clock::now() + 20ms);
    if (!got) return false;
    stream.feed(link::Bytes{room}.first(*got), [&](const mavlink::Frame& frame) {
      const auto beat = mavlink::message_in<mavlink::Heartbeat>(frame);
      if (beat && words.is_drone(frame.sender) && !is)
        is = beat->autopilot == mavlink::Heartbeat::kPx4;
    });
  }
  return is.value_or(false);
}

}  // namespace gatefly::live
