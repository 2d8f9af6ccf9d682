// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/msp_poller.hpp"

#include <algorithm>

#include "gatefly/link/layout.hpp"
#include "gatefly/link/msp_messages.hpp"

namespace gatefly::live {
namespace {

constexpr std::uint8_t id_of(std::uint16_t id) { return static_cast<std::uint8_t>(id); }

}  // namespace

MspPoller::MspPoller(const msp::ImuScale& scale, const msp::BoxIds& boxes, const Params& params)
    : scale_{scale}, boxes_{boxes}, params_{params}, taken_{params.turn} {}

void MspPoller::begin_turn(std::chrono::nanoseconds now) {
  // After a pause turns are not made up for.
  next_turn_ = now - next_turn_ < params_.turn ? next_turn_ + params_.turn : now + params_.turn;
  due_.clear();
  due_.push_back(id_of(msp::RawImu::kId));
  due_.push_back(id_of(msp::Attitude::kId));
  if (turn_ % params_.status_every == 0) {
    due_.push_back(id_of(msp::kStatus));
    due_.push_back(id_of(msp::kRc));
  }
  if (turn_ % params_.battery_every == 1) {
    due_.push_back(id_of(msp::Analog::kId));
    due_.push_back(id_of(msp::Altitude::kId));
  }
  ++turn_;
}

void MspPoller::sticks_sent() {
  answers_.asked(msp::kSetRawRc);
  ++sticks_open_;
}

bool MspPoller::waits_for_sticks(std::chrono::nanoseconds now) {
  if (sticks_open_ > 1 && !waits_since_) waits_since_ = now;
  if (sticks_open_ > 1 && now - *waits_since_ < params_.lost_after) return true;
  if (sticks_open_ > 1) sticks_open_ = 0;  // what is not acknowledged by now will not be
  waits_since_.reset();
  return false;
}

link::Bytes MspPoller::request(std::chrono::nanoseconds now) {
  if (waits_for_sticks(now)) return {};
  if (!asked_.empty()) {
    if (now - asked_at_ < params_.lost_after) return {};
    asked_.clear();
    ++state_.lost;
  }
  if (now >= next_turn_ && (due_.empty() || batched_)) begin_turn(now);
  if (due_.empty()) return {};
  std::size_t size = 0;
  if (batched_) {
    asked_ = due_;
    due_.clear();
    answers_.asked(msp::kMultiple);
    size = msp::encode_frame({msp::kMultiple,
                              {asked_.begin(), asked_.size()},
                              msp::Direction::kToController,
                              msp::Version::k2},
                             room_);
  } else {
    asked_.push_back(due_[0]);
    for (std::size_t i = 1; i < due_.size(); ++i) due_[i - 1] = due_[i];
    due_.pop_back();
    answers_.asked(asked_[0]);
    size = msp::encode_request(asked_[0], room_);
  }
  asked_at_ = now;
  ++state_.asked;
  return {room_.data(), size};
}

bool MspPoller::take(link::Bytes bytes, std::chrono::nanoseconds now) {
  sampled_ = false;
  stream_.feed(bytes, [&](const msp::Frame& frame) { take_frame(frame, now); });
  return sampled_;
}

void MspPoller::take_frame(const msp::Frame& frame, std::chrono::nanoseconds now) {
  if (frame.direction == msp::Direction::kToController) return;
  answers_.answered(frame.id);
  state_.other_client = answers_.other_client();
  if (frame.id == msp::kSetRawRc) {
    if (frame.direction == msp::Direction::kFromController) ++state_.acknowledged;
    sticks_open_ = std::max(0, sticks_open_ - 1);
    return;
  }
  const bool ours =
      !asked_.empty() && (batched_ ? frame.id == msp::kMultiple : frame.id == asked_[0]);
  if (!ours) return;  // late: what it was asked with is forgotten
  if (frame.direction == msp::Direction::kRefused) {
    ++state_.refused;
    batched_ = false;
  } else if (batched_) {
    (void)msp::each_answer(
        {asked_.begin(), asked_.size()}, frame.payload,
        [&](std::uint16_t id, link::Bytes payload) { take_answer(id, payload, now); });
  } else {
    take_answer(frame.id, frame.payload, now);
  }
  asked_.clear();
}

void MspPoller::take_answer(std::uint16_t id, link::Bytes payload, std::chrono::nanoseconds now) {
  if (id == msp::RawImu::kId) {
    const auto raw = link::decoded<msp::RawImu>(payload);
    if (!raw) return;
    imu_watch_.arrived(payload, now);
    state_.imu = msp::imu_of(*raw, scale_);
    state_.imu_at = now;
    state_.imu_changed_at = now - imu_watch_.age(now).value_or(std::chrono::nanoseconds{0});
    state_.imu_taken = taken_.take(now);
    ++state_.samples;
    sampled_ = true;
  } else if (id == msp::Attitude::kId) {
    const auto attitude = link::decoded<msp::Attitude>(payload);
    if (!attitude) return;
    state_.attitude = msp::attitude_of(*attitude);
    state_.attitude_at = now;
  } else if (id == msp::kStatus) {
    const auto status = msp::status_in(payload);
    if (!status) return;
    state_.armed = status->on(msp::Box::kArm, boxes_).value_or(true);  // not known: the worse one
    state_.override_on = status->on(msp::Box::kMspOverride, boxes_).value_or(false);
    state_.status_at = now;
  } else if (id == msp::kRc) {
    const auto channels = msp::channels_in(payload);
    if (!channels) return;
    if (const auto sticks = msp::sticks_in_rc({channels->begin(), channels->size()}))
      state_.sticks = *sticks, state_.sticks_at = now;
    state_.lifted = state_.armed && state_.sticks.throttle > params_.lifting_stick;
  } else if (id == msp::Analog::kId) {
    if (const auto analog = link::decoded<msp::Analog>(payload))
      state_.battery_v = 0.01 * analog->voltage;
  } else if (id == msp::Altitude::kId) {
    if (const auto altitude = link::decoded<msp::Altitude>(payload))
      state_.height = 0.01 * altitude->height;
  }
}

}  // namespace gatefly::live
