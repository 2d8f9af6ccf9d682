// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/hand_over_bench.hpp"

#include <optional>
#include <utility>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/live/flight_deck.hpp"
#include "gatefly/live/hand_over_view.hpp"
#include "gatefly/live/keeper.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr nanoseconds kTakenBack = 500ms;  ///< Then the channels must be the radio's.
constexpr nanoseconds kLongestGap =
    Keeper::kSilence + kStickPeriod;    ///< Between two stick frames, whoever sends them.
constexpr nanoseconds kAlone = 1500ms;  ///< So long the channels are watched when nobody sends.
/// Longest until it lets go of the last set point: GUID_TIMEOUT of 1 s, 0.3 s in which old answers are thrown away, and to be told.
constexpr nanoseconds kLetsGo = 2s;
constexpr nanoseconds kSpinsUp = 3s;  ///< Longest after arming until set points are obeyed.
constexpr int kRadioWithin = 20;      ///< A radio at rest is not quite still [µs].
constexpr int kBrakes = 15;   ///< Pitch that braking has, at least [µs; over MAVLink mrad/s].
constexpr int kCentred = 40;  ///< Its sticks, from the middle [µs].

std::string ms(nanoseconds time) { return files::fixed(1e3 * seconds(time), 0) + " ms"; }

/// The test while it runs. Every step answers whether all was well so far, and has said so if not.
class HandOverWalk {
 public:
  HandOverWalk(const HandOverTest& test, Introduced met, const DroneFile& drone)
      : test_{test}, drone_{drone}, view_{std::move(met), drone} {}

  bool all() {
    const bool is_well = taken_back_and_blind() && killed() && both_killed() && no_gap();
    if (!is_well) come_to_rest();
    return is_well;
  }

 private:
  bool taken_back_and_blind();
  bool killed();
  bool both_killed();
  bool no_gap();

  bool handed_over();
  bool streaming();
  bool follows(nanoseconds lasts, const std::string& when);
  bool followed(const std::string& when);
  bool blind();
  bool taken_back(const std::string& after, bool program_ends);
  bool disarmed();
  bool channels_are_back(const std::string& after, bool program_ends);
  bool ends(const std::string& after, bool program_ends);
  bool alone(const msp::Sticks& last, Moment since);
  bool let_go(const msp::Sticks& last, Moment since);
  void come_to_rest();

  template <class Done>
  bool wait(nanoseconds limit, Done&& done, const std::string& else_line);
  template <class Still>
  bool watch(nanoseconds lasts, Still&& still, const std::string& else_line);
  template <class Done>
  bool asked_for(std::string_view what, Done&& done);
  bool wrong(const std::string& line) {
    test_.found({false, line});
    return false;
  }
  bool well(const std::string& line) {
    test_.found({true, line});
    return true;
  }
  [[nodiscard]] std::string trouble() const {
    return test_.told_to_end() ? "told to end" : view_.trouble();
  }
  [[nodiscard]] bool radios() const {
    return same_sticks(view_.told().sticks, radio_, kRadioWithin);
  }
  /// Over MAVLink the set point that it flies by is read back, which is nobody's once its mode is another.
  [[nodiscard]] bool by_set_points() const { return drone_.by_mavlink(); }

  const HandOverTest& test_;
  const DroneFile& drone_;
  HandOverView view_;
  msp::Sticks radio_;  ///< Its sticks, before it hands over.
};

/// Looks until it is done. @param else_line  the finding when it is not done in time.
template <class Done>
bool HandOverWalk::wait(nanoseconds limit, Done&& done, const std::string& else_line) {
  for (const Moment end = Clock::now() + limit; !done();) {
    if (const std::string why = trouble(); !why.empty()) return wrong(why);
    if (Clock::now() > end) return wrong(else_line);
    view_.look();
  }
  return true;
}

/// Looks for so long. @param still  what must not change meanwhile.
template <class Still>
bool HandOverWalk::watch(nanoseconds lasts, Still&& still, const std::string& else_line) {
  for (const Moment end = Clock::now() + lasts; Clock::now() < end;) {
    if (const std::string why = trouble(); !why.empty()) return wrong(why);
    if (!still()) return wrong(else_line);
    view_.look();
  }
  const std::string why = trouble();
  return why.empty() ? true : wrong(why);
}

