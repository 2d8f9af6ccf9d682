// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/arc_ablation.hpp"

#include <functional>
#include <utility>

#include "gatefly/experiments/arc_table.hpp"
#include "gatefly/experiments/simulated_arcs.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kBias = 0.1;    // 0.6° of tilt, once the AHRS believes it [m/s²]
constexpr double kLess = 0.9;    // of the drag
constexpr double kWind = 0.2;    // [m/s]
constexpr double kFaster = 1.5;  // rotors; the loop's gains below accordingly

using Settings = std::vector<std::string>;
using Change = std::function<void(world::SimConfig&)>;

/// Something that is put right, or made wrong.
struct Step {
  std::string name;
  Settings settings;
  Change change;
};

// The simulated drone's own drag at 1.6 m/s [1/s]: rotor_drag, and body_drag times the speed.
// [world/sim_config.hpp]
struct TrueDrag {
  std::string x, y, z;
};
TrueDrag true_drag() {
  constexpr double kSpeed = 1.6;
  const world::VehicleTruth vehicle;
  const auto text = [&](int axis) {
    return files::text_of(vehicle.rotor_drag[axis] - kSpeed * vehicle.body_drag, 4);
  };
  return {text(0), text(1), text(2)};
}

void without_errors(world::SensorTruth& sensors) {
  sensors.accel_bias.setZero(), sensors.gyro_bias.setZero();
  sensors.noise_scale = 0.0;
}

std::vector<Step> put_right() {
  const TrueDrag k = true_drag();
  return {
      {"sensors without bias and noise",
       {},
       [](world::SimConfig& sim) { without_errors(sim.sensors); }},
      {"and the filter's drag", {"filter.drag_per_s=[" + k.x + "," + k.y + "]"}, {}},
      {"and the speed on entry", {"control.entry_speed_drag_per_s=" + k.x}, {}},
      {"and the arc's drag", {"control.arc_drag_per_s=[" + k.x + "," + k.y + "," + k.z + "]"}, {}},
  };
}

std::vector<Step> made_wrong() {
  return {
      {"an accelerometer that reads 0.1 m/s² too much ahead",
       {},
       [](world::SimConfig& sim) { sim.sensors.flight_bias.x() = kBias; }},
      {"... 0.1 m/s² too much to the right, the turn's inside",
       {},
       [](world::SimConfig& sim) { sim.sensors.flight_bias.y() = kBias; }},
      {"10 % less drag", {}, [](world::SimConfig& sim) { sim.vehicle.rotor_drag *= kLess; }},
      {"0.2 m/s of wind along the lanes",
       {},
       [](world::SimConfig& sim) { sim.wind.mean.x() = kWind; }},
      {"attitude loop and rotors 1.5 times as fast",
       {"control.attitude_gain_per_s2=450", "control.yaw_attitude_gain_per_s2=450",
        "control.rate_gain_per_s=42", "control.yaw_rate_gain_per_s=42"},
       [](world::SimConfig& sim) { sim.vehicle.rotor_time_constant /= kFaster; }},
  };
}

}  // namespace

void report_ablation(const std::vector<BlindArc>& as_flown, const ArcFlightCount& count,
                     const Options& options, Result& result) {
  Settings settings;
  std::vector<Change> changes;
  const auto flown = [&](const Step& step) {
    Settings all = settings;
    all.insert(all.end(), step.settings.begin(), step.settings.end());
    std::vector<Change> each = changes;
    if (step.change) each.push_back(step.change);
    return simulated_arcs({.level = "none",
                           .settings = all,
                           .change =
                               [each](world::SimConfig& sim) {
                                 for (const Change& change : each) change(sim);
                               },
                           .flights = count.flights,
                           .laps = count.laps,
                           .first_seed = count.first_seed},
                          options)
        .arcs;
  };
  auto told = nlohmann::ordered_json::array();
  const auto tell = [&](const std::string& name, const std::vector<BlindArc>& arcs,
                        const Eigen::Vector2d& before) {
    const Spread2 ends = ends_of(arcs);
    result.table.push_back({"  " + name, "",
                            text_of(ends.mean) + " ± " + text_of(ends.deviation()) +
                                " m: moved by " + text_of(ends.mean - before)});
    told.push_back({{"with", name},
                    {"arcs", arcs.size()},
                    {"mean_m", json_of(ends.mean)},
                    {"std_m", json_of(ends.deviation())},
                    {"moves_m", json_of(ends.mean - before)}});
    return ends.mean;
  };
  const Spread2 first = ends_of(as_flown);
  result.table.push_back({"simulated none, put right one after the other", "",
                          text_of(first.mean) + " ± " + text_of(first.deviation()) + " m"});
  Eigen::Vector2d mean = first.mean;
  std::vector<BlindArc> right;
  for (const Step& step : put_right()) {
    right = flown(step);
    mean = tell(step.name, right, mean);
    settings.insert(settings.end(), step.settings.begin(), step.settings.end());
    if (step.change) changes.push_back(step.change);
  }
  result.table.push_back({"  what is left", "",
                          "by 3° left, late nose, speed, slip: x " + parts_text(right, 0) + "; y " +
                              parts_text(right, 1)});
  result.table.push_back({"from there, one thing wrong", "", text_of(mean) + " m"});
  for (const Step& step : made_wrong()) (void)tell(step.name, flown(step), mean);
  result.json["simulated"]["ablation"] = told;
}

}  // namespace gatefly::experiments
