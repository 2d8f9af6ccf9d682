// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/flight_recorder.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <regex>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "gatefly/files/detections_file.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/files/xxh64.hpp"
#include "gatefly/flight_log/flight_folder.hpp"

namespace gatefly::flight_log {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPiece = 1 << 20;  // [bytes]

constexpr const char* kLogHeader =
    "t_ns,t_s,gyro_p_radps,gyro_q_radps,gyro_r_radps,acc_x_mps2,acc_y_mps2,acc_z_mps2,sonar_m,baro_"
    "m,"
    "ot_x_m,ot_y_m,ot_z_m,ot_vx_mps,ot_vy_mps,ot_vz_mps,true_roll_rad,true_pitch_rad,true_yaw_rad,"
    "est_x_m,est_y_m,est_z_m,est_vx_mps,est_vy_mps,est_vz_mps,est_roll_rad,est_pitch_rad,est_yaw_"
    "rad,"
    "cmd_roll_rad,cmd_pitch_rad,cmd_yaw_rad,cmd_thrust_mps2,"
    "motor_lf_radps,motor_rf_radps,motor_rb_radps,motor_lb_radps,phase,target_gate,gates_passed,"
    "battery_v";

// Column t_s, to the last digit as logs of earlier versions have it: gatefly::seconds rounds otherwise.
// It must not bear that name, which would hide the other wherever this folder is compiled as one.
double column_seconds(std::chrono::nanoseconds time) {
  return 1e-9 * static_cast<double>(time.count());
}

constexpr const char* kFilm = "flight.mp4";
constexpr files::OutputKind kFlight{"earlier flight", "\"gates_passed\""};

/// The names of a flight's files, a film on its way among them. Others in its folder are kept.
bool is_of_a_flight(const std::string& name) {
  static const std::regex kNames{
      "log_si\\.csv(\\.gz)?|images\\.csv|detections\\.csv|summary\\.json|report\\.html|flight\\."
      "mcap|"
      "(flight\\.mp4|onboard\\.webm)(\\.partial)?|track\\.toml|config-[0-9]+\\.toml|settings\\.txt|"
      "frame_[0-9]+\\.uyvy|img_[0-9]+\\.(jpg|png|ppm)|drone\\.toml|frames\\.mkv(\\.partial)?"};
  return std::regex_match(name, kNames);
}

/// Full-range JFIF, said of what goes in and of what comes out: ffmpeg converts nothing.
const std::vector<std::string>& jfif() {
  static const std::vector<std::string> kWords{"-color_range", "pc", "-colorspace", "smpte170m"};
  return kWords;
}

/// FFV1, each picture a key picture with its own checksum; the same film for the same frames.
std::vector<std::string> lossless() {
  std::vector<std::string> words{"-c:v",    "ffv1", "-level",    "3", "-g",       "1",
                                 "-slices", "4",    "-slicecrc", "1", "-pix_fmt", "yuv422p"};
  words.insert(words.end(), jfif().begin(), jfif().end());
  for (const char* word : {"-fflags", "+bitexact", "-flags:v", "+bitexact", "-f", "matroska"})
    words.emplace_back(word);
  return words;
}

/// U Y0 V Y1 as planes Y, U, V: FFV1's own order, so that ffmpeg has nothing to convert.
std::vector<std::uint8_t> planes_of(std::span<const std::uint8_t> uyvy) {
  std::vector<std::uint8_t> planes(uyvy.size());
  std::uint8_t* y = planes.data();
  std::uint8_t* u = y + uyvy.size() / 2;
  std::uint8_t* v = u + uyvy.size() / 4;
  for (std::size_t i = 0; i + 3 < uyvy.size(); i += 4) {
    *u++ = uyvy[i], *y++ = uyvy[i + 1];
    *v++ = uyvy[i + 2], *y++ = uyvy[i + 3];
  }
  return planes;
}

/// ",u,v" of each corner; empty cells where the next gate is not shown whole.
std::string corners_of(const std::optional<Quad>& gate) {
  if (!gate) return std::string(kNextGateColumns.size(), ',');
  std::string cells;
  for (const Eigen::Vector2d& corner : *gate)
    cells += "," + files::text_of(corner.x()) + "," + files::text_of(corner.y());
  return cells;
}

/// A folder that may be replaced: not where we are, and not somebody else's.
fs::path checked(fs::path out) {
  std::error_code error;
  const fs::path here = fs::current_path(error), place = fs::weakly_canonical(out, error);
  if (out.empty() ||
      std::mismatch(place.begin(), place.end(), here.begin(), here.end()).first == place.end())
    throw std::runtime_error("--out " + out.string() +
                             ": must be a folder of its own, which will be replaced");
  files::check_output_folder("--out", out);
  files::refuse_foreign_folder(out, "summary.json", kFlight, "choose another --out");
  if (const fs::path aside = files::behind_links(out).string() + ".partial";
      fs::exists(aside / "summary.json"))
    throw std::runtime_error(aside.string() + ": is there and holds a whole flight, move it away");
  return out;
}

/// A name for an earlier flight's film that nobody has.
fs::path free_name(const fs::path& folder) {
  for (int i = 1;; ++i)
    if (const fs::path path = folder / ("flight-before-" + std::to_string(i) + ".mp4");
        !fs::exists(path))
      return path;
}

}  // namespace

