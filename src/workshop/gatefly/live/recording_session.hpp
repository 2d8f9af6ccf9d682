// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "gatefly/live/camera.hpp"
#include "gatefly/live/clock.hpp"
#include "gatefly/live/controller_link.hpp"
#include "gatefly/live/drone_file.hpp"
#include "gatefly/live/handoff.hpp"
#include "gatefly/live/sensor_recorder.hpp"

namespace gatefly::live {

/// One battery's recording, from a controller that has answered until it falls silent, the disk is full or somebody ends it: a thread each for camera,
/// link and the disk's own time, beside the caller's, which writes. Memory is bounded: what the disk does not take in time is lost, and counted.
///
/// Nothing is sent but questions: the link's type has no function that sends sticks.
class RecordingSession {
 public:
  struct Plan {
    CameraUri camera;
    StoredSize size;
    SensorRecorder::Params recorder;
    std::map<std::string, std::string> files;             ///< Files to write into each folder.
    std::uintmax_t keep_free = std::uintmax_t{64} << 20;  ///< Disk space to leave free [bytes].
    std::size_t most_rows = 1'900'000;  ///< Per folder: a little below a reader's limit.
  };
  enum class End { kTold, kSilent, kNewBattery, kDiskFull, kLongEnough };

  struct Counts {
    long pictures_lost = 0, samples_lost = 0;
    ControllerState state;
    std::string camera_error, disk_error;
  };

  RecordingSession(const Plan& plan, const DroneFile& drone, Introduced controller);
  ~RecordingSession();
  RecordingSession(const RecordingSession&) = delete;
  RecordingSession& operator=(const RecordingSession&) = delete;

  /// Records into a new folder of `out` until something ends it.
  /// @param told_to_end  asked often. @param summary  the content of summary.json.
  /// @throws DiskFailed when not even the folder can be made.
  End record(const std::filesystem::path& out, const std::function<bool()>& told_to_end,
             const std::function<std::string(const SensorRecorder&, End, const Counts&)>& summary);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  static constexpr std::size_t kPictures = 32;  // a second of them, while the disk is busy

  void run_camera();
  void run_link();
  void run_disk();
  void write(SensorRecorder& recorder, std::chrono::nanoseconds until);
  [[nodiscard]] std::optional<End> why_over(const SensorRecorder& recorder);

  const Plan& plan_;
  LinkQueries link_;
  RunClock clock_;
  Ring<HeardState> heard_{1024};
  Ring<Picture*> pictures_{kPictures}, free_{kPictures};
  Latest<ControllerState> state_;
  std::vector<Picture> memory_ = std::vector<Picture>(kPictures);
  std::atomic<bool> stop_ = false, link_over_ = false;
  std::atomic<long> pictures_lost_ = 0, samples_lost_ = 0;
  std::string camera_error_;  ///< The camera thread's, read when it has ended.
  std::array<std::thread, 3> threads_;
  std::chrono::nanoseconds due_{0}, sample_at_{0}, flushed_at_{0};
  double highest_v_ = 0.0;
  bool unplugged_ = false;
  std::filesystem::path folder_;
  Counts counts_;
};

[[nodiscard]] const char* text_of(RecordingSession::End end);

}  // namespace gatefly::live
