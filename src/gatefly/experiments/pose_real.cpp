// SPDX-License-Identifier: Apache-2.0
// Ours: distances to a gate that somebody measured with a tape, and a real flight against motion capture.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>

#include <Eigen/Dense>

#include "gatefly/calibration/calibration.hpp"
#include "gatefly/calibration/corner_list.hpp"
#include "gatefly/detection/careful_search.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/gate_survey.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/logged_motion.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/io/config.hpp"
#include "gatefly/io/flight_folder.hpp"
#include "gatefly/io/image_file.hpp"
#include "gatefly/io/labels_file.hpp"
#include "gatefly/io/plot.hpp"
#include "gatefly/io/text.hpp"
#include "gatefly/io/track_file.hpp"
#include "gatefly/pose/map_pose.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kLabelSigmaPx = 1.5;      // corners clicked twice differ by 2.8 px (median)
// Labels and detections are the corners of the bars' middle lines. By motion capture that square has 1.0 m (flight_11).
constexpr double kSide = 1.0;
constexpr const char* kCorners = "calib_rot_3_corners.csv";  // of the upright picture
constexpr const char* kOtherCorners = "calib_Flow_3c_corners.csv";  // of another day, as stored

/// Where the camera sits is the airframe's; the lens comes from the calibration.
io::Config config_with(const std::string& name) {
  std::vector<std::filesystem::path> files = io::config_files(std::vector<std::string>{name});
  files.push_back(io::find_toml("bebop-brown", "cameras"));
  const std::vector<std::string> settings{"gate.corners=middle"};
  return io::load_config(files, settings);
}

/// As `gatefly calibrate` has it. @param rotation_deg  how the listed pictures are stored.
calibration::Calibration calibrated(const char* corners, int rotation_deg, const Options& options) {
  const Eigen::Vector2i upright{315, 160}, stored = rotation_deg == 0 ? upright : Eigen::Vector2i{160, 315};
  calibration::BoardViews views = calibration::read_corner_list(data_folder("fisheye_calibration", options) / "bebop_front_camera" / corners);
  calibration::turn_upright(views, stored, rotation_deg);
  return calibration::calibrate(std::move(views), upright);
}

AnyCamera lens_of(const calibration::ModelResult& result) { return calibration::lens_of(result.fit.model, result.fit.parameters); }

// ---------------------------------------------------------------- distance51

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

double deviation(const std::vector<double>& values) { return std::sqrt(covariance(values, values)); }

/// Half of the 95 % interval of the mean, by Student's t for 10 values.
double half_interval(const std::vector<double>& values) { return 2.26 * deviation(values) / std::sqrt(static_cast<double>(values.size())); }

/// A gate at a distance that somebody measured, by its labels and by the detector that flies.
struct MeasuredGate {
  double distance;  ///< [m]
  Quad label;
  std::optional<Quad> detection;
};

std::vector<MeasuredGate> measured_gates(const std::filesystem::path& folder, const io::Config& config) {
  constexpr double kSamePx = 15.0;  // a second gate stands at the right
  const auto search = std::make_unique<CarefulSearch>(config.pilot.detector);
  std::vector<MeasuredGate> gates;
  for (const io::LabelledPicture& picture : io::read_labels(folder / "labels.csv").pictures) {
    if (picture.gates.empty() || !std::isfinite(picture.true_distance)) continue;
    gates.push_back({picture.true_distance, clockwise_from_top_left(picture.gates.front()), {}});
    const io::ImageFile file = io::read_image(folder / picture.image);
    for (const GateDetection& found : search->detect(file.view(config.stored_rotation_deg), config.pilot.gate_color))
      if ((center(found.corners_px) - center(gates.back().label)).norm() < kSamePx) gates.back().detection = clockwise_from_top_left(found.corners_px);
  }
  return gates;
}

