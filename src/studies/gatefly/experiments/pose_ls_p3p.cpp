// SPDX-License-Identifier: Apache-2.0
// Li18's figure "LS vs PnP": position error of least squares and P3P over the distance; with the
// noise that the authors really drew, and with the noise that the paper names.
#include <array>
#include <cmath>
#include <optional>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();

/// A curve of a figure or a column of a table: one value for each distance, NaN where there is
/// none.
using Column = std::vector<double>;

/// Errors of one draw of noise.
struct Noise {
  const char* name;
  bool gaussian;          ///< Else uniform.
  double px_sigma;        ///< Noise of u and v [px].
  double attitude_sigma;  ///< Noise of roll, pitch and yaw [rad].

  [[nodiscard]] double draw(sim::Stream& random, double sigma) const {
    return gaussian ? sigma * random.normal() : sigma * std::sqrt(3.0) * random.uniform(-1.0, 1.0);
  }
};

/// Curve to compare: an axis of one method under one noise.
struct Curve {
  const char* name;
  Noise noise;
  std::optional<KneipRule> p3p;  ///< Else least squares.
  int axis;
  Column paper;
};

/// Uniform within ±w has σ = w / √3.
Noise as_run(const char* name, double attitude_width_deg) {
  return {name, false, 1.75 / std::sqrt(3.0), 0.5 * attitude_width_deg * kDegree / std::sqrt(3.0)};
}
Noise as_printed(const char* name, double attitude_sigma_deg) {
  return {name, true, 3.5, attitude_sigma_deg * kDegree};
}

constexpr KneipRule kAuthors;

const Column kDistances{.87, 1.20, 1.53, 1.87, 2.20, 2.53, 2.87, 3.20, 3.53, 3.87};
const Column kTableDistances{.87, 1.87, 2.87, 3.87, 5.0, 6.0};

/// Digitised from the authors' figure files; the noise from their analysis code (E7).
std::vector<Curve> curves_as_run() {
  const Noise none = as_run("0", 0.0), five = as_run("'5'", 2.2), fifteen = as_run("'15'", 3.8);
  return {
      {"P3P x", none, kAuthors, 0, {.005, .009, .013, .021, .031, .046, .080, .129, .194, .243}},
      {"P3P y", none, kAuthors, 1, {.012, .027, .053, .092, .154, .212, .296, .422, .563, .680}},
      {"P3P z", none, kAuthors, 2, {.011, .028, .059, .104, .158, .219, .287, .436, .575, .693}},
      {"LS x", none, {}, 0, {.003, .006, .010, .014, .019, .026, .034, .042, .048, .059}},
      {"LS y '0'", none, {}, 1, {.003, .004, .004, .005, .006, .007, .008, .009, .010, .011}},
      {"LS y '5'", five, {}, 1, {.013, .017, .019, .024, .028, .032, .036, .040, .043, .046}},
      {"LS y '15'", fifteen, {}, 1, {.022, .028, .035, .040, .047, .054, .060, .067, .073, .080}}};
}

/// Recomputed by others from the paper's text: 3.5 px and the printed variances, taken as they are.
std::vector<Curve> curves_as_printed() {
  const Noise none = as_printed("0", 0.0), five = as_printed("2.24°", 2.24),
              fifteen = as_printed("3.87°", 3.87), poor = as_printed("15°", 15.0);
  return {{"LS x", none, {}, 0, {.011, .047, .114, .199, .34, .48}},
          {"LS y", none, {}, 1, {.009, .018, .028, .037, .048, .059}},
          {"LS y 2.24°", five, {}, 1, {.046, .083, .123, .165, .21, .25}},
          {"LS y 3.87°", fifteen, {}, 1, {.076, .143, .209, .276, .35, .41}},
          {"LS y 15°", poor, {}, 1, {.25, .45, .68, .90, 1.2, 1.4}},
          {"P3P x", none, kAuthors, 0, Column(6, kNotGiven)},
          {"P3P y", none, kAuthors, 1, Column(6, kNotGiven)}};
}

