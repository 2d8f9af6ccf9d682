// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/held_attitude.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>

#include "gatefly/estimation/navigator.hpp"
#include "gatefly/files/csv.hpp"
#include "gatefly/flight_log/baseline/mahony.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kBeforeMovement = 1.0;  // the rest ends so long before it [s]

struct Held {
  double t = 0.0;
  Imu imu;
  Eigen::Vector3d up_B = Eigen::Vector3d::Zero();
  bool moves = false;
};

// The sensor's axes are like ENU where ours are like NED: y and z change sign.
std::vector<Held> read_held(const std::filesystem::path& file) {
  const files::Csv csv(file);
  const auto column = [&](const char* name) { return csv.numbers(name); };
  const auto t = column("t_s"), moves = column("movement");
  const std::array gyro{column("gyr_x_radps"), column("gyr_y_radps"), column("gyr_z_radps")};
  const std::array accel{column("acc_x_mps2"), column("acc_y_mps2"), column("acc_z_mps2")};
  const std::array q{column("opt_qw"), column("opt_qx"), column("opt_qy"), column("opt_qz")};
  std::vector<Held> rows;
  for (std::size_t i = 0; i < csv.rows(); ++i) {
    if (i > 0 && !(t[i] > t[i - 1]))
      throw std::runtime_error(csv.place(i, "t_s") + ": time must grow");
    Held row;
    row.t = t[i], row.moves = moves[i] == 1.0;
    row.imu = {{gyro[0][i], -gyro[1][i], -gyro[2][i]}, {accel[0][i], -accel[1][i], -accel[2][i]}};
    if (!row.imu.gyro_B.allFinite() || !row.imu.accel_B.allFinite())
      throw std::runtime_error(csv.place(i) + ": a number is missing");
    const Eigen::Vector3d up =
        Eigen::Quaterniond{q[0][i], q[1][i], q[2][i], q[3][i]}.normalized().inverse() *
        Eigen::Vector3d::UnitZ();
    row.up_B = {up.x(), -up.y(), -up.z()};
    rows.push_back(row);
  }
  if (std::none_of(rows.begin(), rows.end(), [](const Held& row) { return row.moves; }))
    throw std::runtime_error(file.string() + ": no row has movement 1");
  return rows;
}

double inclination_error(const RotationEB& R, const Eigen::Vector3d& up_B) {
  const Eigen::Vector3d up = -R.matrix.row(2).transpose();
  return std::atan2(up.cross(up_B).norm(), up.dot(up_B));
}

}  // namespace

HeldErrors held_attitude(const std::filesystem::path& file) {
  const std::vector<Held> rows = read_held(file);
  const double moved =
      std::find_if(rows.begin(), rows.end(), [](const Held& row) { return row.moves; })->t;
  HeldErrors result{{}, {}, AttitudeTrace(file.stem().string())};
  Navigator ours{{}};
  baseline::Mahony mahony;
  ours.start(Eigen::Vector3d::Zero(), 0.0);
  double before = rows.front().t;
  for (const Held& row : rows) {
    const double dt = row.t - before;
    before = row.t;
    if (row.t < moved - kBeforeMovement)
      ours.rest(row.imu, row.t);
    else
      ours.predict_attitude(row.imu, row.t);
    mahony.update(row.imu, dt);
    if (!row.moves || !row.up_B.allFinite()) continue;
    const double e = inclination_error(ours.ahrs().R_EB(), row.up_B),
                 m = inclination_error(mahony.R_EB(), row.up_B);
    result.ours.add(e, ours.ahrs().tilt_sigma()), result.mahony.add(m, 0.0);
    result.trace.add(row.t, e, m);
  }
  return result;
}

}  // namespace gatefly::experiments