/// Asks somebody to do that at the radio, and waits for it.
template <class Done>
bool HandOverWalk::asked_for(std::string_view what, Done&& done) {
  test_.say(std::string{what});
  guard::Reason said = guard::Reason::kNone;
  const auto done_or_refused = [&] {
    // A hand-over in the wrong order is not taken; it can be done again.
    if (view_.rig() != nullptr && view_.news().phase == guard::Phase::kStreaming &&
        view_.news().reason != said) {
      said = view_.news().reason;
      if (said != guard::Reason::kNone) test_.say(std::string{guard::text_of(said)});
    }
    return done();
  };
  return wait(test_.step, done_or_refused,
              "for " + files::fixed(seconds(test_.step), 0) +
                  " s the controller has not seen this at the radio: " + std::string{what});
}

// ---- Steps ----

/// A new process that flies, up to where it may be handed the drone.
bool HandOverWalk::streaming() {
  view_.begin_flight(test_.plan, test_.told_to_end);
  const auto sends = [this] {
    return view_.last() && view_.last()->acknowledged >= test_.plan.limits.neutral_frames;
  };
  const auto sees = [this] { return view_.news().sees || view_.news().trouble[0] != 0; };
  if (!wait(4s, sends, "neutral stick frames are not acknowledged") ||
      !wait(6s, sees, "no pictures from the camera"))
    return false;
  if (!view_.news().sees)
    return wrong("no pictures from the camera: " + std::string{view_.news().trouble.data()});
  return view_.told().armed || view_.told().override_on ? wrong("armed or overridden too early")
                                                        : true;
}

bool HandOverWalk::handed_over() {
  if (!asked_for(at_radio::kArm, [this] { return view_.told().armed; })) return false;
  radio_ = view_.told().sticks;
  const std::uint16_t mid = drone_.receiver.mid;
  const bool at_rest = same_sticks(radio_, {mid, mid, mid, radio_.throttle}, kCentred) &&
                       radio_.throttle < drone_.receiver.min_check;
  if (!by_set_points() && !at_rest)
    return wrong("the radio's sticks are not at rest: " + text_of(radio_));
  return asked_for(at_radio::kOverrideOn, [this] { return view_.flies(); });
}

/// Whether what has been read back since channels() began is what was sent.
bool HandOverWalk::followed(const std::string& when) {
  if (view_.channels().reads() < 3)
    return wrong(when + ": " + (by_set_points() ? "its set point is" : "the channels are") +
                 " not read back, " + files::amount(view_.channels().reads(), "time"));
  if (view_.channels().wrong() == 0) return true;
  return wrong(when + ": " + view_.channels().not_following() + " not as sent, in " +
               std::to_string(view_.channels().wrong()) + " of " +
               files::amount(view_.channels().reads(), "answer") + " (" +
               text_of(view_.channels().wrong_one()) + ")" +
               (by_set_points() ? "; of 1500 a thousandth of a rad/s each, of 1000 of the thrust"
                                : "; msp_override_channels_mask must be 15, and [channels] that "
                                  "of the controller"));
}

bool HandOverWalk::follows(nanoseconds lasts, const std::string& when) {
  // An ArduCopter's motors stand for two seconds after arming, and it obeys nobody until then.
  const auto obeys = [this] {
    return view_.channels().follows() && view_.told().sticks.throttle > drone_.rest_throttle();
  };
  view_.channels().begin(Clock::now());
  for (const Moment end = Clock::now() + kSpinsUp;
       by_set_points() && !obeys() && Clock::now() < end && trouble().empty();)
    view_.look();
  view_.channels().begin(Clock::now() + ChannelWatch::kLag);
  return watch(
             lasts + ChannelWatch::kLag, [this] { return view_.flies(); },
             when + ": taken back too early") &&
         followed(when);
}

/// @param program_ends  what flies ends with it.
bool HandOverWalk::taken_back(const std::string& after, bool program_ends) {
  view_.let_end(program_ends);
  if (!asked_for(at_radio::kOverrideOff, [this] { return !view_.told().override_on; }))
    return false;
  if (!by_set_points()) return channels_are_back(after, program_ends);
  const auto stays = [this] { return !view_.told().override_on; };
  return ends(after, program_ends) &&
         watch(1s, stays, "override off" + after + ": it takes set points again") &&
         well("override off" + after + ": another mode, and it stays" +
              (program_ends ? ", and nothing is sent any more" : ""));
}

