// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/session.hpp"

#include <exception>
#include <utility>

#include "gatefly/live/pilot_loop.hpp"

namespace gatefly::live {

using namespace std::chrono_literals;

Session::Session(const SessionPlan& plan, std::unique_ptr<Camera> camera, LinkWork link)
    : plan_{plan}, camera_{std::move(camera)}, link_{std::move(link)}, pilot_{plan.pilot} {
  for (Picture& picture : memory_) (void)wires_.free_pictures.push(&picture);
}

Session::~Session() { stop(); }

void Session::go_first_unless_recorded(Urgency urgency) {
  // A recording is flown as fast as it goes: first in line it would leave nothing to anybody.
  if (plan_.recorded || !go_first(urgency)) wires_.first = false;
}

void Session::start() {
  if (!plan_.recorded) wires_.held = hold_memory();
  clock_ = RunClock{};
  threads_[0] = std::thread{[this] { run_camera(); }};
  threads_[1] = std::thread{[this] { run_link(); }};
  threads_[2] = std::thread{[this] { run_pilot(); }};
}

void Session::stop() {
  wires_.stop = true;
  for (std::thread& thread : threads_)
    if (thread.joinable()) thread.join();
}

bool Session::drain(const std::function<void(const FlownTick&)>& take) {
  bool any = false;
  while (const FlownTick* const tick = wires_.flown.front()) {
    take(*tick);
    if (tick->picture != nullptr) {
      (void)wires_.free_pictures.push(tick->picture);
      --wires_.at_recorder;
    }
    wires_.flown.pop();
    any = true;
  }
  return any;
}

void Session::run_camera() try {
  go_first_unless_recorded(Urgency::kCamera);
  Picture spare;
  while (!wires_.stop) {
    Ring<Picture*>& from =
        wires_.returned.front() != nullptr ? wires_.returned : wires_.free_pictures;
    Picture* const* const front = from.front();
    if (front == nullptr && plan_.recorded) {
      std::this_thread::sleep_for(200us);
      continue;
    }
    Picture& picture = front != nullptr ? **front : spare;
    const Camera::Got got = camera_->next(picture, Clock::now() + 50ms);
    if (got == Camera::Got::kEnded) break;
    if (got == Camera::Got::kNothing) continue;
    if (got == Camera::Got::kPart) {
      wires_.part_of_picture_at = clock_.now();
      continue;
    }
    picture.arrived = clock_.now();
    if (front == nullptr) {
      ++wires_.pictures_lost;  // the pilot is behind
      continue;
    }
    Picture* const place = *front;
    from.pop();
    (void)wires_.pictures.push(place);
  }
  wires_.camera_error = camera_->why();
  wires_.camera_over = true;
} catch (const std::exception& error) {
  wires_.camera_error = error.what();
  wires_.camera_over = true;
}

void Session::run_link() try {
  go_first_unless_recorded(Urgency::kLink);
  link_(wires_, clock_);
  wires_.link_over = true;
} catch (const std::exception& error) {
  wires_.link_error = error.what();
  wires_.link_over = true;
}

void Session::run_pilot() {
  go_first_unless_recorded(Urgency::kPilot);
  PilotLoop loop{plan_, pilot_, wires_, clock_};
  if (plan_.recorded)
    loop.fly_recorded();
  else
    loop.fly();
  wires_.pilot_over = true;
}

}  // namespace gatefly::live