/// Nobody logged an attitude: level within 15° is all that is assumed.
std::optional<MapPose> pose_of(const Quad& px, const CameraRig& rig, double side) {
  GateObservations seen;
  add_corners(seen, px, side, kLabelSigmaPx);
  return map_pose(seen, {.roll_sigma = 15 * kDegree, .pitch_sigma = 15 * kDegree, .yaw_sigma = 15 * kDegree}, rig).pose;
}

/// Answers at one measured distance, in the order of the pictures.
struct Distances {
  std::vector<double> map, pnp, reported;
  std::vector<double> from_both_label, from_both_detection;  ///< Of the pictures that have an answer from both.

  /// By how much labels and detections agree that the drone was nearer or farther: it was held by hand [m].
  [[nodiscard]] double moved() const {
    return from_both_label.size() < 3 ? 0.0 : std::sqrt(std::max(0.0, covariance(from_both_label, from_both_detection)));
  }
};
using AllDistances = std::map<double, Distances>;

AllDistances distances_of(const std::vector<MeasuredGate>& gates, const CameraRig& rig) {
  AllDistances found;
  for (const MeasuredGate& gate : gates) {
    Distances& at = found[gate.distance];
    const auto pose = pose_of(gate.label, rig, kSide);
    if (pose) at.map.push_back(pose->p_GB.norm()), at.reported.push_back(std::sqrt(pose->covariance(0, 0)));
    if (const auto camera = by_pnp(Pnp::kIppe, gate.label, rig, kSide)) at.pnp.push_back(camera->norm() + rig.p_BC.x());
    const auto other = gate.detection ? pose_of(*gate.detection, rig, kSide) : std::nullopt;
    if (pose && other) at.from_both_label.push_back(pose->p_GB.norm()), at.from_both_detection.push_back(other->p_GB.norm());
  }
  return found;
}

/// Straight line through the mean errors over the distance: what it grows by, and its standard deviation.
/// Each mean is as doubtful as the drone's place was: those of one distance share it.
struct Slope {
  double per_m, sigma, chi2;  ///< chi2 of the means about the line, 3 degrees of freedom.
};

Slope slope_of(const std::map<double, double>& errors, const std::map<double, double>& sigmas) {
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  for (const auto& [d, error] : errors) {
    const Eigen::Vector2d row{1.0, d};
    A += row * row.transpose() / std::pow(sigmas.at(d), 2), b += row * error / std::pow(sigmas.at(d), 2);
  }
  const Eigen::Vector2d line = A.inverse() * b;
  double chi2 = 0.0;
  for (const auto& [d, error] : errors) chi2 += std::pow((error - line.x() - line.y() * d) / sigmas.at(d), 2);
  return {line.y(), std::sqrt(A.inverse()(1, 1)), chi2};
}

/// What the slope could come from: the same pictures, one thing changed.
struct Hypothesis {
  std::string what;
  AnyCamera lens;
  double side = kSide, outwards_px = 0.0;
  bool detections = false;
};

Quad moved_outwards(Quad px, double by_px) {
  const Eigen::Vector2d middle = center(px);
  for (Eigen::Vector2d& corner : px) corner += std::sqrt(2.0) * by_px * (corner - middle).normalized();
  return px;
}

std::map<double, double> mean_errors(const std::vector<MeasuredGate>& gates, CameraRig rig, const Hypothesis& h) {
  rig.lens = h.lens;
  std::map<double, std::vector<double>> errors;
  for (const MeasuredGate& gate : gates) {
    if (h.detections && !gate.detection) continue;
    const auto pose = pose_of(moved_outwards(h.detections ? *gate.detection : gate.label, h.outwards_px), rig, h.side);
    if (pose) errors[gate.distance].push_back(pose->p_GB.norm() - gate.distance);
  }
  std::map<double, double> means;
  for (const auto& [distance, values] : errors) means[distance] = mean(values);
  return means;
}

