// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/hand_over_view.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <unistd.h>

namespace gatefly::live {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

void HandOverView::begin_flight(const HandOverRig::Plan& plan,
                                const std::function<bool()>& told_to_end) {
  queries_.reset(), last_.reset();
  news_ = {}, may_end_ = false;
  rig_ = std::make_unique<HandOverRig>(port_, drone_, known_, plan, told_to_end);
}

void HandOverView::heard(const SentFrame& frame) {
  if (last_ && last_->process != frame.process) taken_over_after_ = frame.at - last_->at;
  if (last_) longest_gap_ = std::max<nanoseconds>(longest_gap_, frame.at - last_->at);
  ++frames_;
  // The first frames of the second process come before it has heard anything.
  if (frame.status_at > told_.status_at) {
    told_.armed = frame.armed, told_.override_on = frame.override_on;
    told_.status_at = frame.status_at;
    if (frame.override_on) told_.overridden_at = frame.status_at;
  }
  if (frame.read_at > told_.sticks_at) {
    told_.sticks = frame.read, told_.sticks_at = frame.read_at;
    channels_.read(frame.read, frame.read_at);
  }
  channels_.sent(frame.sent, frame.at);
  last_ = frame;
}

void HandOverView::ask() {
  if (!queries_) {
    // Answers to somebody else's questions are none to ours.
    std::array<std::uint8_t, 512> room{};
    const Moment end = Clock::now() + 300ms;
    while (Clock::now() < end && port_.read(room, Clock::now() + 40ms).value_or(0) > 0) {
    }
    queries_ = std::make_unique<LinkQueries>(
        queries_on(Port{dup(port_.fd()), port_.name()}, drone_, known_));
    clock_ = RunClock{};
  }
  (void)queries_->serve(clock_, clock_.now() + 5ms);
  const ControllerState& state = queries_->state();
  if (state.sticks_at < 0ns || state.status_at < 0ns) return;
  told_.armed = state.armed, told_.override_on = state.override_on, told_.sticks = state.sticks;
  told_.status_at = clock_.moment(state.status_at);
  told_.sticks_at = clock_.moment(state.sticks_at);
  if (state.override_on) told_.overridden_at = told_.status_at;
}

void HandOverView::look() {
  if (rig_) {
    const bool there = rig_->listen(Clock::now() + 5ms, [this](const SentFrame& f) { heard(f); });
    news_ = rig_->news();
    if (there) return;
    rig_.reset();
    queries_.reset();
  }
  ask();
}

std::string HandOverView::trouble() const {
  if (link_is_gone()) return port_.name() + ": the connection is gone";
  if (may_end_) return "";
  const bool over = news_.phase == guard::Phase::kEnding || news_.phase == guard::Phase::kOver;
  const std::string text{news_.trouble.data()}, reason{guard::text_of(news_.reason)};
  if ((over || !rig_) && !text.empty()) return text;
  // We have not told it: it ends by itself when it has lost its second process.
  if (over && news_.reason == guard::Reason::kTold) return "the second process has died";
  if (over && !reason.empty()) return reason;
  return rig_ ? "" : "the process that flies has ended";
}

}  // namespace gatefly::live
