// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/lens_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>
#include <utility>

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <glog/logging.h>

#include "gatefly/tasks/calibration/board_homography.hpp"

namespace gatefly::calibration {
namespace {

// The lenses of sensing/camera.hpp once more, as templates that Ceres can differentiate (a test
// compares them): from a point in front of the camera to where a focal length of 1 px draws it.

template <class T>
using Point = Eigen::Matrix<T, 3, 1>;
template <class T>
using Drawn = Eigen::Matrix<T, 2, 1>;

struct PinholeLens {
  static constexpr int kParameters = 4;
  template <class T>
  static Drawn<T> draw(const T*, const Point<T>& p) {
    return p.template head<2>() / p.z();
  }
};

struct DhaneLens {
  static constexpr int kParameters = 5;
  template <class T>
  static Drawn<T> draw(const T* d, const Point<T>& p) {
    // sin = R / (k |p|) and tan = sin / sqrt(1 - sin²), over R: nothing is divided by R.
    const T squared = d[0] * d[0] * p.squaredNorm() - p.template head<2>().squaredNorm();
    return p.template head<2>() / sqrt(squared);
  }
};

struct KannalaBrandtLens {
  static constexpr int kParameters = 8;
  template <class T>
  static Drawn<T> draw(const T* d, const Point<T>& p) {
    const T squared = p.template head<2>().squaredNorm();
    if (squared < 1e-20 * p.z() * p.z()) return p.template head<2>() / p.z();
    const T side = sqrt(squared), angle = atan2(side, p.z()), s = angle * angle;
    return p.template head<2>() *
           (angle * (1.0 + s * (d[0] + s * (d[1] + s * (d[2] + s * d[3])))) / side);
  }
};

struct BrownConradyLens {
  static constexpr int kParameters = 9;
  template <class T>
  static Drawn<T> draw(const T* d, const Point<T>& p) {
    const Drawn<T> m = p.template head<2>() / p.z();
    const T x = m.x(), y = m.y(), s = m.squaredNorm();
    const T a = 1.0 + s * (d[0] + s * (d[1] + s * d[4]));
    return {a * x + 2.0 * d[2] * x * y + d[3] * (s + 2.0 * x * x),
            a * y + d[2] * (s + 2.0 * y * y) + 2.0 * d[3] * x * y};
  }
};

template <class Lens>
struct Reprojection {
  BoardCorner corner;

