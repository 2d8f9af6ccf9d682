// SPDX-License-Identifier: Apache-2.0
// Ours: the pose by maximum a posteriori against rays and PnP, over distance, attitude noise, pixel
// noise and the gate's yaw; whether its covariance is consistent; and with one gross outlier.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/pose/map_pose.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kOutlierShare = 0.3, kLeastOutlierPx = 10.0, kMostOutlierPx = 40.0;

/// One setting of the grid and what came out of its trials.
struct Cell {
  double distance, attitude_deg, px, yaw_deg;

  Rmse map = {}, rays = {}, sqpnp = {}, ippe = {}, p3p = {};
  double nees = 0.0;  ///< Summed, of the position.
  /// With an outlier in 30 % of the trials; the oracle knows which corner it is.
  Rmse map_outlier = {}, oracle = {};
  double nees_outlier = 0.0;

  [[nodiscard]] double best_other() const {
    double best = std::numeric_limits<double>::infinity();
    for (const Rmse* other : {&rays, &sqpnp, &ippe, &p3p})
      if (other->n > 0) best = std::min(best, other->all());
    return best;
  }
  [[nodiscard]] double against_best() const { return map.all() / best_other(); }
  [[nodiscard]] double against_rays() const { return map.all() / rays.all(); }
  [[nodiscard]] double against_oracle() const { return map_outlier.all() / oracle.all(); }
  [[nodiscard]] double nees_per_axis() const { return nees / (3.0 * map.n); }
  [[nodiscard]] std::string name() const {
    return files::text_of(distance) + " m, " + files::text_of(attitude_deg) + "°, " +
           files::text_of(px) + " px, yaw " + files::text_of(yaw_deg) + "°";
  }
};

std::vector<Cell> grid() {
  std::vector<Cell> cells;
  for (const double attitude_deg : {0.0, 2.0, 5.0, 15.0})
    for (const double px : {1.0, 3.5, 5.0})
      for (const double distance : {1.0, 1.5, 2.0, 3.0, 4.0, 6.0})
        for (const double yaw_deg : {-30.0, 0.0, 30.0})
          cells.push_back(
              {.distance = distance, .attitude_deg = attitude_deg, .px = px, .yaw_deg = yaw_deg});
  return cells;
}

std::optional<Eigen::Vector3d> position_of(const MapPoseAnswer& answer) {
  return answer.pose ? std::optional{answer.pose->p_GB} : std::nullopt;
}

double nees_of(const MapPoseAnswer& answer, const Eigen::Vector3d& p_GB) {
  if (!answer.pose) return 0.0;
  const Eigen::Vector3d error = answer.pose->p_GB - p_GB;
  const Eigen::Matrix3d P = answer.pose->covariance.topLeftCorner<3, 3>();
  return error.dot(P.inverse() * error);
}

/// The gate is turned by its yaw and seen straight ahead, at the camera's height.
void run(Cell& cell, int trials) {
  const CameraRig rig = study_rig();
  const double yaw = cell.yaw_deg * kDegree, sigma = cell.attitude_deg * kDegree;
  const Attitude truth{0, 0, yaw};
  const Eigen::Vector3d p_GB = rotation_z(yaw) * Eigen::Vector3d{-cell.distance, 0, 0};
  const Quad exact = corners_seen_from(p_GB, truth, rig);
  sim::Stream random(1, "pose-grid/" + cell.name());
  for (int i = 0; i < trials; ++i) {
    Quad px = exact;
    for (Eigen::Vector2d& corner : px)
      for (double& coordinate : corner) coordinate += cell.px * random.normal();
    const double roll = sigma * random.normal(), pitch = sigma * random.normal();
    const Attitude measured{roll, pitch, yaw + sigma * random.normal()};
    const PosePrior prior{
        .attitude_GB = measured, .roll_sigma = sigma, .pitch_sigma = sigma, .yaw_sigma = sigma};

    GateObservations seen;
    add_corners(seen, px, 1.0, cell.px);
    const MapPoseAnswer answer = map_pose(seen, prior, rig);
    cell.map.add(position_of(answer), p_GB);
    cell.nees += nees_of(answer, p_GB);
    if (answer.pose) {  // what ours refuses nobody is asked
      cell.rays.add(by_rays(px, measured, rig, 1.0), p_GB);
      cell.sqpnp.add(by_pnp(Pnp::kSqpnp, px, rig, 1.0), p_GB);
      cell.ippe.add(by_pnp(Pnp::kIppe, px, rig, 1.0), p_GB);
      cell.p3p.add(by_pnp(Pnp::kP3p, px, rig, 1.0), p_GB);
    }

    GateObservations good = seen;
    if (random.uniform() < kOutlierShare) {
      const auto bad = static_cast<std::size_t>(4.0 * random.uniform());
      const double direction = random.uniform(-kPi, kPi),
                   size = random.uniform(kLeastOutlierPx, kMostOutlierPx);
      seen[bad].px += size * Eigen::Vector2d{gatefly::cos(direction), gatefly::sin(direction)};
      good[bad] = good[3];
      good.pop_back();
    }
    const MapPoseAnswer robust = map_pose(seen, prior, rig),
                        oracle = map_pose(good, prior, rig, {.max_outliers = 0.0});
    if (!robust.pose || !oracle.pose) {
      cell.map_outlier.none += !robust.pose, cell.oracle.none += !oracle.pose;
      continue;
    }
    cell.map_outlier.add(position_of(robust), p_GB), cell.oracle.add(position_of(oracle), p_GB);
    cell.nees_outlier += nees_of(robust, p_GB);
  }
}

