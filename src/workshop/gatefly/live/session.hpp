// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <thread>

#include "gatefly/live/camera.hpp"
#include "gatefly/live/clock.hpp"
#include "gatefly/live/real_time.hpp"
#include "gatefly/live/wires.hpp"
#include "gatefly/race/pilot_config.hpp"

namespace gatefly::live {

/// How a session is flown.
struct SessionPlan {
  PilotConfig pilot;
  int rotation_deg = 0;   ///< Rotation of stored pictures.
  bool recorded = false;  ///< Ticks come from a recording, and each waits for its picture.
  bool looks_on = true;   ///< Somebody else flies.
  bool carried = false;   ///< Nobody flies: off the ground once rest is over.
};

/// The loop of the link's thread, until wires.stop: linked.hpp.
using LinkWork = std::function<void(Wires&, const RunClock&)>;

/// A flight of a real drone, or of its recording: a thread each for camera, link and pilot, beside the caller's, which records.
/// Nothing but Pilot::step decides.
class Session {
 public:
  /// @throws std::invalid_argument when the course cannot be flown.
  Session(const SessionPlan& plan, std::unique_ptr<Camera> camera, LinkWork link);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void start();
  /// Gives every tick that has been flown to `take`, oldest first. @return whether there was one.
  bool drain(const std::function<void(const FlownTick&)>& take);
  /// No tick will come any more, but those that drain() has not given yet.
  [[nodiscard]] bool over() const { return wires_.pilot_over; }
  void stop();
  [[nodiscard]] Wires& wires() { return wires_; }
  [[nodiscard]] const RunClock& clock() const { return clock_; }
  /// Counts of the readings that the pilot refused; after stop().
  [[nodiscard]] const SensorHealth& sensor_health() const { return pilot_.health(); }

 private:
  void go_first_unless_recorded(Urgency urgency);
  void run_camera();
  void run_link();
  void run_pilot();

  SessionPlan plan_;
  std::unique_ptr<Camera> camera_;
  LinkWork link_;
  Wires wires_;
  RunClock clock_;
  Pilot pilot_;
  std::array<Picture, Wires::kPictures> memory_;  ///< Memory of all pictures.
  std::array<std::thread, 3> threads_;
};

}  // namespace gatefly::live
