// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/channel_watch.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <optional>
#include <vector>

#include "gatefly/files/text.hpp"

namespace gatefly::live {
namespace {

constexpr std::array<const char*, 4> kChannels{"roll", "pitch", "yaw", "throttle"};

std::array<int, 4> channels_of(const msp::Sticks& sticks) {
  return {sticks.roll, sticks.pitch, sticks.yaw, sticks.throttle};
}

}  // namespace

std::array<bool, 4> differing(const msp::Sticks& a, const msp::Sticks& b, int within_us) {
  const auto one = channels_of(a), other = channels_of(b);
  std::array<bool, 4> differs{};
  for (std::size_t i = 0; i < 4; ++i) differs[i] = std::abs(one[i] - other[i]) > within_us;
  return differs;
}

bool same_sticks(const msp::Sticks& a, const msp::Sticks& b, int within_us) {
  return differing(a, b, within_us) == std::array<bool, 4>{};
}

std::string text_of(const msp::Sticks& sticks) {
  const auto channels = channels_of(sticks);
  std::string text;
  for (std::size_t i = 0; i < 4; ++i)
    text += (i == 0 ? "" : ", ") + std::string{kChannels[i]} + " " + std::to_string(channels[i]);
  return text;
}

void ChannelWatch::begin(Moment from) {
  from_ = from;
  reads_ = 0, wrong_ = 0, follows_ = false, off_ = {}, behind_ = {};
}

void ChannelWatch::sent(const msp::Sticks& sticks, Moment at) {
  frames_.push_back({sticks, at});
  // The one in effect when the oldest window that can still be asked for began has to stay.
  while (frames_.size() > 2 && frames_[1].at + std::chrono::seconds{2} < at) frames_.pop_front();
}

void ChannelWatch::read(const msp::Sticks& sticks, Moment at) {
  if (at < from_) return;
  ++reads_;
  follows_ = true;
  std::optional<Moment> newer;  // since when one was sent that is not to be seen
  std::array<bool, 4> nearest{true, true, true, true};
  for (std::size_t i = frames_.size(); i-- > 0;) {
    const Frame& frame = frames_[i];
    if (frame.at > at) continue;
    const auto differs = differing(sticks, frame.sticks, kWithin);
    const auto count = [](const auto& all) { return std::count(all.begin(), all.end(), true); };
    if (count(differs) == 0) {
      if (newer) behind_ = std::max<std::chrono::nanoseconds>(behind_, at - *newer);
      return;
    }
    if (count(differs) < count(nearest)) nearest = differs;
    newer = frame.at;
    if (frame.at + kLag < at) break;
  }
  if (rounds_steps_off_ && between_frames(sticks, at)) return;
  follows_ = false;
  if (wrong_++ == 0) wrong_one_ = sticks;
  for (std::size_t i = 0; i < 4; ++i) off_[i] = off_[i] || nearest[i];
}

/// Whether each channel is between what frames of the last kLag, and the one in effect at its beginning, have for it.
bool ChannelWatch::between_frames(const msp::Sticks& sticks, Moment at) const {
  const auto is = channels_of(sticks);
  std::array<int, 4> low, high;
  low.fill(std::numeric_limits<int>::max()), high.fill(std::numeric_limits<int>::min());
  for (auto frame = frames_.rbegin(); frame != frames_.rend(); ++frame) {
    if (frame->at > at) continue;
    const auto sent = channels_of(frame->sticks);
    for (std::size_t i = 0; i < 4; ++i)
      low[i] = std::min(low[i], sent[i] - kWithin), high[i] = std::max(high[i], sent[i] + kWithin);
    if (frame->at + kLag < at) break;
  }
  for (std::size_t i = 0; i < 4; ++i)
    if (is[i] < low[i] || is[i] > high[i]) return false;
  return true;
}

std::string ChannelWatch::not_following() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < 4; ++i)
    if (off_[i]) names.emplace_back(kChannels[i]);
  return files::joined(names, " and ");
}

}  // namespace gatefly::live
