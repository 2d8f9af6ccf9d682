// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/linked.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

/// So much after it was taken a sample goes to the pilot: what is late by less comes regularly. Ours.
constexpr nanoseconds kHeldBack = 4ms;

}  // namespace

nanoseconds LateCounts::quantile(double part) const {
  const auto wanted = static_cast<long>(std::ceil(part * static_cast<double>(all_)));
  long seen = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i)
    if ((seen += counts_[i]) >= wanted && seen > 0) return (i + 1) * 100us;
  return longest_;
}

void listen(LinkQueries& link, Wires& wires, const RunClock& clock) {
  while (!wires.stop && !link.broken()) {
    const bool sampled = link.serve(clock, clock.now() + 2ms);
    const ControllerState& state = link.state();
    if (sampled)
      (void)wires.samples.push(
          {.imu = state.imu, .due = state.imu_taken + kHeldBack, .lifted = state.lifted});
    wires.state.write(state);
  }
  if (link.broken()) wires.link_error = link.name() + ": the connection is gone";
}

void fly(LinkCommands& link, FlightDeck& deck, Keeper& keeper, Wires& wires, const RunClock& clock,
         const std::function<bool()>& told_to_end) {
  DeckNews news;
  bool keeper_gone = false;
  nanoseconds sent_at{0};
  for (nanoseconds next = clock.now();; next = std::max(next + kStickPeriod, clock.now())) {
    while (clock.now() < next && !link.broken()) {
      if (!link.serve(clock, std::min(next, clock.now() + 2ms))) continue;
      const ControllerState& state = link.state();
      (void)wires.samples.push({.imu = state.imu,
                                .due = state.imu_taken + kHeldBack,
                                .may_start = news.state.phase == guard::Phase::kFlying});
    }
    const bool end = wires.told_to_end || wires.stop || keeper_gone || told_to_end();
    const FlightDeck::Sent sent = deck.step(link.state(), wires.wanted.read(), end, clock.now());
    const Keeper::Heard heard = keeper.tell(deck.ending());
    if (heard == Keeper::Heard::kTookOver) {
      wires.link_error = "the second process has taken over: this one was late";
      return;
    }
    keeper_gone = heard == Keeper::Heard::kGone;
    if (sent.action != guard::Action::kSilent && link.send(sent.demand, clock)) {
      const nanoseconds now = clock.now();
      if (news.frames++ > 0) news.longest_gap = std::max(news.longest_gap, now - sent_at);
      sent_at = now;
      wires.late_frames.add(now - next);
    }
    news.state = deck.state();
    news.action = sent.action;
    wires.deck.write(news);
    wires.state.write(link.state());
    if (link.broken()) {
      wires.link_error = link.name() + ": the connection is gone";
      return;
    }
    if (news.state.phase == guard::Phase::kOver) return;
  }
}

void play(const std::vector<flight_log::RecordedTick>& ticks,
          const flight_log::FlightFolder& folder, double pace, Wires& wires,
          const RunClock& clock) {
  const nanoseconds first = ticks.empty() ? 0ns : ticks.front().sensors.time;
  for (std::size_t i = 0; i < ticks.size() && !wires.stop; ++i) {
    const flight_log::RecordedTick& tick = ticks[i];
    if (tick.held) continue;
    if (pace > 0.0) {
      const double since = static_cast<double>((tick.sensors.time - first).count()) / pace;
      std::this_thread::sleep_until(clock.moment(nanoseconds{static_cast<std::int64_t>(since)}));
    }
    const RecordedSensors next{tick.sensors, tick.picture, folder.samples[i].motors};
    while (!wires.recorded.push(next) && !wires.stop) std::this_thread::sleep_for(200us);
  }
}

}  // namespace gatefly::live