void report_slopes(const std::vector<MeasuredGate>& gates, const CameraRig& rig, const AllDistances& found,
                   const std::vector<Hypothesis>& hypotheses, Result& result) {
  std::map<double, double> sigmas;
  for (const auto& [distance, at] : found) sigmas[distance] = std::hypot(at.moved(), half_interval(at.map) / 2.26);
  auto list = nlohmann::ordered_json::array();
  for (const Hypothesis& h : hypotheses) {
    const std::map<double, double> errors = mean_errors(gates, rig, h);
    const Slope slope = slope_of(errors, sigmas);
    std::string text;
    for (const auto& [distance, error] : errors) text += fixed(error, 2) + " ";
    result.table.push_back({"  errors [m], slope: " + h.what, "0", text + "m, " + fixed(100.0 * slope.per_m, 1) + " ± " + fixed(100.0 * slope.sigma, 1) + " cm/m"});
    list.push_back({{"what", h.what}, {"slope", slope.per_m}, {"slope_sigma", slope.sigma}, {"chi2", slope.chi2}});
  }
  result.json["distance51"]["slopes"] = list;
}

std::string mean_and_spread(const std::vector<double>& values) {
  if (values.size() < 2) return "-";
  return fixed(mean(values), 2) + " ± " + fixed(half_interval(values), 2) + " (std " + fixed(deviation(values), 2) + ")";
}

io::PlotSeries errors_over_distance(const std::string& name, const AllDistances& found, std::vector<double> Distances::* answers, const io::Color& color, double aside) {
  io::PlotSeries out{.name = name, .points = {}, .color = color, .line = false};
  for (const auto& [truth, at] : found)
    for (const double d : at.*answers) out.points.emplace_back(truth + aside, d - truth);
  return out;
}

io::Plot plotted(const AllDistances& found) {
  constexpr double kAside = 0.06;
  return {.title = "distance51: our distance minus the tape's, picture by picture", .x_label = "distance by tape [m]", .y_label = "[m]",
          .series = {errors_over_distance("from labels", found, &Distances::from_both_label, io::look::kGate, -kAside),
                     errors_over_distance("from detections", found, &Distances::from_both_detection, io::look::kDetection, kAside)},
          .y_from_0 = false};
}

io::Plot report_distances(const Options& options, const calibration::Calibration& camera, Result& result) {
  const io::Config config = config_with("cyberzoo");
  const std::vector<MeasuredGate> gates = measured_gates(data_folder("tudelft_bebop_gates", options) / "distance51", config);
  CameraRig rig = config.pilot.camera;
  rig.lens = lens_of(camera.best());
  const AllDistances distances = distances_of(gates, rig);
  auto list = nlohmann::ordered_json::array();
  for (const auto& [truth, found] : distances) {
    result.table.push_back({"distance51, " + io::text_of(truth) + " m: PnP, ours; the drone moved", mean_and_spread(found.pnp),
                            mean_and_spread(found.map) + "; " + fixed(found.moved(), 2)});
    list.push_back({{"true_m", truth}, {"pictures", found.map.size()}, {"mean_m", mean(found.map)}, {"half_interval_m", half_interval(found.map)},
                    {"std_m", deviation(found.map)}, {"moved_std_m", found.moved()}, {"reported_std_m", mean(found.reported)},
                    {"pnp_mean_m", found.pnp.empty() ? nlohmann::ordered_json(nullptr) : number(mean(found.pnp))},
                    {"pnp_std_m", found.pnp.size() < 2 ? nlohmann::ordered_json(nullptr) : number(deviation(found.pnp))}});
  }
  result.json["distance51"] = {{"camera", calibration::name_of(camera.best().fit.model)}, {"corners", kCorners}, {"side_m", kSide}, {"distances", list}};
  const auto dhane = std::find_if(camera.models.begin(), camera.models.end(), [](const auto& m) { return m.fit.model == calibration::LensModel::kDhane; });
  report_slopes(gates, rig, distances,
                {{.what = "labels", .lens = rig.lens},
                 {.what = "detections", .lens = rig.lens, .detections = true},
                 {.what = "calibrated on the other list", .lens = lens_of(calibrated(kOtherCorners, 90, options).best())},
                 {.what = "Dhane's lens", .lens = lens_of(*dhane)},
                 {.what = "the authors' camera", .lens = config.pilot.camera.lens},
                 {.what = "side 1.05 m", .lens = rig.lens, .side = 1.05},
                 {.what = "corners 0.5 px farther out", .lens = rig.lens, .outwards_px = 0.5}},
                result);
  return plotted(distances);
}

