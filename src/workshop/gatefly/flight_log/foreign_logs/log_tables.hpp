// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/files/csv.hpp"
#include "gatefly/flight_log/foreign_logs/mapping.hpp"
#include "gatefly/flight_log/foreign_logs/ulog.hpp"

namespace gatefly::foreign_logs {

/// The tables of a log, whatever wrote it. Every error is one line with file and line (or byte).
class LogTables {
 public:
  /// @param mapping  must live as long.
  /// @throws std::runtime_error the log cannot be read, or has no such table.
  LogTables(const Mapping& mapping, const std::filesystem::path& log);

  /// Whether there is such a column; a table that is not there has none.
  [[nodiscard]] bool has(const std::string& table, const std::string& column);
  /// By the first of the mapping's times that the table has, never backwards.
  [[nodiscard]] std::vector<std::chrono::nanoseconds> times(const std::string& table);
  /// Empty cells are NaN.
  [[nodiscard]] std::vector<double> numbers(const std::string& table, const std::string& column);
  /// Columns there are, for people.
  [[nodiscard]] std::string columns_of(const std::string& table);
  /// The file of a table, for people: "log.csv", "flight.ulg, sensor_combined".
  [[nodiscard]] std::string name_of(const std::string& table) const;
  /// Remark on the log as a whole; "" when there is none.
  [[nodiscard]] std::string note() const;

 private:
  /// nullptr when there is no such file.
  [[nodiscard]] const files::Csv* csv(const std::string& table);
  [[nodiscard]] std::string place(const std::string& table, std::size_t row);

  const Mapping& mapping_;
  std::filesystem::path log_;
  std::optional<Ulog> ulog_;
  std::map<std::string, std::unique_ptr<files::Csv>> files_;
};

}  // namespace gatefly::foreign_logs
