// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/mount.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <ceres/ceres.h>
#include <glog/logging.h>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::calibration {
namespace {

constexpr std::size_t kMinPictures = 3;

/// Pose of the body when a picture was taken. Level pictures: the origin.
struct BodyPose {
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();
  Attitude attitude = {};
};

/// A gate in a picture. `gate`: which of Solution::gates.
struct Sight {
  Quad corners_px;
  BodyPose body;
  std::size_t gate = 0;
};

/// x, y, z [m] and heading [rad] of an upright gate.
using UprightGate = std::array<double, 4>;

struct Solution {
  std::array<double, 2> mount{};  ///< Tilt down, roll.
  double heading_offset = 0.0;
  std::vector<UprightGate> gates;
  double cost = 0.0;  ///< Half the sum of squares [px²].
};

struct Geometry {
  AnyCamera lens;
  double gate_side = 1.0;
  Eigen::Vector3d p_BC = Eigen::Vector3d::Zero();
  std::optional<double> height = std::nullopt;  ///< Gates' middles above the origin [m].
  bool fit_heading = false;
};

constexpr double kCornerSigmaPx = 1.0;  // ours: what careful labels are off
constexpr double kHeightSigma = 0.05;   // [m] ours: a tape measure, and a drone's feet
// ours: more than the difference between two ways of mounting a camera
constexpr double kMaxTiltSigma = 3.0 * kDegree;

struct HeightError {
  double height;
  template <class T>
  bool operator()(const T* gate, T* residual) const {
    residual[0] = (gate[2] + height) * (kCornerSigmaPx / kHeightSigma);
    return true;
  }
};

struct GateReprojection {
  const Sight& sight;
  const Geometry& geometry;

  bool operator()(const double* mount, const double* heading_offset, const double* gate,
                  double* residuals) const {
    Attitude attitude = sight.body.attitude;
    attitude.yaw += *heading_offset;
    const Eigen::Matrix3d R_EB = rotation_EB(attitude).matrix,
                          R_BC = camera_mount(mount[0], mount[1]).matrix;
    const Eigen::Vector3d p_EG{gate[0], gate[1], gate[2]};
    const Eigen::Matrix3d R_EG = rotation_z(gate[3]);
    const auto corners_G = gate_corners_G(1.0);
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector3d p_E = p_EG + R_EG * (geometry.gate_side * corners_G[k]);
      const Eigen::Vector3d p_B = R_EB.transpose() * (p_E - sight.body.p_EB);
      const auto px = geometry.lens.project(R_BC.transpose() * (p_B - geometry.p_BC));
      if (!px) return false;
      Eigen::Map<Eigen::Vector2d>(residuals + 2 * k) = *px - sight.corners_px[k];
    }
    return true;
  }
};

void pose_problem(ceres::Problem& problem, const std::vector<Sight>& sights,
                  const Geometry& geometry, Solution& start, std::size_t skip) {
  FLAGS_minloglevel = google::GLOG_FATAL;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if (i == skip) continue;
    using Cost = ceres::NumericDiffCostFunction<GateReprojection, ceres::CENTRAL, 8, 2, 1, 4>;
    problem.AddResidualBlock(new Cost(new GateReprojection{sights[i], geometry}), nullptr,
                             start.mount.data(), &start.heading_offset,
                             start.gates[sights[i].gate].data());
    if (geometry.height)
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<HeightError, 1, 4>(new HeightError{*geometry.height}),
          nullptr, start.gates[sights[i].gate].data());
  }
  if (!geometry.fit_heading) problem.SetParameterBlockConstant(&start.heading_offset);
}

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// Least squares from `start`; nullopt when it does not end well. @param skip  a sight that is left
/// out.
std::optional<Solution> solve(const std::vector<Sight>& sights, const Geometry& geometry,
                              Solution start, std::size_t skip = kNone) {
  ceres::Problem problem;
  pose_problem(problem, sights, geometry, start, skip);
  ceres::Solver::Options options;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return std::nullopt;
  start.cost = summary.final_cost;
  return start;
}

