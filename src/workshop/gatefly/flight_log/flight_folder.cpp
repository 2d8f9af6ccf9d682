// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/flight_folder.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "gatefly/files/csv.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/files/xxh64.hpp"
#include "gatefly/flight_log/gzip.hpp"

namespace gatefly::flight_log {
namespace {

using std::chrono::nanoseconds;

constexpr std::size_t kMostRows = 2'000'000;  // an hour at 512 Hz
constexpr double kLatest = 9e6;               // [s]; nanoseconds stay exact in a double.

/// A column if the log has it; each cell may still be empty.
class Column {
 public:
  Column(const files::Csv& csv, const std::string& name) {
    if (csv.has(name)) values_ = csv.numbers(name);
  }
  [[nodiscard]] std::optional<double> at(std::size_t row) const {
    if (values_.empty() || std::isnan(values_[row])) return std::nullopt;
    return values_[row];
  }

 private:
  std::vector<double> values_;
};

struct Triple {
  Column a, b, c;
  Triple(const files::Csv& csv, const std::string& prefix, const std::array<const char*, 3>& names)
      : a{csv, prefix + names[0]}, b{csv, prefix + names[1]}, c{csv, prefix + names[2]} {}
  [[nodiscard]] std::optional<Eigen::Vector3d> at(std::size_t row) const {
    const auto x = a.at(row), y = b.at(row), z = c.at(row);
    if (!x || !y || !z) return std::nullopt;
    return Eigen::Vector3d{*x, *y, *z};
  }
  [[nodiscard]] std::optional<Attitude> attitude(std::size_t row) const {
    const auto angles = at(row);
    if (!angles) return std::nullopt;
    return Attitude{.roll = angles->x(), .pitch = angles->y(), .yaw = angles->z()};
  }
};

/// Exact from t_ns where there is one, else from t_s.
std::vector<nanoseconds> times_of(const files::Csv& csv) {
  const bool exact = csv.has("t_ns");
  const std::vector<double> column = csv.numbers(exact ? "t_ns" : "t_s");
  std::vector<nanoseconds> times;
  times.reserve(column.size());
  for (std::size_t row = 0; row < column.size(); ++row) {
    const double ns = exact ? column[row] : column[row] * 1e9;
    if (!(std::abs(ns) <= kLatest * 1e9))
      throw std::runtime_error(csv.place(row) + ": has no usable time");
    times.emplace_back(std::llround(ns));
    if (row > 0 && times[row] < times[row - 1])
      throw std::runtime_error(csv.place(row) + ": time runs backwards");
  }
  return times;
}

/// All four or none.
class Motors {
 public:
  explicit Motors(const files::Csv& csv)
      : columns_{Column{csv, "motor_lf_radps"}, Column{csv, "motor_rf_radps"},
                 Column{csv, "motor_rb_radps"}, Column{csv, "motor_lb_radps"}} {}
  [[nodiscard]] std::optional<std::array<double, 4>> at(std::size_t row) const {
    std::array<double, 4> speeds{};
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      const auto speed = columns_[i].at(row);
      if (!speed) return std::nullopt;
      speeds[i] = *speed;
    }
    return speeds;
  }

