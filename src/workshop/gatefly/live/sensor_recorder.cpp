// SPDX-License-Identifier: Apache-2.0
#include "gatefly/live/sensor_recorder.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "gatefly/files/jpeg_writer.hpp"
#include "gatefly/flight_log/flight_folder.hpp"

namespace gatefly::live {
namespace {

using std::chrono::nanoseconds;

constexpr nanoseconds kOldestSample = std::chrono::milliseconds{100};  // as the pilot's loop
constexpr std::size_t kLines = 1 << 14;                                // [bytes]

void append(std::string& line, double value) {
  std::array<char, 32> digits{};
  line += ',';
  if (!std::isfinite(value)) return;
  line.append(digits.data(),
              std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

void append(std::string& line, const Imu& imu) {
  for (const double value : imu.gyro_B) append(line, value);
  for (const double value : imu.accel_B) append(line, value);
}

std::string header() {
  std::string line = "t_ns,gyro_p_radps,gyro_q_radps,gyro_r_radps,acc_x_mps2,acc_y_mps2,acc_z_mps2";
  for (const char* column : flight_log::kNavigationImuColumns) line += std::string{","} + column;
  return line + "," + flight_log::kLiftedColumn +
         ",sample_t_ns,fc_roll_rad,fc_pitch_rad,fc_yaw_rad,stick_roll_us,stick_pitch_us,"
         "stick_yaw_us,stick_throttle_us,armed,override,battery_v\n";
}

Imu nothing() {
  const auto nan = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  return {nan, nan};
}

}  // namespace

SensorRecorder::SensorRecorder(std::filesystem::path folder, const Params& params,
                               const std::map<std::string, std::string>& files)
    : folder_{std::move(folder)},
      params_{params},
      log_{folder_ / "log_si.csv"},
      images_{folder_ / "images.csv"},
      held_{nothing()},
      heard_at_{ControllerState::kNever} {
  for (const auto& [name, content] : files) write_whole(folder_ / name, content);
  write_whole(folder_ / flight_log::kRecordingMark, "{\"kind\": \"record\"}\n");
  log_.add(header());
  images_.add("image,t_ns,log_row,arrived_ns,late_ns\n");
}

void SensorRecorder::tick(nanoseconds time, const HeardState* heard, const Picture* picture) {
  if (heard != nullptr) {
    held_ = heard->state.imu;
    heard_at_ = time;
    lifted_ = lifted_ || heard->lifted;
    ++samples_;
  }
  lines_ += std::to_string(time.count());
  append(lines_, time - heard_at_ > kOldestSample ? nothing() : held_);
  append(lines_, heard != nullptr ? held_ : nothing());
  lines_ += lifted_ ? ",1" : ",0";
  if (heard != nullptr) {
    const ControllerState& state = heard->state;
    lines_ += "," + std::to_string(state.imu_at.count());
    const bool has_attitude = state.attitude_at != ControllerState::kNever;
    for (const double angle : {state.attitude.roll, state.attitude.pitch, state.attitude.yaw})
      append(lines_, has_attitude ? angle : std::numeric_limits<double>::quiet_NaN());
    const bool has_sticks = state.sticks_at != ControllerState::kNever;
    for (const auto stick :
         {state.sticks.roll, state.sticks.pitch, state.sticks.yaw, state.sticks.throttle})
      lines_ += has_sticks ? "," + std::to_string(stick) : ",";
    lines_ += state.armed ? ",1" : ",0";
    lines_ += state.override_on ? ",1" : ",0";
    append(lines_,
           state.battery_v > 0.0 ? state.battery_v : std::numeric_limits<double>::quiet_NaN());
  } else {
    lines_ += ",,,,,,,,,,,";
  }
  lines_ += '\n';
  if (lines_.size() > kLines || picture != nullptr) flush();
  ++rows_;
  last_ = time;
  if (picture != nullptr) keep(time, *picture);
}

/// Lines of the log first: no picture is listed in a row that is not there.
void SensorRecorder::flush() {
  if (lines_.empty()) return;
  const std::string lines = std::exchange(lines_, {});
  log_.add(lines);
}

void SensorRecorder::keep(nanoseconds time, const Picture& picture) {
  std::array<char, 32> name{};
  const bool is_file = !picture.file.empty();
  std::snprintf(name.data(), name.size(), "img_%05zu%s", pictures_,
                is_file ? picture.ending : ".jpg");
  if (is_file) {
    write_whole(folder_ / name.data(), picture.file);
  } else {  // the sampling of its colours stays, so that hardly anything is lost
    write_whole(folder_ / name.data(),
                std::string_view{files::recorded_jpeg(picture.view(0), files::Recording::kJpeg)});
  }
  images_.add(std::string{name.data()} + "," + std::to_string(time.count()) + "," +
              std::to_string(rows_ - 1) + "," + std::to_string(picture.arrived.count()) + "," +
              std::to_string(picture.late.count()) + "\n");
  ++pictures_;
}

void SensorRecorder::finish(const std::string& summary_json) {
  flush();
  log_.sync();
  images_.sync();
  write_whole(folder_ / "summary.json", summary_json);
}

}  // namespace gatefly::live
