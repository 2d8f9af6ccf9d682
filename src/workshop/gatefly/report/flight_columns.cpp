// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/flight_columns.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <tuple>

#include <Eigen/Cholesky>

#include "gatefly/files/text.hpp"
#include "gatefly/report/page_course.hpp"
#include "gatefly/report/page_numbers.hpp"

namespace gatefly::report {
namespace {

constexpr std::size_t kMostRows = 6000;  // two minutes at 50 Hz

struct Column {
  const char* name;
  double unit;  ///< Size of one step of the whole numbers.
};
constexpr std::int64_t kMissing = std::numeric_limits<std::int64_t>::min();
constexpr std::array<Column, std::tuple_size_v<FlightRow>> kColumns{{
    {"t_s", kTenth},
    {"x_m", kMilli},
    {"y_m", kMilli},
    {"z_m", kMilli},
    {"est_x_m", kMilli},
    {"est_y_m", kMilli},
    {"est_z_m", kMilli},
    {"vx_mps", kMilli},
    {"vy_mps", kMilli},
    {"vz_mps", kMilli},
    {"est_vx_mps", kMilli},
    {"est_vy_mps", kMilli},
    {"est_vz_mps", kMilli},
    {"roll_rad", kTenth},
    {"pitch_rad", kTenth},
    {"yaw_rad", kTenth},
    {"est_roll_rad", kTenth},
    {"est_pitch_rad", kTenth},
    {"est_yaw_rad", kTenth},
    {"bax_mps2", kTenth},
    {"bay_mps2", kTenth},
    {"baz_mps2", kTenth},
    {"bgx_radps", kHundredth},
    {"bgy_radps", kHundredth},
    {"bgz_radps", kHundredth},
    // In the frame of the target gate, where the filter lives: truth less estimate, and the
    // lower Cholesky factor of the covariance by rows.
    {"error_x_m", kMilli},
    {"error_y_m", kMilli},
    {"error_z_m", kMilli},
    {"l_xx_m", kTenth},
    {"l_yx_m", kTenth},
    {"l_yy_m", kTenth},
    {"l_zx_m", kTenth},
    {"l_zy_m", kTenth},
    {"l_zz_m", kTenth},
    // Truth less estimate along the body's axes, and how sure the filter is.
    {"error_vx_mps", kMilli},
    {"error_vy_mps", kMilli},
    {"error_vz_mps", kMilli},
    {"sigma_vx_mps", kMilli},
    {"sigma_vy_mps", kMilli},
    {"sigma_vz_mps", kMilli},
    {"sigma_bax_mps2", kTenth},
    {"sigma_bay_mps2", kTenth},
    {"sigma_baz_mps2", kTenth},
    {"sigma_tilt_rad", kTenth},
    {"sigma_yaw_rad", kTenth},
    {"wind_north_mps", kMilli},
    {"wind_east_mps", kMilli},
    {"cmd_roll_rad", kTenth},
    {"cmd_pitch_rad", kTenth},
    {"cmd_yaw_rad", kTenth},
    {"cmd_thrust_mps2", kMilli},
    {"phase", 1.0},
    {"target_gate", 1.0},
    {"gates_passed", 1.0},
    // Commands to the rotors since the row before, and the share of ticks in which one of them
    // was at its limit; the mean of what the accelerometer felt.
    {"rotor_fastest_radps", 0.1},
    {"rotor_slowest_radps", 0.1},
    {"rotor_saturated", kMilli},
    {"thrust_mps2", kMilli},
    {"battery_v", kMilli},
}};

const Eigen::Vector3d kNothing =
    Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

/// Fills a row from left to right.
class RowWriter {
 public:
  void put(double value) {
    const double steps = value / kColumns[next_].unit;
    row_[next_++] = std::isfinite(steps) ? std::llround(std::clamp(steps, -1e12, 1e12)) : kMissing;
  }
  void put(const Eigen::Vector3d& v) {
    for (const double value : v) put(value);
  }
  void put(const Attitude& a) { put(Eigen::Vector3d{a.roll, a.pitch, a.yaw}); }

  [[nodiscard]] const FlightRow& row() const { return row_; }

