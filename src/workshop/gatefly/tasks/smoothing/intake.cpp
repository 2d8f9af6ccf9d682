// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/smoothing/intake.hpp"

#include <algorithm>

namespace gatefly::smoothing {

void IntakeWatch::update(const eskf::ErrorStateFilter& filter, bool picture) {
  if (!filter.has_started()) return;
  const eskf::DelayRing& ring = filter.recent();
  if (!started_) {
    begin(filter);
  } else if (ring.oldest() > newest_) {  // gates have changed slots: the memory begins anew
    begin_anew(ring, picture);
    note_slots(filter.landmarks());
  }
  const std::size_t oldest = std::max(first_ + 1, ring.oldest());
  read(ring, picture ? oldest : std::max(oldest, newest_), ring.newest());
  newest_ = ring.newest();
}

void IntakeWatch::begin(const eskf::ErrorStateFilter& filter) {
  const eskf::DelayRing& ring = filter.recent();
  const eskf::Landmarks& landmarks = filter.landmarks();
  started_ = true;
  first_ = newest_ = ring.oldest();
  intake_.setup = filter.setup();
  intake_.start = ring[first_];
  intake_.P_start = ring.covariance(first_).topLeftCorner<eskf::kGates, eskf::kGates>();
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    intake_.landmarks.push_back(landmarks.map(i));
    intake_.first_of.push_back(landmarks.first_of(i));
    intake_.gates.push_back({landmarks.map(i).p_EG, landmarks.map(i).yaw_EG, 0.0});
  }
  note_slots(landmarks);
}

// The memory's first tick is now a copy of the last one before, which may be one that was not yet read.
void IntakeWatch::begin_anew(const eskf::DelayRing& ring, bool picture) {
  std::size_t last = newest_;
  if (ring[newest_ + 1].time <= ring[ring.oldest()].time &&
      ring[newest_ + 1].time > ring[newest_].time)
    ++last;
  const std::size_t overwritten = ring.newest() + 1 - std::min(ring.newest() + 1, ring.capacity());
  const std::size_t oldest = std::max(first_ + 1, overwritten);
  read(ring, picture ? oldest : std::max(oldest, newest_), last);
  before_ = intake_.ticks.size();
  first_ = newest_ = ring.oldest();
}

void IntakeWatch::read(const eskf::DelayRing& ring, std::size_t from, std::size_t to) {
  for (std::size_t i = from; i <= to; ++i) {
    const std::size_t at = before_ + (i - first_ - 1);
    if (at >= intake_.ticks.size()) intake_.ticks.resize(at + 1);
    eskf::Tick& tick = intake_.ticks[at] = ring[i];
    for (eskf::GateSight& sight : tick.sights)
      sight.slot = static_cast<int>(in_slot_[static_cast<std::size_t>(sight.slot)]);
    for (std::size_t slot = 0; slot < in_slot_.size(); ++slot)
      intake_.gates[in_slot_[slot]] = tick.x.gates[slot];
  }
}

void IntakeWatch::note_slots(const eskf::Landmarks& landmarks) {
  in_slot_.clear();
  for (int slot = 0; slot < landmarks.slots(); ++slot) in_slot_.push_back(landmarks.in_slot(slot));
}

}  // namespace gatefly::smoothing