/// Standard deviations of tilt and roll if all pictures shared their errors: what one of them alone
/// would give.
Eigen::Array2d sigma_of_one(const Solution& solution, const std::vector<Sight>& sights,
                            const Geometry& geometry) {
  Solution at = solution;
  ceres::Problem problem;
  pose_problem(problem, sights, geometry, at, kNone);
  ceres::Covariance covariance(ceres::Covariance::Options{});
  Eigen::Matrix<double, 2, 2, Eigen::RowMajor> block =
      Eigen::Matrix2d::Constant(std::numeric_limits<double>::infinity());
  const double* mount = at.mount.data();
  if (covariance.Compute(std::vector{std::pair{mount, mount}}, &problem))
    covariance.GetCovarianceBlock(mount, mount, block.data());
  return kCornerSigmaPx * (static_cast<double>(sights.size()) * block.diagonal().array()).sqrt();
}

/// A first place for a gate, from its middle and its size, for a camera that is tilted by
/// `tilt_down`.
UprightGate first_gate(const Sight& sight, const Geometry& geometry, double tilt_down) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const auto& corner : sight.corners_px) middle += 0.25 * corner;
  const auto ray = geometry.lens.bearing(middle),
             top = geometry.lens.bearing(0.5 * (sight.corners_px[0] + sight.corners_px[1])),
             low = geometry.lens.bearing(0.5 * (sight.corners_px[2] + sight.corners_px[3]));
  if (!ray || !top || !low)
    throw std::runtime_error("a gate's corners are outside the lens's field of view");
  const double distance = geometry.gate_side / std::max(top->cross(*low).norm(), 1e-3);
  const Eigen::Matrix3d R_EB = rotation_EB(sight.body.attitude).matrix;
  const Eigen::Vector3d ray_E = R_EB * camera_mount(tilt_down).matrix * *ray;
  const Eigen::Vector3d p_EG = sight.body.p_EB + R_EB * geometry.p_BC + distance * ray_E;
  return {p_EG.x(), p_EG.y(), p_EG.z(), gatefly::atan2(ray_E.y(), ray_E.x())};
}

/// The best of some first tilts.
std::optional<Solution> best_solution(const std::vector<Sight>& sights, std::size_t gates,
                                      const Geometry& geometry) {
  std::optional<Solution> best;
  for (const double tilt_deg : {0.0, 15.0, 30.0, -15.0}) {
    Solution start;
    start.mount[0] = tilt_deg * kDegree;
    start.gates.resize(gates);
    for (auto sight = sights.rbegin(); sight != sights.rend(); ++sight)
      start.gates[sight->gate] = first_gate(*sight, geometry, start.mount[0]);
    const auto solution = solve(sights, geometry, start);
    if (solution && (!best || solution->cost < best->cost)) best = solution;
  }
  return best;
}

/// Standard deviations of tilt and roll, by leaving out one picture in turn.
Eigen::Array2d jackknife(const Solution& solution, const std::vector<Sight>& sights,
                         const Geometry& geometry) {
  const auto n = static_cast<double>(sights.size());
  Eigen::Array2d squares = Eigen::Array2d::Zero();
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const auto without = solve(sights, geometry, solution, i);
    if (!without) throw std::runtime_error("the mount angle depends on one picture alone");
    for (int k = 0; k < 2; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const double moved = without->mount[at] - solution.mount[at];
      squares[k] += moved * moved;
    }
  }
  return ((n - 1.0) / n * squares).sqrt();
}

Mount mount_of(const Solution& solution, std::size_t pictures, const Eigen::Array2d& sigma) {
  return {.tilt_down = solution.mount[0],
          .roll = solution.mount[1],
          .tilt_sigma = sigma[0],
          .roll_sigma = sigma[1],
          .rms_px = std::sqrt(2.0 * solution.cost / (4.0 * static_cast<double>(pictures))),
          .pictures = pictures,
          .heading_offset = solution.heading_offset,
          .time_offset = 0.0,
          .p_EG = {solution.gates[0][0], solution.gates[0][1], solution.gates[0][2]}};
}

/// Position and attitude between two samples of a log; nullopt outside it or where it has none.
std::optional<BodyPose> body_at(const flight_log::FlightFolder& flight,
                                std::chrono::nanoseconds time) {
  const auto after = std::lower_bound(
      flight.samples.begin(), flight.samples.end(), time,
      [](const flight_log::FlightSample& sample, auto t) { return sample.time < t; });
  if (after == flight.samples.begin() || after == flight.samples.end()) return std::nullopt;
  const flight_log::FlightSample &b = *after, &a = *(after - 1);
  if (!a.true_p_EB || !b.true_p_EB || !a.ahrs || !b.ahrs || a.time == b.time) return std::nullopt;
  const double part =
      static_cast<double>((time - a.time).count()) / static_cast<double>((b.time - a.time).count());
  const auto between = [&](double from, double to) { return from + part * wrap_angle(to - from); };
  return BodyPose{*a.true_p_EB + part * (*b.true_p_EB - *a.true_p_EB),
                  {between(a.ahrs->roll, b.ahrs->roll), between(a.ahrs->pitch, b.ahrs->pitch),
                   between(a.ahrs->yaw, b.ahrs->yaw)}};
}