 private:
  FlightRow row_{};
  std::size_t next_ = 0;
};

void put_states(RowWriter& row, const PageTick& tick, const Estimate& e) {
  row.put(tick.p_EB.value_or(kNothing));
  row.put(e.p_EB);
  row.put(tick.v_E.value_or(kNothing));
  row.put(e.v_E);
  if (tick.attitude)
    row.put(*tick.attitude);
  else
    row.put(kNothing);
  row.put(e.attitude);
  row.put(e.accel_bias);
  row.put(e.gyro_bias);
}

void put_errors(RowWriter& row, const PageTick& tick, const world::World& world,
                const Estimate& e) {
  const auto truth =
      tick.p_EB ? in_gate(world, tick.pilot.target_gate(), *tick.p_EB) : std::nullopt;
  row.put(truth ? Eigen::Vector3d{*truth - e.p_GB} : kNothing);
  const Eigen::Matrix3d l = e.covariance_GB.llt().matrixL();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c) row.put(l(r, c));
  row.put(tick.v_E
              ? Eigen::Vector3d{rotation_EB(e.attitude).matrix.transpose() * (*tick.v_E - e.v_E)}
              : kNothing);
}

/// How sure the pilot's filter is of velocity, biases and attitude.
void put_sigmas(RowWriter& row, const PageTick& tick) {
  if (tick.estimate) {  // the pilot's filter does not know how sure another one is
    for (int i = 0; i < 8; ++i) row.put(kNothing.x());
    return;
  }
  const Navigator& navigator = tick.pilot.navigator();
  row.put(navigator.velocity_sigma());
  row.put(navigator.accel_bias_sigma());
  row.put(navigator.tilt_sigma());
  row.put(navigator.heading_sigma());
}

void put_command(RowWriter& row, const PageTick& tick, const Estimate& e) {
  const Eigen::Vector2d nothing = kNothing.head<2>();
  for (const double wind : tick.wind_E.value_or(nothing)) row.put(wind);
  const AttitudeCommand& command = tick.command.attitude;
  row.put(Eigen::Vector3d{command.roll, command.pitch, command.yaw});
  row.put(command.thrust);
  row.put(static_cast<double>(tick.pilot.phase().index()));
  row.put(tick.pilot.target_gate());
  row.put(e.gates_passed);
}

void put_rotors(RowWriter& row, const PageTick& tick, const RotorUse& rotors) {
  const double nothing = kNothing.x();
  row.put(rotors.ticks > 0 ? rotors.fastest : nothing);
  row.put(rotors.ticks > 0 ? rotors.slowest : nothing);
  row.put(rotors.ticks > 0 ? static_cast<double>(rotors.saturated) / rotors.ticks : nothing);
  row.put(rotors.thrusts > 0 ? rotors.thrust / rotors.thrusts : nothing);
  row.put(tick.battery_v.value_or(nothing));
}

/// In the order of kColumns.
FlightRow row_of(const PageTick& tick, const world::World& world, const RotorUse& rotors,
                 double now) {
  const Estimate own = tick.pilot.estimate();
  const Estimate& e = tick.estimate ? *tick.estimate : own;
  RowWriter row;
  row.put(now);
  put_states(row, tick, e);
  put_errors(row, tick, world, e);
  put_sigmas(row, tick);
  put_command(row, tick, e);
  put_rotors(row, tick, rotors);
  return row.row();
}

}  // namespace

FlightColumns::FlightColumns() { rows_.reserve(kMostRows); }

void RotorUse::add(const PageTick& tick, const PageCourse& course) {
  const auto [slow, fast] =
      std::minmax_element(tick.command.motors.begin(), tick.command.motors.end());
  const auto [lowest, highest] = course.rotor_limits;
  constexpr double kAlmost = 0.5;  // a limit is reached by a root's rounding [rad/s]
  slowest = ticks > 0 ? std::min(slowest, *slow) : *slow;
  fastest = ticks > 0 ? std::max(fastest, *fast) : *fast;
  saturated += *fast > highest - kAlmost || std::abs(*slow - lowest) < kAlmost ? 1 : 0;
  ++ticks;
  const double up = -tick.sensors.imu.accel_B.z();
  if (!std::isfinite(up)) return;
  thrust += up;
  ++thrusts;
}

void FlightColumns::add(const PageTick& tick, const PageCourse& course, double now) {
  rotors_.add(tick, course);
  if (now < next_row_) return;
  next_row_ = std::max(next_row_ + row_period_, now);
  rows_.push_back(row_of(tick, course.world, rotors_, now));
  rotors_ = {};
  if (rows_.size() < kMostRows) return;
  for (std::size_t i = 0; 2 * i < rows_.size(); ++i) rows_[i] = rows_[2 * i];
  rows_.resize((rows_.size() + 1) / 2);
  row_period_ *= 2.0;
}

void FlightColumns::end(const PageTick& tick, const PageCourse& course, double now) {
  if (rotors_.ticks > 0) last_ = row_of(tick, course.world, rotors_, now);
}

std::string FlightColumns::json(std::size_t row_step) const {
  std::vector<FlightRow> rows;
  for (std::size_t i = 0; i < rows_.size(); i += row_step) rows.push_back(rows_[i]);
  if (last_) rows.push_back(*last_);
  std::string text = "{";
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    if (!rows.empty() && std::all_of(rows.begin(), rows.end(),
                                     [&](const FlightRow& row) { return row[c] == kMissing; }))
      continue;
    if (text.size() > 1) text += ',';
    text += '"' + std::string{kColumns[c].name} +
            "\":{\"unit\":" + files::text_of(kColumns[c].unit) + ",\"steps\":[";
    std::int64_t before = 0;
    std::array<char, 24> digits{};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (i > 0) text += ',';
      if (rows[i][c] == kMissing) {
        text += "null";
        continue;
      }
      const auto end =
          std::to_chars(digits.data(), digits.data() + digits.size(), rows[i][c] - before);
      text.append(digits.data(), end.ptr);
      before = rows[i][c];
    }
    text += "]}";
  }
  return text + "}";
}

}  // namespace gatefly::report
