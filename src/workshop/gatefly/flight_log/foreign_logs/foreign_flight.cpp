// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/foreign_logs/foreign_flight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "gatefly/files/pictures.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/foreign_logs/log_tables.hpp"
#include "gatefly/flight_log/foreign_logs/stamps.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/seconds.hpp"

namespace gatefly::foreign_logs {
namespace {

using std::chrono::nanoseconds;

constexpr std::size_t kMostRows = 2'000'000;  // what a flight's folder may have
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

std::string moment(nanoseconds time) { return files::text_of(seconds(time), 9) + " s"; }

/// Numbers of any table, put into the rows of ours.
class Rows {
 public:
  Rows(LogTables& tables, const Mapping& mapping)
      : tables_{tables}, main_{mapping.table}, times_{tables.times(mapping.table)} {
    if (times_.empty()) throw std::runtime_error(tables.name_of(main_) + ": has no rows");
    if (times_.size() > kMostRows)
      throw std::runtime_error(tables.name_of(main_) + ": has " + std::to_string(times_.size()) +
                               " rows, must be at most " + std::to_string(kMostRows));
  }
  [[nodiscard]] const std::vector<nanoseconds>& times() const { return times_; }

  /// The first row at that time or later; none when all are before.
  [[nodiscard]] std::optional<std::size_t> row_at(nanoseconds time) const {
    const auto found = std::lower_bound(times_.begin(), times_.end(), time);
    if (found == times_.end()) return std::nullopt;
    return static_cast<std::size_t>(found - times_.begin());
  }
  /// `values` of a table, each in the row in which it arrives; of two in one row the later.
  /// @param held  goes on until the next one: of an IMU, of which each row has a sample.
  [[nodiscard]] std::vector<double> spread(const std::string& table,
                                           const std::vector<double>& values, bool held) {
    if (table.empty() || table == main_) return values;
    const std::vector<nanoseconds>& stamps = times_of(table);
    std::vector<double> spread(times_.size(), kNothing);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (const auto row = row_at(stamps[i])) spread[*row] = values[i];
    for (std::size_t row = 1; held && row < spread.size(); ++row)
      if (std::isnan(spread[row])) spread[row] = spread[row - 1];
    return spread;
  }

 private:
  const std::vector<nanoseconds>& times_of(const std::string& table) {
    const auto [found, is_new] = others_.try_emplace(table);
    if (is_new) found->second = tables_.times(table);
    return found->second;
  }

  LogTables& tables_;
  std::string main_;
  std::vector<nanoseconds> times_;
  std::map<std::string, std::vector<nanoseconds>> others_;
};

/// Reads what a mapping names out of a log.
class Reader {
 public:
  Reader(const Mapping& mapping, const std::filesystem::path& log)
      : mapping_{mapping}, tables_{mapping, log}, rows_{tables_, mapping} {}

  ForeignFlight read() {
    if (const std::string note = tables_.note(); !note.empty()) flight_.notes.push_back(note);
    for (const std::string& column : known_columns())
      if (const auto found = mapping_.columns.find(column); found != mapping_.columns.end())
        add(column, found->second);
    for (const auto& [whose, sources] : mapping_.quaternions) add_attitude(whose, sources);
    if (mapping_.lifted) add_lifted(*mapping_.lifted);
    for (const nanoseconds time : rows_.times())
      flight_.times.push_back(time - rows_.times().front());
    return std::move(flight_);
  }
  [[nodiscard]] const Rows& rows() const { return rows_; }

 private:
  [[nodiscard]] std::string table_of(const std::string& table) const {
    return table.empty() ? mapping_.table : table;
  }

  [[noreturn]] void refuse_missing(const std::string& what, const Source& source) {
    const std::string table = table_of(source.table);
    throw std::runtime_error(tables_.name_of(table) + ": has no column '" + source.column + "' (" +
                             what + ", " + source.place + "; " + tables_.columns_of(table) + ")");
  }

  void add(const std::string& column, const std::vector<Source>& choices) {
    const bool is_imu = column.starts_with("gyro_") || column.starts_with("acc_");
    for (const Source& source : choices) {
      const std::string table = table_of(source.table);
      if (!tables_.has(table, source.column)) continue;
      std::vector<double> values = tables_.numbers(table, source.column);
      const auto first = std::find_if(values.begin(), values.end(),
                                      [](double value) { return !std::isnan(value); });
      const double zero = source.from_start && first != values.end() ? *first : source.zero;
      double last = kNothing;
      for (double& value : values) {
        const bool same = source.on_change && value == last;
        last = value;
        value = same ? kNothing : (value - zero) * source.factor;
      }
      flight_.columns[column] = rows_.spread(table, values, is_imu);
      flight_.sources[column] = tables_.name_of(table) + ": " + source.column;
      return;
    }
    if (!is_imu) return;  // a log without it
    refuse_missing(column, choices.front());
  }

