// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/replay.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "gatefly/config/derived.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/files/labels_file.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/scoring.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/flight_folder.hpp"
#include "gatefly/flight_log/recording.hpp"
#include "gatefly/geometry/math.hpp"

#include "commands.hpp"
#include "flight_inputs.hpp"

namespace gatefly::cli {
namespace {

namespace fs = std::filesystem;

struct ReplayOptions {
  CommonOptions common;
  std::string directory, track, csv, data, estimator = "drag";
  double heading_offset_deg = 11.5;
  bool json = false;
};

/// A recorded flight, ready for the pilot.
struct Recording {
  io::Config config;
  PilotConfig pilot;
  io::FlightFolder folder;
  std::vector<flight_log::RecordedTick> ticks;
  bool simulated = false;  ///< Flown by `gatefly fly`: carries its own track and configuration.
};

Recording read(const ReplayOptions& options) {
  Recording recording;
  const fs::path directory = io::find_data(options.directory, options.data);
  recording.folder = io::read_flight_folder(directory);
  recording.simulated = is_simulated(directory);
  if (recording.simulated) {
    expect_whole(directory, recording.folder);
    recording.config = config_of_flight(directory, options.common);
  } else {
    CommonOptions common = options.common;
    common.configs.insert(common.configs.begin(), "flights");
    recording.config = load(common);
  }
  const fs::path track_path = !options.track.empty() ? io::find_track(options.track)
                              : recording.simulated  ? directory / "track.toml"
                                                     : io::find_track("flights");
  const io::TrackFile track = io::read_track(track_path, recording.config.gate);
  if (recording.simulated) recording.config = io::on_course(std::move(recording.config), track);
  recording.pilot = recording.config.pilot;
  recording.pilot.track = track.track;
  if (recording.simulated)
    recording.pilot.track.laps = laps_of_flight(directory).value_or(track.track.laps);

  // A real log: heading from its own AHRS plus the offset to motion capture.
  const auto& samples = recording.folder.samples;
  if (!recording.simulated && samples.front().ahrs)
    recording.pilot.track.start_heading =
        wrap_angle(samples.front().ahrs->yaw + options.heading_offset_deg * kDegree);
  recording.ticks = flight_log::ticks_of(recording.folder);
  return recording;
}

/// How many pictures of a set show the gate, and in how many of them it was found.
struct Rate {
  int shown = 0, found = 0;
};

/// Against labels.csv of the folder, in flight only: where the log's truth is off the ground.
std::optional<Rate> against_labels(const Recording& recording,
                                   const flight_log::ReplayResult& result) {
  const fs::path path = recording.folder.directory / "labels.csv";
  if (!fs::exists(path)) return std::nullopt;
  std::map<std::string, std::vector<Quad>> gates_of;
  for (const io::LabelledPicture& picture : io::read_labels(path).pictures)
    gates_of[picture.image] = picture.gates;
  Rate rate;
  for (const auto& row : result.pictures) {
    const auto& image = recording.folder.images[row.picture];
    const auto truth = recording.ticks[image.log_row].p_EB;
    if (!truth || truth->z() > -0.3) continue;
    for (const Quad& gate : gates_of[image.path.filename().string()]) {
      ++rate.shown;
      bool found = false;
      for (const auto& detection : row.sighting.detections)
        found = found || io::matches(detection.corners_px, gate, io::Rule::kOverlap70);
      rate.found += found;
    }
  }
  return rate;
}

/// Against the geometry: where true position, the log's own attitude and the measured gate say that
/// the whole gate is in the picture.
std::optional<Rate> against_geometry(const Recording& recording,
                                     const flight_log::ReplayResult& result,
                                     double heading_offset) {
  Rate rate;
  const CameraRig& rig = recording.pilot.camera;
  for (const auto& row : result.pictures) {
    const auto& sample = recording.folder.samples[recording.folder.images[row.picture].log_row];
    const auto attitude = sample.true_attitude ? sample.true_attitude : sample.ahrs;
    if (!sample.true_p_EB || !attitude || sample.true_p_EB->z() > -0.3) continue;
    Attitude level = *attitude;
    if (!sample.true_attitude) level.yaw += heading_offset;
    const Eigen::Matrix3d R_EC = rotation_EB(level).matrix * rig.R_BC.matrix;
    const Eigen::Vector3d eye = *sample.true_p_EB + rotation_EB(level) * rig.p_BC;
    for (const MapGate& gate : recording.pilot.track.gates) {
      const Eigen::Matrix3d R_EG = rotation_z(gate.yaw_EG);
      bool whole = R_EG.col(0).dot(gate.p_EG - eye) > 0.2;
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (const double y : {-0.5, 0.5})
        for (const double z : {-0.5, 0.5}) {
          const Eigen::Vector3d corner = gate.p_EG + R_EG * (gate.side * Eigen::Vector3d{0, y, z});
          const auto px = rig.lens.project(R_EC.transpose() * (corner - eye));
          whole = whole && px && px->x() > 2 && px->y() > 2 &&
                  px->x() < recording.config.camera.width - 3 &&
                  px->y() < recording.config.camera.height - 3;
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

std::string estimates_csv(const flight_log::ReplayResult& result) {
  std::ostringstream csv;
  csv << std::setprecision(17)
      << "t_s,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,roll_rad,pitch_rad,yaw_rad,bax_mps2,bay_mps2,baz_"
         "mps2,source\n";
  for (const auto& row : result.estimates) {
    const Estimate& e = row.estimate;
    constexpr std::array<const char*, 3> kSources{"predict", "corners", "bars"};
    csv << row.t << ',' << e.p_EB.x() << ',' << e.p_EB.y() << ',' << e.p_EB.z() << ',' << e.v_E.x()
        << ',' << e.v_E.y() << ',' << e.v_E.z() << ',' << e.attitude.roll << ',' << e.attitude.pitch
        << ',' << e.attitude.yaw << ',' << e.accel_bias.x() << ',' << e.accel_bias.y() << ','
        << e.accel_bias.z() << ',' << kSources[static_cast<std::size_t>(row.source)] << '\n';
  }
  return csv.str();
}

/// The recorded pilot's estimates beside those that came out now.
struct Comparison {
  std::optional<std::size_t> first_other;  ///< Row from which on they are not the same to the bit.
  bool told = false;                       ///< To be another pilot: by --config, --set, --track.
};

std::optional<Comparison> compared(const Recording& recording, const ReplayOptions& options,
                                   const flight_log::ReplayResult& result) {
  const auto& samples = recording.folder.samples;
  if (!samples.front().est_p_EB || options.estimator != "drag") return std::nullopt;
  Comparison comparison{.first_other = {},
                        .told = !options.common.configs.empty() ||
                                !options.common.settings.empty() || !options.track.empty()};
  for (std::size_t i = 0; i < samples.size() && !comparison.first_other; ++i)
    if (!samples[i].est_p_EB || *samples[i].est_p_EB != result.estimates[i].estimate.p_EB)
      comparison.first_other = i;
  return comparison;
}

std::string text_of(const Comparison& comparison, const Recording& recording) {
  if (!comparison.first_other) return "the same estimates, to the bit";
  const std::string from =
      "other estimates from log_si.csv:" + std::to_string(*comparison.first_other + 2) + " on";
  if (comparison.told) return from + ", as --config, --set or --track want it";
  const std::string why = difference_in(recording.config, recording.folder.directory);
  return from + (why.empty() ? ": a file of the folder or the program has changed" : ": " + why);
}

/// Many gates and no fix: why; "" where all is well.
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

int replay(const ReplayOptions& options) {
  const bool rows_on_stdout = io::is_stdout(options.csv);
  if (options.json && rows_on_stdout)
    throw std::runtime_error("--json and --csv " + options.csv + ": both want stdout; name a file");
  check_outputs({{"--csv", options.csv, {"table of estimates", "t_s,x_m,y_m,z_m,vx_mps,"}}},
                {io::find_data(options.directory, options.data), options.track}, options.common);
  const bool is_drag = options.estimator == "drag";
  const Recording recording = read(options);
  const auto load_picture = flight_log::picture_loader(
      recording.folder, recording.config.camera.stored_width(),
      recording.config.camera.stored_height(), recording.config.camera.stored_rotation_deg);
  const flight_log::ReplayResult result = [&] {
    try {
      return flight_log::replay(
          recording.pilot, recording.ticks, load_picture,
          is_drag ? flight_log::Estimator::kDrag : flight_log::Estimator::kImu15);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(std::string("the track cannot be flown: ") + error.what());
    }
  }();
  if (!options.csv.empty()) io::write_file(options.csv, estimates_csv(result));

  const auto labelled = against_labels(recording, result);
  const auto visible = against_geometry(recording, result, options.heading_offset_deg * kDegree);
  const auto comparison = compared(recording, options, result);
  if (const std::string why = why_no_fix(result); !why.empty())
    std::cerr << "gatefly replay: " << why << '\n';
  int fixes = 0;
  for (const auto& row : result.pictures) fixes += row.sighting.source != Sighting::Source::kNone;
  if (options.json) {
    nlohmann::json json{{"flight", options.directory},
                        {"samples", result.estimates.size()},
                        {"pictures", result.pictures.size()},
                        {"fixes", fixes},
                        {"finite", result.finite},
                        {"gates_passed", result.gates_passed},
                        {"rmse_m", nullptr},
                        {"rmse_samples", result.rmse_samples},
                        {"labelled", nullptr},
                        {"visible", nullptr},
                        {"same_as_recorded", nullptr}};
    if (result.rmse_samples > 0)
      json["rmse_m"] = {result.rmse.x(), result.rmse.y(), result.rmse.z()};
    if (labelled) json["labelled"] = {{"shown", labelled->shown}, {"found", labelled->found}};
    if (visible) json["visible"] = {{"shown", visible->shown}, {"found", visible->found}};
    if (comparison) json["same_as_recorded"] = !comparison->first_other;
    if (comparison && comparison->first_other)
      json["first_difference_row"] = *comparison->first_other;
    std::cout << json.dump(2) << '\n';
  } else if (!rows_on_stdout) {
    std::cout << std::fixed << std::setprecision(2) << options.directory << ": "
              << result.estimates.size() << " samples, " << result.pictures.size()
              << " pictures, all numbers " << (result.finite ? "finite" : "NOT finite") << '\n';
    if (visible)
      std::cout
          << "  gate found      in " << visible->found << " of " << visible->shown
          << " pictures in flight that show a gate of the map whole, the next one or another\n";
    if (labelled)
      std::cout << "  labelled        in " << labelled->found << " of " << labelled->shown
                << " (overlap70)\n";
    std::cout << "  fixes           " << fixes << " pictures corrected the filter, "
              << result.gates_passed << " gates passed\n";
    if (result.rmse_samples > 0)
      std::cout << "  position error  rms x " << result.rmse.x() << ", y " << result.rmse.y()
                << ", z " << result.rmse.z() << " m, from the first fix to the last gate\n";
    if (comparison) std::cout << "  recorded flight " << text_of(*comparison, recording) << '\n';
  }
  const bool came_out = !comparison || !comparison->first_other || comparison->told;
  return result.finite && came_out ? kDone : kAnswerIsNo;
}

}  // namespace

void declare_replay(Command& command) {
  auto options = std::make_shared<ReplayOptions>();
  command.footer(
      "Example:\n  gatefly replay out/showroom-1 --csv estimates.csv\n"
      "  gatefly replay tudelft_bebop_flights/flight_11 --json\n\n"
      "Folders of gatefly fly carry their track and configuration; others use tracks/flights.toml "
      "and\n"
      "configs/flights.toml. Exit code 0: done; 1: a number was not finite, or a flight of gatefly "
      "fly came out "
      "otherwise; 2: unusable input.");
  command.option("DIR", options->directory, "flight folder: log_si.csv, images.csv, pictures")
      .required()
      .path();
  command.option("--track", options->track,
                 "instead of the folder's own: a name in tracks/ or a file");
  command
      .option("--estimator", options->estimator,
              "drag: the 7-state filter; imu15: the classic inertial one beside it, for comparison")
      .one_of({"drag", "imu15"})
      .show_default();
  command
      .option("--heading-offset-deg", options->heading_offset_deg,
              "real logs: motion capture's heading minus the log's own (differs by flight)")
      .show_default();
  command
      .option("--data", options->data, "where a DIR is looked for that is not here [$GATEFLY_DATA]")
      .path("DIR");
  command.option("--csv", options->csv, "write estimates.csv (- for stdout)").path("FILE");
  command.flag("--json", options->json, "print JSON");
  add_force(command, options->common);
  add_common(command, options->common);
  command.runs([options] { return replay(*options); });
}

}  // namespace gatefly::cli