  template <class T>
  bool operator()(const T* lens, const T* pose, T* residual) const {
    const T p_W[3] = {T(corner.p_W.x()), T(corner.p_W.y()), T(0.0)};
    Point<T> p_C;
    ceres::AngleAxisRotatePoint(pose, p_W, p_C.data());
    for (int i = 0; i < 3; ++i) p_C[i] += pose[3 + i];
    if (!(p_C.z() > 0.0)) return false;  // behind the camera
    const Drawn<T> m = Lens::draw(lens + 4, p_C);
    for (int i = 0; i < 2; ++i) residual[i] = lens[i] * m[i] + lens[2 + i] - corner.px[i];
    using std::isfinite;
    return isfinite(residual[0]) && isfinite(residual[1]);
  }
};

template <class Lens>
ceres::CostFunction* cost_of(const BoardCorner& corner) {
  return new ceres::AutoDiffCostFunction<Reprojection<Lens>, 2, Lens::kParameters, 6>(
      new Reprojection<Lens>{corner});
}

ceres::CostFunction* cost_of(LensModel model, const BoardCorner& corner) {
  switch (model) {
    case LensModel::kPinhole:
      return cost_of<PinholeLens>(corner);
    case LensModel::kDhane:
      return cost_of<DhaneLens>(corner);
    case LensModel::kKannalaBrandt:
      return cost_of<KannalaBrandtLens>(corner);
    case LensModel::kBrownConrady:
      break;
  }
  return cost_of<BrownConradyLens>(corner);
}

void add(ceres::Problem& problem, const BoardView& view, LensModel model, double* lens,
         double* pose, double huber_px) {
  for (const BoardCorner& corner : view.corners)
    problem.AddResidualBlock(cost_of(model, corner),
                             huber_px > 0.0 ? new ceres::HuberLoss(huber_px) : nullptr, lens, pose);
}

/// Whether a minimum was found.
bool solve(ceres::Problem& problem) {
  FLAGS_minloglevel = google::GLOG_FATAL;  // what Ceres complains about comes back as "no minimum"
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.IsSolutionUsable();
}

/// One standard deviation of the lens's parameters, from the scatter of the residuals.
Eigen::VectorXd sigma_of(ceres::Problem& problem, const double* lens, Eigen::Index count,
                         std::size_t fixed) {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  ceres::Covariance covariance(options);
  if (!covariance.Compute(std::vector{std::pair{lens, lens}}, &problem)) return {};
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> block(count, count);
  covariance.GetCovarianceBlock(lens, lens, block.data());
  double cost = 0.0;
  problem.Evaluate({}, &cost, nullptr, nullptr, nullptr);
  const int freedom = problem.NumResiduals() - problem.NumParameters() + static_cast<int>(fixed);
  if (freedom <= 0) return {};
  return (block.diagonal() * (2.0 * cost / freedom)).cwiseSqrt();
}

/// Root mean square over the corners of a view; infinite when one does not show.
double rms_px(const BoardView& view, const AnyCamera& lens, const BoardPose& pose) {
  double sum = 0.0;
  for (const Eigen::Vector2d& residual : residuals_px(view, lens, pose))
    sum += residual.squaredNorm();
  return std::isfinite(sum) ? std::sqrt(sum / static_cast<double>(view.corners.size()))
                            : std::numeric_limits<double>::infinity();
}

/// An equidistant lens and its poses, where it has them.
struct Guess {
  LensFit fit;
  std::vector<bool> has_pose;
  double misfit_px = 0.0;  ///< Median over the views.
};

/// The views that have a pose, and the fit with these poses alone.
std::pair<BoardViews, LensFit> split(const BoardViews& views, const Guess& all) {
  std::pair<BoardViews, LensFit> kept{{}, all.fit};
  kept.second.poses.clear();
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!all.has_pose[i]) continue;
    kept.first.push_back(views[i]);
    kept.second.poses.push_back(all.fit.poses[i]);
  }
  return kept;
}

Guess guess(const BoardViews& views, const Eigen::Vector2i& size_px, double focal_px) {
  Guess result;
  result.fit.parameters = Eigen::VectorXd::Zero(8);
  result.fit.parameters.head<4>() << focal_px, focal_px, 0.5 * (size_px.x() - 1),
      0.5 * (size_px.y() - 1);
  const AnyCamera lens = result.fit.lens();
  std::vector<double> misfits;
  for (const BoardView& view : views) {
    const auto pose = pose_from_homography(view, lens);
    result.has_pose.push_back(pose.has_value());
    result.fit.poses.push_back(pose.value_or(BoardPose::Zero()));
    misfits.push_back(pose ? rms_px(view, lens, *pose) : std::numeric_limits<double>::infinity());
  }
  const auto middle = misfits.begin() + static_cast<std::ptrdiff_t>(misfits.size() / 2);
  std::nth_element(misfits.begin(), middle, misfits.end());
  result.misfit_px = *middle;
  return result;
}

}  // namespace

Eigen::Vector3d in_camera(const BoardPose& pose, const Eigen::Vector2d& p_W) {
  const Eigen::Vector3d turn = pose.head<3>();
  const double angle = turn.norm();
  const Eigen::Vector3d on_board{p_W.x(), p_W.y(), 0.0};
  const Eigen::Vector3d turned =
      angle > 0.0 ? Eigen::AngleAxisd(angle, turn / angle) * on_board : on_board;
  return turned + pose.tail<3>();
}

