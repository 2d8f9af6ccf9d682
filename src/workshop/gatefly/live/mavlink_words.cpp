// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/mavlink_words.hpp"

#include <algorithm>
#include <array>

#include "gatefly/link/mavlink_telemetry.hpp"

namespace gatefly::live {
namespace {

constexpr std::uint8_t kComputerAboard = 18, kNoAutopilot = 8, kActive = 4, kVersion2 = 3;
constexpr std::uint16_t kSetMessageInterval = 511, kRequestMessage = 512;
constexpr int kMostStrange = 1000;

}  // namespace

template <class Message>
void MavlinkWords::say(link::ByteWriter& out, const Message& message) {
  std::array<std::uint8_t, mavlink::kLongestFrame> frame{};
  const std::size_t size =
      mavlink::encode_message(message, {system_, kOurComponent, sequence_++}, frame);
  out.put_bytes(link::Bytes{frame}.first(size));
}

void MavlinkWords::heartbeat(link::ByteWriter& out) {
  say(out, mavlink::Heartbeat{.type = kComputerAboard,
                              .autopilot = kNoAutopilot,
                              .system_status = kActive,
                              .mavlink_version = kVersion2});
}

void MavlinkWords::ask_once(link::ByteWriter& out, std::uint32_t message) {
  say(out, mavlink::CommandLong{.param1 = static_cast<float>(message),
                                .command = kRequestMessage,
                                .target_system = system_,
                                .target_component = kAutopilot});
}

void MavlinkWords::ask_for(link::ByteWriter& out, std::uint32_t message,
                           std::chrono::microseconds interval) {
  say(out, mavlink::CommandLong{.param1 = static_cast<float>(message),
                                .param2 = static_cast<float>(interval.count()),
                                .command = kSetMessageInterval,
                                .target_system = system_,
                                .target_component = kAutopilot});
}

void MavlinkWords::ask_parameter(link::ByteWriter& out, std::string_view name) {
  mavlink::ParamRequestRead question;
  question.param_index = -1;
  question.target_system = system_;
  question.target_component = kAutopilot;
  std::copy_n(name.begin(), std::min(name.size(), question.param_id.size()),
              question.param_id.begin());
  say(out, question);
}

void MavlinkWords::ask_clock(link::ByteWriter& out, std::chrono::nanoseconds now) {
  say(out, mavlink::clock_question(now));
}

void MavlinkWords::answer_clock(link::ByteWriter& out, const mavlink::Timesync& answer) {
  say(out, answer);
}

void MavlinkWords::set_point(link::ByteWriter& out, const mavlink::SetAttitudeTarget& target) {
  say(out, target);
}

void OtherSpeakers::heard(const mavlink::Frame& frame) {
  const auto beat = mavlink::message_in<mavlink::Heartbeat>(frame);
  const bool strange = us_.is_us(frame.sender) || (beat && beat->type == kComputerAboard);
  if (strange) heard_ = std::min(heard_ + 1, kMostStrange);
}

}  // namespace gatefly::live
