// SPDX-License-Identifier: Apache-2.0
#include "gatefly/tasks/replay_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <map>
#include <sstream>
#include <vector>

#include "gatefly/files/labels_file.hpp"
#include "gatefly/files/printed.hpp"
#include "gatefly/files/scoring.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/findings_json.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/rotation_vector.hpp"
#include "gatefly/tasks/flight_inputs.hpp"

namespace gatefly::tasks {
namespace {

namespace fs = std::filesystem;

std::optional<Rate> against_labels(const RecordedFlight& flight,
                                   const flight_log::ReplayResult& result) {
  const fs::path path = flight.folder.directory / "labels.csv";
  if (!fs::exists(path)) return std::nullopt;
  std::map<std::string, std::vector<Quad>> gates_of;
  for (const files::LabelledPicture& picture : files::read_labels(path).pictures)
    gates_of[picture.image] = picture.gates;
  Rate rate;
  for (const auto& row : result.pictures) {
    const auto& image = flight.folder.images[row.picture];
    const auto truth = flight.ticks[image.log_row].p_EB;
    if (!truth || truth->z() > -0.3) continue;
    for (const Quad& gate : gates_of[image.path.filename().string()]) {
      ++rate.shown;
      bool found = false;
      for (const auto& detection : row.sighting.detections)
        found = found || files::matches(detection.corners_px, gate, files::Rule::kOverlap70);
      rate.found += found;
    }
  }
  return rate;
}

std::optional<Rate> against_geometry(const RecordedFlight& flight,
                                     const flight_log::ReplayResult& result,
                                     double heading_offset) {
  Rate rate;
  CameraRig rig = flight.pilot.camera;
  if (const auto& found = result.findings) {
    heading_offset += found->heading.value;
    rig.R_BC.matrix =
        rig.R_BC.matrix * rotation_of({-found->tilt.value, found->pan.value, found->roll.value});
  }
  for (const auto& row : result.pictures) {
    const auto& sample = flight.folder.samples[flight.folder.images[row.picture].log_row];
    const auto attitude = sample.true_attitude ? sample.true_attitude : sample.ahrs;
    if (!sample.true_p_EB || !attitude || sample.true_p_EB->z() > -0.3) continue;
    Attitude level = *attitude;
    if (!sample.true_attitude) level.yaw += heading_offset;
    const Eigen::Matrix3d R_EC = rotation_EB(level).matrix * rig.R_BC.matrix;
    const Eigen::Vector3d eye = *sample.true_p_EB + rotation_EB(level) * rig.p_BC;
    for (const MapGate& gate : flight.pilot.track.gates) {
      const Eigen::Matrix3d R_EG = rotation_z(gate.yaw_EG);
      bool whole = R_EG.col(0).dot(gate.p_EG - eye) > 0.2;
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (const double y : {-0.5, 0.5})
        for (const double z : {-0.5, 0.5}) {
          const Eigen::Vector3d corner = gate.p_EG + R_EG * (gate.side * Eigen::Vector3d{0, y, z});
          const auto px = rig.lens.project(R_EC.transpose() * (corner - eye));
          whole = whole && px && px->x() > 2 && px->y() > 2 &&
                  px->x() < flight.config.camera.width - 3 &&
                  px->y() < flight.config.camera.height - 3;
          if (px) middle += 0.25 * *px;
        }
      if (!whole) continue;
      ++rate.shown;
      bool found = false;
      for (const auto& detection : row.sighting.detections)
        found = found || (center(detection.corners_px) - middle).norm() <
                             0.35 * std::sqrt(std::abs(area(detection.corners_px)));
      rate.found += found;
    }
  }
  if (rate.shown == 0) return std::nullopt;
  return rate;
}

std::optional<Rate> against_next_gate(const RecordedFlight& flight,
                                      const flight_log::ReplayResult& result) {
  constexpr double kPart = 0.7;  // of both areas, as closed_loop/scorer counts
  Rate rate;
  for (const auto& row : result.pictures) {
    const auto& gate = flight.folder.images[row.picture].next_gate_px;
    if (!gate) continue;
    ++rate.shown;
    const auto& detections = row.sighting.detections;
    rate.found += std::any_of(detections.begin(), detections.end(), [&](const auto& detection) {
      return overlaps(detection.corners_px, *gate, kPart);
    });
  }
  if (rate.shown == 0) return std::nullopt;
  return rate;
}

std::optional<Comparison> compared(const RecordedFlight& flight, const ReplayArguments& arguments,
                                   const flight_log::ReplayResult& result) {
  const auto& samples = flight.folder.samples;
  const bool own = estimator_of(arguments, flight.pilot) == estimator_of({}, flight.pilot);
  if (!samples.front().est_p_EB || !own) return std::nullopt;
  Comparison comparison{.first_other = {},
                        .told = !arguments.config.configs.empty() ||
                                !arguments.config.settings.empty() || !arguments.track.empty()};
  for (std::size_t i = 0; i < samples.size() && !comparison.first_other; ++i)
    if (!samples[i].est_p_EB || *samples[i].est_p_EB != result.estimates[i].estimate.p_EB)
      comparison.first_other = i;
  return comparison;
}

std::string why_no_fix(const flight_log::ReplayResult& result) {
  constexpr int kMany = 5;
  int with_gate = 0, offered = 0;
  for (const auto& row : result.pictures) {
    if (row.sighting.source != Sighting::Source::kNone) return "";
    with_gate += row.sighting.seen;
    offered += row.sighting.offered;
  }
  if (with_gate < kMany) return "";
  const std::string reason =
      offered > 0
          ? "the filter refused all " + std::to_string(offered) + " that could be the next gate"
          : "none could be the next gate of the map (--track, --heading-offset-deg?)";
  return "gates in " + std::to_string(with_gate) + " pictures and no fix: " + reason;
}

// An answer of half a metre either way flies through no gate.
std::string unknown(const RecordedFlight& flight, const ReplayArguments& arguments,
                    const flight_log::ReplayResult& result) {
  constexpr double kUseful = 0.5;  // [m]
  if (result.pictures.empty() || estimator_of(arguments, flight.pilot) != "eskf") return "";
  if (!result.known_to)
    return "no gate of the map was seen in " + files::amount(result.pictures.size(), "picture");
  if (*result.known_to < kUseful) return "";
  return "after the last sighting it is known to " + files::text_of(*result.known_to, 2) +
         " m (one sigma) across the floor";
}

std::string other_pictures(const RecordedFlight& flight, const flight_log::HashCheck& hashes) {
  if (!hashes.first_other) return "";
  const std::string first = flight.folder.images[*hashes.first_other].path.filename().string();
  std::string said = std::to_string(hashes.others) + " of " + std::to_string(hashes.checked) +
                     " pictures are not those of the flight, by their hashes, from " + first +
                     " on: ";
  if (flight.pictures != flight_log::Pictures::kHashes) return said + "they were changed";
  const std::string version = version_of_flight(flight.folder.directory);
  return said + "another version" + (version.empty() ? "" : " than " + version) +
         " or another kind of processor renders them otherwise, or the folder was changed";
}

nlohmann::json as_json(const flight_log::ChiSquareCount& count) {
  if (count.samples == 0) return nullptr;
  return {{"samples", count.samples},
          {"mean_per_dof", count.sum_per_dof / count.samples},
          {"inside", static_cast<double>(count.inside) / count.samples}};
}

nlohmann::json as_json(const flight_log::FrameErrors& errors) {
  const Eigen::Vector3d rms = errors.rms();
  return {{"rms_m", {rms.x(), rms.y(), rms.z()}}, {"nees", as_json(errors.nees)}};
}

const char* name_of(flight_log::Pictures pictures) {
  constexpr std::array<const char*, 4> kNames{"none", "files", "film", "rendered"};
  return kNames[static_cast<std::size_t>(pictures)];
}

}  // namespace

ReplayReport report_of(const RecordedFlight& flight, const ReplayArguments& arguments,
                       const flight_log::ReplayResult& result) {
  ReplayReport report;
  report.labelled = against_labels(flight, result);
  report.visible = against_geometry(flight, result, arguments.heading_offset_deg * kDegree);
  report.next_gate = against_next_gate(flight, result);
  report.comparison = compared(flight, arguments, result);
  report.why_no_fix = why_no_fix(result);
  if (!result.divergence) report.unknown = unknown(flight, arguments, result);
  report.other_pictures = other_pictures(flight, result.hashes);
  report.pictures_from = name_of(flight.pictures);
  for (const auto& row : result.pictures)
    report.fixes += row.sighting.source != Sighting::Source::kNone;
  return report;
}

nlohmann::json as_json(const ReplayReport& report, const ReplayArguments& arguments,
                       const flight_log::ReplayResult& result) {
  nlohmann::json json{{"flight", arguments.directory},
                      {"samples", result.estimates.size()},
                      {"pictures", result.pictures.size()},
                      {"pictures_from", report.pictures_from},
                      {"pictures_checked", result.hashes.checked},
                      {"pictures_other", result.hashes.others},
                      {"fixes", report.fixes},
                      {"finite", result.finite},
                      {"gates_passed", result.gates_passed},
                      {"rmse_m", nullptr},
                      {"rmse_samples", result.rmse_samples},
                      {"labelled", nullptr},
                      {"visible", nullptr},
                      {"next_gate", nullptr},
                      {"same_as_recorded", nullptr},
                      {"gate_frame", nullptr},
                      {"earth_frame", nullptr},
                      {"nis", as_json(result.score.nis)},
                      {"known_to_m", nullptr},
                      {"unknown", nullptr},
                      {"diverged", nullptr}};
  if (result.rmse_samples > 0) json["rmse_m"] = {result.rmse.x(), result.rmse.y(), result.rmse.z()};
  if (result.score.gate.samples > 0) json["gate_frame"] = as_json(result.score.gate);
  if (result.score.earth.samples > 0) json["earth_frame"] = as_json(result.score.earth);
  if (report.labelled)
    json["labelled"] = {{"shown", report.labelled->shown}, {"found", report.labelled->found}};
  if (report.visible)
    json["visible"] = {{"shown", report.visible->shown}, {"found", report.visible->found}};
  if (report.next_gate)
    json["next_gate"] = {{"shown", report.next_gate->shown}, {"found", report.next_gate->found}};
  if (result.known_to) json["known_to_m"] = *result.known_to;
  if (!report.unknown.empty()) json["unknown"] = report.unknown;
  json["found"] = flight_log::as_json(result.findings);
  if (result.divergence)
    json["diverged"] = {{"since_s", result.divergence->since},
                        {"why", eskf::text_of(result.divergence->why)}};
  if (report.comparison) json["same_as_recorded"] = !report.comparison->first_other;
  if (report.comparison && report.comparison->first_other)
    json["first_difference_row"] = *report.comparison->first_other;
  return json;
}

std::string text_of(const Comparison& comparison, const RecordedFlight& flight) {
  if (!comparison.first_other) return "the same estimates, to the bit";
  const std::string from = "other estimates from " + flight.folder.log.filename().string() + ":" +
                           std::to_string(*comparison.first_other + 2) + " on";
  if (comparison.told) return from + ", as --config, --set or --track want it";
  const std::string why = difference_in(flight.config, flight.folder.directory);
  return from + (why.empty() ? ": a file of the folder or the program has changed" : ": " + why);
}

std::string text_of(const flight_log::ReplayScore& score) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  const auto counted = [&text](const char* name, const flight_log::ChiSquareCount& count) {
    if (count.samples == 0) return;
    text << name << count.sum_per_dof / count.samples << ", " << std::setprecision(0)
         << 100.0 * count.inside / count.samples << std::setprecision(2)
         << " % inside its 95 % bounds";
  };
  const auto put = [&](const char* name, const flight_log::FrameErrors& errors) {
    if (errors.samples == 0) return;
    const Eigen::Vector3d rms = errors.rms();
    text << name << rms.x() << ", y " << rms.y() << ", z " << rms.z() << " m";
    counted("; NEES/3 ", errors.nees);
    text << '\n';
  };
  put("  from the gate   rms x ", score.gate);
  put("  in earth axes   rms x ", score.earth);
  if (score.nis.samples == 0) return text.str();
  counted("  sightings       NIS/dof ", score.nis);
  text << '\n';
  return text.str();
}

const char* name_of(Sighting::Source source) {
  constexpr std::array<const char*, 3> kNames{"predict", "corners", "bars"};
  return kNames[static_cast<std::size_t>(source)];
}

std::string estimates_csv(const flight_log::ReplayResult& result) {
  std::ostringstream csv;
  csv << std::setprecision(17)
      << "t_s,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,roll_rad,pitch_rad,yaw_rad,bax_mps2,bay_mps2,baz_"
         "mps2,source\n";
  for (const auto& row : result.estimates) {
    const Estimate& e = row.estimate;
    csv << row.t << ',' << e.p_EB.x() << ',' << e.p_EB.y() << ',' << e.p_EB.z() << ',' << e.v_E.x()
        << ',' << e.v_E.y() << ',' << e.v_E.z() << ',' << e.attitude.roll << ',' << e.attitude.pitch
        << ',' << e.attitude.yaw << ',' << e.accel_bias.x() << ',' << e.accel_bias.y() << ','
        << e.accel_bias.z() << ',' << name_of(row.source) << '\n';
  }
  return csv.str();
}

}  // namespace gatefly::tasks
