// SPDX-License-Identifier: Apache-2.0
#include "gatefly/guard/answer_watch.hpp"

#include <algorithm>

namespace gatefly::guard {
namespace {

/// FNV-1a.
std::uint64_t fingerprint_of(link::Bytes bytes) {
  std::uint64_t hash = 0xCBF29CE484222325ull;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001B3ull;
  return hash;
}

}  // namespace

void AnswerWatch::asked(std::uint16_t id) {
  std::uint8_t& open = open_[id % open_.size()];
  open = std::min<std::uint8_t>(kMostOpen, static_cast<std::uint8_t>(open + 1));
}

void AnswerWatch::answered(std::uint16_t id) {
  std::uint8_t& open = open_[id % open_.size()];
  if (open > 0)
    --open;
  else
    ++strange_;
}

void SampleWatch::arrived(link::Bytes sample, std::chrono::nanoseconds now) {
  const std::uint64_t fingerprint = fingerprint_of(sample);
  if (changed_ && fingerprint == fingerprint_) return;
  fingerprint_ = fingerprint;
  changed_ = now;
}

std::optional<std::chrono::nanoseconds> SampleWatch::age(std::chrono::nanoseconds now) const {
  if (!changed_) return std::nullopt;
  return now - *changed_;
}

}  // namespace gatefly::guard