FlightRecorder::FlightRecorder(fs::path out, const Keep& keep)
    : out_{checked(std::move(out))},
      folder_{out_, files::PartialFolder::Grows::kBeside, is_of_a_flight},
      keep_{keep} {
  if (keep.packed_log)
    packed_log_.open(folder_.path() / "log_si.csv.gz");
  else
    log_.open(folder_.path() / "log_si.csv", std::ios::binary);
  images_.open(folder_.path() / "images.csv", std::ios::binary);
  detections_.open(folder_.path() / "detections.csv", std::ios::binary);
  buffer_.reserve(kPiece + 4096);
  buffer_ = kLogHeader;
  if (keep.navigation_imu)
    for (const char* column : kNavigationImuColumns) buffer_ += std::string{","} + column;
  if (keep.lifted) buffer_ += std::string{","} + kLiftedColumn;
  buffer_ += '\n';
  images_ << "image,t_s,log_row,t_ns,xxh64";
  for (const char* column : kNextGateColumns) images_ << ',' << column;
  if (keep.picture_late) images_ << ',' << kLateColumn;
  images_ << '\n';
  detections_ << files::detections_header();
  check(keep.packed_log ? packed_log_.good() : log_.good(), "log_si.csv");
  check(images_.good(), "images.csv");
  check(detections_.good(), "detections.csv");
  if (keep.frames)
    film_.emplace(folder_.path() / kFrameFilm,
                  files::FilmPipe::Pictures{
                      .pixels = "yuv422p",
                      .width = keep.stored_width,
                      .height = keep.stored_height,
                      .per_second = std::max(1, static_cast<int>(keep.frames_per_second + 0.5)),
                      .colors = jfif()},
                  lossless());
}

void FlightRecorder::check(bool good, const fs::path& path) const {
  if (!good) throw std::runtime_error((out_ / path).string() + ": cannot be written (disk full?)");
}

void FlightRecorder::append(double value) {
  std::array<char, 32> text{};
  if (!std::isfinite(value)) {  // a lost sample is an empty cell
    buffer_ += ',';
    return;
  }
  // The shortest that reads back as the same number.
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  buffer_.append(text.data(), end.ptr);
  buffer_ += ',';
}

void FlightRecorder::append(const Eigen::Vector3d& value) {
  for (const double x : value) append(x);
}

void FlightRecorder::append(const Attitude& attitude) {
  append(Eigen::Vector3d{attitude.roll, attitude.pitch, attitude.yaw});
}

void FlightRecorder::append(const std::optional<Imu>& imu) {
  if (!imu) {
    buffer_.append(kNavigationImuColumns.size(), ',');
    return;
  }
  append(imu->gyro_B);
  append(imu->accel_B);
}

void FlightRecorder::flush(bool all) {
  if (buffer_.size() < kPiece && !all) return;
  if (keep_.packed_log)
    packed_log_.write(buffer_);
  else
    log_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  buffer_.clear();
  check(keep_.packed_log ? packed_log_.good() : log_.good(), "log_si.csv");
}

void FlightRecorder::append(const std::optional<Truth>& truth) {
  constexpr std::size_t kCells = 9;
  if (!truth) {
    buffer_.append(kCells, ',');
    return;
  }
  append(truth->p_EB);
  append(truth->v_E);
  append(truth->attitude);
}

void FlightRecorder::record(const Tick& tick) {
  const Estimate estimate = tick.pilot.estimate();
  record(RecordedRow{.sensors = tick.sensors,
                     .command = tick.command,
                     .estimate = estimate,
                     .phase = tick.pilot.phase().index(),
                     .target_gate = tick.pilot.target_gate(),
                     .detections = tick.pilot.sighting().detections,
                     .truth = tick.truth,
                     .battery_v = tick.truth.battery_v,
                     .motors = tick.command.motors,
                     .frame = tick.frame,
                     .next_gate_px = tick.next_gate_px});
}