 private:
  std::array<Column, 4> columns_;
};

/// All six or none.
std::optional<Imu> imu_of(const std::optional<Eigen::Vector3d>& gyro_B,
                          const std::optional<Eigen::Vector3d>& accel_B) {
  if (!gyro_B || !accel_B) return std::nullopt;
  return Imu{*gyro_B, *accel_B};
}

/// Whether it was recorded in place, and nobody has ended it.
bool was_cut(const std::filesystem::path& directory) {
  std::error_code error;
  return std::filesystem::exists(directory / kRecordingMark, error) &&
         !std::filesystem::exists(directory / "summary.json", error);
}

/// Without the line within which it was cut.
std::string whole_lines(const std::filesystem::path& path) {
  std::string content = files::read_file(path);
  content.resize(content.rfind('\n') + 1);  // none: npos + 1 is 0
  return content;
}

std::string content_of(const std::filesystem::path& path) {
  if (path.extension() == ".gz") return read_gzip(path);
  return was_cut(path.parent_path()) ? whole_lines(path) : files::read_file(path);
}

std::vector<FlightSample> read_log(const std::filesystem::path& path) {
  const files::Csv csv(path, content_of(path));
  if (csv.rows() == 0) throw std::runtime_error(path.string() + ": has no rows");
  if (csv.rows() > kMostRows)
    throw std::runtime_error(path.string() + ": has " + std::to_string(csv.rows()) +
                             " rows, must be at most " + std::to_string(kMostRows));
  const std::vector<nanoseconds> times = times_of(csv);
  // A flight without its IMU is none: these must be there. An empty cell stays NaN, as a lost
  // sample.
  const auto p = csv.numbers("gyro_p_radps"), q = csv.numbers("gyro_q_radps"),
             r = csv.numbers("gyro_r_radps");
  const auto ax = csv.numbers("acc_x_mps2"), ay = csv.numbers("acc_y_mps2"),
             az = csv.numbers("acc_z_mps2");
  const Column sonar(csv, "sonar_m"), baro(csv, "baro_m"), thrust(csv, "thrust_cmd"),
      battery(csv, "battery_v"), lifted(csv, kLiftedColumn);
  const Triple true_p(csv, "ot_", {"x_m", "y_m", "z_m"}),
      true_v(csv, "ot_", {"vx_mps", "vy_mps", "vz_mps"});
  const Triple true_angles(csv, "true_", {"roll_rad", "pitch_rad", "yaw_rad"});
  const Triple ahrs(csv, "ahrs_", {"phi_rad", "theta_rad", "psi_rad"});
  const Triple est_p(csv, "est_", {"x_m", "y_m", "z_m"}),
      est_v(csv, "est_", {"vx_mps", "vy_mps", "vz_mps"});
  const Triple est_angles(csv, "est_", {"roll_rad", "pitch_rad", "yaw_rad"});
  const Motors motors(csv);
  const Triple nav_gyro(csv, "nav_gyro_", {"p_radps", "q_radps", "r_radps"}),
      nav_accel(csv, "nav_acc_", {"x_mps2", "y_mps2", "z_mps2"});

  std::vector<FlightSample> samples(csv.rows());
  for (std::size_t row = 0; row < samples.size(); ++row) {
    samples[row] = {
        .time = times[row],
        .imu = {.gyro_B = {p[row], q[row], r[row]}, .accel_B = {ax[row], ay[row], az[row]}},
        .sonar = sonar.at(row),
        .baro = baro.at(row),
        .true_p_EB = true_p.at(row),
        .true_v_E = true_v.at(row),
        .true_attitude = true_angles.attitude(row),
        .ahrs = ahrs.attitude(row),
        .thrust = thrust.at(row),
        .est_p_EB = est_p.at(row),
        .est_v_E = est_v.at(row),
        .est_attitude = est_angles.attitude(row),
        .motors = motors.at(row),
        .battery_v = battery.at(row),
        .navigation_imu = imu_of(nav_gyro.at(row), nav_accel.at(row)),
        .lifted = lifted.at(row) ? std::optional{*lifted.at(row) != 0.0} : std::nullopt};
  }
  return samples;
}

/// All corners of the next gate, or none.
class NextGate {
 public:
  explicit NextGate(const files::Csv& csv) {
    for (const char* name : kNextGateColumns) columns_.emplace_back(csv, name);
  }
  [[nodiscard]] std::optional<Quad> at(std::size_t row) const {
    Quad quad;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const auto value = columns_[i].at(row);
      if (!value) return std::nullopt;
      quad[i / 2][static_cast<Eigen::Index>(i % 2)] = *value;
    }
    return quad;
  }

 private:
  std::vector<Column> columns_;
};

/// A picture arrives in its row: exactly so in our own flights, which tell nanoseconds.
void expect_at_its_row(const files::Csv& csv, std::size_t i, nanoseconds time,
                       nanoseconds row_time) {
  const nanoseconds most = csv.has("t_ns") ? nanoseconds{0} : nanoseconds{100'000'000};
  const nanoseconds off = time > row_time ? time - row_time : row_time - time;
  if (off <= most) return;
  const auto text = [](nanoseconds t) {
    return files::text_of(1e-9 * static_cast<double>(t.count()), 9);
  };
  throw std::runtime_error(csv.place(i) + ": came at " + text(time) +
                           " s, the row of its log_row at " + text(row_time) +
                           " s: rows are missing in log_si.csv, or it has too many");
}