// ---------------------------------------------------------------- flight_11

/// Labels or detections of one gate, and what the recording does not say: fitted once to the labels of all pictures taken
/// in the air.
struct Flown {
  LoggedMotion motion;
  PilotConfig pilot;
  Survey setup;

  [[nodiscard]] const SurveyedGate& gate() const { return setup.gates.front(); }
  [[nodiscard]] double exposed(const GatePicture& picture) const { return exposed_at(picture, setup.airframe, pilot); }
  [[nodiscard]] Attitude attitude_GB(const GatePicture& picture) const {
    Attitude attitude = motion.attitude(exposed(picture));
    attitude.yaw = wrap_angle(attitude.yaw + setup.flights.front().heading - gate().yaw);
    return attitude;
  }
  [[nodiscard]] Eigen::Vector3d true_p_GB(const GatePicture& picture) const {
    return rotation_z(-gate().yaw) * (motion.position(exposed(picture) + setup.airframe.mocap_delay) - gate().p_EG);
  }
};

Survey fitted(const LoggedMotion& motion, const std::vector<GatePicture>& pictures, PilotConfig pilot, double side) {
  pilot.track.gates.front().side = side;
  const MapGate& gate = pilot.track.gates.front();
  const Survey start{.airframe = {}, .gates = {{gate.p_EG, gate.yaw_EG}}, .flights = {{.heading = 11.5 * kDegree, .tilt = 13.2 * kDegree}}};
  const SurveyFlight seen{.motion = &motion, .pictures = pictures, .gate = 0};
  return surveyed({&seen, 1}, start, Open::kAll, pilot);
}

/// Of u and v of all corners [px].
double rms_px(const Flown& flown, const std::vector<GatePicture>& pictures) {
  const SurveyFlight seen{.motion = &flown.motion, .pictures = {}, .gate = 0};
  double squares = 0.0;
  for (const GatePicture& picture : pictures) squares += std::pow(misfit_px(flown.setup, 0, seen, picture, flown.pilot), 2);
  return std::sqrt(squares / (2.0 * static_cast<double>(pictures.size())));
}

double rms_px_with_side(Flown flown, const std::vector<GatePicture>& pictures, double side) {
  flown.pilot.track.gates.front().side = side;
  flown.setup = fitted(flown.motion, pictures, flown.pilot, side);
  return rms_px(flown, pictures);
}

/// Where the parabola through the misfits of three sides is least [m].
double best_side(const Flown& flown, const std::vector<GatePicture>& pictures) {
  constexpr double kStep = 0.05;
  const auto cost = [&](double side) { return std::pow(rms_px_with_side(flown, pictures, side), 2); };
  const double less = cost(kSide - kStep), here = cost(kSide), more = cost(kSide + kStep);
  return kSide + 0.5 * kStep * (less - more) / (less - 2.0 * here + more);
}

/// Errors of our pose over some frames.
struct FlightErrors {
  Rmse map, rays;
  double nees = 0.0;
  std::vector<Eigen::Vector3d> found, truth;
};

