// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/identification/drag_fit.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/seconds.hpp"

namespace gatefly::identification {
namespace {

constexpr double kPiece = 1.0, kEvery = 0.1;  // [s]
constexpr double kFlownDragY = -0.47, kFlownWeight = 0.3;
constexpr double kBiasWeight = 5.0;                      // of a known bias, in pieces
constexpr double kMostOffset = 40.0, kOffsetStep = 0.5;  // [deg]

bool is_complete(const flight_log::FlightSample& s) { return s.true_p_EB && s.true_v_E && s.ahrs; }

using Theta = Eigen::Vector4d;  // 1/k_x, −b_x/k_x, 1/k_y, −b_y/k_y

struct Solution {
  Theta theta;
  Eigen::Matrix4d inverse;  // of the normal matrix
  double cost = std::numeric_limits<double>::infinity();
};

Solution solved(std::span<const Displacement> pieces, const Eigen::Matrix4d& prior_weight,
                const Theta& prior) {
  Eigen::Matrix4d N = prior_weight;
  Theta right = prior_weight * prior;
  for (const Displacement& d : pieces)
    N += d.M.transpose() * d.M, right += d.M.transpose() * d.moved;
  const Eigen::LDLT<Eigen::Matrix4d> ldlt = N.ldlt();
  Solution s{.theta = ldlt.solve(right), .inverse = ldlt.solve(Eigen::Matrix4d::Identity())};
  s.cost = (s.theta - prior).dot(prior_weight * (s.theta - prior));
  for (const Displacement& d : pieces) s.cost += (d.M * s.theta - d.moved).squaredNorm();
  return s;
}

// The heading offset with the least cost, by trying all: 161 small least-squares problems.
template <class Solve>
std::pair<double, Solution> best_offset(const Solve& solve) {
  std::pair<double, Solution> best;
  for (double degrees = -kMostOffset; degrees <= kMostOffset; degrees += kOffsetStep) {
    const Solution s = solve(degrees * kDegree);
    if (s.theta(0) < 0.0 && s.theta(2) < 0.0 && s.cost < best.second.cost)
      best = {degrees * kDegree, s};
  }
  return best;
}

}  // namespace

Airborne airborne(const flight_log::FlightFolder& flight) {
  const auto above = [&](std::size_t i, double height) {
    return is_complete(flight.samples[i]) && flight.samples[i].true_p_EB->z() < -height;
  };
  Airborne rows{0, flight.samples.size()};
  while (rows.first < rows.last && !above(rows.first, 0.9)) ++rows.first;
  while (rows.last > rows.first && !above(rows.last - 1, 0.6)) --rows.last;
  return rows;
}

std::vector<Displacement> displacements(const flight_log::FlightFolder& flight,
                                        const Airborne& rows, double heading_offset,
                                        double length) {
  // Integrals up to each row; a piece is the difference of two.
  struct Integral {
    std::size_t row;
    Eigen::Matrix<double, 2, 4> M;
    Eigen::Vector2d vertical;
  };
  std::vector<Integral> integrals;
  Integral sum{rows.first, Eigen::Matrix<double, 2, 4>::Zero(), Eigen::Vector2d::Zero()};
  for (std::size_t i = std::max<std::size_t>(rows.first, 1); i < rows.last; ++i) {
    const flight_log::FlightSample& s = flight.samples[i];
    if (!is_complete(s)) continue;
    const double dt = seconds(s.time - flight.samples[i - 1].time);
    Attitude attitude = *s.ahrs;
    attitude.yaw += heading_offset;
    const Eigen::Matrix3d R = rotation_EB(attitude).matrix;
    // v_z of the body is what makes up the true vertical velocity.
    const Eigen::Matrix2d A =
        R.topLeftCorner<2, 2>() - R.topRightCorner<2, 1>() * R.bottomLeftCorner<1, 2>() / R(2, 2);
    for (int axis = 0; axis < 2; ++axis) {
      sum.M.col(2 * axis) += dt * s.imu.accel_B[axis] * A.col(axis);
      sum.M.col(2 * axis + 1) += dt * A.col(axis);
    }
    sum.vertical += dt * s.true_v_E->z() / R(2, 2) * R.topRightCorner<2, 1>();
    sum.row = i;
    integrals.push_back(sum);
  }
  std::vector<Displacement> pieces;
  const auto time = [&](std::size_t k) { return seconds(flight.samples[integrals[k].row].time); };
  double next = -1e9;
  for (std::size_t from = 0, to = 0; from < integrals.size(); ++from) {
    if (time(from) < next) continue;
    while (to < integrals.size() && time(to) < time(from) + length) ++to;
    if (to == integrals.size()) break;
    next = time(from) + kEvery;
    const Integral &a = integrals[from], &b = integrals[to];
    pieces.push_back(
        {b.M - a.M,
         (*flight.samples[b.row].true_p_EB - *flight.samples[a.row].true_p_EB).head<2>() -
             (b.vertical - a.vertical)});
  }
  return pieces;
}

std::optional<DragFit> fit_drag(const flight_log::FlightFolder& flight) {
  const Airborne rows = airborne(flight);
  const std::size_t pieces = displacements(flight, rows, 0.0, kPiece).size();
  if (pieces == 0) return std::nullopt;
  Eigen::Matrix4d weight = Eigen::Matrix4d::Zero();
  weight(2, 2) = kFlownWeight;
  const Theta prior{0.0, 0.0, 1.0 / kFlownDragY, 0.0};
  const auto [offset, s] = best_offset(
      [&](double o) { return solved(displacements(flight, rows, o, kPiece), weight, prior); });
  if (!std::isfinite(s.cost)) return std::nullopt;

  DragFit fit{.heading_offset = offset, .pieces = pieces};
  fit.drag = {1.0 / s.theta(0), 1.0 / s.theta(2)};
  fit.bias = {-s.theta(1) / s.theta(0), -s.theta(3) / s.theta(2)};
  fit.rms = std::sqrt(s.cost / static_cast<double>(pieces));
  // Pieces overlap: one in ten is independent.
  const double variance = 0.5 * fit.rms * fit.rms * kPiece / kEvery;
  for (int axis = 0; axis < 2; ++axis)
    fit.drag_sigma[axis] =
        std::sqrt(variance * s.inverse(2 * axis, 2 * axis)) * fit.drag[axis] * fit.drag[axis];
  return fit;
}

double fit_heading(const flight_log::FlightFolder& flight, const DragFit& fit) {
  const Airborne rows = airborne(flight);
  const Theta known{1.0 / fit.drag.x(), -fit.bias.x() / fit.drag.x(), 1.0 / fit.drag.y(),
                    -fit.bias.y() / fit.drag.y()};
  const Eigen::Matrix4d weight = Eigen::Vector4d{1e6, kBiasWeight, 1e6, kBiasWeight}.asDiagonal();
  return best_offset([&](double o) {
           return solved(displacements(flight, rows, o, 2.0 * kPiece), weight, known);
         })
      .first;
}

DragFit mean_of(std::span<const DragFit> fits, std::optional<std::size_t> left_out) {
  DragFit mean;
  double n = 0.0;
  Eigen::Vector2d square = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (i == left_out) continue;
    mean.drag += fits[i].drag, mean.bias += fits[i].bias, square += fits[i].drag.cwiseAbs2(),
        n += 1.0;
    mean.pieces += fits[i].pieces;
  }
  if (n == 0.0) return mean;
  mean.drag /= n, mean.bias /= n;
  // Sigma of the mean, from the scatter of the flights.
  if (n > 1.0)
    mean.drag_sigma = ((square / n - mean.drag.cwiseAbs2()).cwiseMax(0.0) / (n - 1.0)).cwiseSqrt();
  return mean;
}

}  // namespace gatefly::identification
