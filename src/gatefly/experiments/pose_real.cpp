// SPDX-License-Identifier: Apache-2.0
// Ours: distances to a gate that somebody measured with a tape, and a real flight against motion capture.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>

#include <Eigen/Dense>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include "gatefly/detection/careful_search.hpp"
#include "gatefly/experiments/experiment.hpp"
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
#include "gatefly/pose/map_pose.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kLabelSigmaPx = 1.5;      // corners clicked twice differ by 2.8 px (median)
// Labels and detections are the corners of the bars' middle lines. By motion capture that square has 1.0 m.
constexpr double kSide = 1.0;
constexpr const char* kCamera = "bebop-brown";  // nothing of it comes from the pictures used here

io::Config config_with(const std::string& name) {
  std::vector<std::filesystem::path> files = io::config_files(std::vector<std::string>{name});
  files.push_back(io::find_toml(kCamera, "cameras"));
  const std::vector<std::string> settings{"gate.corners=middle"};
  return io::load_config(files, settings);
}

// ---------------------------------------------------------------- distance51

/// Answers at one measured distance.
struct Distances {
  std::vector<double> map, pnp, reported;
};

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double deviation(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += std::pow(v - mean(values), 2);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

/// Half of the 95 % interval of the mean, by Student's t for 10 values.
double half_interval(const std::vector<double>& values) { return 2.26 * deviation(values) / std::sqrt(static_cast<double>(values.size())); }

/// Nobody logged an attitude: level within 15° is all that is assumed.
std::map<double, Distances> distances_in(const io::Labels& labels, const CameraRig& rig) {
  std::map<double, Distances> found;
  for (const io::LabelledPicture& picture : labels.pictures) {
    if (picture.gates.empty() || !std::isfinite(picture.true_distance)) continue;
    const Quad px = clockwise_from_top_left(picture.gates.front());
    Distances& at = found[picture.true_distance];
    GateObservations seen;
    add_corners(seen, px, kSide, kLabelSigmaPx);
    const auto answer = map_pose(seen, {.roll_sigma = 15 * kDegree, .pitch_sigma = 15 * kDegree, .yaw_sigma = 15 * kDegree}, rig);
    if (answer.pose) {
      at.map.push_back(answer.pose->p_GB.norm());
      at.reported.push_back(std::sqrt(answer.pose->covariance(0, 0)));
    }
    if (const auto camera = by_pnp(Pnp::kIppe, px, rig, kSide)) at.pnp.push_back(camera->norm() + rig.p_BC.x());
  }
  return found;
}

std::string mean_and_spread(const std::vector<double>& values) {
  if (values.size() < 2) return "-";
  return fixed(mean(values), 2) + " ± " + fixed(half_interval(values), 2) + " (std " + fixed(deviation(values), 2) + ")";
}

void report_distances(const Options& options, Result& result) {
  const io::Labels labels = io::read_labels(data_folder("tudelft_bebop_gates", options) / "distance51" / "labels.csv");
  const io::Config config = config_with("cyberzoo");
  auto list = nlohmann::ordered_json::array();
  for (const auto& [truth, found] : distances_in(labels, config.pilot.camera)) {
    result.table.push_back({"distance51, " + io::text_of(truth) + " m: PnP, ours", mean_and_spread(found.pnp), mean_and_spread(found.map)});
    list.push_back({{"true_m", truth}, {"pictures", found.map.size()}, {"mean_m", mean(found.map)}, {"half_interval_m", half_interval(found.map)},
                    {"std_m", deviation(found.map)}, {"reported_std_m", mean(found.reported)},
                    {"pnp_mean_m", found.pnp.empty() ? nlohmann::ordered_json(nullptr) : number(mean(found.pnp))},
                    {"pnp_std_m", found.pnp.size() < 2 ? nlohmann::ordered_json(nullptr) : number(deviation(found.pnp))}});
  }
  result.json["distance51"] = {{"camera", kCamera}, {"side_m", kSide}, {"distances", list}};
}

// ---------------------------------------------------------------- flight_11

/// What the recording does not say; fitted once to the labelled corners of all pictures taken in the air.
struct Setup {
  Eigen::Vector3d gate_E{4.15, 0.73, -1.36};
  double gate_yaw = 0.0, heading_offset = 11.5 * kDegree;
  double tilt = 13.2 * kDegree, camera_roll = 0.0;
  double time_offset = -0.019;  ///< Of the truth against the picture's stamp [s].
};
using Unknowns = Eigen::Matrix<double, 8, 1>;

Setup setup_of(const Eigen::VectorXd& x) {
  return {.gate_E = x.head<3>(), .gate_yaw = x(3), .heading_offset = x(4), .tilt = x(5), .camera_roll = x(6), .time_offset = x(7)};
}
Unknowns unknowns_of(const Setup& s) {
  Unknowns x;
  x << s.gate_E, s.gate_yaw, s.heading_offset, s.tilt, s.camera_roll, s.time_offset;
  return x;
}

struct Frame {
  std::string image;
  double t;
  Quad px;
};

CameraRig rig_of(CameraRig rig, const Setup& setup) {
  rig.R_BC = camera_mount(setup.tilt, setup.camera_roll);
  return rig;
}

Attitude attitude_GB(const LoggedMotion& track, const Frame& frame, const Setup& setup) {
  Attitude attitude = track.attitude(frame.t + setup.time_offset);
  attitude.yaw = wrap_angle(attitude.yaw + setup.heading_offset - setup.gate_yaw);
  return attitude;
}

Eigen::Vector3d true_p_GB(const LoggedMotion& track, const Frame& frame, const Setup& setup) {
  return rotation_z(-setup.gate_yaw) * (track.position(frame.t + setup.time_offset) - setup.gate_E);
}

/// Errors of all labelled corners as a function of the setup, for Eigen's Levenberg-Marquardt.
struct Residuals {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  const LoggedMotion& track;
  const std::vector<Frame>& frames;
  const CameraRig& rig;
  double side;

  [[nodiscard]] int inputs() const { return 8; }
  [[nodiscard]] int values() const { return 8 * static_cast<int>(frames.size()); }
  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& r) const {
    constexpr double kUnseen = 100.0;  // px
    const Setup setup = setup_of(x);
    const CameraRig mounted = rig_of(rig, setup);
    const double h = 0.5 * side;
    const std::array<Eigen::Vector3d, 4> corners{{{0, -h, -h}, {0, h, -h}, {0, h, h}, {0, -h, h}}};
    Eigen::Index row = 0;
    for (const Frame& frame : frames) {
      const Eigen::Matrix3d R_BG = rotation_EB(attitude_GB(track, frame, setup)).matrix.transpose();
      const Eigen::Vector3d p_GB = true_p_GB(track, frame, setup);
      for (std::size_t i = 0; i < 4; ++i, row += 2) {
        const auto px = mounted.lens.project(mounted.R_BC.matrix.transpose() * (R_BG * (corners[i] - p_GB) - mounted.p_BC));
        r.segment<2>(row) = px ? Eigen::Vector2d{*px - frame.px[i]} : Eigen::Vector2d::Constant(kUnseen);
      }
    }
    return 0;
  }
};

