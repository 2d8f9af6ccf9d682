// SPDX-License-Identifier: Apache-2.0
#include "gatefly/pose/map_pose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/LU>

#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/exponential.hpp"
#include "gatefly/geometry/gate_corners.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/pose/pose_moments.hpp"
#include "gatefly/pose/pose_starts.hpp"
#include "gatefly/pose/reprojection.hpp"

namespace gatefly {
namespace {

using namespace reprojection;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// of an angle [rad] or the height [m]; less would only be ill-conditioned
constexpr double kLeastSigma = 1e-4;
// from here on the covariance is integrated, not taken from the curvature [rad]
constexpr double kRoughAttitude = 0.06;
constexpr double kPoorAttitude = 0.1;  // from here on the homography's poses are tried, too [rad]
// In a race gates are often seen straight on; to a poor prior that is one attitude of many, and the
// covariance comes out too small there: it is inflated. [ours: reproduce
// pose-grid, NEES/3 1.8 at 15°]
constexpr double kCaution = 1.6;

bool usable(const GateObservations& seen, const PosePrior& prior) {
  const Attitude& a = prior.attitude_GB;
  bool good = std::isfinite(a.roll) && std::isfinite(a.pitch) && std::isfinite(a.yaw) &&
              std::isfinite(prior.z);
  for (const double sigma : {prior.roll_sigma, prior.pitch_sigma, prior.yaw_sigma, prior.z_sigma})
    good = good && sigma >= 0.0;
  for (const GateObservation& one : seen)
    good = good && one.px.allFinite() && one.sigma_px > 0.0 && std::isfinite(one.sigma_px) &&
           one.point_G.allFinite() && one.along_G.allFinite();
  return good;
}

PosePrior softened(PosePrior prior) {
  for (double* sigma : {&prior.roll_sigma, &prior.pitch_sigma, &prior.yaw_sigma, &prior.z_sigma})
    *sigma = std::max(*sigma, kLeastSigma);
  return prior;
}

double largest_sigma(const PosePrior& prior) {
  return std::max({prior.roll_sigma, prior.pitch_sigma, prior.yaw_sigma});
}

/// Equations beyond the six unknowns.
int degrees_of_freedom(const Sights& sights, Active active, const PosePrior& prior) {
  int equations = -6;
  for (std::size_t i = 0; i < sights.size(); ++i)
    if ((active >> i & 1u) != 0) equations += sights[i].line ? 1 : 2;
  for (const double sigma : {prior.roll_sigma, prior.pitch_sigma, prior.yaw_sigma, prior.z_sigma})
    equations += std::isfinite(sigma);
  return equations;
}

/// Inputs that stay fixed while starts and subsets are tried.
struct Problem {
  const Sights& sights;
  const PosePrior& prior;
  const CameraRig& rig;
  const MapPoseParams& params;
};

/// Which observations are inliers, and the pose that fits them.
struct Hypothesis {
  Active active;
  Fit fit;
  Moments moments;
  double cost;  ///< The fit's, and what was paid for outliers.
};
using Hypotheses = FixedList<Hypothesis, 12>;

double outlier_cost(const Sight& sight, const MapPoseParams& params) {
  // Densities of N(0, σ²) and N(0, outlier σ²) at their middles, with their shares.
  const double ratio = params.outlier_sigma_px * params.outlier_sigma_px / sight.variance_px;
  const double share = (1.0 - params.outlier_share) / params.outlier_share;
  return 2.0 * gatefly::log(share) + (sight.line ? 1.0 : 2.0) * gatefly::log(std::max(1.0, ratio));
}

/// Cost of the observations that a fit leaves out: each is N(0, outlier σ²) around its expected place.
double paid_for_outliers(const Problem& problem, Active active, const Fit& fit) {
  constexpr double kBehind = 25.0;  // where it cannot show at all: five outlier sigmas
  double cost = 0.0;
  for (std::size_t i = 0; i < problem.sights.size(); ++i) {
    if ((active >> i & 1u) != 0) continue;
    const auto with =
        normal_at(fit.pose, problem.sights, active | 1u << i, problem.prior, problem.rig);
    const double ratio = problem.sights[i].variance_px /
                         (problem.params.outlier_sigma_px * problem.params.outlier_sigma_px);
    cost += outlier_cost(problem.sights[i], problem.params) +
            (with ? (with->cost - fit.normal.cost) * ratio : kBehind);
  }
  return cost;
}

/// Whether two fits leave out the same and mean one place, a third of a standard deviation apart at
/// most.
bool same(const Hypothesis& a, const Hypothesis& b) {
  const Eigen::Vector3d off = (a.moments.mean - b.moments.mean).head<3>();
  const Eigen::Matrix3d P = (a.moments.covariance + b.moments.covariance).topLeftCorner<3, 3>();
  return a.active == b.active && off.dot(P.inverse() * off) < 0.1;
}

/// Adds a fit, in place of the same one or the worst if there is no room.
void consider(Hypotheses& list, const Fit& fit, Active active, const Problem& problem) {
  const auto moments = moments_of(fit);
  if (!moments) return;
  const Hypothesis one{active, fit, *moments,
                       fit.normal.cost + paid_for_outliers(problem, active, fit)};
  Hypothesis* place = nullptr;
  for (Hypothesis& other : list)
    if (same(one, other)) place = &other;
  if (place == nullptr && list.push_back(one)) return;
  if (place == nullptr)
    place = std::max_element(list.begin(), list.end(),
                             [](const auto& a, const auto& b) { return a.cost < b.cost; });
  if (one.cost < place->cost) *place = one;
}

/// The descents from all starts; true when one of them had nothing behind the camera.
bool consider_all_starts(Hypotheses& list, Active active, const Problem& problem,
                         const Pose* known = nullptr) {
  bool any = false;
  const auto from = [&](const Pose& start) {
    const auto fit = descend(start, problem.sights, active, problem.prior, problem.rig,
                             problem.params.max_steps);
    if (!fit) return;
    any = true;
    consider(list, *fit, active, problem);
  };
  if (const auto start = start_from_rays(problem.sights, active, problem.prior, problem.rig))
    from(*start);
  if (largest_sigma(problem.prior) <= kPoorAttitude) return any;
  if (known != nullptr) from(*known);
  for (const Pose& start : starts_from_homography(problem.sights, active, problem.rig)) from(start);
  return any;
}

const Hypothesis& best_of(const Hypotheses& list) {
  return *std::min_element(list.begin(), list.end(),
                           [](const auto& a, const auto& b) { return a.cost < b.cost; });
}

/// Leaves out one observation after the other while each makes the best hypothesis cheaper.
void consider_outliers(Hypotheses& list, const Problem& problem) {
  const Sights& sights = problem.sights;
  double least = outlier_cost(sights[0], problem.params);
  for (const Sight& sight : sights) least = std::min(least, outlier_cost(sight, problem.params));
  // A poor attitude may swallow an outlier: what is almost as good without it must be known, too.
  if (largest_sigma(problem.prior) > kRoughAttitude) least -= problem.params.search_depth;
  for (auto most =
           static_cast<int>(problem.params.max_outliers * static_cast<double>(sights.size()));
       most > 0; --most) {
    const Hypothesis best = best_of(list);
    if (!(best.fit.normal.cost > least)) return;
    for (std::size_t i = 0; i < sights.size(); ++i) {
      const Active active = best.active & ~(1u << i);
      if (active != best.active && degrees_of_freedom(sights, active, problem.prior) >= 1)
        consider_all_starts(list, active, problem, &best.fit.pose);
    }
    if (best_of(list).active == best.active) return;
  }
}

/// A prior that is flat in the gate's size in the picture instead of its distance: p(d) ~ 1/d², in
/// first order. Without it noise of 5 px makes a gate at 6 m seem 2 % farther than it is, on
/// average.
void move_to_size_prior(Moments& moments) {
  const Eigen::Vector3d d = moments.mean.head<3>();
  moments.mean -= moments.covariance.leftCols<3>() * (2.0 / d.squaredNorm() * d);
}

/// Hypotheses weighted by probability; moments are relative to one position.
struct Mixture {
  Vector6 first = Vector6::Zero();
  Matrix6 second = Matrix6::Zero();
  double total = 0.0;