FlightErrors errors_of(const Flown& flown, const std::vector<GatePicture>& pictures, double sigma_px) {
  const CameraRig rig = mounted(flown.pilot.camera, flown.setup.airframe, flown.setup.flights.front());
  FlightErrors errors;
  for (const GatePicture& picture : pictures) {
    const Eigen::Vector3d p_GB = flown.true_p_GB(picture);
    const Attitude attitude = flown.attitude_GB(picture);
    GateObservations seen;
    add_corners(seen, picture.px, kSide, sigma_px);
    const auto answer = map_pose(seen, {.attitude_GB = attitude}, rig);
    errors.map.add(answer.pose ? std::optional{answer.pose->p_GB} : std::nullopt, p_GB);
    errors.rays.add(by_rays(picture.px, attitude, rig, kSide), p_GB);
    if (!answer.pose) continue;
    const Eigen::Vector3d error = answer.pose->p_GB - p_GB;
    const Eigen::Matrix3d P = answer.pose->covariance.topLeftCorner<3, 3>();
    errors.nees += error.dot(P.inverse() * error);
    errors.found.push_back(answer.pose->p_GB), errors.truth.push_back(p_GB);
  }
  return errors;
}

/// In pictures taken in the air: by label, and by the detector that flies.
struct Seen {
  std::vector<GatePicture> labels, detections;
};

Seen seen_in_flight(const io::FlightFolder& flight, const io::Config& config) {
  constexpr std::size_t kFirst = 18;  // before it the drone stands on the ground
  const io::Labels labels = io::read_labels(flight.directory / "labels.csv");
  const auto search = std::make_unique<CarefulSearch>(config.pilot.detector);
  Seen seen;
  for (std::size_t i = kFirst; i < flight.images.size(); ++i)
    for (const io::LabelledPicture& picture : labels.pictures) {
      if (picture.image != flight.images[i].path.filename().string() || picture.gates.empty()) continue;
      const double t = std::chrono::duration<double>(flight.images[i].time).count();
      seen.labels.push_back({t, picture.gates.front()});
      const io::ImageFile file = io::read_image(flight.images[i].path);
      const GateDetections gates = search->detect(file.view(config.stored_rotation_deg), config.pilot.gate_color);
      if (!gates.empty()) seen.detections.push_back({t, clockwise_from_top_left(gates[0].corners_px)});
    }
  if (seen.labels.empty()) throw std::runtime_error("flight_11/labels.csv: labels no picture taken in the air");
  return seen;
}

std::string per_axis(const FlightErrors& errors) {
  return "x " + fixed(errors.map.axis(0), 3) + ", y " + fixed(errors.map.axis(1), 3) + ", z " + fixed(errors.map.axis(2), 3) + " m of " +
         std::to_string(errors.map.n) + " (rays " + fixed(errors.rays.axis(0), 3) + ", " + fixed(errors.rays.axis(1), 3) + ")";
}

nlohmann::ordered_json json_of(const FlightErrors& errors) {
  return {{"frames", errors.map.n}, {"refused", errors.map.none}, {"rmse_x_m", number(errors.map.axis(0))}, {"rmse_y_m", number(errors.map.axis(1))},
          {"rmse_z_m", number(errors.map.axis(2))}, {"rays_rmse_x_m", number(errors.rays.axis(0))}, {"rays_rmse_y_m", number(errors.rays.axis(1))},
          {"nees_per_axis", number(errors.nees / (3.0 * errors.map.n))}};
}

io::PlotSeries series(const std::string& name, const std::vector<Eigen::Vector3d>& points, const io::Color& color, bool line, bool rings) {
  io::PlotSeries out{.name = name, .points = {}, .color = color, .line = line, .rings = rings};
  for (const Eigen::Vector3d& p : points) out.points.emplace_back(p.x(), p.y());
  return out;
}

void add_rows(const std::string& from, const FlightErrors& errors, std::string& csv) {
  for (std::size_t i = 0; i < errors.found.size(); ++i) {
    csv += from;
    for (const Eigen::Vector3d& p : {errors.truth[i], errors.found[i]})
      for (const double v : p) csv += "," + io::text_of(v, 5);
    csv += "\n";
  }
}

