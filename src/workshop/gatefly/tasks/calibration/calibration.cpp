// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/calibration/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::calibration {
namespace {

constexpr std::size_t kMinViews = 5;    // ours: fewer leave no view to hold out of every fold
constexpr std::size_t kMinCorners = 8;  // ours: twice what a pose needs
constexpr double kOutlierSigmas = 5.0;  // ours: a corner in 300,000 by chance
// ours: no corner is known better; keeps exact corners of a computer
constexpr double kMinSigmaPx = 0.02;
constexpr double kMaxLostPart = 0.3;  // ours: of a view's corners, else the view goes
// ours: between two boards; below, focal length and distance trade
constexpr double kMinTilt = 10.0 * kDegree;
constexpr double kMaxFocalSigma = 0.02;  // ours: of the focal length
// ours: of the picture's diagonal; worse is no flat board of that pattern
constexpr double kMaxRms = 0.003;

std::string rounded(double value, int digits = 3) { return files::text_of(value, digits); }

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Distances of all corners of a view [px]; infinite where the lens shows nothing.
std::vector<double> distances_px(const BoardView& view, const AnyCamera& lens,
                                 const BoardPose& pose) {
  std::vector<double> distances;
  for (const Eigen::Vector2d& residual : residuals_px(view, lens, pose)) {
    const double distance = residual.norm();
    distances.push_back(std::isnan(distance) ? std::numeric_limits<double>::infinity() : distance);
  }
  return distances;
}

double median_distance_px(const BoardViews& views, const LensFit& fit) {
  std::vector<double> all;
  const AnyCamera lens = fit.lens();
  for (std::size_t i = 0; i < views.size(); ++i)
    for (const double distance : distances_px(views[i], lens, fit.poses[i]))
      all.push_back(distance);
  return median(std::move(all));
}

double mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return sum / static_cast<double>(std::max<std::size_t>(values.size(), 1));
}

/// The lens with the smallest median residual, each fitted so that bad corners count little.
std::optional<LensFit> most_flexible(const BoardViews& views, const LensFit& start) {
  std::optional<LensFit> best;
  double best_px = std::numeric_limits<double>::infinity();
  LensFit from = start;
  for (const LensModel model : {LensModel::kKannalaBrandt, LensModel::kBrownConrady,
                                LensModel::kDhane, LensModel::kPinhole}) {
    auto fit = fit_lens(views, as_model(from, model), kHuberPx);
    if (!fit) continue;
    const double px = median_distance_px(views, *fit);
    if (px < best_px) {
      best_px = px;
      best = *fit;
    }
    if (model == LensModel::kKannalaBrandt) from = *std::move(fit);
  }
  return best;
}

/// Views and the poses that go with them.
struct Kept {
  BoardViews views;
  LensFit fit;
};

/// Without the corners farther off than five robust standard deviations, and the views that lose
/// too many.
Kept without_outliers(const Kept& all, std::map<std::string, std::string>& reasons, bool& changed) {
  const AnyCamera lens = all.fit.lens();
  // The median distance of a two-dimensional Gauss error is 1.1774 σ.
  const double sigma_px = std::max(median_distance_px(all.views, all.fit) / 1.1774, kMinSigmaPx);
  Kept kept{.views = {}, .fit = all.fit};
  kept.fit.poses.clear();
  for (std::size_t i = 0; i < all.views.size(); ++i) {
    const BoardView& view = all.views[i];
    const auto distances = distances_px(view, lens, all.fit.poses[i]);
    BoardView good{view.image, {}};
    for (std::size_t j = 0; j < distances.size(); ++j)
      if (distances[j] <= kOutlierSigmas * sigma_px) good.corners.push_back(view.corners[j]);
    const auto lost = static_cast<double>(view.corners.size() - good.corners.size());
    changed |= lost > 0.0;
    if (lost > kMaxLostPart * static_cast<double>(view.corners.size()) ||
        good.corners.size() < kMinCorners) {
      changed = true;
      reasons[view.image] = "its corners are off by " + rounded(median(distances), 2) +
                            " px where " + rounded(sigma_px, 2) +
                            " px is usual: blurred, bent, or mistaken";
      continue;
    }
    kept.views.push_back(std::move(good));
    kept.fit.poses.push_back(all.fit.poses[i]);
  }
  return kept;
}

[[noreturn]] void refuse_few(std::size_t left, std::size_t all) {
  throw std::runtime_error(
      std::to_string(left) + " of " + std::to_string(all) + " pictures can be used, at least " +
      std::to_string(kMinViews) +
      " are needed, better 20: tilted to all sides, the board in every part of the picture");
}