  void add_attitude(const std::string& whose, const std::vector<QuaternionSource>& choices) {
    static const std::map<std::string, std::array<const char*, 3>> kColumns{
        {"ahrs", {"ahrs_phi_rad", "ahrs_theta_rad", "ahrs_psi_rad"}},
        {"true", {"true_roll_rad", "true_pitch_rad", "true_yaw_rad"}}};
    const auto& names = kColumns.at(whose);
    for (const QuaternionSource& source : choices) {
      const std::string table = table_of(source.table);
      const auto is_there = [&](const std::string& column) { return tables_.has(table, column); };
      if (!std::all_of(source.columns.begin(), source.columns.end(), is_there)) continue;
      std::array<std::vector<double>, 4> q;
      for (std::size_t i = 0; i < 4; ++i) q[i] = tables_.numbers(table, source.columns[i]);
      std::array<std::vector<double>, 3> angles;
      for (auto& angle : angles) angle.assign(q[0].size(), kNothing);
      for (std::size_t i = 0; i < q[0].size(); ++i) {
        const double length =
            std::hypot(std::hypot(q[0][i], q[1][i]), std::hypot(q[2][i], q[3][i]));
        if (!(length > 0.5 && length < 2.0)) continue;  // none, or zeros before the first
        const Attitude attitude = attitude_in(
            {q[0][i] / length, q[1][i] / length, q[2][i] / length, q[3][i] / length}, source.axes);
        angles[0][i] = attitude.roll, angles[1][i] = attitude.pitch, angles[2][i] = attitude.yaw;
      }
      for (std::size_t i = 0; i < 3; ++i) {
        flight_.columns[names[i]] = rows_.spread(table, angles[i], false);
        flight_.sources[names[i]] = tables_.name_of(table) + ": " + source.columns[0] + " ...";
      }
      return;
    }
  }

  static Attitude attitude_in(const Quaternion& q, Axes axes) {
    if (axes == Axes::kFrdNed) return attitude_of(rotation_EB(q));
    // From front, left, up to front, right, down: half a turn about x, on both sides.
    Attitude attitude = attitude_of(rotation_EB(Quaternion{q.w, q.x, -q.y, -q.z}));
    // East, north, up: its x is our east. Yaw from east, turning left, becomes one from north.
    if (axes == Axes::kFluEnu) attitude.yaw = wrap_angle(attitude.yaw + 0.5 * kPi);
    return attitude;
  }

  void add_lifted(const Source& source) {
    const std::string table = table_of(source.table);
    if (!tables_.has(table, source.column)) refuse_missing("lifted", source);
    const std::vector<double> values =
        rows_.spread(table, tables_.numbers(table, source.column), false);
    bool lifted = false;
    for (const double value : values) {
      lifted = lifted || value * source.factor > mapping_.lifted_above;
      flight_.lifted.push_back(lifted);
    }
    if (!lifted)
      flight_.notes.push_back(tables_.name_of(table) + ": " + source.column + " is never " +
                              (source.factor > 0.0 ? "above " : "below ") +
                              files::text_of(source.factor * mapping_.lifted_above) +
                              ": it never takes off (" + source.place + ")");
  }

  const Mapping& mapping_;
  LogTables tables_;
  Rows rows_;
  ForeignFlight flight_;
};

struct Stamped {
  nanoseconds time;
  std::filesystem::path path;
};

/// Pictures of a folder by the stamps in their names, in order of time.
std::vector<Stamped> stamped_pictures(const std::filesystem::path& folder,
                                      const std::string& unit) {
  std::vector<Stamped> pictures;
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error))
    throw std::runtime_error(folder.string() + ": is no folder of pictures");
  for (const std::filesystem::path& path : files::picture_files(folder)) {
    const std::string name = path.filename().string();
    const auto stamp = stamp_in(stamp_of_name(name), unit);
    if (!stamp)
      throw std::runtime_error(path.string() +
                               ": has no stamp in its name, e.g. 1403636579763.png");
    pictures.push_back({*stamp, path});
  }
  std::sort(pictures.begin(), pictures.end(),
            [](const Stamped& a, const Stamped& b) { return a.time < b.time; });
  return pictures;
}

void add_pictures(ForeignFlight& flight, const Rows& rows, const std::filesystem::path& folder,
                  const PictureSource& source) {
  const std::vector<Stamped> pictures = stamped_pictures(folder, source.unit);
  const nanoseconds late = source.offset + source.delay;
  for (const Stamped& picture : pictures) {
    const nanoseconds arrival = picture.time + late;
    const auto row = rows.row_at(arrival);
    if (!row || arrival < rows.times().front())
      ++flight.pictures_outside;
    else
      flight.pictures.push_back({picture.path, *row});
  }
  if (!flight.pictures.empty()) return;
  throw std::runtime_error(
      folder.string() + ": no picture is within the log's time, " + moment(rows.times().front()) +
      " to " + moment(rows.times().back()) + "; theirs is " + moment(pictures.front().time + late) +
      " to " + moment(pictures.back().time + late) +
      ": stamps of another unit (pictures.stamp), or of another clock (--clock-offset-s)");
}

}  // namespace

double ForeignFlight::seconds() const { return gatefly::seconds(times.back()); }

double ForeignFlight::hz() const {
  std::vector<nanoseconds> steps;
  for (std::size_t i = 1; i < times.size(); ++i)
    if (times[i] > times[i - 1]) steps.push_back(times[i] - times[i - 1]);
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return 1.0 / gatefly::seconds(*middle);
}

ForeignFlight read_foreign_log(const Mapping& mapping, const std::filesystem::path& log,
                               const Given& given) {
  Reader reader{mapping, log};
  ForeignFlight flight = reader.read();
  PictureSource source = mapping.pictures;
  if (given.clock_offset_s) source.offset = nanoseconds{std::llround(1e9 * *given.clock_offset_s)};
  if (given.delay_ms) source.delay = nanoseconds{std::llround(1e6 * *given.delay_ms)};
  const bool own = given.pictures.empty();
  if (!own || !source.folder.empty())
    add_pictures(flight, reader.rows(), own ? log / source.folder : given.pictures, source);
  return flight;
}

}  // namespace gatefly::foreign_logs
