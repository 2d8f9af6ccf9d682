// SPDX-License-Identifier: Apache-2.0
// Distances to a gate that somebody measured with a tape.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/LU>

#include "gatefly/detection/search/careful_search.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/pose_real.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/labels_file.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/pose/map_pose.hpp"

namespace gatefly::experiments::pose_real_parts {
namespace {

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double covariance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean(a)) * (b[i] - mean(b));
  return sum / static_cast<double>(a.size() - 1);
}

double deviation(const std::vector<double>& values) {
  return std::sqrt(covariance(values, values));
}

/// Half of the 95 % interval of the mean, by Student's t for 10 values.
double half_interval(const std::vector<double>& values) {
  return 2.26 * deviation(values) / std::sqrt(static_cast<double>(values.size()));
}

/// A gate at a distance that somebody measured, by its labels and by the detector that flies.
struct MeasuredGate {
  double distance;  ///< [m]
  Quad label;
  std::optional<Quad> detection;
};

std::vector<MeasuredGate> measured_gates(const std::filesystem::path& folder,
                                         const config::Config& config) {
  constexpr double kSamePx = 15.0;  // a second gate stands at the right
  const auto search = std::make_unique<CarefulSearch>(config.pilot.detector);
  std::vector<MeasuredGate> gates;
  for (const files::LabelledPicture& picture : files::read_labels(folder / "labels.csv").pictures) {
    if (picture.gates.empty() || !std::isfinite(picture.true_distance)) continue;
    gates.push_back({picture.true_distance, clockwise_from_top_left(picture.gates.front()), {}});
    const files::ImageFile file = files::read_image(folder / picture.image);
    for (const GateDetection& found :
         search->detect(file.view(config.camera.stored_rotation_deg), config.pilot.gate_color))
      if ((center(found.corners_px) - center(gates.back().label)).norm() < kSamePx)
        gates.back().detection = clockwise_from_top_left(found.corners_px);
  }
  return gates;
}

/// Nobody logged an attitude: level within 15° is all that is assumed.
std::optional<MapPose> pose_of(const Quad& px, const CameraRig& rig, double side) {
  GateObservations seen;
  add_corners(seen, px, side, kLabelSigmaPx);
  return map_pose(
             seen,
             {.roll_sigma = 15 * kDegree, .pitch_sigma = 15 * kDegree, .yaw_sigma = 15 * kDegree},
             rig)
      .pose;
}

/// Answers at one measured distance, in the order of the pictures.
struct Distances {
  std::vector<double> map, pnp, reported;
  /// Distances of the pictures that have an answer from both.
  std::vector<double> from_both_label, from_both_detection;

  /// By how much labels and detections agree that the drone was nearer or farther: it was held by
  /// hand [m].
  [[nodiscard]] double moved() const {
    return from_both_label.size() < 3
               ? 0.0
               : std::sqrt(std::max(0.0, covariance(from_both_label, from_both_detection)));
  }
};
using AllDistances = std::map<double, Distances>;

AllDistances distances_of(const std::vector<MeasuredGate>& gates, const CameraRig& rig) {
  AllDistances found;
  for (const MeasuredGate& gate : gates) {
    Distances& at = found[gate.distance];
    const auto pose = pose_of(gate.label, rig, kSide);
    if (pose)
      at.map.push_back(pose->p_GB.norm()), at.reported.push_back(std::sqrt(pose->covariance(0, 0)));
    if (const auto camera = by_pnp(Pnp::kIppe, gate.label, rig, kSide))
      at.pnp.push_back(camera->norm() + rig.p_BC.x());
    const auto other = gate.detection ? pose_of(*gate.detection, rig, kSide) : std::nullopt;
    if (pose && other)
      at.from_both_label.push_back(pose->p_GB.norm()),
          at.from_both_detection.push_back(other->p_GB.norm());
  }
  return found;
}

/// Straight line through the mean errors over the distance: what it grows by, and its standard
/// deviation. Each mean is as uncertain as the drone's place was: those of one distance share it.
struct Slope {
  double per_m, sigma, chi2;  ///< chi2 of the means about the line, 3 degrees of freedom.
};

Slope slope_of(const std::map<double, double>& errors, const std::map<double, double>& sigmas) {
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  for (const auto& [d, error] : errors) {
    const Eigen::Vector2d row{1.0, d};
    A += row * row.transpose() / std::pow(sigmas.at(d), 2),
        b += row * error / std::pow(sigmas.at(d), 2);
  }
  const Eigen::Vector2d line = A.inverse() * b;
  double chi2 = 0.0;
  for (const auto& [d, error] : errors)
    chi2 += std::pow((error - line.x() - line.y() * d) / sigmas.at(d), 2);
  return {line.y(), std::sqrt(A.inverse()(1, 1)), chi2};
}

/// A possible cause of the slope: the same pictures, one thing changed.
struct Hypothesis {
  std::string what;
  AnyCamera lens;
  double side = kSide, outwards_px = 0.0;
  bool detections = false;
};

Quad moved_outwards(Quad px, double by_px) {
  const Eigen::Vector2d middle = center(px);
  for (Eigen::Vector2d& corner : px)
    corner += std::sqrt(2.0) * by_px * (corner - middle).normalized();
  return px;
}

