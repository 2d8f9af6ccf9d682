// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "gatefly/live/clock.hpp"
#include "gatefly/live/mavlink_words.hpp"
#include "gatefly/live/port.hpp"

namespace gatefly::live {

/// Asks an autopilot that speaks MAVLink about itself, one question at a time, and listens to all that comes. `Introduction` has facts of
/// guard::AutopilotFacts, and other_client.
template <class Introduction>
class AutopilotQuestions {
 public:
  /// @param names  of the parameters that its facts have. @param value_of  what a parameter's message says.
  AutopilotQuestions(Port& port, int system, std::span<const std::string_view> names,
                     float (*value_of)(const mavlink::ParamValue&))
      : port_{port}, words_{system}, names_{names}, value_of_{value_of} {}

  /// @throws std::runtime_error one line: nobody of that id is there.
  [[nodiscard]] Introduction answers() {
    using namespace std::chrono_literals;
    constexpr auto kPatience = 5s;  // a controller that has just been switched on is slow
    constexpr auto kAgain = 300ms;  // a question that is not answered is asked again
    const Moment end = Clock::now() + kPatience;
    Moment again = Clock::now();
    while (Clock::now() < end && (!all_there() || !heard_others())) {
      if (Clock::now() >= again && !all_there()) ask(), again = Clock::now() + kAgain;
      if (listen(std::min(again, Clock::now() + 20ms))) again = Clock::now();
    }
    if (!said_.facts.heartbeat)
      throw std::runtime_error(port_.name() + ": no MAVLink 2 from system " +
                               std::to_string(words_.system()));
    said_.other_client = others_.other_client();
    return said_;
  }

 private:
  /// Any other ground station or pilot sends a heartbeat each second.
  [[nodiscard]] bool heard_others() const {
    return Clock::now() - began_ > std::chrono::milliseconds{1200};
  }
  [[nodiscard]] std::optional<std::size_t> missing_parameter() const {
    const auto& all = said_.facts.parameters;
    const auto found = std::find(all.begin(), all.end(), std::nullopt);
    if (found == all.end()) return std::nullopt;
    return static_cast<std::size_t>(found - all.begin());
  }
  [[nodiscard]] bool all_there() const {
    return said_.facts.heartbeat && said_.facts.version && said_.facts.sensors &&
           !missing_parameter();
  }
  void ask() {
    link::ByteWriter out{room_};
    words_.heartbeat(out);
    if (!said_.facts.version) words_.ask_once(out, mavlink::AutopilotVersion::kId);
    if (!said_.facts.sensors) words_.ask_once(out, mavlink::SysStatus::kId);
    if (const auto missing = missing_parameter()) words_.ask_parameter(out, names_[*missing]);
    (void)port_.write(out.written(), Clock::now() + std::chrono::milliseconds{200});
  }
  [[nodiscard]] static std::string_view name_in(const std::array<char, 16>& id) {
    const auto end = std::find(id.begin(), id.end(), '\0');
    return {id.data(), static_cast<std::size_t>(end - id.begin())};
  }
  /// @return whether an answer has come that the next question has waited for.
  bool listen(Moment until) {
    const auto got = port_.read(incoming_, until);
    if (!got) throw std::runtime_error(port_.name() + ": has closed the connection");
    bool answered = false;
    stream_.feed(link::Bytes{incoming_}.first(*got), [&](const mavlink::Frame& frame) {
      others_.heard(frame);
      if (!words_.is_drone(frame.sender)) return;
      auto& facts = said_.facts;
      if (const auto beat = mavlink::message_in<mavlink::Heartbeat>(frame)) facts.heartbeat = beat;
      if (const auto is = mavlink::message_in<mavlink::AutopilotVersion>(frame)) facts.version = is;
      if (const auto is = mavlink::message_in<mavlink::SysStatus>(frame)) facts.sensors = is;
      const auto value = mavlink::message_in<mavlink::ParamValue>(frame);
      if (!value) return;
      for (std::size_t i = 0; i < names_.size(); ++i) {
        if (name_in(value->param_id) != names_[i]) continue;
        facts.parameters[i] = value_of_(*value);
        answered = true;
      }
    });
    return answered;
  }

  Port& port_;
  MavlinkWords words_;
  std::span<const std::string_view> names_;
  float (*value_of_)(const mavlink::ParamValue&);
  OtherSpeakers others_{words_};
  mavlink::Stream stream_;
  Moment began_ = Clock::now();
  Introduction said_;
  std::array<std::uint8_t, 512> room_{};
  std::array<std::uint8_t, 2048> incoming_{};
};

}  // namespace gatefly::live
