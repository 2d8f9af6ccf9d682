// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gatefly/live/session.hpp"
#include "gatefly/live/stream_watch.hpp"

namespace gatefly::live {

/// The pilot's thread: gathers what has arrived into Sensors, steps, hands on what came of it.
class PilotLoop {
 public:
  PilotLoop(const SessionPlan& plan, Pilot& pilot, Wires& wires, const RunClock& clock);

  /// A tick every 1 / imu_hz, as the pilot of a simulated autopilot has it: the last sample is held, a new one is also Sensors::navigation_imu.
  void fly();
  /// The ticks of a recording.
  void fly_recorded();

 private:
  void gather(Sensors& sensors, std::chrono::nanoseconds now);
  [[nodiscard]] Picture* newest_picture(std::chrono::nanoseconds now);
  [[nodiscard]] Picture* recorded_picture(std::size_t number);
  void give_back(Picture* picture);
  void step(Sensors& sensors, Picture* picture, FlownTick& tick, std::chrono::nanoseconds now);
  void hand_on(FlownTick& tick);
  void say(const Command& command, std::chrono::nanoseconds now);

  const SessionPlan& plan_;
  Pilot& pilot_;
  Wires& wires_;
  const RunClock& clock_;
  StreamWatch pictures_;
  Imu held_;
  std::chrono::nanoseconds heard_at_{0}, height_at_ = Wanted::kNever, picture_at_ = Wanted::kNever,
                                         ground_at_ = Wanted::kNever;
  bool lifted_ = false, may_start_ = false, was_stalled_ = false;
  long rest_ticks_ = 0;
  Command last_;
};

}  // namespace gatefly::live