bool HandOverWalk::channels_are_back(const std::string& after, bool program_ends) {
  const auto not_radios = [this] {
    return "override off: the channels are not the radio's, " + text_of(view_.told().sticks) +
           "; the radio's were " + text_of(radio_);
  };
  // Looked at for the whole time, so that the line shows what they are then.
  for (const Moment end = Clock::now() + kTakenBack; !radios() && Clock::now() < end;) view_.look();
  if (!radios()) return wrong(not_radios());
  const nanoseconds within = view_.told().sticks_at - view_.told().overridden_at;
  if (!ends(after, program_ends)) return false;
  for (const Moment end = Clock::now() + 1s; Clock::now() < end; view_.look())
    if (!radios()) return wrong(not_radios());
  return well("override off" + after + ": the channels are the radio's within " + ms(within) +
              (program_ends ? ", and nothing is sent any more" : ""));
}

bool HandOverWalk::ends(const std::string& after, bool program_ends) {
  return !program_ends || wait(
                              2s, [this] { return view_.rig() == nullptr; },
                              "override off" + after + ": the program sends on");
}

bool HandOverWalk::disarmed() {
  return asked_for(at_radio::kDisarm,
                   [this] { return !view_.told().armed && view_.rig() == nullptr; });
}

/// The camera is closed in flight.
bool HandOverWalk::blind() {
  if (!asked_for(at_radio::kOverrideOnAgain, [this] { return view_.flies(); }) ||
      !follows(500ms, "override on again"))
    return false;
  view_.rig()->close_camera();
  view_.let_end(true);
  if (!wait(
          1500ms, [this] { return view_.news().phase == guard::Phase::kEnding; },
          "camera out: it flies on") ||
      !wait(
          300ms, [this] { return view_.news().action == guard::Action::kBrake; },
          "camera out: it does not brake"))
    return false;
  if (view_.news().reason != guard::Reason::kPicturesStale)
    return wrong("camera out: it ends because of another thing: " +
                 std::string{guard::text_of(view_.news().reason)});
  const nanoseconds after = view_.news().since - view_.news().picture_at;
  if (after > view_.news().picture_limit + 2 * kStickPeriod)
    return wrong("camera out: it has flown on for " + ms(after));
  view_.channels().begin(Clock::now() + ChannelWatch::kLag);
  const auto ends = [this] { return view_.news().phase == guard::Phase::kEnding; };
  return wait(
             2s, [this] { return view_.news().action == guard::Action::kDescend; },
             "camera out: it does not descend") &&
         watch(500ms, ends, "camera out: taken back too early") && followed("camera out") &&
         well("camera out: it brakes " + ms(after) +
              " after the last picture, descends then, and the channels follow");
}

bool HandOverWalk::taken_back_and_blind() {
  if (!streaming()) return false;
  well("disarmed, override off: " + files::amount(view_.last()->acknowledged, "neutral frame") +
       " acknowledged, pictures come");
  if (!handed_over() || !follows(1500ms, "override on")) return false;
  well("override on: roll, pitch, yaw and throttle as sent, in " +
       files::amount(view_.channels().reads(), "answer") + ", at most " +
       ms(view_.channels().behind()) + " behind");
  return taken_back("", false) && blind() && taken_back(" after it", true) && disarmed();
}

/// The process that flies is killed.
bool HandOverWalk::killed() {
  if (!streaming() || !handed_over() || !follows(500ms, "override on")) return false;
  const pid_t first = view_.rig()->process();
  view_.let_end(true);  // should the second one have died, too, that is for the line below
  view_.rig()->kill_first();
  if (!wait(
          1s, [&] { return view_.last()->process != first; },
          "program killed: the second process sends nothing"))
    return false;
  view_.let_end(false);
  if (view_.taken_over_after() > kLongestGap)
    return wrong("program killed: nothing was sent for " + ms(view_.taken_over_after()));
  const msp::Sticks at_first = view_.last()->sent;
  view_.channels().begin(Clock::now() + ChannelWatch::kLag);
  if (!watch(
          1600ms, [this] { return view_.told().armed && view_.told().override_on; },
          "program killed: taken back too early") ||
      !followed("program killed"))
    return false;
  // It was told that the drone moves forward: braking pulls the nose up, by what is gone when it descends, however it lies.
  const msp::Sticks& at_end = view_.last()->sent;
  if (at_first.pitch + kBrakes > at_end.pitch)
    return wrong("program killed: the second process does not brake, " + text_of(at_first));
  if (at_end.throttle > drone_.hover_throttle() || at_end.throttle <= drone_.rest_throttle())
    return wrong("program killed: the second process does not descend, " + text_of(at_end));
  return well("program killed (-9): the second process sends after " +
              ms(view_.taken_over_after()) + ", brakes, descends, and the channels follow") &&
         taken_back(" after it", true) && disarmed();
}