/// A claim over some of the cells: how many keep it, and which is the worst.
struct Claim {
  std::string what;
  bool (*concerns)(const Cell&);
  double (*value)(const Cell&);
  double at_least, at_most;

  void report(const std::vector<Cell>& cells, Result& result) const {
    int n = 0, kept = 0;
    const Cell* worst = nullptr;
    for (const Cell& cell : cells) {
      if (!concerns(cell) || !std::isfinite(value(cell))) continue;
      const double v = value(cell);
      ++n, kept += v >= at_least && v <= at_most;
      if (worst == nullptr || v > value(*worst)) worst = &cell;
    }
    const std::string limit =
        (at_least > 0.0 ? fixed(at_least, 2) + "-" : "at most ") + fixed(at_most, 2);
    result.table.push_back(
        {what, limit,
         std::to_string(kept) + " of " + std::to_string(n) +
             (worst != nullptr ? ", most " + fixed(value(*worst), 2) + " (" + worst->name() + ")"
                               : "")});
    result.json["claims"].push_back({{"what", what},
                                     {"at_least", at_least},
                                     {"at_most", at_most},
                                     {"cells", n},
                                     {"kept", kept},
                                     {"most", worst != nullptr ? number(value(*worst)) : nullptr}});
  }
};

const std::vector<Claim>& claims() {
  static const std::vector<Claim> list{
      {"MAP / best other, <= 5°", [](const Cell& c) { return c.attitude_deg <= 5.0; },
       [](const Cell& c) { return c.against_best(); }, 0, 1.05},
      {"MAP / best other, 15°", [](const Cell& c) { return c.attitude_deg > 5.0; },
       [](const Cell& c) { return c.against_best(); }, 0, 1.10},
      {"MAP / rays, 1 m, >= 5°",
       [](const Cell& c) { return c.distance == 1.0 && c.attitude_deg >= 5.0; },
       [](const Cell& c) { return c.against_rays(); }, 0, 0.70},
      {"MAP / rays, 1.5-2 m, 15°, <= 3.5 px",
       [](const Cell& c) {
         return (c.distance == 1.5 || c.distance == 2.0) && c.attitude_deg > 5.0 && c.px <= 3.5;
       },
       [](const Cell& c) { return c.against_rays(); }, 0, 0.70},
      {"NEES/3, <= 5°", [](const Cell& c) { return c.attitude_deg <= 5.0; },
       [](const Cell& c) { return c.nees_per_axis(); }, 0.8, 1.25},
      {"NEES/3, 15° (conservative)", [](const Cell& c) { return c.attitude_deg > 5.0; },
       [](const Cell& c) { return c.nees_per_axis(); }, 0, 1.25},
      {"outlier: MAP / oracle, <= 5°", [](const Cell& c) { return c.attitude_deg <= 5.0; },
       [](const Cell& c) { return c.against_oracle(); }, 0, 1.2},
      {"outlier: MAP / oracle, 15°", [](const Cell& c) { return c.attitude_deg > 5.0; },
       [](const Cell& c) { return c.against_oracle(); }, 0, 1.2},
  };
  return list;
}

