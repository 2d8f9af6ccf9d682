// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/pilot_loop.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "gatefly/geometry/seconds.hpp"

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

/// The pilot gets ticks at rest for so long and is then held back: its biases are nearly learnt, and it would take off with more.
constexpr double kRestSeconds = 1.3;
/// A held sample that is older is none.
constexpr nanoseconds kOldest = 100ms;
/// So long after it has left the floor a height by the accelerometer alone is believed: 0.3 m/s² make it 0.6 m wrong. Ours.
constexpr nanoseconds kFromGround = 2s;

Imu no_sample() {
  const auto nothing = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  return {nothing, nothing};
}

}  // namespace

PilotLoop::PilotLoop(const SessionPlan& plan, Pilot& pilot, Wires& wires, const RunClock& clock)
    : plan_{plan}, pilot_{pilot}, wires_{wires}, clock_{clock}, held_{no_sample()} {}

void PilotLoop::fly() {
  const nanoseconds period{std::llround(1e9 / plan_.pilot.imu_hz)};
  nanoseconds due = clock_.now();
  // A flying pilot goes on after landing: somebody must decide the sticks until the drone is disarmed.
  while (!wires_.stop && !wires_.link_over && (!plan_.looks_on || !pilot_.landed())) {
    due += period;
    std::this_thread::sleep_until(clock_.moment(due));
    const nanoseconds now = clock_.now();
    if (now - due > 4 * period) {
      wires_.ticks_missed += (now - due) / period;
      due = now;  // what is missed is not made up for
    }
    Sensors sensors{.time = due, .imu = held_};
    FlownTick tick;
    tick.late = now - due;
    gather(sensors, due);
    Picture* const picture = newest_picture(now);
    const double rested = static_cast<double>(rest_ticks_) / plan_.pilot.imu_hz;
    const bool released = plan_.looks_on ? lifted_ || plan_.carried : may_start_;
    if (!released && (rested > kRestSeconds || !std::isfinite(sensors.imu.gyro_B.x()))) {
      give_back(picture);
      say(last_, now);
      continue;
    }
    if (!released) ++rest_ticks_;
    step(sensors, picture, tick, now);
  }
}

void PilotLoop::fly_recorded() {
  while (!wires_.stop) {
    const RecordedSensors* const front = wires_.recorded.front();
    if (front == nullptr) {
      if (wires_.link_over && wires_.recorded.front() == nullptr) return;
      std::this_thread::sleep_for(200us);
      continue;
    }
    RecordedSensors next = *front;
    wires_.recorded.pop();
    Picture* picture = nullptr;
    if (next.picture) picture = recorded_picture(*next.picture);
    if (next.picture && picture == nullptr) return;  // it will not come: the camera says why
    FlownTick tick;
    tick.motors = next.motors;
    step(next.sensors, picture, tick, clock_.now());
  }
}

void PilotLoop::gather(Sensors& sensors, nanoseconds now) {
  sensors.looks_on = plan_.looks_on;
  if (const Heard* const heard = wires_.samples.front(); heard != nullptr && heard->due <= now) {
    held_ = heard->imu;
    heard_at_ = now;
    lifted_ = lifted_ || heard->lifted;
    may_start_ = may_start_ || heard->may_start;
    if (plan_.pilot.filter_imu_hz > 0.0) sensors.navigation_imu = held_;
    wires_.samples.pop();
  }
  sensors.imu = now - heard_at_ > kOldest ? no_sample() : held_;
  sensors.lifted = plan_.looks_on && lifted_;
}

Picture* PilotLoop::newest_picture(nanoseconds now) {
  Picture* newest = nullptr;
  while (Picture* const* const front = wires_.pictures.front()) {
    give_back(newest);
    newest = *front;
    wires_.pictures.pop();
    pictures_.arrived(newest->arrived);
    picture_at_ = newest->arrived;
    ++wires_.pictures_seen;
  }
  pictures_.part_arrived(wires_.part_of_picture_at);
  const bool stalled = pictures_.stalled(now);
  if (stalled && !was_stalled_) ++wires_.stalls;
  was_stalled_ = stalled;
  return newest;
}

Picture* PilotLoop::recorded_picture(std::size_t number) {
  while (!wires_.stop) {
    // Asked before looking: what came just before its end is still there then.
    const bool over = wires_.camera_over;
    Picture* const* const front = wires_.pictures.front();
    if (front == nullptr) {
      if (over) return nullptr;
      std::this_thread::sleep_for(100us);
      continue;
    }
    Picture* const picture = *front;
    wires_.pictures.pop();
    ++wires_.pictures_seen;
    if (picture->number == number) return picture;
    give_back(picture);
  }
  return nullptr;
}

void PilotLoop::give_back(Picture* picture) {
  if (picture != nullptr) (void)wires_.returned.push(picture);
}

void PilotLoop::step(Sensors& sensors, Picture* picture, FlownTick& tick, nanoseconds now) {
  if (picture != nullptr) {
    sensors.image = picture->view(plan_.rotation_deg);
    sensors.picture_late = seconds(picture->late);
  }
  const Moment before = Clock::now();
  last_ = pilot_.step(sensors);
  tick.took = Clock::now() - before;
  tick.command = last_;
  tick.estimate = pilot_.estimate();
  if (picture != nullptr) {
    tick.detections = pilot_.sighting().detections;
    if (pilot_.sighting().tells_height) height_at_ = now;
  }
  say(last_, now);
  sensors.image.reset();
  tick.sensors = sensors;
  tick.picture = picture;
  if (!plan_.looks_on) tick.motors = last_.motors;
  tick.phase = pilot_.phase().index();
  tick.target_gate = pilot_.target_gate();
  tick.finished = pilot_.finished(), tick.landed = pilot_.landed();
  hand_on(tick);
}

/// A recording loses nothing; a drone waits for no disk.
void PilotLoop::hand_on(FlownTick& tick) {
  const auto wait = [this] { return plan_.recorded && !wires_.stop; };
  if (tick.picture != nullptr) {
    while (wires_.at_recorder >= Wires::kAtRecorder && wait()) std::this_thread::sleep_for(100us);
    if (wires_.at_recorder >= Wires::kAtRecorder) {
      ++wires_.unrecorded;
      give_back(std::exchange(tick.picture, nullptr));
    }
  }
  // Counted before it is there: the recorder may be quicker than we are.
  wires_.at_recorder += tick.picture != nullptr;
  while (!wires_.flown.push(tick)) {
    if (wait()) {
      std::this_thread::sleep_for(100us);
      continue;
    }
    ++wires_.unrecorded;
    wires_.at_recorder -= tick.picture != nullptr;
    give_back(tick.picture);
    return;
  }
}

void PilotLoop::say(const Command& command, nanoseconds now) {
  const Estimate estimate = pilot_.estimate();
  // The floor tells the height, and for a while after take-off the accelerometer, which has just rested.
  if (std::holds_alternative<OnGround>(pilot_.phase())) ground_at_ = now;
  if (now - ground_at_ < kFromGround) height_at_ = now;
  wires_.wanted.write(
      {.at = now,
       .command = command,
       .steers = is_flying(pilot_.phase()) || std::holds_alternative<Land>(pilot_.phase()),
       .landed = pilot_.landed(),
       .p_EB = estimate.p_EB,
       .v_E = estimate.v_E,
       .yaw = estimate.attitude.yaw,
       .climb_sigma = pilot_.navigator().velocity_sigma().z(),
       .height_at = height_at_,
       .picture_at = picture_at_,
       .picture_limit = pictures_.gone(now)});
}

}  // namespace gatefly::live
