// SPDX-License-Identifier: Apache-2.0
// Ours: distances to a gate that somebody measured with a tape, and a real flight against motion
// capture.
#include "gatefly/experiments/pose_real.hpp"

#include <filesystem>
#include <vector>

#include "gatefly/files/shipped_files.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/tasks/calibration/corner_list.hpp"

namespace gatefly::experiments {
namespace pose_real_parts {

config::Config config_with(const std::string& name) {
  std::vector<std::filesystem::path> files = config::config_files(std::vector<std::string>{name});
  files.push_back(files::find_toml("bebop-brown", "cameras"));
  const std::vector<std::string> settings{"gate.corners=middle"};
  return config::load_config(files, settings);
}

calibration::Calibration calibrated(const char* corners, int rotation_deg, const Options& options) {
  const Eigen::Vector2i upright{315, 160},
      stored = rotation_deg == 0 ? upright : Eigen::Vector2i{160, 315};
  calibration::BoardViews views = calibration::read_corner_list(
      data_folder("fisheye_calibration", options) / "bebop_front_camera" / corners);
  calibration::turn_upright(views, stored, rotation_deg);
  return calibration::calibrate(std::move(views), upright);
}

AnyCamera lens_of(const calibration::ModelResult& result) {
  return calibration::lens_of(result.fit.model, result.fit.parameters);
}

}  // namespace pose_real_parts

Result pose_real(const Options& options) {
  using namespace pose_real_parts;
  Result result{.table = {},
                .json = {},
                .csv = "from,true_x_m,true_y_m,true_z_m,x_m,y_m,z_m\n",
                .picture = drawing::Canvas(1, 1)};
  if (options.stopped()) throw Stopped{};
  const calibration::Calibration camera = calibrated(kCorners, 0, options);
  const drawing::Plot distances = report_distances(options, camera, result);
  options.progress(0.2, "flight_11");
  if (options.stopped()) throw Stopped{};
  const drawing::Plot flight = report_flight(options, camera, result);
  result.picture = drawing::draw_sheet(std::array{distances, flight}, 1);
  return result;
}

}  // namespace gatefly::experiments
