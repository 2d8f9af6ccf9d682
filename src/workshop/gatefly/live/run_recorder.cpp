// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/run_recorder.hpp"

#include <stdexcept>

#include "gatefly/geometry/seconds.hpp"

namespace gatefly::live {

RunRecorder::RunRecorder(const std::filesystem::path& out, const flight_log::Keep& keep) {
  if (!out.empty()) recorder_.emplace(out, keep);
}

void RunRecorder::record(const FlownTick& tick) {
  ++ticks_;
  if (tick.picture != nullptr) ++pictures_, with_gate_ += !tick.detections.empty();
  gates_passed_ = tick.estimate.gates_passed;
  finished_ = finished_ || tick.finished;
  last_time_ = tick.sensors.time;
  late_.push_back(seconds(tick.late));
  took_.push_back(seconds(tick.took));
  unwritten_ += recorder_ && !error_.empty();
  if (!recorder_ || !error_.empty()) return;
  flight_log::RecordedRow row{.sensors = tick.sensors,
                              .command = tick.command,
                              .estimate = tick.estimate,
                              .phase = tick.phase,
                              .target_gate = tick.target_gate,
                              .detections = tick.detections,
                              .motors = tick.motors};
  if (tick.picture != nullptr) {
    row.frame = tick.picture->pixels;
    row.file = tick.picture->file;
    row.ending = tick.picture->ending;
  }
  try {
    recorder_->record(row);
  } catch (const std::exception& error) {
    error_ = error.what();
  }
}

void RunRecorder::add_file(const std::string& name, const std::string& content) {
  if (recorder_) recorder_->add_file(name, content);
}

std::string RunRecorder::finish(const std::string& summary_json) {
  if (!recorder_ || !error_.empty()) return "";
  try {
    return recorder_->finish(summary_json);
  } catch (const std::exception& error) {
    error_ = error.what();
    return "";
  }
}

}  // namespace gatefly::live
