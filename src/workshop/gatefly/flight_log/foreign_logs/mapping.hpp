// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gatefly::foreign_logs {

/// A column of a log, and what its numbers mean: (number − zero) · scale · sign, in `unit`.
struct Source {
  std::string table;  ///< Table of a log with several; "": the one whose rows become ours.
  std::string column;
  double factor = 1.0, zero = 0.0;  ///< factor: to our own unit; scale, sign and unit in one.
  bool on_change = false;   ///< A new value is a new measurement; one that repeats itself is none.
  bool from_start = false;  ///< Counted from its first value: an altitude as a height.
  std::string place;        ///< Place of it in the mapping file, for errors.
};

/// Stamps of a table: columns that add up ("secs", "nsecs").
struct TimeColumns {
  std::vector<std::string> columns, units;
};

/// Axes of an attitude that a log has as a quaternion, body and earth.
enum class Axes {
  kFrdNed,  ///< Front, right, down; north, east, down: ours, PX4's.
  kFluNwu,  ///< Front, left, up; x ahead, y left, z up: ROS, with a map of its own.
  kFluEnu   ///< Front, left, up; east, north, up: ROS, with a compass.
};

/// Columns w, x, y, z of an attitude, and whose attitude it is ("ahrs" or "true").
struct QuaternionSource {
  std::string table;
  std::array<std::string, 4> columns;
  Axes axes = Axes::kFrdNed;
  std::string place;
};

/// Pictures whose names have their stamps.
struct PictureSource {
  std::string folder;                  ///< Below the log's; "": none unless the caller names one.
  std::string unit = "ns";             ///< Unit of a stamp.
  std::chrono::nanoseconds delay{0};   ///< From a stamp to its arrival at the pilot.
  std::chrono::nanoseconds offset{0};  ///< From the pictures' clock to the log's.
};

/// How a log of a kind is read: the content of a mapping file.
struct Mapping {
  enum class Kind {
    kCsv,    ///< One table.
    kUlog,   ///< PX4's; tables are topics.
    kFolder  ///< Tables are files in it.
  };
  std::filesystem::path file;
  Kind kind = Kind::kCsv;
  std::string table;              ///< Its rows become ours.
  std::vector<TimeColumns> time;  ///< The first that each table has.
  /// By the names of log_si.csv's columns; of several the first that the log has.
  std::map<std::string, std::vector<Source>> columns;
  std::map<std::string, std::vector<QuaternionSource>> quaternions;  ///< "ahrs", "true".
  /// Taken off: this, times its factor, is above `lifted_above`, once and for all.
  std::optional<Source> lifted;
  double lifted_above = 0.0;
  PictureSource pictures;
};

/// @throws std::runtime_error one line with file and line.
[[nodiscard]] Mapping read_mapping(const std::filesystem::path& file);

/// Columns of log_si.csv that a mapping may fill, in their order.
[[nodiscard]] const std::vector<std::string>& known_columns();
/// The unit of such a column: "rad/s".
[[nodiscard]] std::string_view unit_of(const std::string& column);

}  // namespace gatefly::foreign_logs
