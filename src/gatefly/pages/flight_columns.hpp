// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gatefly/pages/page_tick.hpp"
#include "gatefly/world/world.hpp"

namespace gatefly::io {

/// Whole numbers of the units in flight_columns.cpp: differences of them add up without error.
using FlightRow = std::array<std::int64_t, 54>;

/// What was and what the pilot believed over time: the page's table, at most 6000 rows, thinned as
/// it comes.
class FlightColumns {
 public:
  FlightColumns();

  /// @param now  the tick's time [s]; ticks between two rows are left out.
  /// @param world  whose gates errors are relative to.
  void add(const PageTick& tick, const sim::World& world, double now);

  /// {"t_s":{"unit":0.0001,"steps":[..]}, ..}: each number is what is added to the one before; null
  /// where there is none. A column in which there is nothing at all is left out.
  [[nodiscard]] std::string json(std::size_t row_step) const;

 private:
  std::vector<FlightRow> rows_;
  double row_period_ = 0.02, next_row_ = 0.0;  ///< [s]
};

}  // namespace gatefly::io