/// Bad corners and bad views out, until nothing changes any more.
Kept cleaned(BoardViews views, const LensFit& start, std::map<std::string, std::string>& reasons,
             std::size_t all) {
  const auto robust = most_flexible(views, start);
  if (!robust)
    throw std::runtime_error(
        "no lens fits these corners at all: are they of one flat board, in its order?");
  Kept kept{std::move(views), *robust};
  constexpr int kMaxRounds = 5;
  bool changed = true;
  for (int round = 0; round < kMaxRounds && changed; ++round) {
    changed = false;
    kept = without_outliers(kept, reasons, changed);
    if (kept.views.size() < kMinViews || kept.views.size() * 2 < all)
      refuse_few(kept.views.size(), all);
    if (!changed) break;
    if (auto fit = fit_lens(kept.views, kept.fit, kHuberPx)) kept.fit = *std::move(fit);
  }
  return kept;
}

/// The largest angle between two boards, seen from the camera [rad].
double spread(const LensFit& fit) {
  double most = 0.0;
  std::vector<Eigen::Vector3d> normals;
  for (const BoardPose& pose : fit.poses) {
    const double angle = pose.head<3>().norm();
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    if (angle > 0.0) normal = Eigen::AngleAxisd(angle, pose.head<3>() / angle) * normal;
    if (normal.z() < 0.0) normal = -normal;  // corners counted from the other side
    for (const auto& other : normals) most = std::max(most, gatefly::acos(normal.dot(other)));
    normals.push_back(normal);
  }
  return most;
}

/// Mean squared distance of each view from a lens that it had no part in.
std::vector<double> held_out(const BoardViews& views, const LensFit& full, int folds) {
  std::vector<double> squares(views.size(), std::numeric_limits<double>::infinity());
  const auto k = static_cast<std::size_t>(folds);
  for (std::size_t fold = 0; fold < k; ++fold) {
    BoardViews rest;
    LensFit start = full;
    start.poses.clear();
    for (std::size_t i = 0; i < views.size(); ++i)
      if (i % k != fold) {
        rest.push_back(views[i]);
        start.poses.push_back(full.poses[i]);
      }
    const auto fit = fit_lens(rest, start, 1e9);  // never linear; no sigma needed
    if (!fit) continue;
    for (std::size_t i = fold; i < views.size(); i += k)
      if (const auto pose = fit_pose(views[i], *fit, full.poses[i]))
        squares[i] = mean_square(distances_px(views[i], fit->lens(), *pose));
  }
  return squares;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(std::max<std::size_t>(values.size(), 1));
}

/// Sets the named coefficients to zero and keeps them there.
void hold_at_zero(LensFit& fit, const std::vector<std::string>& zero) {
  const auto names = parameter_names(fit.model);
  for (std::size_t i = 4; i < names.size(); ++i) {
    if (names[i] == "k" || std::find(zero.begin(), zero.end(), names[i]) == zero.end()) continue;
    fit.fixed.push_back(static_cast<int>(i));
    fit.parameters[static_cast<Eigen::Index>(i)] = 0.0;
  }
}

ModelResult result_of(LensModel model, const Kept& kept, const CalibrationOptions& options) {
  ModelResult result;
  result.fit = as_model(kept.fit, model);
  hold_at_zero(result.fit, options.zero);
  const auto fit = fit_lens(kept.views, result.fit);
  if (!fit) {
    result.failure = "no minimum in front of the camera";
    return result;
  }
  result.fit = *fit;
  if (fit->sigma.size() == 0) result.failure = "these views do not determine all its parameters";
  std::vector<double> distances;
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < kept.views.size(); ++i)
    for (const double distance : distances_px(kept.views[i], fit->lens(), fit->poses[i])) {
      if (std::isinf(distance))
        ++hidden;
      else
        distances.push_back(distance);
    }
  result.rms_px = std::sqrt(mean_square(distances));
  if (!result.failure.empty()) return result;
  if (hidden > 0) {
    result.failure = "it does not show " + std::to_string(hidden) +
                     " of the corners: they are outside its field of view";
    return result;
  }
  result.held_out_px2 = held_out(kept.views, *fit, options.folds);
  result.held_out_px = std::sqrt(mean(result.held_out_px2));
  if (!std::isfinite(result.held_out_px))
    result.failure = "some held-out corners are outside its field of view";
  return result;
}

/// Index of the simplest usable model within one standard error of the best [Breiman et al.
/// 1984].
std::size_t recommended(const std::vector<ModelResult>& models) {
  std::size_t best = models.size();
  for (std::size_t i = 0; i < models.size(); ++i)
    if (models[i].failure.empty() &&
        (best == models.size() || models[i].held_out_px < models[best].held_out_px))
      best = i;
  if (best == models.size())
    throw std::runtime_error("no lens model shows all corners of these pictures");
  for (std::size_t i = 0; i < best; ++i) {
    if (!models[i].failure.empty()) continue;
    std::vector<double> worse;
    for (std::size_t v = 0; v < models[i].held_out_px2.size(); ++v)
      worse.push_back(models[i].held_out_px2[v] - models[best].held_out_px2[v]);
    const double by = mean(worse), n = static_cast<double>(worse.size());
    double variance = 0.0;
    for (const double each : worse) variance += (each - by) * (each - by) / (n - 1.0);
    if (by <= std::sqrt(variance / n)) return i;
  }
  return best;
}

