// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>

#include <Eigen/Core>

#include "gatefly/files/film_pipe.hpp"
#include "gatefly/files/partial_folder.hpp"
#include "gatefly/flight_log/gzip.hpp"
#include "gatefly/flight_log/tick.hpp"
#include "gatefly/geometry/attitude.hpp"

namespace gatefly::flight_log {

/// Records that a flight keeps.
struct Keep {
  /// log_si.csv.gz in place of log_si.csv: less than half, for a few per cent of a rendered flight's
  /// time. Of an ideal flight, which takes a second, it would be half as much again.
  bool packed_log = false;
  /// The frames, too: without loss in frames.mkv, by ffmpeg. Else a hash of each, which tells whether
  /// one that is rendered again is the same.
  bool frames = false;
  int stored_width = 0, stored_height = 0;  ///< Size of a frame [px].
  double frames_per_second = 25.0;          ///< Its rate, about; when each came is in images.csv.
  bool navigation_imu = false;  ///< The log has columns for what the estimator got beside.
  bool raw_frames = false;      ///< Frames in a file each, as they are: without ffmpeg.
  bool lifted = false;          ///< The log has a column for Sensors::lifted.
  bool picture_late = false;    ///< images.csv has a column for Sensors::picture_late.
};

/// A tick as it is recorded, whoever flew it. What nobody knows is an empty cell.
struct RecordedRow {
  const Sensors& sensors;
  const Command& command;
  const Estimate& estimate;
  std::size_t phase = 0;
  int target_gate = 0;
  const GateDetections& detections;
  std::optional<Truth> truth = std::nullopt;
  std::optional<double> battery_v = std::nullopt;
  /// The rotor speeds that were commanded, by whichever pilot, if they are known [rad/s].
  std::optional<std::array<double, 4>> motors = std::nullopt;
  std::span<const std::uint8_t> frame = {};  ///< As Tick has it ...
  std::span<const std::uint8_t> file = {};   ///< ... or the file that it came as, and that is kept,
  const char* ending = "";                   ///< and the ending of its name.
  std::optional<Quad> next_gate_px = std::nullopt;
};

/// Writes a flight while it is flown: log_si.csv, images.csv, frames or hashes of them, and what the
/// pilot saw in each frame: detections.csv.
///
/// A folder that is there is whole: everything goes to a PartialFolder, to which finish() gives its
/// name. Numbers have as many digits as they need to read back exactly.
class FlightRecorder {
 public:
  /// @throws std::runtime_error when `out` cannot be written, or is there and is no earlier flight;
  ///     or ffmpeg cannot be started.
  explicit FlightRecorder(std::filesystem::path out, const Keep& keep = {});
  FlightRecorder(const FlightRecorder&) = delete;
  FlightRecorder& operator=(const FlightRecorder&) = delete;

  /// One more row, and the picture if one arrived. @throws std::runtime_error e.g. disk full.
  void record(const Tick& tick);
  void record(const RecordedRow& row);

  /// Another file of the folder, e.g. a report, before finish().
  void add_file(const std::string& name, const std::string& content);

  /// Place for a file of the folder that somebody else writes, before finish().
  [[nodiscard]] std::filesystem::path place_for(const std::string& name) const {
    return folder_.path() / name;
  }

  /// Writes summary.json and gives the folder its name, in place of an earlier flight's. Other files
  /// that lay there stay.
  /// @return what became of an earlier flight, in words; "" when there was none.
  std::string finish(const std::string& summary_json);

 private:
  void append(double value);
  void append(const Eigen::Vector3d& value);
  void append(const Attitude& attitude);
  void append(const std::optional<Imu>& imu);
  void append(const std::optional<Truth>& truth);
  void record_frame(const RecordedRow& row);
  [[nodiscard]] std::string keep_frame(const RecordedRow& row);
  void flush(bool all);
  void check(bool good, const std::filesystem::path& path) const;

  std::filesystem::path out_;
  files::PartialFolder folder_;
  Keep keep_;
  std::ofstream log_, images_, detections_;
  GzipFile packed_log_;
  std::optional<files::FilmPipe> film_;
  std::string buffer_;  ///< Part of the log, written in large pieces.
  std::size_t row_ = 0, frame_ = 0;
};

}  // namespace gatefly::flight_log