/// The largest share of trials without an answer of any cell.
double most_refused(const std::vector<Cell>& cells, Rmse Cell::*method) {
  double most = 0.0;
  for (const Cell& cell : cells)
    most = std::max(most, static_cast<double>((cell.*method).none) /
                              std::max(1, (cell.*method).n + (cell.*method).none));
  return most;
}

std::string csv_of(const std::vector<Cell>& cells) {
  std::string csv =
      "distance_m,attitude_deg,px,gate_yaw_deg,map_m,rays_m,sqpnp_m,ippe_m,p3p_m,map_over_best,"
      "nees_per_axis,map_refused,"
      "outlier_map_m,outlier_oracle_m,outlier_ratio,outlier_nees_per_axis,outlier_refused\n";
  for (const Cell& c : cells) {
    for (const double value :
         {c.distance, c.attitude_deg, c.px, c.yaw_deg, c.map.all(), c.rays.all(), c.sqpnp.all(),
          c.ippe.all(), c.p3p.all(), c.against_best(), c.nees_per_axis(),
          static_cast<double>(c.map.none), c.map_outlier.all(), c.oracle.all(), c.against_oracle(),
          c.nees_outlier / (3.0 * c.map_outlier.n)})
      csv += (std::isfinite(value) ? files::text_of(value, 5) : "") + ",";
    csv += std::to_string(c.map_outlier.none) + "\n";
  }
  return csv;
}

drawing::Canvas plotted(const std::vector<Cell>& cells) {
  std::vector<drawing::Plot> plots;
  for (const double attitude_deg : {0.0, 5.0, 15.0}) {
    drawing::Plot plot{.title = "Position error, 3.5 px, attitude " + files::text_of(attitude_deg) +
                                "°, gate straight across",
                       .x_label = "distance [m]",
                       .y_label = "3-D RMSE [m]",
                       .series = {{.name = "P3P", .color = drawing::kLight.muted},
                                  {.name = "IPPE", .color = drawing::kLight.flown},
                                  {.name = "SQPNP", .color = drawing::kLight.estimate},
                                  {.name = "MAP (ours)", .color = drawing::kLight.found},
                                  {.name = "rays (paper)",
                                   .color = drawing::kLight.gate_solid,
                                   .line = false,
                                   .rings = true}}};  // often the same points
    for (const Cell& c : cells) {
      if (c.attitude_deg != attitude_deg || c.px != 3.5 || c.yaw_deg != 0.0) continue;
      const std::array<double, 5> values{c.p3p.all(), c.ippe.all(), c.sqpnp.all(), c.map.all(),
                                         c.rays.all()};
      for (std::size_t i = 0; i < values.size(); ++i)
        plot.series[i].points.emplace_back(c.distance, values[i]);
    }
    plots.push_back(plot);
  }
  return drawing::draw_sheet(plots, 1);
}

}  // namespace

Result pose_grid(const Options& options) {
  const int trials = options.quick ? 50 : 1'000;
  std::vector<Cell> cells = grid();
  in_pieces(cells.size(), options, [&](std::size_t i) { run(cells[i], trials); });

  Result result{.table = {},
                .json = {{"trials", trials},
                         {"cells", cells.size()},
                         {"opencv", has_pnp()},
                         {"claims", nlohmann::ordered_json::array()}},
                .csv = csv_of(cells),
                .picture = plotted(cells)};
  for (const Claim& claim : claims()) claim.report(cells, result);
  const double refused = most_refused(cells, &Cell::map),
               refused_outlier = most_refused(cells, &Cell::map_outlier);
  result.table.push_back(
      {"refused, worst cell", "-",
       fixed(100 * refused, 1) + " %, with outliers " + fixed(100 * refused_outlier, 1) + " %"});
  result.json["most_refused"] = refused, result.json["most_refused_outlier"] = refused_outlier;
  if (!has_pnp()) result.table.push_back({"SQPNP, IPPE, P3P", "-", kNoPnp});
  return result;
}

}  // namespace gatefly::experiments
