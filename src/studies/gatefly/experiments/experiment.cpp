// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/experiment.hpp"

#include <array>
#include <stdexcept>
#include <system_error>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/files/pictures.hpp"

namespace gatefly::experiments {

std::span<const Experiment> all() {
  // Sections of docs/paper/deviations.md.
  static const Deviation kAhrs{"ahrs", "AHRS"};
  static const Deviation kAlg1{"alg-1", "which gate is returned"};
  static const Deviation kArcTime{"arc-time", "a half circle takes 2.8-3.0 s"};
  static const Deviation kCarefulSearch{"careful-search", "frames tried everywhere"};
  static const Deviation kEq10{"eq-10", "signed bearings"};
  static const Deviation kEq13{"eq-13", "drag coefficients"};
  static const Deviation kEq22{"eq-22", "PD on the line"};
  static const Deviation kEq29{"eq-29", "PD trim inside arcs"};
  static const Deviation kEq30{"eq-30", "the lateral model"};
  static const Deviation kEq31{"eq-31", "the filter"};
  static const Deviation kFigEkf{"fig-ekf", "their figure is offline"};
  static const Deviation kHeading{"heading", "heading from gates"};
  static const Deviation kLens{"lens", "the lens"};
  static const Deviation kLi18{"li18", "the original in one file"};
  static const Deviation kMapPose{"map-pose", "the most probable pose"};
  static const Deviation kNoiseClaims{"noise-claims", "the noise as stated and as run"};
  static const Deviation kP3p{"p3p", "P3P and uniqueness"};
  static const Deviation kPaperMode{"paper-mode", "the paper's detectors as modes"};
  static const Deviation kPoseNoise{"pose-noise", "the noise of the pose studies"};
  static const Deviation kRates{"rates", "rates and counts"};
  static const Deviation kSnakeSearch{"snake-search", "snakes in strides"};
  static const Deviation kSpeed{"speed", "speed held by pitch"};
  static const Deviation kTable2{"table-2", "Table 2 holds variances"};
  static const std::array<Experiment, 27> list{{
      {"roc-length",
       "hits against false positives over the minimum length σ_L",
       roc_length,
       true,
       {kPaperMode, kAlg1, kRates}},
      {"roc-fitness",
       "hits against false positives over the colour fitness σ_cf",
       roc_fitness,
       true,
       {kPaperMode, kAlg1}},
      {"tpr-distance",
       "true positive rate by distance",
       tpr_distance,
       true,
       {kPaperMode, kCarefulSearch}},
      {"approach-sequence",
       "what is found picture by picture while a gate is approached",
       approach_sequence,
       true,
       {kPaperMode}},
      {"own-detector",
       "our detector, colours fitted to one half of the pictures and scored on the other",
       own_detector,
       true,
       {kCarefulSearch, kSnakeSearch}},
      {"detection-failures",
       "the pictures where our detector is most wrong, by name",
       detection_failures,
       true,
       {kCarefulSearch}},
      {"robustness",
       "our detector on changed pictures: other cameras, light, motion, what hides a gate",
       robustness,
       true,
       {kCarefulSearch}},
      {"false-alarms",
       "what every shipped configuration takes for a gate where there is none",
       false_alarms,
       true,
       {kCarefulSearch},
       true},
      {"twin-hardness",
       "are rendered pictures as hard as real ones? The same detectors on both, by apparent size",
       twin_hardness,
       true,
       {kPaperMode},
       true},
      {"other-camera",
       "another hall, a wide lens, JPEG: gates found with colours learnt from ten pictures",
       other_camera,
       false,
       {kCarefulSearch},
       true},
      {"wide-gates",
       "gates of wide boards by a camera tilted up: found by corners in view and distance",
       wide_gates,
       false,
       {kCarefulSearch},
       true},
      {"ekf-track",
       "laps through two gates: the filter beside the truth, its errors as histograms",
       ekf_track,
       false,
       {kFigEkf, kEq31}},
      {"ekf-vs-15",
       "simulated laps with gaps: drag filter beside the 15-state inertial one, bias and drift",
       ekf_vs_15,
       false,
       {kEq31}},
      {"arc-accuracy",
       "where blind half circles end: the paper's, recorded ones, simulated ones",
       arc_accuracy,
       false,
       {kTable2, kArcTime, kEq29},
       true},
      {"convergence",
       "when drag filter and 15-state filter know the bias, and from when on the latter knows more",
       convergence,
       false,
       {kEq31},
       true},
      {"blind-real",
       "drift without a fix on real flights: drag filter beside the 15-state inertial one",
       blind_real,
       true,
       {kEq13, kEq31}},
      {"ahrs-real",
       "roll and pitch beside a plain Mahony filter: hand-held, in turns, on real flights",
       ahrs_real,
       true,
       {kAhrs}},
      {"eyes-real",
       "real flights through the pilot: IMU and pictures, from the first gate seen until the gate",
       eyes_real,
       true,
       {kMapPose, kHeading, kLens}},
      {"pose-ls-p3p",
       "position error of least squares and P3P over the distance",
       pose_ls_p3p,
       false,
       {kNoiseClaims, kPoseNoise, kP3p}},
      {"pose-bars",
       "position error from the two side bars over the distance",
       pose_bars,
       false,
       {kPoseNoise, kEq10}},
      {"pose-grid",
       "our pose against rays and PnP; is its covariance consistent?",
       pose_grid,
       false,
       {kMapPose, kP3p}},
      {"pose-real",
       "distances to a real gate, and a real flight against motion capture",
       pose_real,
       true,
       {kMapPose, kLens}},
      {"feasible-set",
       "from where a gate can still be flown through, by speed and lateral law",
       feasible_set,
       false,
       {kEq22, kEq30}},
      {"full-track",
       "the showroom: three flights of 15 gates each at -5 and -7 degrees, and ours",
       full_track,
       false,
       {kLi18, kSpeed},
       true},
      {"speed-ladder",
       "how fast three courses are flown before races are lost, rung by rung",
       speed_ladder,
       false,
       {kSpeed},
       true},
      {"paper-vs-ours",
       "the original beside ours on the same seeds; which box makes the difference",
       paper_vs_ours,
       false,
       {kLi18},
       true},
      {"twin-liveliness",
       "real flights beside simulated ones with the same set points: vibration, drag, responses",
       twin_liveliness,
       true,
       {kEq13},
       true},
  }};
  return list;
}

Result run(const Experiment& experiment, const Options& options) {
  Result result = experiment.run(options);
  result.json["quick"] = options.quick;
  if (!options.quick) return result;
  drawing::stamp_quick(result.picture);
  for (ExtraPicture& extra : result.extra) drawing::stamp_quick(extra.picture);
  return result;
}

std::uint64_t first_seed(const Options& options, std::uint64_t reported, std::uint64_t looked_at) {
  return options.first_seed.value_or(options.quick ? looked_at : reported);
}

std::filesystem::path data_folder(const std::string& name, const Options& options) {
  const std::filesystem::path folder = files::find_data(name, options.data);
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error))
    throw std::runtime_error(name + ": there is no such folder" +
                             (options.data.empty()
                                  ? " (name the folder of real data by --data or $GATEFLY_DATA)"
                                  : " in " + options.data));
  return folder;
}

}  // namespace gatefly::experiments
