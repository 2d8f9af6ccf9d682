// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gatefly/link/bytes.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/simulated_race/link_sim/datagrams.hpp"

namespace gatefly::link_sim {

/// Faults of a network of datagrams.
struct NetworkTroubles {
  double loss = 0.0;     ///< Part that never arrives.
  double reorder = 0.0;  ///< Part that arrives after the next one.
};

/// Datagrams that a bad network loses and swaps, in both directions.
class TroubledLine {
 public:
  TroubledLine(Datagrams line, const NetworkTroubles& troubles, const sim::Stream& chance);

  void send(link::Bytes bytes);
  /// Sends what still waits for a next one.
  void flush();
  /// The next one that has arrived and was not lost, valid until the next call.
  [[nodiscard]] std::optional<link::Bytes> receive();

 private:
  [[nodiscard]] bool is_lost() { return chance_.uniform() < troubles_.loss; }
  [[nodiscard]] bool is_swapped() { return chance_.uniform() < troubles_.reorder; }

  Datagrams line_;
  NetworkTroubles troubles_;
  sim::Stream chance_;
  std::vector<std::uint8_t> out_, in_;  ///< Each waits for the one after it; empty: none does.
  bool in_is_due_ = false;
  std::array<std::uint8_t, 2048> room_{};
};

}  // namespace gatefly::link_sim
