// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <deque>
#include <string>

#include "gatefly/link/msp_axes.hpp"
#include "gatefly/live/clock.hpp"

namespace gatefly::live {

/// Roll, pitch, yaw, throttle of both that differ by more than `within_us`.
[[nodiscard]] std::array<bool, 4> differing(const msp::Sticks& a, const msp::Sticks& b,
                                            int within_us);
[[nodiscard]] bool same_sticks(const msp::Sticks& a, const msp::Sticks& b, int within_us);
/// "roll 1600, pitch 1350, yaw 1700, throttle 1362"
[[nodiscard]] std::string text_of(const msp::Sticks& sticks);

/// Compares the channels that a controller flies by with the stick frames that were sent to it.
///
/// Sticks that are read back must be those of a frame of the last kLag, or of the one in effect at its beginning: the line, the
/// controller and the answer take time. A frame counts as a whole: channels of two frames are none of them. One that rounds steps off, as
/// ArduCopter does with set points, may be on its way between two of these frames.
class ChannelWatch {
 public:
  static constexpr std::chrono::nanoseconds kLag =
      std::chrono::milliseconds{130};  ///< Two periods of sticks and a turn of the status.
  static constexpr int kWithin = 2;    ///< [µs]

  explicit ChannelWatch(bool rounds_steps_off = false) : rounds_steps_off_{rounds_steps_off} {}

  /// Only what is read back from then on counts.
  void begin(Moment from);
  void sent(const msp::Sticks& sticks, Moment at);
  /// In the order of time, after all frames that were sent before.
  void read(const msp::Sticks& sticks, Moment at);

  [[nodiscard]] int reads() const { return reads_; }
  [[nodiscard]] int wrong() const { return wrong_; }
  /// The last that was read was right.
  [[nodiscard]] bool follows() const { return follows_; }
  /// The longest time for which a newer frame was not to be seen yet.
  [[nodiscard]] std::chrono::nanoseconds behind() const { return behind_; }
  /// "yaw and throttle": those that did not follow; "" when all did.
  [[nodiscard]] std::string not_following() const;
  /// The first that was wrong.
  [[nodiscard]] const msp::Sticks& wrong_one() const { return wrong_one_; }

 private:
  struct Frame {
    msp::Sticks sticks;
    Moment at;
  };
  [[nodiscard]] bool between_frames(const msp::Sticks& sticks, Moment at) const;

  bool rounds_steps_off_;
  std::deque<Frame> frames_;  ///< Newest last.
  Moment from_{};
  int reads_ = 0, wrong_ = 0;
  bool follows_ = false;
  std::array<bool, 4> off_{};
  msp::Sticks wrong_one_;
  std::chrono::nanoseconds behind_{0};
};

}  // namespace gatefly::live