bool has_nothing(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  return error || size == 0;
}

nanoseconds late_of(const files::Csv& csv, std::size_t row, double late_ns) {
  constexpr double kMost = 1e9;  // a second: whoever writes more has mistaken the unit or the clock
  if (std::isnan(late_ns)) return nanoseconds{0};  // an empty cell: nobody knows
  if (!(late_ns >= 0.0 && late_ns <= kMost))
    throw std::runtime_error(csv.place(row, kLateColumn) + ": late_ns = " +
                             files::text_of(late_ns) + ", must be 0 to 1000000000 (a second)");
  return nanoseconds{std::llround(late_ns)};
}

std::vector<FlightImage> read_images(const std::filesystem::path& directory,
                                     const std::vector<FlightSample>& samples) {
  const std::size_t log_rows = samples.size();
  const files::Csv csv(directory / "images.csv", content_of(directory / "images.csv"));
  const bool cut = was_cut(directory);
  const auto names = csv.texts("image");
  const auto rows = csv.numbers("log_row");
  const std::vector<nanoseconds> times = times_of(csv);
  const auto hashes =
      csv.has("xxh64") ? csv.texts("xxh64") : std::vector<std::string>(names.size());
  const NextGate next_gate(csv);
  const auto late =
      csv.has(kLateColumn) ? csv.numbers(kLateColumn) : std::vector<double>(names.size());

  std::vector<FlightImage> images;
  std::set<std::string> known;
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    const std::filesystem::path name{names[i]};
    if (name.empty() || name.has_parent_path())
      throw std::runtime_error(csv.place(i) + ": image = '" + names[i] +
                               "', must be a file name in this folder");
    if (!known.insert(names[i]).second)
      throw std::runtime_error(csv.place(i) + ": image = '" + files::one_line(names[i]) +
                               "', a second time");
    const double row = rows[i];
    // The rows listed last may not have reached the disk.
    if (cut && (row >= static_cast<double>(log_rows) || has_nothing(directory / name))) break;
    if (!(row >= 0 && row < static_cast<double>(log_rows)) || row != std::floor(row))
      throw std::runtime_error(csv.place(i) + ": log_row must be a whole number in 0.." +
                               std::to_string(log_rows - 1) + ", the rows of log_si.csv");
    const auto hash = files::xxh64_of_text(hashes[i]);
    if (!hash && !hashes[i].empty())
      throw std::runtime_error(csv.place(i, "xxh64") + ": '" + files::one_line(hashes[i]) +
                               "', must be 16 hexadecimal digits");
    images.push_back({.path = directory / name,
                      .time = times[i],
                      .log_row = static_cast<std::size_t>(row),
                      .late = late_of(csv, i, late[i]),
                      .xxh64 = hash,
                      .next_gate_px = next_gate.at(i)});
    if (i > 0 && images[i].log_row < images[i - 1].log_row)
      throw std::runtime_error(csv.place(i) + ": log_row runs backwards");
    expect_at_its_row(csv, i, times[i], samples[images[i].log_row].time);
  }
  return images;
}

/// A reader of a pipe that nobody writes to waits for ever.
void refuse_pipes(const std::filesystem::path& directory) {
  std::error_code error, ignored;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error))
    if (std::filesystem::is_fifo(entry.status(ignored)))
      throw std::runtime_error(entry.path().string() + ": is a pipe, must be a file");
}

}  // namespace

std::optional<std::filesystem::path> log_in(const std::filesystem::path& directory) {
  std::error_code error;
  for (const char* name : {"log_si.csv", "log_si.csv.gz"})
    if (std::filesystem::exists(directory / name, error)) return directory / name;
  return std::nullopt;
}

FlightFolder read_flight_folder(const std::filesystem::path& directory) {
  std::error_code error;
  if (!std::filesystem::is_directory(directory, error))
    throw std::runtime_error(directory.string() + ": is no folder");
  refuse_pipes(directory);
  FlightFolder flight{.directory = directory,
                      .log = log_in(directory).value_or(directory / "log_si.csv"),
                      .samples = {},
                      .images = {}};
  flight.samples = read_log(flight.log);
  if (std::filesystem::exists(directory / "images.csv", error))
    flight.images = read_images(directory, flight.samples);
  return flight;
}

}  // namespace gatefly::flight_log
