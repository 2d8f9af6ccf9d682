// SPDX-License-Identifier: Apache-2.0
// Li18's figure "histogram": position from the two side bars over the distance, heading -30, 0 and
// 30°. That heading turns the drone about the gate, not about itself: only so do the authors'
// curves come out.
#include <array>
#include <cmath>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/pose/map_pose.hpp"

namespace gatefly::experiments {
namespace {

constexpr std::array<double, 5> kBarDistances{.30, .63, .97, 1.30, 1.63};

/// A line of the figure or of the recomputed table.
struct Line {
  const char* name;
  bool gaussian;  ///< 3.5 px; else uniform within ±5 px, as the authors drew it.
  /// Bearing of the drone from the gate's axis; it looks at the gate's middle [rad].
  double bearing;
  std::array<double, 5> paper_x, paper_y;
};

const std::array<Line, 4>& lines() {
  static const std::array<Line, 4> list{{{"as run, 0°",
                                          false,
                                          0.0,
                                          {.0022, .0102, .0225, .0392, .0645},
                                          {.0036, .0076, .0114, .0165, .0195}},
                                         {"as run, 30°",
                                          false,
                                          30 * kDegree,
                                          {.0053, .0137, .0268, .045, .069},
                                          {.0071, .006, .0104, .0203, .0335}},
                                         {"as run, -30°",
                                          false,
                                          -30 * kDegree,
                                          {.0053, .0137, .0268, .045, .069},
                                          {.0071, .006, .0104, .0203, .0335}},
                                         {"3.5 px, 0°",
                                          true,
                                          0.0,
                                          {.0027, .0118, .0278, .0505, .0806},
                                          {.0044, .0092, .0144, .0189, .0241}}}};
  return list;
}

struct Errors {
  Rmse paper;  ///< By fix_from_bars: the paper's solution with the signs corrected.
  Rmse map;    ///< By map_pose, the height known to 0.5 m, the attitude to 1 mrad.
};

Errors errors_of(const Line& line, double distance, int trials) {
  // The study has no tilt: a level camera, its row 0 looks ahead.
  CameraRig rig = study_rig();
  rig.R_BC = camera_mount(0.0);
  const Pinhole lens;
  const Attitude attitude{0, 0, -line.bearing};
  const Eigen::Vector3d p_GB = rotation_z(-line.bearing) * Eigen::Vector3d{-distance, 0, 0};
  PoseParams anywhere;
  anywhere.min_bars_distance = 0.0, anywhere.max_bars_distance = anywhere.max_bars_lateral = 1e3;
  const double sigma_px = line.gaussian ? 3.5 : 5.0 / std::sqrt(3.0);
  sim::Stream random(static_cast<std::uint64_t>(std::lround(100.0 * distance)),
                     std::string("pose-bars/") + line.name);
  Errors errors;
  for (int i = 0; i < trials; ++i) {
    std::array<Eigen::Vector2d, 2> px;
    for (std::size_t bar = 0; bar < 2; ++bar) {
      const double bearing =
          gatefly::atan2((bar == 0 ? -0.5 : 0.5) - p_GB.y(), -p_GB.x()) + line.bearing;
      const double noise = line.gaussian ? sigma_px * random.normal() : random.uniform(-5.0, 5.0);
      px[bar] = {lens.center_px.x() + lens.focal_px.x() * gatefly::tan(bearing) + noise,
                 lens.center_px.y()};
    }
    const GateBars bars{px[0], px[1]};
    const auto flat = [](const Eigen::Vector3d& p) { return Eigen::Vector3d{p.x(), p.y(), 0}; };
    const auto fix = fix_from_bars(bars, {rotation_EB(attitude).matrix}, 1.0, rig, anywhere);
    errors.paper.add(fix ? std::optional{flat(fix->p_GB)} : std::nullopt, p_GB);
    GateObservations seen;
    add_bars(seen, bars, 1.0, sigma_px);
    const auto answer = map_pose(seen,
                                 {.attitude_GB = attitude,
                                  .roll_sigma = 1e-3,
                                  .pitch_sigma = 1e-3,
                                  .yaw_sigma = 1e-3,
                                  .z_sigma = 0.5},
                                 rig);
    errors.map.add(answer.pose ? std::optional{flat(answer.pose->p_GB)} : std::nullopt, p_GB);
  }
  return errors;
}

using LineErrors = std::array<Errors, 5>;

void report(const Line& line, const LineErrors& row, Result& result) {
  for (const int axis : {0, 1}) {
    const auto& paper = axis == 0 ? line.paper_x : line.paper_y;
    std::string theirs, ours;
    int good = 0;
    auto points = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < kBarDistances.size(); ++i) {
      const double value = row[i].paper.axis(axis), map = row[i].map.axis(axis);
      good += reproduced(value, paper[i]);
      theirs += fixed(paper[i], 4) + " ", ours += fixed(value, 4) + " ";
      points.push_back({{"distance_m", kBarDistances[i]},
                        {"paper_rmse_m", paper[i]},
                        {"rmse_m", value},
                        {"map_rmse_m", number(map)},
                        {"no_answer", row[i].paper.none},
                        {"map_no_answer", row[i].map.none}});
      result.csv += std::string(line.name) + "," + (axis == 0 ? "x" : "y") + "," +
                    files::text_of(kBarDistances[i]) + "," + files::text_of(paper[i]) + "," +
                    files::text_of(value, 5) + "," +
                    (std::isfinite(map) ? files::text_of(map, 5) : "") + "\n";
    }
    const std::string name = std::string(line.name) + (axis == 0 ? " x" : " y");
    result.table.push_back({name, theirs, ours + "(" + std::to_string(good) + " of 5)"});
    result.json["lines"].push_back(
        {{"line", name}, {"compared", 5}, {"within", good}, {"points", points}});
  }
}

drawing::Plot panel(const std::array<LineErrors, 4>& rows, int axis, const std::string& title) {
  constexpr std::array<drawing::Color, 4> kColors{drawing::kLight.found, drawing::kLight.flown,
                                                  drawing::kLight.muted,
                                                  drawing::kLight.gate_solid};
  drawing::Plot plot{
      .title = title, .x_label = "distance [m]", .y_label = "RMSE [m]", .series = {}};
  for (std::size_t l = 0; l < rows.size(); ++l) {
    if (l == 2) continue;  // -30° is the same as 30°
    const Line& line = lines()[l];
    drawing::PlotSeries ours{.name = line.name, .points = {}, .color = kColors[l]};
    drawing::PlotSeries theirs{
        .name = "", .points = {}, .color = kColors[l], .line = false, .rings = true};
    for (std::size_t i = 0; i < kBarDistances.size(); ++i) {
      ours.points.emplace_back(kBarDistances[i], rows[l][i].paper.axis(axis));
      theirs.points.emplace_back(kBarDistances[i], axis == 0 ? line.paper_x[i] : line.paper_y[i]);
    }
    plot.series.push_back(ours), plot.series.push_back(theirs);
  }
  plot.series.push_back(paper_marks());
  return plot;
}

drawing::Canvas plotted(const std::array<LineErrors, 4>& rows) {
  return drawing::draw_sheet(
      std::array{panel(rows, 0, "Position from the two side bars: x, through the gate"),
                 panel(rows, 1, "Position from the two side bars: y, to the right")},
      1);
}

}  // namespace

Result pose_bars(const Options& options) {
  const int trials = options.quick ? 1'000 : 20'000;
  std::array<LineErrors, 4> rows;
  in_pieces(rows.size() * kBarDistances.size(), options, [&](std::size_t i) {
    rows[i / 5][i % 5] = errors_of(lines()[i / 5], kBarDistances[i % 5], trials);
  });
  Result result{.table = {{"RMSE [m] at", "0.30 0.63 0.97 1.30 1.63", "m"}},
                .json = {{"trials", trials}, {"lines", nlohmann::ordered_json::array()}},
                .csv = "line,axis,distance_m,paper_rmse_m,rmse_m,map_rmse_m\n",
                .picture = plotted(rows)};
  for (std::size_t l = 0; l < rows.size(); ++l) report(lines()[l], rows[l], result);
  return result;
}

}  // namespace gatefly::experiments
