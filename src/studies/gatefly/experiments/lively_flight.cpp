// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/lively_flight.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "gatefly/control/altitude.hpp"
#include "gatefly/files/csv.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/sensors.hpp"
#include "gatefly/sim/twin_body.hpp"
#include "gatefly/tasks/identification/drag_fit.hpp"

namespace gatefly::experiments {
namespace {

namespace fs = std::filesystem;

constexpr double kUp = 0.9, kDown = 0.6;  // heights that bound the flight [m]
constexpr double kRadpsPerRpm = 2.0 * kPi / 60.0;
constexpr int kSubsteps = 2;                                      // of the body in an IMU interval
constexpr double kPositionStep = 1.0 / 256.0, kSpeedStep = 0.01;  // as motion capture is logged

double stepped(double x, double step) { return std::round(x / step) * step; }

void find_airborne(LivelyFlight& flight) {
  const auto above = [&](std::size_t i, double h) { return flight.samples[i].p_E.z() < -h; };
  flight.first = 0, flight.last = flight.samples.size();
  while (flight.first < flight.last && !above(flight.first, kUp)) ++flight.first;
  while (flight.last > flight.first && !above(flight.last - 1, kDown)) --flight.last;
}

/// Log columns as three-vectors.
class Columns {
 public:
  explicit Columns(const files::Csv& csv) : csv_{csv} {}
  template <std::size_t N>
  [[nodiscard]] std::array<std::vector<double>, N> of(
      const std::array<const char*, N>& names) const {
    std::array<std::vector<double>, N> columns;
    for (std::size_t i = 0; i < N; ++i) columns[i] = csv_.numbers(names[i]);
    return columns;
  }

 private:
  const files::Csv& csv_;
};

LivelyFlight read_flight(const fs::path& folder) {
  const files::Csv csv{folder / "log_si.csv"};
  const Columns in{csv};
  const auto t = csv.numbers("t_s");
  const auto gyro = in.of<3>({"gyro_p_radps", "gyro_q_radps", "gyro_r_radps"});
  const auto accel = in.of<3>({"acc_x_mps2", "acc_y_mps2", "acc_z_mps2"});
  const auto ahrs = in.of<3>({"ahrs_phi_rad", "ahrs_theta_rad", "ahrs_psi_rad"});
  const auto wanted = in.of<3>({"phi_sp_rad", "theta_sp_rad", "psi_sp_rad"});
  const auto p = in.of<3>({"ot_x_m", "ot_y_m", "ot_z_m"});
  const auto v = in.of<3>({"ot_vx_mps", "ot_vy_mps", "ot_vz_mps"});
  const auto ref = in.of<4>({"rpm_ref_lf", "rpm_ref_rf", "rpm_ref_rb", "rpm_ref_lb"});
  const auto obs = in.of<4>({"rpm_obs_lf", "rpm_obs_rf", "rpm_obs_rb", "rpm_obs_lb"});
  const auto vector = [](const auto& columns, std::size_t i) {
    return Eigen::Vector3d{columns[0][i], columns[1][i], columns[2][i]};
  };
  const auto attitude = [](const auto& columns, std::size_t i) {
    return Attitude{columns[0][i], columns[1][i], columns[2][i]};
  };
  LivelyFlight flight{.name = folder.filename().string()};
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    LivelySample s{.t = t[i],
                   .dt = i > 0 ? t[i] - t[i - 1] : 0.0,
                   .imu = {vector(gyro, i), vector(accel, i)},
                   .attitude = attitude(ahrs, i),
                   .wanted = attitude(wanted, i),
                   .p_E = vector(p, i),
                   .v_E = vector(v, i)};
    for (std::size_t r = 0; r < 4; ++r)
      s.rotor_wanted[r] = kRadpsPerRpm * ref[r][i], s.rotor[r] = kRadpsPerRpm * obs[r][i];
    flight.samples.push_back(s);
  }
  find_airborne(flight);
  return flight;
}

/// Attitude control of the autopilot that flew these logs, found in them: what it asked of its rotors
/// is, with R² of 0.98-1.00 in roll and pitch, a line through the errors of angle and rate behind a
/// reference model of 450 °/s, ζ 0.9 [Paparazzi's, without integral]. No INDI yet.
class FlownAutopilot {
 public:
  void start(double yaw) { angle_.z() = yaw; }

