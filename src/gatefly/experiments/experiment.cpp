// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/experiment.hpp"

#include <array>
#include <stdexcept>
#include <system_error>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/files/pictures.hpp"

namespace gatefly::experiments {

std::span<const Experiment> all() {
  static const std::array<Experiment, 20> list{{
      {"roc-length", "hits against false positives over the minimum length σ_L", roc_length},
      {"roc-fitness", "hits against false positives over the colour fitness σ_cf", roc_fitness},
      {"tpr-distance", "true positive rate by distance", tpr_distance},
      {"approach-sequence", "what is found picture by picture while a gate is approached",
       approach_sequence},
      {"own-detector",
       "our detector, colours fitted to one half of the pictures and scored on the other",
       own_detector},
      {"detection-failures", "the pictures where our detector is most wrong, by name",
       detection_failures},
      {"ekf-track", "laps through two gates: the filter beside the truth, its errors as histograms",
       ekf_track, false},
      {"ekf-vs-15",
       "simulated laps with gaps: drag filter beside the 15-state inertial one, bias and drift",
       ekf_vs_15, false},
      {"arc-accuracy", "where blind half circles end: the paper's, recorded ones, simulated ones",
       arc_accuracy, false},
      {"convergence",
       "when drag filter and 15-state filter know the bias, and from when on the latter knows more",
       convergence, false},
      {"blind-real",
       "drift without a fix on real flights: drag filter beside the 15-state inertial one",
       blind_real},
      {"ahrs-real",
       "roll and pitch beside a plain Mahony filter: hand-held, in turns, on real flights",
       ahrs_real},
      {"eyes-real",
       "real flights through the pilot: IMU and pictures, from the first gate seen until the gate",
       eyes_real},
      {"pose-ls-p3p", "position error of least squares and P3P over the distance", pose_ls_p3p,
       false},
      {"pose-bars", "position error from the two side bars over the distance", pose_bars, false},
      {"pose-grid", "our pose against rays and PnP; is its covariance consistent?", pose_grid,
       false},
      {"pose-real", "distances to a real gate, and a real flight against motion capture",
       pose_real},
      {"feasible-set", "from where a gate can still be flown through, by speed and lateral law",
       feasible_set, false},
      {"full-track", "the showroom: three flights of 15 gates each at -5 and -7 degrees, and ours",
       full_track, false},
      {"paper-vs-ours", "the original beside ours on the same days; which box makes the difference",
       paper_vs_ours, false},
  }};
  return list;
}

Result run(const Experiment& experiment, const Options& options) {
  Result result = experiment.run(options);
  result.json["quick"] = options.quick;
  if (!options.quick) return result;
  io::stamp_quick(result.picture);
  for (ExtraPicture& extra : result.extra) io::stamp_quick(extra.picture);
  return result;
}

std::filesystem::path data_folder(const std::string& name, const Options& options) {
  const std::filesystem::path folder = io::find_data(name, options.data);
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error))
    throw std::runtime_error(name + ": there is no such folder" +
                             (options.data.empty()
                                  ? " (name the folder of real data by --data or $GATEFLY_DATA)"
                                  : " in " + options.data));
  return folder;
}

}  // namespace gatefly::experiments
