// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/link_sim/troubled_line.hpp"

#include <algorithm>
#include <utility>

namespace gatefly::link_sim {

TroubledLine::TroubledLine(Datagrams line, const NetworkTroubles& troubles,
                           const sim::Stream& chance)
    : line_{std::move(line)}, troubles_{troubles}, chance_{chance} {}

void TroubledLine::send(link::Bytes bytes) {
  if (is_lost()) return;
  if (out_.empty() && is_swapped()) {
    out_.assign(bytes.begin(), bytes.end());
    return;
  }
  line_.send(bytes);
  flush();
}

void TroubledLine::flush() {
  if (!out_.empty()) line_.send(out_);
  out_.clear();
}

std::optional<link::Bytes> TroubledLine::receive() {
  if (in_is_due_) {
    in_is_due_ = false;
    std::copy(in_.begin(), in_.end(), room_.begin());
    return link::Bytes{room_}.first(std::exchange(in_, {}).size());
  }
  while (const auto bytes = line_.receive(room_)) {
    if (is_lost()) continue;
    if (in_.empty() && is_swapped()) {
      in_.assign(bytes->begin(), bytes->end());
      continue;
    }
    in_is_due_ = !in_.empty();
    return bytes;
  }
  return std::nullopt;
}

}  // namespace gatefly::link_sim