/// Nobody sends any more, as with the cable out.
bool HandOverWalk::both_killed() {
  if (!streaming() || !handed_over() || !follows(500ms, "override on")) return false;
  view_.rig()->kill_both();
  const Moment since = Clock::now();
  view_.let_end(true);
  return wait(
             1s, [this] { return view_.rig() == nullptr; },
             "both processes killed: something still sends") &&
         (by_set_points() ? let_go(view_.last()->sent, since) : alone(view_.last()->sent, since)) &&
         taken_back(" after it", true) && disarmed();
}

/// One that takes set points must let go of the last one in time, level itself, and stay so.
bool HandOverWalk::let_go(const msp::Sticks& last, Moment since) {
  const std::string line = "both processes killed, as with the cable out: ";
  const auto levels = [&] {
    const msp::Sticks& is = view_.told().sticks;
    return view_.told().sticks_at > since &&
           same_sticks(is, {1500, 1500, 1500, is.throttle}, kCentred) &&
           !same_sticks(is, last, ChannelWatch::kWithin);
  };
  const auto levels_or_is_taken = [&] { return !view_.told().override_on || levels(); };
  if (!wait(kLetsGo, levels_or_is_taken,
            line + "the controller holds the last set point for longer than " + ms(kLetsGo)))
    return false;
  const nanoseconds after = view_.told().sticks_at - since;
  if (!watch(500ms, levels_or_is_taken,
             line + "it lets go of the last set point, but not for good"))
    return false;
  if (!view_.told().override_on) return wrong(line + "taken back too early");
  return well(line + "the controller lets go of the last set point after " + ms(after) +
              ", and levels: only your switch ends it");
}

/// Finds out what the channels do when nobody sends. Either answer is well: the pilot only has to know it.
bool HandOverWalk::alone(const msp::Sticks& last, Moment since) {
  const std::string line = "both processes killed, as with the cable out: ";
  std::optional<nanoseconds> given_back;
  int reads = 0;
  for (Moment seen = since; Clock::now() < since + kAlone; view_.look()) {
    if (const std::string why = trouble(); !why.empty()) return wrong(why);
    if (view_.told().sticks_at <= seen) continue;
    seen = view_.told().sticks_at;
    if (!view_.told().override_on) return wrong(line + "taken back too early");
    ++reads;
    if (radios() && !given_back) given_back = seen - since;
    if (!radios() && (given_back || !same_sticks(view_.told().sticks, last, ChannelWatch::kWithin)))
      return wrong(line + "the channels are neither the last sticks nor the radio's, " +
                   text_of(view_.told().sticks));
  }
  if (reads < 3) return wrong(line + "the controller does not answer");
  return well(line + (given_back ? "the channels are the radio's again after " + ms(*given_back) +
                                       ": hold your sticks as for hovering"
                                 : "the controller keeps the last sticks for " + ms(kAlone) +
                                       " and may for ever: only your override switch ends it"));
}

bool HandOverWalk::no_gap() {
  const std::string line = files::amount(view_.frames(), "stick frame") + ", at most " +
                           ms(view_.longest_gap()) + " from one to the next";
  return view_.longest_gap() <= kLongestGap ? well(line)
                                            : wrong(line + ", must be " + ms(kLongestGap));
}

/// After a failure: until the override is off and the drone disarmed. What flies ends as it always does, which may take long.
void HandOverWalk::come_to_rest() {
  if (view_.rig() != nullptr) view_.rig()->bring_down();
  const Moment since = Clock::now();
  Moment said{}, alone_since = since;
  for (;;) {
    const bool known = view_.told().status_at > since;
    if (view_.rig() == nullptr && known && !view_.told().armed && !view_.told().override_on) return;
    if (view_.rig() != nullptr) alone_since = Clock::now();
    if (Clock::now() > alone_since + test_.step || view_.link_is_gone()) return;
    if (known && Clock::now() - said > 10s) {
      said = Clock::now();
      test_.say(std::string{at_radio::kBothOff});
    }
    view_.look();
  }
}

}  // namespace

bool HandOverTest::run(Introduced met, const DroneFile& drone) const {
  return HandOverWalk{*this, std::move(met), drone}.all();
}

}  // namespace gatefly::live