void FlightRecorder::record(const RecordedRow& row) {
  const Sensors& sensors = row.sensors;
  const auto append_if = [&](const std::optional<double>& value) {
    if (value)
      append(*value);
    else
      buffer_ += ',';
  };
  buffer_ += std::to_string(sensors.time.count()) + ",";
  append(column_seconds(sensors.time));
  append(sensors.imu.gyro_B);
  append(sensors.imu.accel_B);
  append_if(sensors.sonar);
  append_if(sensors.baro);
  append(row.truth);
  append(row.estimate.p_EB);
  append(row.estimate.v_E);
  append(row.estimate.attitude);
  const AttitudeCommand& command = row.command.attitude;
  append(Eigen::Vector3d{command.roll, command.pitch, command.yaw});
  append(command.thrust);
  for (std::size_t i = 0; i < row.command.motors.size(); ++i)
    append_if(row.motors ? std::optional{(*row.motors)[i]} : std::nullopt);
  buffer_ += std::to_string(row.phase) + "," + std::to_string(row.target_gate) + "," +
             std::to_string(row.estimate.gates_passed) + ",";
  append_if(row.battery_v);
  if (keep_.navigation_imu) append(sensors.navigation_imu);
  if (keep_.lifted) buffer_ += sensors.lifted ? "1," : "0,";
  buffer_.back() = '\n';
  flush(false);

  if (!row.frame.empty() || !row.file.empty()) record_frame(row);
  ++row_;
}

/// @return the picture's name.
std::string FlightRecorder::keep_frame(const RecordedRow& row) {
  const bool is_file = !row.file.empty();
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), is_file ? "img_%05zu%s" : "frame_%05zu%s", frame_++,
                is_file ? row.ending : ".uyvy");
  if (is_file || keep_.raw_frames) {
    const std::span<const std::uint8_t> bytes = is_file ? row.file : row.frame;
    folder_.write(name.data(), {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  } else if (film_) {
    film_->add(planes_of(row.frame));
  }
  return name.data();
}

void FlightRecorder::record_frame(const RecordedRow& row) {
  const std::chrono::nanoseconds time = row.sensors.time;
  const std::string name = keep_frame(row);
  // Decoders differ, so a hash of a decoded file would say nothing.
  const std::string hash = row.file.empty() ? files::text_of_xxh64(files::xxh64(row.frame)) : "";
  images_ << name << ',' << files::text_of(column_seconds(time)) << ',' << row_ << ','
          << time.count() << ',' << hash << corners_of(row.next_gate_px);
  if (keep_.picture_late) images_ << ',' << std::llround(1e9 * row.sensors.picture_late);
  images_ << '\n';
  check(images_.good(), "images.csv");

  int rank = 0;
  for (const GateDetection& gate : row.detections)
    detections_ << files::line_of(files::row_of(name, rank++, gate));
  check(detections_.good(), "detections.csv");
}

void FlightRecorder::add_file(const std::string& name, const std::string& content) {
  folder_.write(name, content);
}

std::string FlightRecorder::finish(const std::string& summary_json) {
  flush(true);
  if (keep_.packed_log)
    packed_log_.close();
  else
    log_.close();
  images_.close();
  detections_.close();
  check(keep_.packed_log ? packed_log_.good() : log_.good(), "log_si.csv");
  check(images_.good(), "images.csv");
  check(detections_.good(), "detections.csv");
  if (film_) film_->finish();
  add_file("summary.json", summary_json);

  const bool replaces = fs::exists(out_ / "summary.json");
  const bool film = fs::exists(folder_.path() / kFilm);
  try {
    files::refuse_foreign_folder(out_, "summary.json", kFlight, "it came while we flew");
    folder_.replace([film](const std::string& name) { return name == kFilm && !film; });
  } catch (const std::exception& error) {  // the flight itself is complete
    folder_.keep();
    throw std::runtime_error(std::string{error.what()} + "; this flight is in " +
                             folder_.path().string());
  }
  if (!replaces) return "";
  std::string said = "in place of the flight that was there";
  if (!film && fs::exists(out_ / kFilm)) {  // it shows another flight than the one beside it
    const fs::path before = free_name(out_);
    fs::rename(out_ / kFilm, before);
    said += ", whose film is now " + before.filename().string();
  }
  return said;
}

}  // namespace gatefly::flight_log