  void add(double weight, const Vector6& off, const Matrix6& covariance) {
    total += weight;
    first += weight * off;
    second += weight * (covariance + off * off.transpose());
  }
  [[nodiscard]] Vector6 mean() const { return first / total; }
  [[nodiscard]] Matrix6 covariance() const { return second / total - mean() * mean().transpose(); }
  [[nodiscard]] double position_variance() const {
    return covariance().topLeftCorner<3, 3>().trace();
  }
};

/// Mean and covariance over all hypotheses.
struct Summary {
  Moments moments;
  /// The position's variance, in units of what it would be if all that may be left out meant one
  /// place.
  double widening;
};

Summary summary_of(const Hypotheses& list, const Problem& problem) {
  const Hypothesis& best = best_of(list);
  const bool walk = largest_sigma(problem.prior) > kRoughAttitude;
  const double best_volume = best.moments.covariance.determinant();
  Mixture all, alike;
  double others = 0.0;
  for (const Hypothesis& one : list) {
    double weight = gatefly::exp(0.5 * (best.cost - one.cost));
    // Laplace; between different observations it would favour those that tell less.
    if (one.active == best.active)
      weight *= std::sqrt(one.moments.covariance.determinant() / best_volume);
    if (!(weight > 1e-6 && weight < 1e6)) continue;
    Moments moments = one.moments;
    if (walk)
      moments = integrated_moments_of(one.fit, moments, problem.sights, one.active, problem.prior,
                                      problem.rig);
    move_to_size_prior(moments);
    Vector6 off = moments.mean - best.moments.mean;
    for (int i = 3; i < 6; ++i) off(i) = wrap_angle(off(i));
    all.add(weight, off, moments.covariance);
    if (one.active == best.active)
      alike.add(weight, off, moments.covariance);
    else
      others += weight * moments.covariance.topLeftCorner<3, 3>().trace();
  }
  const double caution = largest_sigma(problem.prior) > kPoorAttitude ? kCaution : 1.0;
  return {{best.moments.mean + all.mean(), caution * all.covariance()},
          all.total * all.position_variance() / (alike.total * alike.position_variance() + others)};
}

NoPose refusal_of(const MapPose& pose, bool converged, const CameraRig& rig,
                  const MapPoseParams& params) {
  const Eigen::Vector3d camera_G = pose.p_GB + rotation_EB(pose.attitude_GB).matrix * rig.p_BC;
  const double distance = camera_G.norm();
  if (!converged || !pose.p_GB.allFinite()) return NoPose::kNotConverged;
  if (!(camera_G.x() < 0.0)) return NoPose::kBehind;
  if (!(-camera_G.x() > params.min_incidence * distance)) return NoPose::kEdgeOn;
  if (!(distance < params.max_distance)) return NoPose::kTooFar;
  const double most = pose.dropped == 0u ? params.max_deviate : params.max_deviate_after_drop;
  if (!(normal_deviate(pose.chi2, pose.dof) < most)) return NoPose::kMisfit;
  return NoPose::kNone;
}

void add_line(GateObservations& seen, const Eigen::Vector2d& px, double y, double sigma_px) {
  seen.push_back(
      {.px = px, .sigma_px = sigma_px, .point_G = {0, y, 0}, .along_G = Eigen::Vector3d::UnitZ()});
}

}  // namespace

bool add_corners(GateObservations& seen, const Quad& outer_corners_px, double side,
                 double sigma_px) {
  if (seen.size() + 4 > GateObservations::kCapacity) return false;
  const auto corners_G = gate_corners_G(side);
  for (std::size_t i = 0; i < 4; ++i)
    seen.push_back({.px = outer_corners_px[i], .sigma_px = sigma_px, .point_G = corners_G[i]});
  return true;
}

bool add_bars(GateObservations& seen, const GateBars& bars, double bar_distance, double sigma_px) {
  if (seen.size() + 2 > GateObservations::kCapacity) return false;
  add_line(seen, bars.left_px, -0.5 * bar_distance, sigma_px);
  add_line(seen, bars.right_px, 0.5 * bar_distance, sigma_px);
  return true;
}

MapPoseAnswer map_pose(const GateObservations& seen, const PosePrior& given, const CameraRig& rig,
                       const MapPoseParams& params) {
  const auto refused = [](NoPose reason) { return MapPoseAnswer{std::nullopt, reason}; };
  if (!usable(seen, given)) return refused(NoPose::kNotANumber);
  const PosePrior prior = softened(given);
  const auto sights = sights_of(seen, rig);
  if (!sights) return refused(NoPose::kOutsideLens);
  const Active all = (1u << sights->size()) - 1u;
  if (sights->size() < 2 || degrees_of_freedom(*sights, all, prior) < 0)
    return refused(NoPose::kTooFew);

  const Problem problem{*sights, prior, rig, params};
  Hypotheses list;
  const bool in_front = consider_all_starts(list, all, problem);
  if (list.empty()) return refused(in_front ? NoPose::kTooFew : NoPose::kBehind);
  consider_outliers(list, problem);
  const Hypothesis& best = best_of(list);
  const auto [mean, widening] = summary_of(list, problem);

  const MapPose pose{.p_GB = mean.mean.head<3>(),
                     .attitude_GB = {mean.mean(3), mean.mean(4), mean.mean(5)},
                     .covariance = mean.covariance,
                     .chi2 = best.fit.normal.cost,
                     .dof = degrees_of_freedom(*sights, best.active, prior),
                     .dropped = all & ~best.active};
  const NoPose refusal = refusal_of(pose, best.fit.converged, rig, params);
  if (refusal != NoPose::kNone) return refused(refusal);
  if (!(widening < params.max_widening)) return refused(NoPose::kAmbiguous);
  return {pose, NoPose::kNone};
}

double normal_deviate(double chi2, int dof) {
  if (dof < 1) return 0.0;
  const double spread = 2.0 / (9.0 * dof);
  return (gatefly::cbrt(chi2 / dof) - (1.0 - spread)) / std::sqrt(spread);
}

const char* text_of(NoPose reason) {
  constexpr std::array<const char*, 10> kTexts{
      "none",    "not a number", "outside the lens", "too few", "behind",
      "edge-on", "too far",      "not converged",    "misfit",  "ambiguous"};
  return kTexts[static_cast<std::size_t>(reason)];
}

}  // namespace gatefly