LensFit first_guess(BoardViews& views, const Eigen::Vector2i& size_px) {
  // Focal lengths as parts of the longer side: from a 180° fisheye to a 20° telephoto.
  constexpr std::array kParts{0.25, 0.35, 0.5, 0.7, 1.0, 1.5, 2.5};
  Guess best;
  for (const double part : kParts) {
    Guess next = guess(views, size_px, part * size_px.maxCoeff());
    if (best.has_pose.empty() || next.misfit_px < best.misfit_px) best = std::move(next);
  }
  const auto posed = split(views, best);
  LensFit fit = posed.second;
  if (auto better = fit_lens(posed.first, fit, kHuberPx)) fit = *std::move(better);
  // With a better lens, boards at the picture's border have a pose too.
  Guess again{fit, {}, 0.0};
  again.fit.poses.clear();
  std::size_t next = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto pose = best.has_pose[i] ? std::optional{fit.poses[next++]}
                                       : pose_from_homography(views[i], fit.lens());
    again.has_pose.push_back(pose.has_value());
    again.fit.poses.push_back(pose.value_or(BoardPose::Zero()));
  }
  std::tie(views, fit) = split(views, again);
  return fit;
}

LensFit as_model(const LensFit& fit, LensModel model) {
  LensFit other = fit;
  other.model = model;
  other.sigma.resize(0);
  other.fixed.clear();
  other.parameters =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(parameter_names(model).size()));
  other.parameters.head<4>() = fit.parameters.head<4>();
  if (model == fit.model)
    other.parameters = fit.parameters;
  else if (model == LensModel::kDhane) {
    constexpr double kWide = 1.1;  // drawn at f sin θ / k for small θ
    other.parameters[4] = kWide;
    other.parameters.head<2>() *= kWide;
  } else if (model == LensModel::kBrownConrady && fit.model == LensModel::kKannalaBrandt) {
    // tan θ = θ + θ³/3; a tenth: fold-back must not start it
    other.parameters[4] = 0.1 * (fit.parameters[4] - 1.0 / 3.0);
  }
  return other;
}

std::optional<LensFit> fit_lens(const BoardViews& views, const LensFit& start, double huber_px) {
  LensFit fit = start;
  ceres::Problem problem;
  for (std::size_t i = 0; i < views.size(); ++i)
    add(problem, views[i], fit.model, fit.parameters.data(), fit.poses[i].data(), huber_px);
  if (!fit.fixed.empty())
    problem.SetManifold(
        fit.parameters.data(),
        new ceres::SubsetManifold(static_cast<int>(fit.parameters.size()), fit.fixed));
  if (!solve(problem) || !fit.parameters.allFinite() || fit.parameters.head<2>().minCoeff() <= 0.0)
    return std::nullopt;
  fit.sigma.resize(0);
  if (huber_px == 0.0)
    fit.sigma = sigma_of(problem, fit.parameters.data(), fit.parameters.size(), fit.fixed.size());
  return fit;
}

std::optional<BoardPose> fit_pose(const BoardView& view, const LensFit& lens,
                                  const BoardPose& start) {
  BoardPose pose = start;
  Eigen::VectorXd parameters = lens.parameters;
  ceres::Problem problem;
  add(problem, view, lens.model, parameters.data(), pose.data(), 0.0);
  problem.SetParameterBlockConstant(parameters.data());
  if (!solve(problem) || !pose.allFinite()) return std::nullopt;
  return pose;
}

std::vector<Eigen::Vector2d> residuals_px(const BoardView& view, const AnyCamera& lens,
                                          const BoardPose& pose) {
  std::vector<Eigen::Vector2d> residuals;
  residuals.reserve(view.corners.size());
  const Eigen::Vector2d nowhere =
      Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  for (const BoardCorner& corner : view.corners) {
    const auto px = lens.project(in_camera(pose, corner.p_W));
    residuals.push_back(px ? Eigen::Vector2d{corner.px - *px} : nowhere);
  }
  return residuals;
}

}  // namespace gatefly::calibration