Rmse errors_of(const Curve& curve, double distance, int trials) {
  const CameraRig rig = study_rig();
  const Eigen::Vector3d p_GB{-distance, 0, 0};
  const Quad exact = corners_seen_from(p_GB, {}, rig);
  sim::Stream random(static_cast<std::uint64_t>(std::lround(100.0 * distance)),
                     std::string("pose-ls-p3p/") + curve.noise.name);
  Rmse rmse;
  for (int i = 0; i < trials; ++i) {
    Quad px = exact;
    for (Eigen::Vector2d& corner : px)
      for (double& coordinate : corner)
        coordinate += curve.noise.draw(random, curve.noise.px_sigma);
    const double roll = curve.noise.draw(random, curve.noise.attitude_sigma),
                 pitch = curve.noise.draw(random, curve.noise.attitude_sigma);
    const Attitude attitude{roll, pitch, curve.noise.draw(random, curve.noise.attitude_sigma)};
    rmse.add(curve.p3p ? by_kneip(*curve.p3p, px, rig, 1.0) : by_rays(px, attitude, rig, 1.0),
             p_GB);
  }
  return rmse;
}

struct Study {
  const char* name;
  const Column& distances;
  std::vector<Curve> curves;
  std::vector<Column> ours = {};
};

void run(Study& study, int trials, const Options& options) {
  const std::size_t points = study.distances.size();
  study.ours.assign(study.curves.size(), Column(points, kNotGiven));
  in_pieces(study.curves.size() * points, options, [&](std::size_t i) {
    const Curve& curve = study.curves[i / points];
    study.ours[i / points][i % points] =
        errors_of(curve, study.distances[i % points], trials).axis(curve.axis);
  });
}

/// The table has every third distance of a long list, the files all.
bool shown(const Study& study, std::size_t i) { return study.distances.size() <= 6 || i % 3 == 0; }

std::string distances_of(const Study& study) {
  std::string list;
  for (std::size_t i = 0; i < study.distances.size(); ++i)
    if (shown(study, i)) list += files::text_of(study.distances[i]) + " ";
  return list + "m";
}

void report(const Study& study, Result& result) {
  result.table.push_back({std::string(study.name) + ", RMSE [m] at", distances_of(study), ""});
  for (std::size_t c = 0; c < study.curves.size(); ++c) {
    const Curve& curve = study.curves[c];
    std::string paper, ours;
    int compared = 0, good = 0;
    auto points = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < study.distances.size(); ++i) {
      const double theirs = curve.paper[i], mine = study.ours[c][i];
      if (std::isfinite(theirs) && std::isfinite(mine))
        ++compared, good += reproduced(mine, theirs);
      if (shown(study, i)) paper += fixed(theirs, 3) + " ", ours += fixed(mine, 3) + " ";
      points.push_back({{"distance_m", study.distances[i]},
                        {"paper_rmse_m", number(theirs)},
                        {"rmse_m", number(mine)}});
      result.csv += std::string(study.name) + "," + curve.name + "," +
                    files::text_of(study.distances[i]) + "," +
                    (std::isfinite(theirs) ? files::text_of(theirs) : "") + "," +
                    (std::isfinite(mine) ? files::text_of(mine, 5) : "") + "\n";
    }
    const std::string within =
        compared > 0 ? "(" + std::to_string(good) + " of " + std::to_string(compared) + ")" : "";
    result.table.push_back({std::string(study.name) + " " + curve.name, paper, ours + within});
    result.json["curves"].push_back({{"study", study.name},
                                     {"curve", curve.name},
                                     {"compared", compared},
                                     {"within", good},
                                     {"points", points}});
  }
}

/// How the authors may have chosen among a P3P's answers, and how many points of their curves that
/// gives.
struct Variant {
  const char* name;
  KneipRule rule;
  int within = 0, compared = 0;
};