std::map<double, double> mean_errors(const std::vector<MeasuredGate>& gates, CameraRig rig,
                                     const Hypothesis& h) {
  rig.lens = h.lens;
  std::map<double, std::vector<double>> errors;
  for (const MeasuredGate& gate : gates) {
    if (h.detections && !gate.detection) continue;
    const auto pose = pose_of(
        moved_outwards(h.detections ? *gate.detection : gate.label, h.outwards_px), rig, h.side);
    if (pose) errors[gate.distance].push_back(pose->p_GB.norm() - gate.distance);
  }
  std::map<double, double> means;
  for (const auto& [distance, values] : errors) means[distance] = mean(values);
  return means;
}

void report_slopes(const std::vector<MeasuredGate>& gates, const CameraRig& rig,
                   const AllDistances& found, const std::vector<Hypothesis>& hypotheses,
                   Result& result) {
  std::map<double, double> sigmas;
  for (const auto& [distance, at] : found)
    sigmas[distance] = std::hypot(at.moved(), half_interval(at.map) / 2.26);
  auto list = nlohmann::ordered_json::array();
  for (const Hypothesis& h : hypotheses) {
    const std::map<double, double> errors = mean_errors(gates, rig, h);
    const Slope slope = slope_of(errors, sigmas);
    std::string text;
    for (const auto& [distance, error] : errors) text += fixed(error, 2) + " ";
    result.table.push_back({"  errors [m], slope: " + h.what, "0",
                            text + "m, " + fixed(100.0 * slope.per_m, 1) + " ± " +
                                fixed(100.0 * slope.sigma, 1) + " cm/m"});
    list.push_back({{"what", h.what},
                    {"slope", slope.per_m},
                    {"slope_sigma", slope.sigma},
                    {"chi2", slope.chi2}});
  }
  result.json["distance51"]["slopes"] = list;
}

std::string mean_and_spread(const std::vector<double>& values) {
  if (values.size() < 2) return "-";
  return fixed(mean(values), 2) + " ± " + fixed(half_interval(values), 2) + " (std " +
         fixed(deviation(values), 2) + ")";
}

drawing::PlotSeries errors_over_distance(const std::string& name, const AllDistances& found,
                                         std::vector<double> Distances::*answers,
                                         const drawing::Color& color, double aside) {
  drawing::PlotSeries out{.name = name, .points = {}, .color = color, .line = false};
  for (const auto& [truth, at] : found)
    for (const double d : at.*answers) out.points.emplace_back(truth + aside, d - truth);
  return out;
}

drawing::Plot plotted(const AllDistances& found) {
  constexpr double kAside = 0.06;
  return {.title = "Distance to a gate (distance51), picture by picture",
          .x_label = "distance by tape [m]",
          .y_label = "ours - tape [m]",
          .series = {errors_over_distance("from labels", found, &Distances::from_both_label,
                                          drawing::kLight.gate_solid, -kAside),
                     errors_over_distance("from detections", found, &Distances::from_both_detection,
                                          drawing::kLight.found, kAside)},
          .y_from_0 = false};
}

}  // namespace

drawing::Plot report_distances(const Options& options, const calibration::Calibration& camera,
                               Result& result) {
  const config::Config config = config_with("cyberzoo");
  const std::vector<MeasuredGate> gates =
      measured_gates(data_folder("tudelft_bebop_gates", options) / "distance51", config);
  CameraRig rig = config.pilot.camera;
  rig.lens = lens_of(camera.best());
  const AllDistances distances = distances_of(gates, rig);
  auto list = nlohmann::ordered_json::array();
  for (const auto& [truth, found] : distances) {
    result.table.push_back(
        {"distance51, " + files::text_of(truth) + " m: PnP, ours; the drone moved",
         mean_and_spread(found.pnp), mean_and_spread(found.map) + "; " + fixed(found.moved(), 2)});
    list.push_back({{"true_m", truth},
                    {"pictures", found.map.size()},
                    {"mean_m", mean(found.map)},
                    {"half_interval_m", half_interval(found.map)},
                    {"std_m", deviation(found.map)},
                    {"moved_std_m", found.moved()},
                    {"reported_std_m", mean(found.reported)},
                    {"pnp_mean_m",
                     found.pnp.empty() ? nlohmann::ordered_json(nullptr) : number(mean(found.pnp))},
                    {"pnp_std_m", found.pnp.size() < 2 ? nlohmann::ordered_json(nullptr)
                                                       : number(deviation(found.pnp))}});
  }
  result.json["distance51"] = {{"camera", calibration::name_of(camera.best().fit.model)},
                               {"corners", kCorners},
                               {"side_m", kSide},
                               {"distances", list}};
  const auto dhane = std::find_if(camera.models.begin(), camera.models.end(), [](const auto& m) {
    return m.fit.model == calibration::LensModel::kDhane;
  });
  report_slopes(gates, rig, distances,
                {{.what = "labels", .lens = rig.lens},
                 {.what = "detections", .lens = rig.lens, .detections = true},
                 {.what = "calibrated on the other list",
                  .lens = lens_of(calibrated(kOtherCorners, 90, options).best())},
                 {.what = "Dhane's lens", .lens = lens_of(*dhane)},
                 {.what = "the authors' camera", .lens = config.pilot.camera.lens},
                 {.what = "side 1.05 m", .lens = rig.lens, .side = 1.05},
                 {.what = "corners 0.5 px farther out", .lens = rig.lens, .outwards_px = 0.5}},
                result);
  return plotted(distances);
}

}  // namespace gatefly::experiments::pose_real_parts