/// Tells each view's outcome, in the order they were given.
void describe_views(Calibration& answer, const BoardViews& all,
                    const std::map<std::string, std::string>& reasons) {
  const AnyCamera lens = answer.best().fit.lens();
  std::size_t k = 0;
  for (const BoardView& view : all) {
    ViewResult result;
    result.image = view.image;
    result.corners = view.corners.size();
    if (k < answer.kept.size() && answer.kept[k].image == view.image) {
      const auto distances = distances_px(answer.kept[k], lens, answer.best().fit.poses[k]);
      result.dropped = view.corners.size() - answer.kept[k].corners.size();
      result.rms_px = std::sqrt(mean_square(distances));
      result.max_px = *std::max_element(distances.begin(), distances.end());
      ++k;
    } else {
      const auto reason = reasons.find(view.image);
      result.reason =
          reason == reasons.end() ? "no pose of the board explains its corners" : reason->second;
      result.dropped = view.corners.size();
    }
    answer.views.push_back(std::move(result));
  }
}

double coverage(const BoardViews& views, const Eigen::Vector2i& size_px) {
  const Eigen::Vector2d middle = 0.5 * (size_px.cast<double>() - Eigen::Vector2d::Ones());
  double most = 0.0;
  for (const BoardView& view : views)
    for (const BoardCorner& corner : view.corners)
      most = std::max(most, (corner.px - middle).norm());
  return most / middle.norm();
}

/// @throws when what came out is no camera.
void refuse_hopeless(const Calibration& answer) {
  const ModelResult& best = answer.models[answer.recommended];
  const double limit_px = kMaxRms * answer.size_px.cast<double>().norm();
  if (best.rms_px > limit_px)
    throw std::runtime_error("the best model (" + name_of(best.fit.model) + ") leaves " +
                             rounded(best.rms_px) + " px, at most " + rounded(limit_px) +
                             " px (0.3 % of the diagonal) is a calibration: is the board flat and "
                             "of that pattern, its corners in order?");
  const double angle = spread(best.fit);
  if (angle < kMinTilt)
    throw std::runtime_error("all views are alike: no two boards differ by more than " +
                             rounded(angle / kDegree) +
                             "° in direction, at least 10° is needed to tell focal length from "
                             "distance: tilt the board by 30° to all sides");
  const LensFit& fit = answer.best().fit;
  const double sigma =
      fit.sigma.size() < 2
          ? 1.0
          : (fit.sigma.head<2>().cwiseQuotient(fit.parameters.head<2>())).maxCoeff();
  if (!(sigma < kMaxFocalSigma))
    throw std::runtime_error(
        "these views do not determine the focal length of " + name_of(fit.model) +
        (sigma < 1.0 ? ": ±" + rounded(100 * sigma, 2) + " %" : std::string{}) +
        ", at most 2 % is usable: take more pictures, tilted to all sides, from different "
        "distances");
}

}  // namespace

Calibration calibrate(BoardViews all, const Eigen::Vector2i& size_px,
                      const CalibrationOptions& options) {
  if (all.size() < kMinViews) refuse_few(all.size(), all.size());
  Calibration answer;
  answer.size_px = size_px;
  std::map<std::string, std::string> reasons;

  BoardViews views = all;
  options.progress(0.0, "first guess");
  const LensFit start = first_guess(views, size_px);
  if (views.size() < kMinViews) refuse_few(views.size(), all.size());
  const Kept kept = cleaned(std::move(views), start, reasons, all.size());
  for (const LensModel model : kLensModels) {
    options.progress(0.2 + 0.2 * static_cast<double>(answer.models.size()), name_of(model));
    answer.models.push_back(result_of(model, kept, options));
  }
  answer.kept = kept.views;
  answer.recommended = answer.chosen = recommended(answer.models);
  if (options.model)
    for (std::size_t i = 0; i < answer.models.size(); ++i)
      if (answer.models[i].fit.model == *options.model) answer.chosen = i;
  if (const std::string& failure = answer.best().failure;
      !failure.empty() && answer.best().fit.sigma.size() == 0)
    throw std::runtime_error(name_of(answer.best().fit.model) + " cannot be fitted: " + failure);
  refuse_hopeless(answer);
  describe_views(answer, all, reasons);
  answer.coverage = coverage(answer.kept, size_px);
  return answer;
}

}  // namespace gatefly::calibration
