// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string_view>

namespace gatefly::guard {

/// State of drone and program, as known at the beginning of a period. Ages are since arrival; what has never come is
/// older than any limit.
struct Situation {
  std::chrono::nanoseconds time{0};  ///< Time of our clock; does not run backwards.
  bool hand_over_tested =
      false;  ///< A test without propellers, of this drone and this program, has passed.
  bool course_can_be_flown = false;
  bool armed = false, override_on = false;  ///< As the controller last said.
  bool other_client = false;                ///< Somebody else talks to the controller: AnswerWatch.
  int acknowledged = 0;  ///< Stick frames of ours that it has answered since the start.
  std::chrono::nanoseconds status_age = kNever, attitude_age = kNever, picture_age = kNever;
  std::chrono::nanoseconds command_age = kNever;  ///< Age of the pilot's last answer.
  std::chrono::nanoseconds height_age =
      kNever;         ///< Since a gate or a range finder told the height.
  double tilt = 0.0;  ///< Between body and vertical [rad].
  bool inside_fence = true;
  double battery_v = 0.0;  ///< 0: not known.
  bool told_to_end = false;

  static constexpr std::chrono::nanoseconds kNever = std::chrono::hours{24};
};

/// Kinds of output in a period.
enum class Action : std::uint8_t {
  kSilent,   ///< Nothing.
  kNeutral,  ///< Sticks at rest, throttle at its least: on the floor only.
  kPilot,    ///< The pilot's command, limited by CommandGuard.
  kBrake,    ///< Against the last velocity.
  kDescend,  ///< Level, and gently down.
};

/// Why it refuses, waits or ends.
enum class Reason : std::uint8_t {
  kNone,
  kNotTested,
  kCourse,
  kArmedAtStart,
  kOverrideAtStart,
  kOtherClient,
  kTooEarly,
  kSwitchOrder,
  kStatusStale,
  kAttitudeStale,
  kPicturesStale,
  kPilotLate,
  kHeightLost,
  kTilt,
  kFence,
  kBattery,
  kTime,
  kTold,
};

/// For the line that a user reads.
[[nodiscard]] std::string_view text_of(Reason reason);

enum class Phase : std::uint8_t {
  kStarting,   ///< Nothing is sent yet.
  kStreaming,  ///< The drone is the radio's; frames are there for when it hands over.
  kFlying,
  kEnding,  ///< Brakes, then descends, until it is disarmed or the override is off.
  kOver,    ///< Nothing leads out of it but a new start.
};

/// Limits. All ours, none flown yet; a period is that of the stick stream, 25 ms at 40 Hz.
struct HandOverParams {
  std::chrono::nanoseconds status = std::chrono::milliseconds{500};
  /// One lost answer leaves 100 ms without an attitude: 60 until it is asked for again, 20 of a turn, 20 of the answer.
  std::chrono::nanoseconds attitude = std::chrono::milliseconds{150};
  std::chrono::nanoseconds picture =
      std::chrono::milliseconds{150};  ///< Four missing pictures at 30 Hz.
  std::chrono::nanoseconds command = std::chrono::milliseconds{50};
  /// A turn to the next gate takes 5 s, and some time goes to looking for it; meanwhile it does not climb: CommandGuard.
  std::chrono::nanoseconds height = std::chrono::seconds{8};
  std::chrono::nanoseconds brake = std::chrono::seconds{1};
  std::chrono::nanoseconds flight = std::chrono::minutes{8};
  /// An ending is given up when nothing has told for so long whether it is armed, or after so long: never, of a real drone.
  std::chrono::nanoseconds gone = std::chrono::nanoseconds::max(),
                           ending = std::chrono::nanoseconds::max();
  int neutral_frames = 40;     ///< Before the override may be switched on.
  double tilt = 1.05;          ///< [rad], 60°.
  double least_battery_v = 0;  ///< 0: not looked at.
};

/// Phases of the hand-over, from period to period.
struct HandOver {
  Phase phase = Phase::kStarting;
  Reason reason = Reason::kNone;
  std::chrono::nanoseconds since{0};  ///< When the phase began.
  bool override_was = false;          ///< In the period before.
  bool flown = false;                 ///< Since it was armed: it may be in the air.
  bool blocked = false;  ///< The override came on when it must not: it has to go off first.
};

/// The state of the next period: a pure function.
///
/// The pilot's radio arms, and switches the override on and off; neither is ever done here. It flies only when armed first and
/// overridden then, with neutral frames acknowledged before; whatever fails in flight ends it, and it does not come back. Once it
/// has flown, and until it is disarmed, frames are never neutral: in the air these would let it fall.
[[nodiscard]] HandOver next(const HandOver& before, const Situation& now,
                            const HandOverParams& params);

/// The output of this period.
[[nodiscard]] Action action_of(const HandOver& state, const Situation& now,
                               const HandOverParams& params);

}  // namespace gatefly::guard
