// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/recording_session.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

namespace gatefly::live {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

// All ours.
constexpr nanoseconds kRecordedLater = 4ms;  // as a run's link thread
constexpr nanoseconds kBehind = 30ms;        // the writer, so that what belongs to a tick is there
constexpr nanoseconds kSilence = 3s;         // a controller without a battery
constexpr nanoseconds kSyncEvery = 1s;       // what a battery that is pulled may cost
constexpr double kUnplugged = 0.6, kPlugged = 0.9;  // of the highest voltage

}  // namespace

const char* text_of(RecordingSession::End end) {
  switch (end) {
    case RecordingSession::End::kTold:
      return "told to end";
    case RecordingSession::End::kSilent:
      return "the controller has fallen silent";
    case RecordingSession::End::kNewBattery:
      return "another battery";
    case RecordingSession::End::kDiskFull:
      return "the disk is full";
    case RecordingSession::End::kLongEnough:
      break;
  }
  return "as long as a folder may be";
}

RecordingSession::RecordingSession(const Plan& plan, const DroneFile& drone, Introduced controller)
    : plan_{plan}, link_{queries_on(std::move(controller.port), drone, controller.known)} {
  for (Picture& picture : memory_) (void)free_.push(&picture);
}

RecordingSession::~RecordingSession() {
  stop_ = true;
  for (std::thread& thread : threads_)
    if (thread.joinable()) thread.join();
}

/// A camera that ends, or is not there yet, is opened again: the rest goes on without.
void RecordingSession::run_camera() {
  Picture spare;
  while (!stop_) {
    try {
      const std::unique_ptr<Camera> camera = opened(plan_.camera, plan_.size, true);
      while (!stop_) {
        Picture* const* const front = free_.front();
        Picture& picture = front != nullptr ? **front : spare;
        const Camera::Got got = camera->next(picture, Clock::now() + 50ms);
        if (got == Camera::Got::kNothing || got == Camera::Got::kPart) continue;
        if (got == Camera::Got::kEnded) {
          camera_error_ = camera->why().empty() ? "has ended" : camera->why();
          break;
        }
        picture.arrived = clock_.now();
        if (front == nullptr) {
          ++pictures_lost_;  // the disk is behind
          continue;
        }
        Picture* const place = *front;
        free_.pop();
        (void)pictures_.push(place);
      }
    } catch (const std::exception& error) {
      camera_error_ = error.what();
    }
    for (int i = 0; i < 20 && !stop_; ++i) std::this_thread::sleep_for(50ms);
  }
}

void RecordingSession::run_link() {
  while (!stop_ && !link_.broken()) {
    const bool sampled = link_.serve(clock_, clock_.now() + 5ms);
    const ControllerState& state = link_.state();
    state_.write(state);
    if (!sampled) continue;
    const HeardState heard{
        .state = state, .due = state.imu_taken + kRecordedLater, .lifted = state.lifted};
    if (!heard_.push(heard)) ++samples_lost_;
  }
  link_over_ = true;
}

/// A slow disk keeps nobody waiting but itself.
void RecordingSession::run_disk() {
  Moment next = Clock::now() + kSyncEvery;
  while (!stop_) {
    std::this_thread::sleep_for(50ms);
    if (Clock::now() < next) continue;
    sync_disk_of(folder_);
    next = Clock::now() + kSyncEvery;
  }
}

void RecordingSession::write(SensorRecorder& recorder, nanoseconds until) {
  const nanoseconds period{std::llround(1e9 / plan_.recorder.imu_hz)};
  for (; due_ <= until; due_ += period) {
    std::optional<HeardState> heard;
    if (const HeardState* const front = heard_.front(); front != nullptr && front->due <= due_) {
      heard = *front;
      sample_at_ = due_;
      heard_.pop();
    }
    Picture* newest = nullptr;
    while (Picture* const* const front = pictures_.front()) {
      if ((*front)->arrived > due_) break;
      if (newest != nullptr) {  // two in one tick: the later one
        ++pictures_lost_;
        (void)free_.push(newest);
      }
      newest = *front;
      pictures_.pop();
    }
    try {
      recorder.tick(due_, heard ? &*heard : nullptr, newest);
    } catch (...) {
      if (newest != nullptr) (void)free_.push(newest);
      throw;
    }
    if (newest != nullptr) (void)free_.push(newest);
  }
  if (due_ - flushed_at_ < kSyncEvery) return;
  flushed_at_ = due_;
  recorder.flush();
}

std::optional<RecordingSession::End> RecordingSession::why_over(const SensorRecorder& recorder) {
  const double volts = state_.read().battery_v;
  highest_v_ = std::max(highest_v_, volts);
  unplugged_ = unplugged_ || volts < kUnplugged * highest_v_;
  if (unplugged_ && volts > kPlugged * highest_v_) return End::kNewBattery;
  if (link_over_ || due_ - sample_at_ > kSilence) return End::kSilent;
  if (recorder.rows() >= plan_.most_rows) return End::kLongEnough;
  if (free_bytes(recorder.folder()) < plan_.keep_free) return End::kDiskFull;
  return std::nullopt;
}

RecordingSession::End RecordingSession::record(
    const std::filesystem::path& out, const std::function<bool()>& told_to_end,
    const std::function<std::string(const SensorRecorder&, End, const Counts&)>& summary) {
  folder_ = next_flight_folder(out);
  SensorRecorder recorder{folder_, plan_.recorder, plan_.files};
  clock_ = RunClock{};
  threads_[0] = std::thread{[this] { run_camera(); }};
  threads_[1] = std::thread{[this] { run_link(); }};
  threads_[2] = std::thread{[this] { run_disk(); }};
  std::optional<End> end;
  int round = 0;
  while (!end) {
    std::this_thread::sleep_for(10ms);
    try {
      write(recorder, clock_.now() - kBehind);
    } catch (const DiskFailed& error) {
      counts_.disk_error = error.what();
      end = End::kDiskFull;
    }
    constexpr int kLookEvery = 20;  // rounds: a look at the disk costs
    if (!end && told_to_end()) end = End::kTold;
    if (!end && (++round % kLookEvery == 0 || link_over_)) end = why_over(recorder);
  }
  stop_ = true;
  for (std::thread& thread : threads_) thread.join();
  if (counts_.disk_error.empty()) {
    try {
      write(recorder, clock_.now() - kBehind);
    } catch (const DiskFailed& error) {
      counts_.disk_error = error.what();
    }
  }
  counts_.pictures_lost = pictures_lost_;
  counts_.samples_lost = samples_lost_;
  counts_.state = state_.read();
  counts_.camera_error = camera_error_;
  try {
    recorder.finish(summary(recorder, *end, counts_));
  } catch (const DiskFailed& error) {  // it is read as one that was cut
    if (counts_.disk_error.empty()) counts_.disk_error = error.what();
  }
  return *end;
}

}  // namespace gatefly::live
