// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/flight_recorder.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <system_error>

#include "gatefly/files/detections_file.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPiece = 1 << 20;  // [bytes]

constexpr const char* kHeader =
    "t_ns,t_s,gyro_p_radps,gyro_q_radps,gyro_r_radps,acc_x_mps2,acc_y_mps2,acc_z_mps2,sonar_m,baro_"
    "m,"
    "ot_x_m,ot_y_m,ot_z_m,ot_vx_mps,ot_vy_mps,ot_vz_mps,true_roll_rad,true_pitch_rad,true_yaw_rad,"
    "est_x_m,est_y_m,est_z_m,est_vx_mps,est_vy_mps,est_vz_mps,est_roll_rad,est_pitch_rad,est_yaw_"
    "rad,"
    "cmd_roll_rad,cmd_pitch_rad,cmd_yaw_rad,cmd_thrust_mps2,"
    "motor_lf_radps,motor_rf_radps,motor_rb_radps,motor_lb_radps,phase,target_gate,gates_passed\n";

double seconds(std::chrono::nanoseconds time) { return 1e-9 * static_cast<double>(time.count()); }

/// An earlier flight may be replaced, and a folder with nothing in it. Nothing else.
void refuse_foreign(const fs::path& out) {
  std::error_code error;
  if (!fs::exists(out, error)) return;
  if (!fs::is_directory(out, error))
    throw std::runtime_error(out.string() + ": is there and is no folder, choose another --out");
  if (!fs::is_empty(out, error) && !fs::exists(out / "summary.json", error))
    throw std::runtime_error(
        out.string() +
        ": is there and holds no earlier flight (summary.json), choose another --out");
}

}  // namespace

FlightRecorder::FlightRecorder(fs::path out) : out_{std::move(out)} {
  while (!out_.empty() && !out_.has_filename()) out_ = out_.parent_path();  // "out/a/" is "out/a"
  if (out_.empty() || out_ == "." || out_ == "..")
    throw std::runtime_error("--out: must be a folder of its own, which will be replaced");
  refuse_foreign(out_);
  partial_ = out_.string() + ".partial";

  std::error_code error;
  fs::remove_all(partial_, error);
  if (!error) fs::create_directories(partial_, error);
  if (error) throw std::runtime_error(out_.string() + ": cannot be written: " + error.message());
  log_.open(partial_ / "log_si.csv", std::ios::binary);
  images_.open(partial_ / "images.csv", std::ios::binary);
  detections_.open(partial_ / "detections.csv", std::ios::binary);
  buffer_.reserve(kPiece + 4096);
  buffer_ = kHeader;
  images_ << "image,t_s,log_row,t_ns\n";
  check(log_, "log_si.csv");
  detections_ << detections_header();
  check(images_, "images.csv");
  check(detections_, "detections.csv");
}

FlightRecorder::~FlightRecorder() {
  if (finished_) return;
  log_.close();
  images_.close();
  detections_.close();
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
}

void FlightRecorder::check(const std::ofstream& file, const fs::path& path) const {
  if (!file)
    throw std::runtime_error((partial_ / path).string() + ": cannot be written (disk full?)");
}

void FlightRecorder::append(double value) {
  std::array<char, 32> text{};
  if (!std::isfinite(value)) {  // a lost sample is an empty cell
    buffer_ += ',';
    return;
  }
  // 17 significant digits: any double reads back as itself.
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 17);
  buffer_.append(text.data(), end.ptr);
  buffer_ += ',';
}

void FlightRecorder::append(const Eigen::Vector3d& value) {
  for (const double x : value) append(x);
}

void FlightRecorder::append(const Attitude& attitude) {
  append(Eigen::Vector3d{attitude.roll, attitude.pitch, attitude.yaw});
}

void FlightRecorder::flush(bool all) {
  if (buffer_.size() < kPiece && !all) return;
  log_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  buffer_.clear();
  check(log_, "log_si.csv");
}

void FlightRecorder::record(const Tick& tick) {
  const Sensors& sensors = tick.sensors;
  const auto append_if = [&](const std::optional<double>& value) {
    if (value)
      append(*value);
    else
      buffer_ += ',';
  };
  buffer_ += std::to_string(sensors.time.count()) + ",";
  append(seconds(sensors.time));
  append(sensors.imu.gyro_B);
  append(sensors.imu.accel_B);
  append_if(sensors.sonar);
  append_if(sensors.baro);
  append(tick.truth.p_EB);
  append(tick.truth.v_E);
  append(tick.truth.attitude);
  const Estimate estimate = tick.pilot.estimate();
  append(estimate.p_EB);
  append(estimate.v_E);
  append(estimate.attitude);
  const AttitudeCommand& command = tick.command.attitude;
  append(Eigen::Vector3d{command.roll, command.pitch, command.yaw});
  append(command.thrust);
  for (const double speed : tick.command.motors) append(speed);
  buffer_ += std::to_string(tick.pilot.phase().index()) + "," +
             std::to_string(tick.pilot.target_gate()) + "," +
             std::to_string(estimate.gates_passed) + "\n";
  flush(false);

  if (!tick.frame.empty()) record_frame(tick);
  ++row_;
}

void FlightRecorder::record_frame(const Tick& tick) {
  const std::chrono::nanoseconds time = tick.sensors.time;
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "frame_%05zu.uyvy", frame_++);
  std::ofstream file(partial_ / name.data(), std::ios::binary);
  file.write(reinterpret_cast<const char*>(tick.frame.data()),
             static_cast<std::streamsize>(tick.frame.size()));
  file.flush();
  check(file, name.data());
  images_ << name.data() << ',' << text_of(seconds(time)) << ',' << row_ << ',' << time.count()
          << '\n';
  check(images_, "images.csv");

  int rank = 0;
  for (const GateDetection& gate : tick.pilot.sighting().detections)
    detections_ << line_of(row_of(name.data(), rank++, gate));
  check(detections_, "detections.csv");
}

void FlightRecorder::add_file(const std::string& name, const std::string& content) {
  write_file(partial_ / name, content);
}

void FlightRecorder::finish(const std::string& summary_json) {
  flush(true);
  log_.close();
  images_.close();
  detections_.close();
  check(log_, "log_si.csv");
  check(images_, "images.csv");
  check(detections_, "detections.csv");
  add_file("summary.json", summary_json);

  // Out of the way first, then in place: at no moment is there half a flight under the name.
  refuse_foreign(out_);
  const fs::path old = out_.string() + ".replaced";
  std::error_code error;
  fs::remove_all(old, error);
  if (fs::exists(out_, error)) fs::rename(out_, old, error);
  if (!error) fs::rename(partial_, out_, error);
  if (error) throw std::runtime_error(out_.string() + ": cannot be written: " + error.message());
  finished_ = true;
  fs::remove_all(old, error);
}

}  // namespace gatefly::io