io::Plot report_flight(const Options& options, const calibration::Calibration& camera, Result& result) {
  const io::FlightFolder flight = io::read_flight_folder(data_folder("tudelft_bebop_flights", options) / "flight_11");
  const io::Config config = config_with("flights");
  const Seen seen = seen_in_flight(flight, config);
  Flown flown{.motion = LoggedMotion(flight), .pilot = config.pilot, .setup = {}};
  flown.pilot.camera.lens = lens_of(camera.best());
  flown.pilot.track = io::read_track(io::find_track("flights")).track;
  flown.setup = fitted(flown.motion, seen.labels, flown.pilot, kSide);
  const FlightErrors labels = errors_of(flown, seen.labels, kLabelSigmaPx);
  const FlightErrors detections = errors_of(flown, seen.detections, config.pilot.pose.corner_sigma_px);

  result.table.push_back({"flight_11, labels", "<= 0.12 m", per_axis(labels)});
  result.table.push_back({"flight_11, detections", "<= 0.20 m", per_axis(detections)});
  const auto& [airframe, gates, flights] = flown.setup;
  const Eigen::Vector3d& p_EG = gates.front().p_EG;
  const double misfit = rms_px(flown, seen.labels), side = best_side(flown, seen.labels);
  result.table.push_back({"  fitted once to the labels", "-",
                          "gate " + fixed(p_EG.x(), 2) + ", " + fixed(p_EG.y(), 2) + ", " + fixed(p_EG.z(), 2) + " m, turned " +
                              fixed(gates.front().yaw / kDegree, 1) + "°; heading " + fixed(flights.front().heading / kDegree, 1) + "°; tilt " +
                              fixed(flights.front().tilt / kDegree, 1) + "°, roll " + fixed(airframe.camera_roll / kDegree, 1) + "°; pictures " +
                              fixed(1e3 * airframe.exposure_delay, 0) + " ms late, positions " + fixed(1e3 * airframe.mocap_delay, 0) + " ms; " +
                              fixed(misfit, 2) + " px RMS; best with a side of " + fixed(side, 3) + " m"});
  result.json["flight_11"] = {{"camera", calibration::name_of(camera.best().fit.model)}, {"labels", json_of(labels)}, {"detections", json_of(detections)},
                              {"fitted", {{"gate_m", {p_EG.x(), p_EG.y(), p_EG.z()}}, {"gate_yaw_deg", gates.front().yaw / kDegree},
                                          {"heading_offset_deg", flights.front().heading / kDegree}, {"tilt_deg", flights.front().tilt / kDegree},
                                          {"camera_roll_deg", airframe.camera_roll / kDegree}, {"exposure_delay_ms", 1e3 * airframe.exposure_delay},
                                          {"mocap_delay_ms", 1e3 * airframe.mocap_delay}, {"rms_px", misfit}}},
                              {"best_side_m", side}};
  add_rows("labels", labels, result.csv), add_rows("detections", detections, result.csv);
  return {.title = "flight_11 before the gate: motion capture and our pose from single pictures",
          .x_label = "x, through the gate [m]", .y_label = "y, to the right [m]",
          .series = {series("motion capture", labels.truth, io::look::kInk, true, false), series("from labels", labels.found, io::look::kGate, false, true),
                     series("from detections", detections.found, io::look::kDetection, false, false)},
          .y_from_0 = false};
}

}  // namespace

Result pose_real(const Options& options) {
  Result result{.table = {}, .json = {}, .csv = "from,true_x_m,true_y_m,true_z_m,x_m,y_m,z_m\n", .picture = io::Canvas(1, 1)};
  if (options.stopped()) throw Stopped{};
  constexpr int kWidth = 960, kHeight = 500;
  const calibration::Calibration camera = calibrated(kCorners, 0, options);
  const io::Plot distances = report_distances(options, camera, result);
  options.progress(0.2, "flight_11");
  if (options.stopped()) throw Stopped{};
  const io::Plot flight = report_flight(options, camera, result);
  result.picture = io::Canvas(kWidth, 2 * kHeight);
  result.picture.paste(io::draw(distances, kWidth, kHeight), {0.0, 0.0});
  result.picture.paste(io::draw(flight, kWidth, kHeight), {0.0, static_cast<double>(kHeight)});
  return result;
}

}  // namespace gatefly::experiments
