// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string_view>

#include "gatefly/link/bytes.hpp"
#include "gatefly/link/mavlink.hpp"
#include "gatefly/link/mavlink_axes.hpp"
#include "gatefly/link/mavlink_commands.hpp"

namespace gatefly::live {

/// Messages to an autopilot, from a companion computer: its own system, component 191. None of it arms, changes the mode or sets a
/// parameter: there is no such word.
class MavlinkWords {
 public:
  static constexpr std::uint8_t kOurComponent = 191, kAutopilot = 1;

  explicit MavlinkWords(int system) : system_{static_cast<std::uint8_t>(system)} {}

  void heartbeat(link::ByteWriter& out);
  /// A message, once.
  void ask_once(link::ByteWriter& out, std::uint32_t message);
  /// A message, again and again.
  void ask_for(link::ByteWriter& out, std::uint32_t message, std::chrono::microseconds interval);
  void ask_parameter(link::ByteWriter& out, std::string_view name);
  void ask_clock(link::ByteWriter& out, std::chrono::nanoseconds now);
  void answer_clock(link::ByteWriter& out, const mavlink::Timesync& answer);
  void set_point(link::ByteWriter& out, const mavlink::SetAttitudeTarget& target);

  [[nodiscard]] int system() const { return system_; }
  [[nodiscard]] mavlink::Target drone() const { return {system_, kAutopilot}; }
  [[nodiscard]] bool is_drone(const mavlink::Sender& sender) const {
    return sender.system == system_ && sender.component == kAutopilot;
  }
  [[nodiscard]] bool is_us(const mavlink::Sender& sender) const {
    return sender.system == system_ && sender.component == kOurComponent;
  }

 private:
  template <class Message>
  void say(link::ByteWriter& out, const Message& message);

  std::uint8_t system_, sequence_ = 0;
};

/// Notices others who may fly the same drone: one with our name, or another computer aboard. A ground station may be there: it is where
/// the safety pilot looks.
class OtherSpeakers {
 public:
  explicit OtherSpeakers(const MavlinkWords& us) : us_{us} {}
  void heard(const mavlink::Frame& frame);
  /// One may be a garbled frame.
  [[nodiscard]] bool other_client() const { return heard_ >= 2; }

 private:
  MavlinkWords us_;
  int heard_ = 0;
};

}  // namespace gatefly::live
