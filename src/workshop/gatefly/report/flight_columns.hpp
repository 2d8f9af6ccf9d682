// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/report/page_course.hpp"
#include "gatefly/report/page_tick.hpp"

namespace gatefly::report {

/// Whole numbers of the units in flight_columns.cpp: differences of them add up without error.
using FlightRow = std::array<std::int64_t, 59>;

/// Use of the rotors over every tick since the row before: one is at
/// its limit for milliseconds.
struct RotorUse {
  double fastest = 0.0, slowest = 0.0;  ///< Extremes of the four over all ticks [rad/s].
  double thrust = 0.0;                  ///< Sum of the specific forces upwards, body axes [m/s²].
  int ticks = 0, saturated = 0, thrusts = 0;

  void add(const PageTick& tick, const PageCourse& course);
};

/// Truth and the pilot's belief over time: the page's table, at most 6000 rows, thinned as
/// it comes.
class FlightColumns {
 public:
  FlightColumns();

  /// @param now  the tick's time [s]; ticks between two rows are left out.
  /// @param course  whose gates errors are relative to, whose limits rotors reach.
  void add(const PageTick& tick, const PageCourse& course, double now);
  /// The last tick once more, which gets a row: a flight that is lost goes on to the contact.
  void end(const PageTick& tick, const PageCourse& course, double now);

  /// {"t_s":{"unit":0.0001,"steps":[..]}, ..}: each number is what is added to the one before; null
  /// where there is none. A column in which there is nothing at all is left out.
  [[nodiscard]] std::string json(std::size_t row_step) const;

 private:
  std::vector<FlightRow> rows_;
  std::optional<FlightRow> last_;  ///< The last tick, where that is none of `rows_`.
  RotorUse rotors_;
  double row_period_ = 0.02, next_row_ = 0.0;  ///< [s]
};

}  // namespace gatefly::report
