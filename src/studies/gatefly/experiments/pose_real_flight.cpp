// SPDX-License-Identifier: Apache-2.0
// A real flight against motion capture.
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/LU>

#include "gatefly/config/track_file.hpp"
#include "gatefly/detection/search/careful_search.hpp"
#include "gatefly/experiments/gate_survey.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/logged_motion.hpp"
#include "gatefly/experiments/pose_real.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/files/image_file.hpp"
#include "gatefly/files/labels_file.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/pose/map_pose.hpp"

namespace gatefly::experiments::pose_real_parts {
namespace {

/// Labels or detections of one gate, and what the recording does not say: fitted once to the labels
/// of all pictures taken in the air.
struct Flown {
  LoggedMotion motion;
  PilotConfig pilot;
  Survey setup;

  [[nodiscard]] const SurveyedGate& gate() const { return setup.gates.front(); }
  [[nodiscard]] double exposed(const GatePicture& picture) const {
    return exposed_at(picture, setup.airframe, pilot);
  }
  [[nodiscard]] Attitude attitude_GB(const GatePicture& picture) const {
    Attitude attitude = motion.attitude(exposed(picture));
    attitude.yaw = wrap_angle(attitude.yaw + setup.flights.front().heading - gate().yaw);
    return attitude;
  }
  [[nodiscard]] Eigen::Vector3d true_p_GB(const GatePicture& picture) const {
    return rotation_z(-gate().yaw) *
           (motion.position(exposed(picture) + setup.airframe.mocap_delay) - gate().p_EG);
  }
};

Survey fitted(const LoggedMotion& motion, const std::vector<GatePicture>& pictures,
              PilotConfig pilot, double side) {
  pilot.track.gates.front().side = side;
  const MapGate& gate = pilot.track.gates.front();
  const Survey start{.airframe = {},
                     .gates = {{gate.p_EG, gate.yaw_EG}},
                     .flights = {{.heading = 11.5 * kDegree, .tilt = 13.2 * kDegree}}};
  const SurveyFlight seen{.motion = &motion, .pictures = pictures, .gate = 0};
  return surveyed({&seen, 1}, start, Open::kAll, pilot);
}

/// Misfit of u and v of all corners [px].
double rms_px(const Flown& flown, const std::vector<GatePicture>& pictures) {
  const SurveyFlight seen{.motion = &flown.motion, .pictures = {}, .gate = 0};
  double squares = 0.0;
  for (const GatePicture& picture : pictures)
    squares += std::pow(misfit_px(flown.setup, 0, seen, picture, flown.pilot), 2);
  return std::sqrt(squares / (2.0 * static_cast<double>(pictures.size())));
}

double rms_px_with_side(Flown flown, const std::vector<GatePicture>& pictures, double side) {
  flown.pilot.track.gates.front().side = side;
  flown.setup = fitted(flown.motion, pictures, flown.pilot, side);
  return rms_px(flown, pictures);
}

/// Minimum of the parabola through the misfits of three sides [m].
double best_side(const Flown& flown, const std::vector<GatePicture>& pictures) {
  constexpr double kStep = 0.05;
  const auto cost = [&](double side) {
    return std::pow(rms_px_with_side(flown, pictures, side), 2);
  };
  const double less = cost(kSide - kStep), here = cost(kSide), more = cost(kSide + kStep);
  return kSide + 0.5 * kStep * (less - more) / (less - 2.0 * here + more);
}

/// Errors of our pose over some frames.
struct FlightErrors {
  Rmse map, rays;
  double nees = 0.0;
  std::vector<Eigen::Vector3d> found, truth;
};

FlightErrors errors_of(const Flown& flown, const std::vector<GatePicture>& pictures,
                       double sigma_px) {
  const CameraRig rig =
      mounted(flown.pilot.camera, flown.setup.airframe, flown.setup.flights.front());
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

Seen seen_in_flight(const flight_log::FlightFolder& flight, const config::Config& config) {
  constexpr std::size_t kFirst = 18;  // before it the drone stands on the ground
  const files::Labels labels = files::read_labels(flight.directory / "labels.csv");
  const auto search = std::make_unique<CarefulSearch>(config.pilot.detector);
  Seen seen;
  for (std::size_t i = kFirst; i < flight.images.size(); ++i)
    for (const files::LabelledPicture& picture : labels.pictures) {
      if (picture.image != flight.images[i].path.filename().string() || picture.gates.empty())
        continue;
      const double t = seconds(flight.images[i].time);
      seen.labels.push_back({t, picture.gates.front()});
      const files::ImageFile file = files::read_image(flight.images[i].path);
      const GateDetections gates =
          search->detect(file.view(config.camera.stored_rotation_deg), config.pilot.gate_color);
      if (!gates.empty())
        seen.detections.push_back({t, clockwise_from_top_left(gates[0].corners_px)});
    }
  if (seen.labels.empty())
    throw std::runtime_error("flight_11/labels.csv: labels no picture taken in the air");
  return seen;
}

std::string per_axis(const FlightErrors& errors) {
  return "x " + fixed(errors.map.axis(0), 3) + ", y " + fixed(errors.map.axis(1), 3) + ", z " +
         fixed(errors.map.axis(2), 3) + " m of " + std::to_string(errors.map.n) + " (rays " +
         fixed(errors.rays.axis(0), 3) + ", " + fixed(errors.rays.axis(1), 3) + ")";
}

nlohmann::ordered_json json_of(const FlightErrors& errors) {
  return {{"frames", errors.map.n},
          {"refused", errors.map.none},
          {"rmse_x_m", number(errors.map.axis(0))},
          {"rmse_y_m", number(errors.map.axis(1))},
          {"rmse_z_m", number(errors.map.axis(2))},
          {"rays_rmse_x_m", number(errors.rays.axis(0))},
          {"rays_rmse_y_m", number(errors.rays.axis(1))},
          {"nees_per_axis", number(errors.nees / (3.0 * errors.map.n))}};
}

drawing::PlotSeries series(const std::string& name, const std::vector<Eigen::Vector3d>& points,
                           const drawing::Color& color, bool line, bool rings) {
  drawing::PlotSeries out{.name = name, .points = {}, .color = color, .line = line, .rings = rings};
  for (const Eigen::Vector3d& p : points) out.points.emplace_back(p.x(), p.y());
  return out;
}

void add_rows(const std::string& from, const FlightErrors& errors, std::string& csv) {
  for (std::size_t i = 0; i < errors.found.size(); ++i) {
    csv += from;
    for (const Eigen::Vector3d& p : {errors.truth[i], errors.found[i]})
      for (const double v : p) csv += "," + files::text_of(v, 5);
    csv += "\n";
  }
}

}  // namespace

drawing::Plot report_flight(const Options& options, const calibration::Calibration& camera,
                            Result& result) {
  const flight_log::FlightFolder flight =
      flight_log::read_flight_folder(data_folder("tudelft_bebop_flights", options) / "flight_11");
  const config::Config config = config_with("flights");
  const Seen seen = seen_in_flight(flight, config);
  Flown flown{.motion = LoggedMotion(flight), .pilot = config.pilot, .setup = {}};
  flown.pilot.camera.lens = lens_of(camera.best());
  flown.pilot.track = config::read_track(config::find_track("flights")).track;
  flown.setup = fitted(flown.motion, seen.labels, flown.pilot, kSide);
  const FlightErrors labels = errors_of(flown, seen.labels, kLabelSigmaPx);
  const FlightErrors detections =
      errors_of(flown, seen.detections, config.pilot.pose.corner_sigma_px);

  result.table.push_back({"flight_11, labels", "<= 0.12 m", per_axis(labels)});
  result.table.push_back({"flight_11, detections", "<= 0.20 m", per_axis(detections)});
  const auto& [airframe, gates, flights] = flown.setup;
  const Eigen::Vector3d& p_EG = gates.front().p_EG;
  const double misfit = rms_px(flown, seen.labels), side = best_side(flown, seen.labels);
  result.table.push_back({"  fitted once to the labels", "-",
                          "gate " + fixed(p_EG.x(), 2) + ", " + fixed(p_EG.y(), 2) + ", " +
                              fixed(p_EG.z(), 2) + " m, turned " +
                              fixed(gates.front().yaw / kDegree, 1) + "°; heading " +
                              fixed(flights.front().heading / kDegree, 1) + "°; tilt " +
                              fixed(flights.front().tilt / kDegree, 1) + "°, roll " +
                              fixed(airframe.camera_roll / kDegree, 1) + "°; pictures " +
                              fixed(1e3 * airframe.exposure_delay, 0) + " ms late, positions " +
                              fixed(1e3 * airframe.mocap_delay, 0) + " ms; " + fixed(misfit, 2) +
                              " px RMS; best with a side of " + fixed(side, 3) + " m"});
  result.json["flight_11"] = {{"camera", calibration::name_of(camera.best().fit.model)},
                              {"labels", json_of(labels)},
                              {"detections", json_of(detections)},
                              {"fitted",
                               {{"gate_m", {p_EG.x(), p_EG.y(), p_EG.z()}},
                                {"gate_yaw_deg", gates.front().yaw / kDegree},
                                {"heading_offset_deg", flights.front().heading / kDegree},
                                {"tilt_deg", flights.front().tilt / kDegree},
                                {"camera_roll_deg", airframe.camera_roll / kDegree},
                                {"exposure_delay_ms", 1e3 * airframe.exposure_delay},
                                {"mocap_delay_ms", 1e3 * airframe.mocap_delay},
                                {"rms_px", misfit}}},
                              {"best_side_m", side}};
  add_rows("labels", labels, result.csv), add_rows("detections", detections, result.csv);
  return {
      .title = "flight_11 before the gate: pose from single pictures",
      .x_label = "x, through the gate [m]",
      .y_label = "y, to the right [m]",
      .series = {series("motion capture", labels.truth, drawing::kLight.ink, true, false),
                 series("from labels", labels.found, drawing::kLight.gate_solid, false, true),
                 series("from detections", detections.found, drawing::kLight.found, false, false)},
      .y_from_0 = false};
}

}  // namespace gatefly::experiments::pose_real_parts