struct Fitted {
  Setup setup;
  double rms_px;
};

Fitted fitted(const LoggedMotion& track, const std::vector<Frame>& frames, const CameraRig& rig, double side) {
  const Residuals residuals{track, frames, rig, side};
  Eigen::NumericalDiff<Residuals, Eigen::Central> with_slope{residuals, 1e-10};
  Eigen::LevenbergMarquardt<decltype(with_slope)> descent{with_slope};
  Eigen::VectorXd x = unknowns_of({});
  descent.minimize(x);
  Eigen::VectorXd r(residuals.values());
  residuals(x, r);
  return {setup_of(x), std::sqrt(r.squaredNorm() / static_cast<double>(r.size()))};
}

/// Errors of our pose over some frames.
struct FlightErrors {
  Rmse map, rays;
  double nees = 0.0;
  std::vector<Eigen::Vector3d> found, truth;
};

FlightErrors errors_of(const LoggedMotion& track, const std::vector<Frame>& frames, const Setup& setup, const CameraRig& lens, double sigma_px) {
  const CameraRig rig = rig_of(lens, setup);
  FlightErrors errors;
  for (const Frame& frame : frames) {
    const Eigen::Vector3d p_GB = true_p_GB(track, frame, setup);
    const Attitude attitude = attitude_GB(track, frame, setup);
    GateObservations seen;
    add_corners(seen, frame.px, kSide, sigma_px);
    const auto answer = map_pose(seen, {.attitude_GB = attitude}, rig);
    errors.map.add(answer.pose ? std::optional{answer.pose->p_GB} : std::nullopt, p_GB);
    errors.rays.add(by_rays(frame.px, attitude, rig, kSide), p_GB);
    if (!answer.pose) continue;
    const Eigen::Vector3d error = answer.pose->p_GB - p_GB;
    const Eigen::Matrix3d P = answer.pose->covariance.topLeftCorner<3, 3>();
    errors.nees += error.dot(P.inverse() * error);
    errors.found.push_back(answer.pose->p_GB), errors.truth.push_back(p_GB);
  }
  return errors;
}

/// The same pictures through the detector that flies.
std::vector<Frame> detected(const std::vector<Frame>& frames, const io::FlightFolder& flight, const io::Config& config) {
  const auto search = std::make_unique<CarefulSearch>(config.pilot.detector);
  std::vector<Frame> found;
  for (const Frame& frame : frames) {
    const io::ImageFile file = io::read_image(flight.directory / frame.image);
    const GateDetections gates = search->detect(file.view(config.stored_rotation_deg), config.pilot.gate_color);
    if (!gates.empty()) found.push_back({frame.image, frame.t, clockwise_from_top_left(gates[0].corners_px)});
  }
  return found;
}

