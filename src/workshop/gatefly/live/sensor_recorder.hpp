// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "gatefly/live/growing_folder.hpp"
#include "gatefly/live/msp_poller.hpp"
#include "gatefly/live/picture.hpp"
#include "gatefly/sensing/imu.hpp"

namespace gatefly::live {

/// A sample of the controller's IMU, and what it has last said of itself.
struct HeardState {
  ControllerState state;
  std::chrono::nanoseconds due{0};  ///< When a pilot would get it.
  bool lifted = false;
};

/// Writes what a camera and a controller send as a flight folder, in the ticks in which a pilot would have got it; nothing decides, nothing is held back.
///
/// The folder grows in place, so that what is written stays when the power goes; summary.json comes last. Its rows are those that `gatefly run` would have
/// had: the last sample held, a new one also in nav_*.
class SensorRecorder {
 public:
  struct Params {
    double imu_hz = 250.0;  ///< Rows a second.
    int rotation_deg = 0;   ///< Rotation of stored pictures, which are kept as they are.
  };
  /// @param folder  new and empty. @param files  others in it, by name.
  /// @throws DiskFailed
  SensorRecorder(std::filesystem::path folder, const Params& params,
                 const std::map<std::string, std::string>& files);

  /// The row of tick `time`, with what has arrived since the one before. @throws DiskFailed
  void tick(std::chrono::nanoseconds time, const HeardState* heard, const Picture* picture);
  /// All rows so far to the file: what is there stays when the program dies. @throws DiskFailed
  void flush();
  /// The last file. @throws DiskFailed
  void finish(const std::string& summary_json);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t pictures() const { return pictures_; }
  [[nodiscard]] std::size_t samples() const { return samples_; }
  [[nodiscard]] std::chrono::nanoseconds last_time() const { return last_; }
  [[nodiscard]] bool lifted() const { return lifted_; }

 private:
  void keep(std::chrono::nanoseconds time, const Picture& picture);

  std::filesystem::path folder_;
  Params params_;
  GrowingFile log_, images_;
  std::string lines_;  ///< Log lines not yet written.
  Imu held_;
  std::chrono::nanoseconds heard_at_, last_{0};
  std::size_t rows_ = 0, pictures_ = 0, samples_ = 0;
  bool lifted_ = false;
};

}  // namespace gatefly::live
