// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include "gatefly/geometry/fixed_list.hpp"
#include "gatefly/guard/answer_watch.hpp"
#include "gatefly/link/msp.hpp"
#include "gatefly/link/msp_axes.hpp"
#include "gatefly/link/msp_lists.hpp"
#include "gatefly/live/arrival_clock.hpp"
#include "gatefly/live/dialect.hpp"

namespace gatefly::live {

/// Asks a Betaflight over MSP for what a pilot needs, in turn, and reads the answers. Bytes in, bytes out: it opens no port.
///
/// IMU and attitude are asked for with every turn; status and sticks, battery and height in some. As many as are due go in one
/// request (MSP_MULTIPLE_MSP); one after the other when the controller refuses that. A request is lost after a while. A controller takes
/// so many commands a second, a Betaflight 100 at most: stick frames come first, and questions wait until they are acknowledged.
class MspPoller : public Listener {
 public:
  struct Params {
    std::chrono::nanoseconds turn = std::chrono::milliseconds{20};  ///< 50 a second. Ours.
    int status_every = 4, battery_every = 25;                       ///< Turns.
    std::chrono::nanoseconds lost_after = std::chrono::milliseconds{60};
    /// From here on the throttle's stick lifts a drone [µs].
    int lifting_stick = 2000;
  };
  MspPoller(const msp::ImuScale& scale, const msp::BoxIds& boxes)
      : MspPoller(scale, boxes, Params{}) {}
  MspPoller(const msp::ImuScale& scale, const msp::BoxIds& boxes, const Params& params);

  [[nodiscard]] link::Bytes request(std::chrono::nanoseconds now) override;
  bool take(link::Bytes bytes, std::chrono::nanoseconds now) override;
  [[nodiscard]] const ControllerState& state() const override { return state_; }

 protected:
  /// Stick frames are sent by somebody else, who says so.
  void sticks_sent();

 private:
  [[nodiscard]] bool waits_for_sticks(std::chrono::nanoseconds now);
  void begin_turn(std::chrono::nanoseconds now);
  void take_frame(const msp::Frame& frame, std::chrono::nanoseconds now);
  void take_answer(std::uint16_t id, link::Bytes payload, std::chrono::nanoseconds now);

  msp::ImuScale scale_;
  msp::BoxIds boxes_;
  Params params_;
  msp::Stream stream_;
  guard::AnswerWatch answers_;
  guard::SampleWatch imu_watch_;
  ArrivalClock taken_;
  ControllerState state_;
  FixedList<std::uint8_t, 8> due_;    ///< Left to ask for in this turn.
  FixedList<std::uint8_t, 8> asked_;  ///< In the request that is open; empty: none is.
  std::chrono::nanoseconds asked_at_{0}, next_turn_{0};
  int sticks_open_ = 0;  ///< Stick frames that are not acknowledged.
  std::optional<std::chrono::nanoseconds> waits_since_;  ///< A question waits for them.
  int turn_ = 0;
  bool batched_ = true, sampled_ = false;
  std::array<std::uint8_t, 32> room_{};
};

}  // namespace gatefly::live