std::vector<Frame> labelled_in_flight(const io::FlightFolder& flight) {
  constexpr std::size_t kFirst = 18;  // before it the drone stands on the ground
  const io::Labels labels = io::read_labels(flight.directory / "labels.csv");
  std::vector<Frame> frames;
  for (std::size_t i = kFirst; i < flight.images.size(); ++i)
    for (const io::LabelledPicture& picture : labels.pictures)
      if (picture.image == flight.images[i].path.filename().string() && !picture.gates.empty())
        frames.push_back({picture.image, std::chrono::duration<double>(flight.images[i].time).count(), picture.gates.front()});
  if (frames.empty()) throw std::runtime_error("flight_11/labels.csv: labels no picture taken in the air");
  return frames;
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

void report_flight(const Options& options, Result& result) {
  const io::FlightFolder flight = io::read_flight_folder(data_folder("tudelft_bebop_flights", options) / "flight_11");
  const io::Config config = config_with("flights");
  const LoggedMotion track(flight);
  const std::vector<Frame> frames = labelled_in_flight(flight);
  const CameraRig& lens = config.pilot.camera;
  const auto [setup, rms_px] = fitted(track, frames, lens, kSide);
  const FlightErrors labels = errors_of(track, frames, setup, lens, kLabelSigmaPx);
  const std::vector<Frame> own = detected(frames, flight, config);
  const FlightErrors detections = errors_of(track, own, setup, lens, config.pilot.pose.corner_sigma_px);

  result.table.push_back({"flight_11, labels", "<= 0.12 m", per_axis(labels)});
  result.table.push_back({"flight_11, detections", "<= 0.20 m", per_axis(detections)});
  const std::string fit = "gate " + fixed(setup.gate_E.x(), 2) + ", " + fixed(setup.gate_E.y(), 2) + ", " + fixed(setup.gate_E.z(), 2) + " m, turned " +
                          fixed(setup.gate_yaw / kDegree, 1) + "°; heading " + fixed(setup.heading_offset / kDegree, 1) + "°; tilt " +
                          fixed(setup.tilt / kDegree, 1) + "°, roll " + fixed(setup.camera_roll / kDegree, 1) + "°; time " +
                          fixed(1e3 * setup.time_offset, 0) + " ms; " + fixed(rms_px, 2) + " px RMS";
  result.table.push_back({"  fitted once to the labels", "-", fit});
  result.json["flight_11"] = {{"camera", kCamera}, {"labels", json_of(labels)}, {"detections", json_of(detections)},
                              {"fitted", {{"gate_m", {setup.gate_E.x(), setup.gate_E.y(), setup.gate_E.z()}}, {"gate_yaw_deg", setup.gate_yaw / kDegree},
                                          {"heading_offset_deg", setup.heading_offset / kDegree}, {"tilt_deg", setup.tilt / kDegree},
                                          {"camera_roll_deg", setup.camera_roll / kDegree}, {"time_offset_ms", 1e3 * setup.time_offset},
                                          {"rms_px", rms_px}}},
                              {"rms_px_with_side_095_m", fitted(track, frames, lens, 0.95).rms_px},
                              {"rms_px_with_side_105_m", fitted(track, frames, lens, 1.05).rms_px}};
  for (std::size_t i = 0; i < labels.found.size(); ++i) {
    result.csv += "labels";
    for (const double v : {labels.truth[i].x(), labels.truth[i].y(), labels.truth[i].z(), labels.found[i].x(), labels.found[i].y(), labels.found[i].z()})
      result.csv += "," + io::text_of(v, 5);
    result.csv += "\n";
  }
  for (std::size_t i = 0; i < detections.found.size(); ++i) {
    result.csv += "detections";
    for (const double v : {detections.truth[i].x(), detections.truth[i].y(), detections.truth[i].z(), detections.found[i].x(),
                           detections.found[i].y(), detections.found[i].z()})
      result.csv += "," + io::text_of(v, 5);
    result.csv += "\n";
  }
  result.picture = io::draw({.title = "flight_11 before the gate: motion capture and our pose from single pictures",
                             .x_label = "x, through the gate [m]", .y_label = "y, to the right [m]",
                             .series = {series("motion capture", labels.truth, io::look::kInk, true, false),
                                        series("from labels", labels.found, io::look::kGate, false, true),
                                        series("from detections", detections.found, io::look::kDetection, false, false)},
                             .y_from_0 = false});
}

}  // namespace

Result pose_real(const Options& options) {
  Result result{.table = {}, .json = {}, .csv = "from,true_x_m,true_y_m,true_z_m,x_m,y_m,z_m\n", .picture = io::Canvas(1, 1)};
  if (options.stopped()) throw Stopped{};
  report_distances(options, result);
  options.progress(0.2, "flight_11");
  if (options.stopped()) throw Stopped{};
  report_flight(options, result);
  return result;
}

}  // namespace gatefly::experiments