  /// Rotor speeds about their mean [rad/s].
  std::array<double, 4> step(const Attitude& wanted, const Attitude& is,
                             const Eigen::Vector3d& rate, double mean, double dt) {
    constexpr double kOmega = 7.85, kZeta = 0.9;
    const Eigen::Vector3d target{wanted.roll, wanted.pitch,
                                 angle_.z() + wrap_angle(wanted.yaw - angle_.z())};
    speed_ += dt * (kOmega * kOmega * (target - angle_) - 2.0 * kZeta * kOmega * speed_);
    angle_ += dt * speed_;
    const Eigen::Vector3d error{angle_.x() - is.roll, angle_.y() - is.pitch,
                                wrap_angle(angle_.z() - is.yaw)};
    // Sums of the four rotors' speeds, each with its sign [(rad/s) / rad, (rad/s) / (rad/s)].
    const Eigen::Vector3d kAngle{1530, 1530, 3300}, kRate{354, 354, 400};
    const Eigen::Vector3d u = kAngle.cwiseProduct(error) + kRate.cwiseProduct(speed_ - rate);
    const double roll = 0.25 * u.x(), pitch = 0.25 * u.y(), yaw = 0.25 * u.z();
    return {mean + roll + pitch - yaw, mean - roll + pitch + yaw, mean - roll - pitch - yaw,
            mean + roll - pitch + yaw};
  }

 private:
  Eigen::Vector3d angle_ = Eigen::Vector3d::Zero(), speed_ = Eigen::Vector3d::Zero();
};

/// Holds what motion capture said until the next of its samples came, in its steps.
class MotionCapture {
 public:
  void look(const sim::BodyState& state) {
    p_E_ = state.p_EB.unaryExpr([](double x) { return stepped(x, kPositionStep); });
    v_E_ = state.v_E.unaryExpr([](double x) { return stepped(x, kSpeedStep); });
  }
  void tell(LivelySample& sample) const { sample.p_E = p_E_, sample.v_E = v_E_; }

 private:
  Eigen::Vector3d p_E_ = Eigen::Vector3d::Zero(), v_E_ = Eigen::Vector3d::Zero();
};

}  // namespace

Eigen::Vector3d LivelyFlight::v_B(std::size_t i) const {
  Attitude attitude = samples[i].attitude;
  attitude.yaw += heading_offset;
  return rotation_EB(attitude).matrix.transpose() * samples[i].v_E;
}

std::vector<LivelyFlight> lively_flights(const fs::path& folder, const Options& options) {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && entry.path().filename().string().starts_with("flight_"))
      folders.push_back(entry.path());
  if (folders.empty())
    throw std::runtime_error(folder.string() + ": there is no folder flight_* in it");
  std::sort(folders.begin(), folders.end());
  std::vector<LivelyFlight> flights;
  for (const fs::path& each : folders) {
    if (options.stopped()) throw Stopped{};
    const auto fit = identification::fit_drag(flight_log::read_flight_folder(each));
    if (!fit) continue;
    flights.push_back(read_flight(each));
    flights.back().heading_offset = fit->heading_offset;
  }
  return flights;
}

LivelyFlight flown_again(const LivelyFlight& real, world::SimConfig config) {
  config.start.heading = real.samples.front().attitude.yaw;
  config.start.position.setZero();
  config.world = {};
  config.world.room_size = {200, 200, 50};
  config.wind = {};
  sim::TwinBody body{config};
  sim::ImuModel imu{config.sensors, config.seed};
  FlownAutopilot autopilot;
  autopilot.start(config.start.heading);
  Altitude altitude;
  MotionCapture capture;

  LivelyFlight again{.name = real.name};
  std::array<double, 4> command{};
  bool started = false;
  for (std::size_t i = 0; i < real.samples.size(); ++i) {
    const LivelySample& asked = real.samples[i];
    for (int step = 0; step < kSubsteps && asked.dt > 0.0; ++step)
      body.step(command, asked.dt / kSubsteps);
    const sim::BodyState& state = body.state();
    const RotationEB R_EB{sim::R_EB_of(state.q_EB)};
    LivelySample s{.t = asked.t,
                   .dt = asked.dt,
                   .imu = imu.measure(state, asked.dt),
                   .attitude = attitude_of(R_EB),
                   .wanted = asked.wanted,
                   .rotor_wanted = command,
                   .rotor = state.rotor_speed};
    if (i == 0 || asked.p_E != real.samples[i - 1].p_E) capture.look(state);
    capture.tell(s);
    again.samples.push_back(s);

    // The motors are on from the moment it leaves the floor.
    started = started || asked.p_E.z() < -0.05;
    if (!started) continue;
    const double up = altitude.step(asked.p_E.z(), asked.v_E.z(), state.p_EB.z(), state.v_E.z(),
                                    asked.dt, AltitudeParams{});
    const double thrust = thrust_for(kGravity + up, R_EB.matrix(2, 2));
    const Eigen::Vector3d bias = config.sensors.gyro_bias + config.sensors.gyro_drift;
    const double mean = std::sqrt(config.vehicle.mass * std::max(0.0, thrust) / 4.0 /
                                  config.vehicle.thrust_coefficient);
    command = autopilot.step(asked.wanted, s.attitude, s.imu.gyro_B - bias, mean, asked.dt);
  }
  find_airborne(again);
  return again;
}

}  // namespace gatefly::experiments
