// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gatefly/flight_log/flight_recorder.hpp"
#include "gatefly/live/wires.hpp"

namespace gatefly::live {

/// Writes a session as a flight folder that `replay` flies again, and counts. A disk that fails ends the recording, not the flight.
class RunRecorder {
 public:
  /// @param out  "": nothing is written, only counted.
  RunRecorder(const std::filesystem::path& out, const flight_log::Keep& keep);

  void record(const FlownTick& tick);
  void add_file(const std::string& name, const std::string& content);
  /// Names the folder. @return what became of an earlier flight; "" when there was none, or nothing is written.
  std::string finish(const std::string& summary_json);

  [[nodiscard]] std::size_t ticks() const { return ticks_; }
  [[nodiscard]] std::size_t pictures() const { return pictures_; }
  [[nodiscard]] std::size_t pictures_with_gate() const { return with_gate_; }
  [[nodiscard]] int gates_passed() const { return gates_passed_; }
  [[nodiscard]] bool finished() const { return finished_; }
  [[nodiscard]] std::chrono::nanoseconds last_time() const { return last_time_; }
  [[nodiscard]] const std::string& error() const { return error_; }
  /// Ticks that came after the error.
  [[nodiscard]] std::size_t unwritten() const { return unwritten_; }
  /// Lateness of the pilot's ticks, and time in its step [s].
  [[nodiscard]] std::vector<double>& late() { return late_; }
  [[nodiscard]] std::vector<double>& took() { return took_; }

 private:
  std::optional<flight_log::FlightRecorder> recorder_;
  std::string error_;
  std::size_t ticks_ = 0, pictures_ = 0, with_gate_ = 0, unwritten_ = 0;
  int gates_passed_ = 0;
  bool finished_ = false;
  std::chrono::nanoseconds last_time_{0};
  std::vector<double> late_, took_;
};

}  // namespace gatefly::live
