// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/flight_log/foreign_logs/mapping.hpp"

namespace gatefly::foreign_logs {

struct ForeignPicture {
  std::filesystem::path path;
  std::size_t row = 0;  ///< In which it arrives.
};

/// A log of somebody else's, in our units and axes.
struct ForeignFlight {
  std::vector<std::chrono::nanoseconds> times;  ///< From the first row.
  /// By name of log_si.csv's columns, those that the log has; NaN: nothing came in that row.
  std::map<std::string, std::vector<double>> columns;
  std::vector<bool> lifted;  ///< Empty: the log does not say.
  std::vector<ForeignPicture> pictures;
  std::size_t pictures_outside = 0;            ///< Pictures outside the log's time.
  std::map<std::string, std::string> sources;  ///< Origin of each column.
  std::vector<std::string> notes;

  [[nodiscard]] double seconds() const;  ///< From the first row to the last.
  [[nodiscard]] double hz() const;       ///< Rows a second, by the median step.
};

/// Facts that the caller knows better than the mapping file.
struct Given {
  std::filesystem::path pictures;  ///< "": as the mapping says.
  std::optional<double> clock_offset_s, delay_ms;
};

/// @throws std::runtime_error one line that names file and line or column.
[[nodiscard]] ForeignFlight read_foreign_log(const Mapping& mapping,
                                             const std::filesystem::path& log, const Given& given);

}  // namespace gatefly::foreign_logs
