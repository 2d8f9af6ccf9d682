// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/foreign_logs/plausibility.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"
#include "gatefly/geometry/seconds.hpp"

namespace gatefly::foreign_logs {
namespace {

using files::fixed;

// All ours.
constexpr double kRestSeconds = 1.0,
                 kRestWithin = 10.0;  // so long it must rest, looked for so long
constexpr double kPiece = 0.05;  // vibration of idling motors is gone in the mean of so long [s]
constexpr double kRestSpread = 0.03;  // of those means, as part of gravity
constexpr double kGravityOff = 0.6;   // [m/s²]: bias and scale of cheap sensors, a tilt of 20°
constexpr double kUpright = 0.8;      // cosine of the tilt at rest: a start box at 35°
constexpr double kRestRate = 0.5;     // of a gyro with its worst bias [rad/s]
constexpr double kFastest = 40.0;     // 2000 °/s are 35 rad/s
constexpr double kTurned = 0.15;      // rates that are enough to compare [rad/s], rms
constexpr double kFollowed = 8.0, kWindow = 2.0;  // gravity is followed for so long by the gyro [s]
constexpr double kGravityGone = 5.0;  // m/s²: no drone of ours speeds up by 10 m/s in a window
constexpr double kEnough = 0.5;       // rad: a turn that shows it
constexpr double kSlopeLow = 0.7, kSlopeHigh = 1.4;

constexpr std::array kGyro{"gyro_p_radps", "gyro_q_radps", "gyro_r_radps"};
constexpr std::array kAccel{"acc_x_mps2", "acc_y_mps2", "acc_z_mps2"};

struct Mean {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  double at = 0.0;  ///< Middle of the piece [s].
};

/// Means over pieces of a vector's columns.
std::vector<Mean> means_of(const ForeignFlight& flight, const std::array<const char*, 3>& names,
                           double piece, double until) {
  std::array<const std::vector<double>*, 3> columns{};
  for (std::size_t i = 0; i < 3; ++i) columns[i] = &flight.columns.at(names[i]);
  std::vector<Mean> means;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0, begin = 0.0;
  for (std::size_t row = 0; row < flight.times.size(); ++row) {
    const double t = seconds(flight.times[row]);
    if (t > until) break;
    const Eigen::Vector3d value{(*columns[0])[row], (*columns[1])[row], (*columns[2])[row]};
    if (value.allFinite()) sum += value, count += 1.0;
    if (t - begin < piece) continue;
    if (count > 0.0) means.push_back({sum / count, 0.5 * (begin + t)});
    sum.setZero(), count = 0.0, begin = t;
  }
  return means;
}

struct Rest {
  double begin = 0.0;
  Eigen::Vector3d accel_B, gyro_B;
};

/// The first second in which the accelerometer, whatever its unit, reads the same all along.
std::optional<Rest> rest_of(const ForeignFlight& flight) {
  const std::vector<Mean> accel = means_of(flight, kAccel, kPiece, kRestWithin),
                          gyro = means_of(flight, kGyro, kPiece, kRestWithin);
  const auto count = static_cast<std::size_t>(std::lround(kRestSeconds / kPiece));
  for (std::size_t first = 0; first + count <= std::min(accel.size(), gyro.size()); ++first) {
    Rest rest{.begin = accel[first].at,
              .accel_B = Eigen::Vector3d::Zero(),
              .gyro_B = Eigen::Vector3d::Zero()};
    for (std::size_t i = first; i < first + count; ++i) {
      rest.accel_B += accel[i].value / static_cast<double>(count);
      rest.gyro_B += gyro[i].value / static_cast<double>(count);
    }
    double spread = 0.0;
    for (std::size_t i = first; i < first + count; ++i)
      spread += (accel[i].value - rest.accel_B).squaredNorm() / static_cast<double>(count);
    if (rest.accel_B.norm() > 0.0 && std::sqrt(spread) < kRestSpread * rest.accel_B.norm())
      return rest;
  }
  return std::nullopt;
}

std::string text_of(const Eigen::Vector3d& v) {
  return "(" + fixed(v.x(), 2) + ", " + fixed(v.y(), 2) + ", " + fixed(v.z(), 2) + ")";
}

/// The mistake that would make gravity so large; "" when none is known.
std::string unit_hint(double length) {
  const double ratio = kGravity / length;
  const auto near = [&](double factor) { return std::abs(ratio / factor - 1.0) < 0.07; };
  if (near(kGravity)) return "; are they in g?";
  if (near(1.0 / kGravity)) return "; are they in m/s^2?";
  for (double counts = 256.0; counts < 40'000.0; counts *= 2.0) {
    if (near(1.0 / counts) || near(kGravity / counts) || near(1.0 / counts / kGravity))
      return "; are " + files::text_of(counts) +
             " counts 1 g (scale = " + files::text_of(1.0 / counts) + ")?";
  }
  return ratio > 1.5 || ratio < 0.67 ? "; its scale is " + files::text_of(ratio, 3) + " times that"
                                     : "";
}

/// Which way gravity's reaction points, where it should point along -z.
std::string axis_hint(const Eigen::Vector3d& accel_B) {
  Eigen::Index largest = 0;
  accel_B.cwiseAbs().maxCoeff(&largest);
  const std::string axis{"xyz"[largest]};
  if (largest == 2) return "up is along +z: sign = -1 for z, and what belongs to it";
  return "up is along " + std::string{accel_B[largest] > 0.0 ? "+" : "-"} + axis +
         ": axes are swapped, or the drone lay on its side";
}

/// From rest on the gyro tells where down is, and what the accelerometer reads must go on to hold the drone up: on the mean of two
/// seconds, but for what its speed has changed by. A gyro of another scale loses gravity at the first turn.
void check_gravity_stays(const ForeignFlight& flight, const Rest& rest, Plausibility& found) {
  const Eigen::Vector3d& f = rest.accel_B;
  Quaternion q = quaternion_of(
      {.roll = atan2(-f.y(), -f.z()), .pitch = atan2(f.x(), std::hypot(f.y(), f.z())), .yaw = 0.0});
  const double from = rest.begin + 0.5 * kRestSeconds;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double time = 0.0, turned = 0.0, worst = 0.0, last = from;
  for (std::size_t row = 0; row < flight.times.size(); ++row) {
    const double t = seconds(flight.times[row]), dt = t - last;
    if (t <= from) continue;
    if (t > from + kFollowed) break;
    Eigen::Vector3d gyro_B, accel_B;
    for (Eigen::Index i = 0; i < 3; ++i) {
      gyro_B[i] = flight.columns.at(kGyro[static_cast<std::size_t>(i)])[row];
      accel_B[i] = flight.columns.at(kAccel[static_cast<std::size_t>(i)])[row];
    }
    last = t;
    if (!gyro_B.allFinite() || !accel_B.allFinite()) continue;
    q = integrated(q, gyro_B - rest.gyro_B, dt);
    turned += dt * (gyro_B - rest.gyro_B).norm();
    sum += dt * (rotation_EB(q).matrix * accel_B + kGravity * Eigen::Vector3d::UnitZ());
    time += dt;
    if (time < kWindow) continue;
    worst = std::max(worst, (sum / time).norm());
    sum.setZero(), time = 0.0;
  }
  if (turned < kEnough) return;
  const std::string off = fixed(worst, 1) + " m/s^2";
  if (worst > kGravityGone)
    found.wrong.push_back(
        "in the " + fixed(kFollowed, 0) +
        " s after its rest gyro_* lose gravity: what acc_* read there is off by " + off +
        " on the mean of " + fixed(kWindow, 0) + " s; wrong unit, scale, sign or axis of the gyro");
  else
    found.checked.push_back("gravity stays down as the gyro turns, within " + off);
}

void check_rest(const ForeignFlight& flight, Plausibility& found) {
  const auto rest = rest_of(flight);
  if (!rest) {
    found.unknown.emplace_back("accelerometer's unit and axes: no second of rest in the first " +
                               fixed(kRestWithin, 0) + " s");
    return;
  }
  const double length = rest->accel_B.norm();
  const std::string when = "at rest, " + fixed(rest->begin, 1) + " s";
  if (std::abs(length - kGravity) > kGravityOff)
    found.wrong.push_back(when + ": acc_* read " + text_of(rest->accel_B) + " m/s^2, must be " +
                          fixed(kGravity, 2) + " +- " + fixed(kGravityOff, 1) + " in all" +
                          unit_hint(length));
  if (-rest->accel_B.z() < kUpright * length)
    found.wrong.push_back(when + ": acc_* read " + text_of(rest->accel_B) +
                          ", must be (0, 0, -9.81): " + axis_hint(rest->accel_B));
  if (rest->gyro_B.norm() > kRestRate)
    found.wrong.push_back(when + ": gyro_* read " + text_of(rest->gyro_B) +
                          " rad/s, must be below " + fixed(kRestRate, 1) +
                          "; are they in deg/s, or counts?");
  if (!found.wrong.empty()) return;
  check_gravity_stays(flight, *rest, found);
  if (found.wrong.empty())
    found.checked.push_back(when + " the accelerometer reads " + fixed(length, 2) +
                            " m/s^2 upwards, the gyro " + fixed(rest->gyro_B.norm(), 3) + " rad/s");
}

/// A gyro that turns faster than any can is in another unit.
bool check_fastest(const ForeignFlight& flight, Plausibility& found) {
  for (const char* name : kGyro) {
    double most = 0.0;
    for (const double value : flight.columns.at(name))
      if (std::isfinite(value)) most = std::max(most, std::abs(value));
    if (most <= kFastest) continue;
    found.wrong.push_back(std::string{name} + " reaches " + fixed(most, 0) +
                          " rad/s, gyros read up to 35; is it in deg/s, or counts?");
    return false;
  }
  return true;
}

/// Attitudes of the log, where it has them.
std::vector<std::pair<double, Attitude>> attitudes_of(const ForeignFlight& flight) {
  std::vector<std::pair<double, Attitude>> attitudes;
  for (const auto& names : {std::array{"true_roll_rad", "true_pitch_rad", "true_yaw_rad"},
                            std::array{"ahrs_phi_rad", "ahrs_theta_rad", "ahrs_psi_rad"}}) {
    const auto has = [&](const char* name) { return flight.columns.contains(name); };
    if (!attitudes.empty() || !std::all_of(names.begin(), names.end(), has)) continue;
    for (std::size_t row = 0; row < flight.times.size(); ++row) {
      const Attitude attitude{flight.columns.at(names[0])[row], flight.columns.at(names[1])[row],
                              flight.columns.at(names[2])[row]};
      if (std::isfinite(attitude.roll + attitude.pitch + attitude.yaw))
        attitudes.emplace_back(seconds(flight.times[row]), attitude);
    }
  }
  return attitudes;
}

/// Rates by which the log's attitude turns, against the gyro's over the same time.
void check_against_attitude(const ForeignFlight& flight, Plausibility& found) {
  constexpr double kStep = 0.2;  // a whole degree is much in less [s]
  const auto attitudes = attitudes_of(flight);
  if (attitudes.size() < 3) {
    found.unknown.emplace_back(
        "gyro's scale and signs axis by axis: the log has no attitude to compare with");
    return;
  }
  Eigen::Vector3d gyro_turned = Eigen::Vector3d::Zero(), turned_turned = gyro_turned;
  double count = 0.0;
  std::size_t row = 0, first = 0;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  // by the gyro, since attitudes[first]
  for (std::size_t i = 1; i < attitudes.size(); ++i) {
    for (; row < flight.times.size() && seconds(flight.times[row]) < attitudes[i].first; ++row) {
      const Eigen::Vector3d rate{flight.columns.at(kGyro[0])[row], flight.columns.at(kGyro[1])[row],
                                 flight.columns.at(kGyro[2])[row]};
      const double dt = row > 0 ? seconds(flight.times[row] - flight.times[row - 1]) : 0.0;
      if (rate.allFinite()) turn += dt * rate;
    }
    const double dt = attitudes[i].first - attitudes[first].first;
    if (dt < kStep) continue;
    const Eigen::Vector3d turned = turn_of(rotation_EB(attitudes[first].second).matrix.transpose() *
                                           rotation_EB(attitudes[i].second).matrix);
    if (dt < 2.0 * kStep && turned.norm() < 1.0) {
      gyro_turned += turn.cwiseProduct(turned) / (dt * dt);
      turned_turned += turned.cwiseProduct(turned) / (dt * dt);
      count += 1.0;
    }
    first = i, turn.setZero();
  }
  std::string well, still;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const std::string name = kGyro[static_cast<std::size_t>(axis)];
    if (count < 3.0 || std::sqrt(turned_turned[axis] / count) < kTurned) {
      still += (still.empty() ? "" : ", ") + name;
      continue;
    }
    const double slope = gyro_turned[axis] / turned_turned[axis];
    if (slope < kSlopeLow || slope > kSlopeHigh)
      found.wrong.push_back(name + " is " + fixed(slope, 2) +
                            " times the rate by which the log's attitude turns, must be 1: wrong " +
                            (slope < 0.0 ? "sign" : "scale or axis"));
    else
      well += (well.empty() ? "" : ", ") + name + " " + fixed(slope, 2);
  }
  if (!well.empty()) found.checked.push_back("rates over those of the log's attitude: " + well);
  if (!still.empty())
    found.unknown.push_back(still +
                            ": it hardly turned about that axis, scale and sign not checked");
}

}  // namespace

Plausibility plausibility_of(const ForeignFlight& flight) {
  Plausibility found;
  check_rest(flight, found);
  if (check_fastest(flight, found)) check_against_attitude(flight, found);
  return found;
}

}  // namespace gatefly::foreign_logs