std::vector<Variant> variants(int trials, const Options& options) {
  std::vector<Variant> list{
      {"real parts of complex roots, least distances", kAuthors},
      {"real parts of complex roots, least squares", {.squares = true}},
      {"real roots only, least distances", {.complex_roots = false}},
      {"real roots only, least squares", {.complex_roots = false, .squares = true}},
      {"TL TR BR only, the fourth chooses", {.triples = 1}}};
  std::vector<Curve> theirs = curves_as_run();
  std::erase_if(theirs, [](const Curve& curve) { return !curve.p3p; });
  const std::size_t points = kDistances.size();
  std::vector<Rmse> errors(list.size() * points);
  in_pieces(errors.size(), options, [&](std::size_t i) {
    Curve curve = theirs.front();
    curve.p3p = list[i / points].rule;
    errors[i] = errors_of(curve, kDistances[i % points], trials);
  });
  for (std::size_t i = 0; i < errors.size(); ++i)
    for (const Curve& curve : theirs)
      ++list[i / points].compared, list[i / points].within +=
                                   reproduced(errors[i].axis(curve.axis), curve.paper[i % points]);
  return list;
}

void report(const std::vector<Variant>& list, Result& result) {
  auto json = nlohmann::ordered_json::array();
  for (const Variant& v : list) {
    result.table.push_back({std::string("P3P as run: ") + v.name, "",
                            std::to_string(v.within) + " of " + std::to_string(v.compared)});
    json.push_back({{"variant", v.name}, {"compared", v.compared}, {"within", v.within}});
  }
  result.json["p3p_variants"] = json;
}

/// One panel: the curves of one method.
drawing::Plot panel(const Study& study, bool p3p, const std::string& title) {
  constexpr std::array<drawing::Color, 4> kColors{drawing::kLight.estimate,
                                                  drawing::kLight.gate_solid, drawing::kLight.found,
                                                  drawing::kLight.flown};
  drawing::Plot plot{
      .title = title, .x_label = "distance [m]", .y_label = "RMSE [m]", .series = {}};
  for (std::size_t c = 0, shown = 0; c < study.curves.size(); ++c) {
    if (study.curves[c].p3p.has_value() != p3p) continue;
    const drawing::Color color = kColors[shown++];
    drawing::PlotSeries ours{.name = study.curves[c].name, .points = {}, .color = color};
    drawing::PlotSeries theirs{
        .name = "", .points = {}, .color = color, .line = false, .rings = true};
    for (std::size_t i = 0; i < study.distances.size(); ++i) {
      ours.points.emplace_back(study.distances[i], study.ours[c][i]);
      theirs.points.emplace_back(study.distances[i], study.curves[c].paper[i]);
    }
    plot.series.push_back(ours), plot.series.push_back(theirs);
  }
  plot.series.push_back(paper_marks());
  return plot;
}

/// Above each other: P3P is ten times as far off.
drawing::Canvas plotted(const Study& study) {
  return drawing::draw_sheet(
      std::array{panel(study, true, "P3P, noise as the authors drew it"),
                 panel(study, false, "Least squares (LS), the same corners")},
      1);
}

}  // namespace

Result pose_ls_p3p(const Options& options) {
  const int trials = options.quick ? 500 : 10'000;
  Study as_run_{"as run", kDistances, curves_as_run()},
      printed{"3.5 px", kTableDistances, curves_as_printed()};
  run(as_run_, trials, options);
  run(printed, trials, options);
  Result result{.table = {},
                .json = {{"trials", trials}, {"curves", nlohmann::ordered_json::array()}},
                .csv = "study,curve,distance_m,paper_rmse_m,rmse_m\n",
                .picture = plotted(as_run_)};
  report(as_run_, result);
  report(printed, result);
  report(variants(trials, options), result);
  return result;
}

}  // namespace gatefly::experiments