std::vector<Sight> sights_of(const flight_log::FlightFolder& flight, const files::Labels& labels,
                             double time_offset) {
  constexpr double kInTheAir = 0.5;  // [m]
  const std::chrono::nanoseconds shift{std::llround(1e9 * time_offset)};
  const auto start = std::find_if(
      flight.samples.begin(), flight.samples.end(),
      [](const flight_log::FlightSample& sample) { return sample.true_p_EB.has_value(); });
  std::vector<Sight> sights;
  if (start == flight.samples.end()) return sights;
  for (const flight_log::FlightImage& image : flight.images) {
    const auto body = body_at(flight, image.time + shift);
    if (!body) continue;
    const auto label = std::find_if(
        labels.pictures.begin(), labels.pictures.end(),
        [&](const files::LabelledPicture& each) { return each.image == image.path.filename(); });
    if (label == labels.pictures.end() || label->gates.size() != 1 ||
        start->true_p_EB->z() - body->p_EB.z() < kInTheAir)
      continue;
    sights.push_back({label->gates[0], *body, 0});
  }
  return sights;
}

}  // namespace

Mount mount_from_level(std::span<const Quad> gates, const AnyCamera& lens, double gate_side,
                       std::optional<double> height) {
  if (gates.size() < kMinPictures)
    throw std::runtime_error(std::to_string(gates.size()) + " pictures show a gate, at least " +
                             std::to_string(kMinPictures) + " are needed");
  const Geometry geometry{
      .lens = lens, .gate_side = gate_side, .p_BC = Eigen::Vector3d::Zero(), .height = height};
  // every picture has a gate of its own, so that heading is the gate's alone
  std::vector<Sight> sights;
  for (const Quad& gate : gates) sights.push_back({gate, {}, sights.size()});
  const auto solution = best_solution(sights, sights.size(), geometry);
  if (!solution)
    throw std::runtime_error("no upright gate before a tilted camera explains these corners");
  const Eigen::Array2d one = sigma_of_one(*solution, sights, geometry),
                       sigma = one.max(jackknife(*solution, sights, geometry));
  if (!(sigma[0] <= kMaxTiltSigma))
    throw std::runtime_error(
        "these gates leave the tilt open by +-" + files::text_of(sigma[0] / kDegree, 2) +
        " deg, at most 3 is usable: " +
        (height ? "come nearer to the gate" : "come nearer to the gate, or give --gate-height-m"));
  return mount_of(*solution, sights.size(), sigma);
}

Mount mount_from_flight(const flight_log::FlightFolder& flight, const files::Labels& labels,
                        const AnyCamera& lens, double gate_side, const Eigen::Vector3d& p_BC) {
  const Geometry geometry{
      .lens = lens, .gate_side = gate_side, .p_BC = p_BC, .height = {}, .fit_heading = true};
  constexpr double kStep = 0.005, kFarthest = 0.1;  // [s]
  std::optional<Solution> best;
  // per picture: a shift may lose one
  double best_offset = 0.0, best_cost = std::numeric_limits<double>::infinity();
  for (double offset = -kFarthest; offset <= kFarthest + 1e-9; offset += kStep) {
    const auto sights = sights_of(flight, labels, offset);
    if (sights.size() < kMinPictures)
      throw std::runtime_error(std::to_string(sights.size()) +
                               " labelled pictures were taken in the air with motion capture and "
                               "attitude in the log, at least " +
                               std::to_string(kMinPictures) + " are needed");
    const auto solution =
        best ? solve(sights, geometry, *best) : best_solution(sights, 1, geometry);
    if (!solution || !(solution->cost / static_cast<double>(sights.size()) < best_cost)) continue;
    best = solution;
    best_cost = solution->cost / static_cast<double>(sights.size());
    best_offset = offset;
  }
  if (!best) throw std::runtime_error("no gate explains the labelled corners of this flight");
  const auto sights = sights_of(flight, labels, best_offset);
  Mount mount = mount_of(*best, sights.size(), jackknife(*best, sights, geometry));
  mount.time_offset = best_offset;
  return mount;
}

}  // namespace gatefly::calibration
