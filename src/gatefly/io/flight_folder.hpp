// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gatefly/closed_loop/race.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/sensing/imu.hpp"

namespace gatefly::io {

/// One row of a flight's log_si.csv. What the log does not have is empty.
struct FlightSample {
  std::chrono::nanoseconds time{0};
  Imu imu;
  std::optional<double> sonar = std::nullopt;               ///< [m]
  std::optional<double> baro = std::nullopt;                ///< [m]
  std::optional<Eigen::Vector3d> true_p_EB = std::nullopt;  ///< Motion capture or simulator [m].
  std::optional<Eigen::Vector3d> true_v_E = std::nullopt;   ///< [m/s]
  std::optional<Attitude> true_attitude = std::nullopt;     ///< Simulator only.
  std::optional<Attitude> ahrs = std::nullopt;              ///< The autopilot's own, in real logs.
  std::optional<Eigen::Vector3d> est_p_EB = std::nullopt;   ///< The recorded pilot's [m].
  std::optional<Eigen::Vector3d> est_v_E = std::nullopt;    ///< [m/s]
  std::optional<Attitude> est_attitude = std::nullopt;
};

/// One row of images.csv.
struct FlightImage {
  std::filesystem::path path;
  std::chrono::nanoseconds time{0};  ///< Of arrival: the time of its log row in our own flights.
  std::size_t log_row = 0;           ///< From 0: the sample in whose tick it arrives.
};

struct FlightFolder {
  std::filesystem::path directory;
  std::vector<FlightSample> samples;  ///< Ascending in time.
  std::vector<FlightImage> images;    ///< Ascending in log_row.
};

/// Reads log_si.csv and, if there is one, images.csv; real logs' columns or ours. Pictures stay on
/// disk.
/// @throws std::runtime_error one line with file and line: unreadable, damaged, time runs
///     backwards.
[[nodiscard]] FlightFolder read_flight_folder(const std::filesystem::path& directory);

/// Writes a flight while it is flown: log_si.csv, images.csv, frame_00000.uyvy ..., and what the
/// pilot saw in each frame: detections.csv.
///
/// Everything goes to `<out>.partial`, which finish() renames, so that a folder that is there is
/// whole; an unfinished one is removed by the destructor. Numbers have 17 digits: they read back
/// exactly.
class FlightRecorder {
 public:
  /// @throws std::runtime_error when `out` cannot be written, or is there and is no earlier flight.
  explicit FlightRecorder(std::filesystem::path out);
  ~FlightRecorder();
  FlightRecorder(const FlightRecorder&) = delete;
  FlightRecorder& operator=(const FlightRecorder&) = delete;

  /// One more row, and the picture if one arrived. @throws std::runtime_error e.g. disk full.
  void record(const closed_loop::Tick& tick);

  /// Another file of the folder, e.g. a report, before finish().
  void add_file(const std::string& name, const std::string& content);

  /// Where somebody else may write a file of the folder, before finish().
  [[nodiscard]] std::filesystem::path place_for(const std::string& name) const {
    return partial_ / name;
  }

  /// Writes summary.json and gives the folder its name, in place of an earlier flight's.
  void finish(const std::string& summary_json);

 private:
  void append(double value);
  void append(const Eigen::Vector3d& value);
  void append(const Attitude& attitude);
  void record_frame(const closed_loop::Tick& tick);
  void flush(bool all);
  void check(const std::ofstream& file, const std::filesystem::path& path) const;

  std::filesystem::path out_, partial_;
  std::ofstream log_, images_, detections_;
  std::string buffer_;  ///< Of log_, written in large pieces.
  std::size_t row_ = 0, frame_ = 0;
  bool finished_ = false;
};

}  // namespace gatefly::io
