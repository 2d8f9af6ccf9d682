// SPDX-License-Identifier: Apache-2.0
#include "gatefly/estimation/eskf/delay_ring.hpp"

#include <algorithm>
#include <cmath>

namespace gatefly::eskf {

DelayRing::DelayRing(std::size_t ticks)
    : ticks_(std::max<std::size_t>(2, ticks)), spacing_{(ticks_.size() + kMost - 3) / (kMost - 2)} {
  spacing_ = std::max<std::size_t>(1, spacing_);
  kept_.resize(ticks_.size() / spacing_ + 2);
}

void DelayRing::restart(const Tick& tick, const Covariance& P) {
  // At a place whose covariance is kept.
  first_ = (count_ / spacing_ + 1) * spacing_;
  count_ = first_ + 1;
  (*this)[first_] = tick;
  keep(first_, P);
}

Tick& DelayRing::push() {
  const Nominal& before = (*this)[newest()].x;
  ++count_;
  Tick& tick = (*this)[newest()];
  tick.samples.clear(), tick.heights.clear(), tick.positions.clear();
  tick.sights.clear();
  tick.doubted = false;
  tick.x = before;
  return tick;
}

void DelayRing::keep(std::size_t index, const Covariance& P) {
  if (is_kept(index)) kept_[(index / spacing_) % kept_.size()] = P;
}

std::size_t DelayRing::oldest() const {
  return count_ - first_ < ticks_.size() ? first_ : count_ - ticks_.size();
}

std::size_t DelayRing::kept_before(std::size_t index) const { return index / spacing_ * spacing_; }

std::optional<std::size_t> DelayRing::at(double time, double beyond) const {
  // The one before must be there, with a covariance before that.
  const std::size_t first = kept_before(oldest() + spacing_ - 1) + 1;
  if (newest() < first) return std::nullopt;
  std::size_t i = newest();
  // At most once a moment kept.
  while (i > first && std::abs((*this)[i - 1].time - time) <= std::abs((*this)[i].time - time)) --i;
  const double step = (*this)[i].time - (*this)[i - 1].time;
  const double most = time > (*this)[i].time ? std::max(step, beyond) : step;
  if (!(std::abs((*this)[i].time - time) <= most + 1e-9)) return std::nullopt;
  return i;
}

}  // namespace gatefly::eskf
