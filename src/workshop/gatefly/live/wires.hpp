// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "gatefly/guard/hand_over.hpp"
#include "gatefly/live/controller_state.hpp"
#include "gatefly/live/handoff.hpp"
#include "gatefly/live/picture.hpp"
#include "gatefly/race/pilot.hpp"

namespace gatefly::live {

/// An IMU sample of the controller, for the pilot.
struct Heard {
  Imu imu;
  std::chrono::nanoseconds due{
      0};  ///< When the pilot gets it: a little after it was taken, so that they come regularly.
  bool lifted = false;     ///< Somebody else has taken off with the drone.
  bool may_start = false;  ///< The drone is this pilot's.
};

/// A tick of a recorded flight, in the place of a drone's.
struct RecordedSensors {
  Sensors sensors;
  std::optional<std::size_t> picture;           ///< Its number.
  std::optional<std::array<double, 4>> motors;  ///< Rotor commands at that time.
};

/// The pilot's command and estimate, for the thread that sends set points.
struct Wanted {
  static constexpr std::chrono::nanoseconds kNever = -std::chrono::hours{24};
  std::chrono::nanoseconds at = kNever;
  Command command;
  bool steers = false;  ///< Off the ground; else the motors rest.
  bool landed = false;
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero(), v_E = Eigen::Vector3d::Zero();
  double yaw = 0.0;
  double climb_sigma = 1e9;                     ///< Of v_E.z [m/s].
  std::chrono::nanoseconds height_at = kNever;  ///< A gate told it.
  std::chrono::nanoseconds picture_at = kNever, picture_limit = std::chrono::milliseconds{150};
};

/// One step of the pilot, for the recorder.
struct FlownTick {
  Sensors sensors;             ///< Without its image ...
  Picture* picture = nullptr;  ///< ... which goes back when it is written.
  Command command;
  std::optional<std::array<double, 4>> motors;
  Estimate estimate;
  std::size_t phase = 0;
  int target_gate = 0;
  GateDetections detections;
  bool finished = false, landed = false;
  std::chrono::nanoseconds late{0}, took{0};  ///< Woken up after it was due; in Pilot::step.
};

/// The state of the hand-over and what is sent because of it.
struct DeckNews {
  guard::HandOver state;
  guard::Action action = guard::Action::kSilent;
  long frames = 0;                          ///< Set points.
  std::chrono::nanoseconds longest_gap{0};  ///< Between two of them.
};

/// How late something came that was due regularly, counted by tenths of a millisecond: fixed memory, whatever comes.
class LateCounts {
 public:
  void add(std::chrono::nanoseconds late) {
    const auto tenths = late / std::chrono::microseconds{100};
    ++counts_[static_cast<std::size_t>(
        std::clamp<std::int64_t>(tenths, 0, static_cast<std::int64_t>(counts_.size()) - 1))];
    ++all_;
    longest_ = std::max(longest_, late);
  }
  /// The lateness that `part` of all did not exceed, to a tenth of a millisecond.
  [[nodiscard]] std::chrono::nanoseconds quantile(double part) const;
  [[nodiscard]] std::chrono::nanoseconds longest() const { return longest_; }
  [[nodiscard]] long all() const { return all_; }

 private:
  std::array<std::uint32_t, 1000> counts_{};
  std::chrono::nanoseconds longest_{0};
  long all_ = 0;
};

/// All that goes between camera, link, pilot and recorder; each end of each wire is one thread's.
struct Wires {
  static constexpr std::size_t kPictures = 12;

  Ring<Heard> samples{64};                  ///< link → pilot
  Ring<RecordedSensors> recorded{128};      ///< link → pilot, of a replay
  Ring<Picture*> pictures{kPictures};       ///< camera → pilot
  Ring<FlownTick> flown{1024};              ///< pilot → recorder
  Ring<Picture*> free_pictures{kPictures};  ///< recorder → camera
  Ring<Picture*> returned{kPictures};       ///< pilot → camera: what is not recorded
  Latest<Wanted> wanted;                    ///< pilot → link
  Latest<ControllerState> state;            ///< link → recorder

  Latest<DeckNews> deck;   ///< link → recorder
  LateCounts late_frames;  ///< Set points; the link's thread's until it is over.

  std::atomic<bool> stop = false;  ///< Everybody ends; a drone in the air is brought down first.
  std::atomic<bool> told_to_end = false;  ///< The drone is to be brought down.
  /// All threads that must not be late go first, and memory is held: as far as the system allows it.
  std::atomic<bool> first = true, held = false;
  std::atomic<bool> link_over = false, camera_over = false, pilot_over = false;
  std::atomic<std::chrono::nanoseconds> part_of_picture_at{
      std::chrono::nanoseconds{0}};      ///< When something of a new one came last.
  std::string link_error, camera_error;  ///< Written before its thread is over.
  std::atomic<int> at_recorder =
      0;  ///< Pictures; at most kAtRecorder, so that a slow disk does not blind the pilot.
  static constexpr int kAtRecorder = kPictures - 4;
  std::atomic<long> pictures_lost = 0, pictures_seen = 0, stalls = 0, ticks_missed = 0,
                    unrecorded = 0;  ///< Ticks or pictures of ticks.
};

}  // namespace gatefly::live
