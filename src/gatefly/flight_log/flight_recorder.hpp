// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

#include <Eigen/Core>

#include "gatefly/files/partial_folder.hpp"
#include "gatefly/flight_log/tick.hpp"
#include "gatefly/geometry/attitude.hpp"

namespace gatefly::io {

/// Writes a flight while it is flown: log_si.csv, images.csv, frame_00000.uyvy ..., and what the
/// pilot saw in each frame: detections.csv.
///
/// A folder that is there is whole: everything goes to a PartialFolder, to which finish() gives its
/// name. Numbers have 17 digits: they read back exactly.
class FlightRecorder {
 public:
  /// @throws std::runtime_error when `out` cannot be written, or is there and is no earlier flight.
  explicit FlightRecorder(std::filesystem::path out);
  FlightRecorder(const FlightRecorder&) = delete;
  FlightRecorder& operator=(const FlightRecorder&) = delete;

  /// One more row, and the picture if one arrived. @throws std::runtime_error e.g. disk full.
  void record(const Tick& tick);

  /// Another file of the folder, e.g. a report, before finish().
  void add_file(const std::string& name, const std::string& content);

  /// Where somebody else may write a file of the folder, before finish().
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
  void record_frame(const Tick& tick);
  void flush(bool all);
  void check(const std::ofstream& file, const std::filesystem::path& path) const;

  std::filesystem::path out_;
  PartialFolder folder_;
  std::ofstream log_, images_, detections_;
  std::string buffer_;  ///< Of log_, written in large pieces.
  std::size_t row_ = 0, frame_ = 0;
};

}  // namespace gatefly::io
