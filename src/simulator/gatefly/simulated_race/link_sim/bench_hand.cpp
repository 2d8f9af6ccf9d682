// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/bench_hand.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>

#include "gatefly/live/bench.hpp"
#include "gatefly/live/hand_over_bench.hpp"

namespace gatefly::link_sim {
namespace {

constexpr double kMoment = 0.3;    ///< That somebody takes for it [s].
constexpr double kTurning = 2.3;   ///< There, back, and a rest [s].
constexpr double kHolds = 1.0;     ///< Sticks that are a command, until they are let go [s].
constexpr double kArms = 3.0;      ///< A controller that has not by then is asked again [s].
constexpr double kSwitched = 1.0;  ///< The arming switch is off before it is asked again [s].

struct Request {
  std::string_view word, prompt;  ///< Nothing prompts for "".
  std::array<Deed, 3> deeds;
  std::size_t count;
};
constexpr std::array kRequests{
    Request{"turn", live::kTurnPrompt, {Deed::kTurnRoll, Deed::kTurnPitch, Deed::kTurnYaw}, 3},
    Request{"calibrate", "", {Deed::kCalibrate}, 1},
    Request{"arm", live::at_radio::kArm, {Deed::kArm}, 1},
    Request{"override on", live::at_radio::kOverrideOn, {Deed::kOverrideOn}, 1},
    Request{
        "override off, disarm", live::at_radio::kBothOff, {Deed::kOverrideOff, Deed::kDisarm}, 2},
    Request{"override off", live::at_radio::kOverrideOff, {Deed::kOverrideOff}, 1},
    Request{"disarm", live::at_radio::kDisarm, {Deed::kDisarm}, 1}};

bool is_turn(Deed deed) { return deed <= Deed::kTurnYaw; }

}  // namespace

std::string_view text_of(Deed deed) {
  switch (deed) {
    case Deed::kTurnRoll:
      return "turned about its front";
    case Deed::kTurnPitch:
      return "turned about its right";
    case Deed::kTurnYaw:
      return "turned about its down";
    case Deed::kCalibrate:
      return "throttle up, yaw left, pitch back: the accelerometer is calibrated";
    case Deed::kArm:
      return "armed";
    case Deed::kOverrideOn:
      return "override on";
    case Deed::kOverrideOff:
      return "override off";
    case Deed::kDisarm:
      return "disarmed";
  }
  return "";
}

void BenchHand::hear(std::string_view line, double now) {
  const bool prompted = line.starts_with(live::kBenchSays);
  if (prompted) line.remove_prefix(live::kBenchSays.size());
  for (const Request& request : kRequests) {
    const bool meant = prompted ? !request.prompt.empty() && line.starts_with(request.prompt)
                                : line == request.word;
    if (!meant) continue;
    // It is said every second that it has to be turned still.
    if (is_turn(request.deeds[0]) && std::any_of(asked_.begin(), asked_.end(), is_turn)) return;
    next_ = std::max(next_, now + kMoment);
    asked_.insert(asked_.end(), request.deeds.begin(),
                  request.deeds.begin() + static_cast<std::ptrdiff_t>(request.count));
    return;
  }
}

std::optional<Deed> BenchHand::step(double now, bool motors) {
  motors_seen_ = motors_seen_ || (armed_ && motors);
  // Betaflight does not arm by a switch that came on too early: off, and on again. ArduCopter's motors stand for two seconds.
  if (armed_ && !motors_seen_ && now - armed_at_ >= kArms) {
    armed_ = false;
    asked_.push_front(Deed::kArm);
    next_ = now + kSwitched;
  }
  if (now >= next_) sticks_ = msp::kNeutral;
  if (asked_.empty() || now < next_) return std::nullopt;
  const Deed deed = asked_.front();
  asked_.pop_front();
  next_ = now + (is_turn(deed) ? kTurning : deed == Deed::kCalibrate ? kHolds : kMoment);
  if (deed == Deed::kCalibrate)
    sticks_ = {.roll = 1500, .pitch = 1000, .yaw = 1000, .throttle = 2000};
  if (deed == Deed::kArm) armed_ = true, armed_at_ = now, motors_seen_ = false;
  if (deed == Deed::kDisarm) armed_ = false;
  if (deed == Deed::kOverrideOn || deed == Deed::kOverrideOff)
    override_on_ = deed == Deed::kOverrideOn;
  return deed;
}

}  // namespace gatefly::link_sim
