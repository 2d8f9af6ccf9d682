// SPDX-License-Identifier: Apache-2.0
// Is the simulator as lively as the real drone? Recorded flights beside simulated ones that were
// given the same set points.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "gatefly/config/config.hpp"
#include "gatefly/config/derived.hpp"
#include "gatefly/config/track_file.hpp"
#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/liveliness.hpp"
#include "gatefly/experiments/lively_flight.hpp"
#include "gatefly/experiments/recorded_arcs.hpp"
#include "gatefly/experiments/simulated_arcs.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/drawn.hpp"

namespace gatefly::experiments {
namespace {

constexpr std::uint64_t kLivelyReported = 2701,
                        kLivelyLookedAt = 1001;  // first seeds, one a flight: in full, quick
constexpr double kAllowed = 0.30;                // of the real median
constexpr int kLapFlights = 4, kLaps = 5, kQuickLaps = 2;

/// One quantity of all flights, real and simulated in the same order.
struct Quantity {
  std::string key, name;
  int digits = 2;
  bool judged = true;  ///< Else it is said, for it explains another.
  std::vector<double> real = {}, simulated = {};

  [[nodiscard]] static double part(std::vector<double> values, double part) {
    std::sort(values.begin(), values.end());
    return files::quantile(values, part);
  }
  [[nodiscard]] double ratio() const { return part(simulated, 0.5) / part(real, 0.5); }
  [[nodiscard]] bool within() const { return std::abs(ratio() - 1.0) <= kAllowed; }
};

/// All that is compared of one flight, in the order of the table.
struct Measured {
  std::string key, name;
  int digits;
  bool judged;
  double value;
};
std::vector<Measured> measured(const LivelyFlight& flight) {
  std::vector<Measured> all;
  const Vibration shake = vibration_of(flight);
  const auto axes = [&](const std::string& key, const std::string& name, const Eigen::Vector3d& v,
                        int digits, const std::array<const char*, 3>& letters) {
    for (int i = 0; i < 3; ++i) {
      const std::string axis = letters[static_cast<std::size_t>(i)];
      all.push_back({key + "_" + axis, name + ", " + axis, digits, true, v[i]});
    }
  };
  axes("accel_high_mps2", "accelerometer above 20 Hz [m/s²]", shake.accel_high, 2, {"x", "y", "z"});
  axes("accel_low_mps2", "accelerometer 3-20 Hz [m/s²]", shake.accel_low, 2, {"x", "y", "z"});
  axes("gyro_high_radps", "gyro above 20 Hz [rad/s]", shake.gyro_high, 3, {"p", "q", "r"});
  axes("gyro_low_radps", "gyro 3-20 Hz [rad/s]", shake.gyro_low, 3, {"p", "q", "r"});
  for (const int axis : {0, 1}) {
    const Drag drag = drag_of(flight, axis);
    const std::string letter = axis == 0 ? "x" : "y";
    all.push_back({"drag_slope_" + letter, "drag, " + letter + " [1/s]", 2, true, drag.slope});
    all.push_back({"drag_correlation_" + letter, "  correlation of a and v, " + letter, 2, true,
                   drag.correlation});
  }
  for (const int axis : {0, 1}) {
    const AttitudeResponse r = response_of(flight, axis);
    const std::string what = axis == 0 ? "roll" : "pitch";
    all.push_back({what + "_omega_radps", what + " step: ω_n [rad/s]", 1, true, r.omega});
    all.push_back({what + "_zeta", "  ζ", 2, true, r.zeta});
    all.push_back({what + "_delay_ms", "  delay [ms]", 0, false, 1e3 * r.delay});
    all.push_back({what + "_half_ms", "  half of it after [ms]", 0, true, 1e3 * r.half});
    all.push_back({what + "_overshoot", "  overshoot", 3, false, r.overshoot});
    all.push_back({what + "_rms_deg", "  unexplained, RMS [°]", 2, false, r.rms / kDegree});
  }
  const RotorResponse rotors = rotors_of(flight);
  all.push_back({"rotor_lag_ms", "rotors: lag [ms]", 1, false, 1e3 * rotors.lag});
  all.push_back({"rotor_delay_ms", "  delay [ms]", 1, false, 1e3 * rotors.delay});
  const Effectiveness push = effectiveness_of(flight);
  for (const int axis : {0, 1}) {
    const std::string what = axis == 0 ? "roll" : "pitch";
    all.push_back({what + "_effectiveness", what + " acceleration / rotor speed² [10⁻⁶ rad]", 1,
                   false, 1e6 * push.slope[axis]});
    all.push_back({what + "_air", "  air [rad/s² / (m/s²)]", 2, false, push.air[axis]});
    all.push_back({what + "_explained", "  R²", 2, false, push.explained[axis]});
  }
  for (const double t : {1.0, 2.0, 3.0}) {
    const auto speed = speed_after(flight, t);
    all.push_back({"speed_after_" + fixed(t, 0) + "s_mps",
                   "speed " + fixed(t, 0) + " s after nose down [m/s]", 2, true,
                   speed ? *speed : std::nan("")});
  }
  return all;
}

class Comparisons {
 public:
  void add(const LivelyFlight& real, const LivelyFlight& simulated) {
    const auto one = measured(real), two = measured(simulated);
    for (std::size_t i = 0; i < one.size(); ++i)
      if (std::isfinite(one[i].value) && std::isfinite(two[i].value)) {
        Quantity& q = of(one[i].key, one[i].name, one[i].digits, one[i].judged);
        q.real.push_back(one[i].value), q.simulated.push_back(two[i].value);
      }
  }
  Quantity& of(const std::string& key, const std::string& name, int digits, bool judged) {
    for (Quantity& q : quantities_)
      if (q.key == key) return q;
    quantities_.push_back({.key = key, .name = name, .digits = digits, .judged = judged});
    return quantities_.back();
  }
  [[nodiscard]] const std::vector<Quantity>& quantities() const { return quantities_; }

 private:
  std::vector<Quantity> quantities_;
};

/// The truth of one seed.
world::SimConfig config_of_seed(std::uint64_t seed) {
  const config::Config config = config::load_config(config::config_files({}));
  const config::TrackFile track = config::read_track(config::find_track("oval"), config.gate);
  return sim::drawn(config::simulator_config(config, track), world::randomize_level("race"), seed);
}

std::string quartiles(const std::vector<double>& values, int digits) {
  return fixed(Quantity::part(values, 0.5), digits) + " (" +
         fixed(Quantity::part(values, 0.25), digits) + " to " +
         fixed(Quantity::part(values, 0.75), digits) + ")";
}

void report(const std::vector<Quantity>& quantities, Result& result) {
  int judged = 0, within = 0;
  result.csv =
      "quantity,real_q25,real_median,real_q75,simulated_q25,simulated_median,"
      "simulated_q75,ratio,judged,within\n";
  auto& json = result.json["quantities"] = nlohmann::ordered_json::object();
  for (const Quantity& q : quantities) {
    if (q.judged) ++judged, within += q.within() ? 1 : 0;
    result.table.push_back({q.name, quartiles(q.real, q.digits),
                            quartiles(q.simulated, q.digits) + ", ratio " + fixed(q.ratio(), 2) +
                                (!q.judged    ? ""
                                 : q.within() ? ""
                                              : ": NOT within 30 %")});
    result.csv += q.key;
    auto& told = json[q.key];
    for (const auto* side : {&q.real, &q.simulated}) {
      auto values = nlohmann::ordered_json::array();
      for (const double part : {0.25, 0.5, 0.75}) {
        const double value = Quantity::part(*side, part);
        result.csv += "," + files::text_of(value, 5);
        values.push_back(number(value));
      }
      told[side == &q.real ? "real" : "simulated"] = values;
    }
    result.csv += "," + files::text_of(q.ratio(), 4) + (q.judged ? ",1," : ",0,") +
                  (q.within() ? "1\n" : "0\n");
    told["count"] = q.real.size();
    told["ratio"] = number(q.ratio());
    told["judged"] = q.judged, told["within_30_percent"] = q.within();
  }
  result.table.push_back({"within ± 30 % of the real median", "",
                          std::to_string(within) + " of " + std::to_string(judged)});
  result.json["judged"] = judged, result.json["within"] = within;
}

drawing::Plot trace(const LivelyFlight& real, const LivelyFlight& simulated,
                    const std::string& title, const std::string& y,
                    const std::function<double(const LivelyFlight&, std::size_t)>& of,
                    const std::function<double(const LivelySample&)>& wanted) {
  drawing::Plot plot{.title = title, .x_label = "time [s]", .y_label = y, .y_from_0 = false};
  plot.series = {{.name = "real", .marks = false},
                 {.name = "simulated", .color = drawing::kLight.gate_solid, .marks = false}};
  if (wanted)
    plot.series.push_back({.name = "set point", .color = drawing::kLight.flown, .marks = false});
  constexpr std::size_t kOneIn = 4;
  for (std::size_t i = real.first; i < real.last; i += kOneIn) {
    plot.series[0].points.emplace_back(real.samples[i].t, of(real, i));
    plot.series[1].points.emplace_back(real.samples[i].t, of(simulated, i));
    if (wanted) plot.series[2].points.emplace_back(real.samples[i].t, wanted(real.samples[i]));
  }
  return plot;
}

drawing::Plot ratios(const std::vector<Quantity>& quantities) {
  drawing::Plot plot{.title = "All judged quantities",
                     .x_label = "number in the table",
                     .y_label = "simulated / real"};
  plot.series = {{.name = "ratio of the medians", .line = false},
                 {.name = "± 30 %", .color = drawing::kLight.flown, .marks = false, .dash = 6},
                 {.name = "", .color = drawing::kLight.flown, .marks = false, .dash = 6}};
  int i = 0;
  for (const Quantity& q : quantities) {
    if (!q.judged) continue;
    plot.series[0].points.emplace_back(++i, q.ratio());
  }
  for (const double x : {0.0, i + 1.0})
    plot.series[1].points.emplace_back(x, 1.0 + kAllowed),
        plot.series[2].points.emplace_back(x, 1.0 - kAllowed);
  return plot;
}

/// How fast a straight at -5° ends: half circles flown by the paper's scheme, by motion capture and
/// simulated.
void add_laps(Comparisons& all, const Options& options) {
  const RecordedArcs takes = recorded_arcs(options);
  const SimulatedArcs flown =
      simulated_arcs({.level = "race",
                      .flights = options.quick ? 1 : kLapFlights,
                      .laps = options.quick ? kQuickLaps : kLaps,
                      .first_seed = first_seed(options, kLivelyReported, kLivelyLookedAt)},
                     options);
  for (const bool entry : {true, false}) {
    Quantity& q = all.of(
        entry ? "lap_entry_speed_mps" : "lap_exit_speed_mps",
        entry ? "laps at -5°: speed where a straight ends [m/s]" : "  where the half circle ends",
        2, true);
    for (const BlindArc& arc : takes.arcs())
      q.real.push_back(entry ? arc.entry_speed() : arc.exit_speed());
    for (const BlindArc& arc : flown.arcs)
      q.simulated.push_back(entry ? arc.entry_speed() : arc.exit_speed());
  }
}

}  // namespace

Result twin_liveliness(const Options& options) {
  const std::vector<LivelyFlight> flights =
      lively_flights(data_folder("tudelft_bebop_flights", options), options);
  Comparisons all;
  std::vector<drawing::Plot> plots;
  const std::size_t count =
      options.quick ? std::min<std::size_t>(2, flights.size()) : flights.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (options.stopped()) throw Stopped{};
    options.progress(0.8 * static_cast<double>(i) / static_cast<double>(count), flights[i].name);
    const LivelyFlight simulated = flown_again(
        flights[i], config_of_seed(first_seed(options, kLivelyReported, kLivelyLookedAt) + i));
    all.add(flights[i], simulated);
    if (i > 0) continue;
    const LivelyFlight& real = flights[i];
    plots.push_back(trace(
        real, simulated, real.name + ": roll", "roll [°]",
        [](const LivelyFlight& f, std::size_t k) { return f.samples[k].attitude.roll / kDegree; },
        [](const LivelySample& s) { return s.wanted.roll / kDegree; }));
    plots.push_back(trace(real, simulated, real.name + ": speed along the nose", "speed [m/s]",
                          [](const LivelyFlight& f, std::size_t k) { return f.v_B(k).x(); }, {}));
    plots.push_back(trace(
        real, simulated, real.name + ": accelerometer x", "a [m/s²]",
        [](const LivelyFlight& f, std::size_t k) { return f.samples[k].imu.accel_B.x(); }, {}));
  }
  options.progress(0.85, "laps");
  add_laps(all, options);

  Result result{.table = {}, .json = {}, .csv = {}, .picture = drawing::Canvas(1, 1)};
  report(all.quantities(), result);
  result.json["flights"] = count,
  result.json["first_seed"] = first_seed(options, kLivelyReported, kLivelyLookedAt);
  plots.push_back(ratios(all.quantities()));
  result.picture = drawing::draw_sheet(plots, 2);
  return result;
}

}  // namespace gatefly::experiments
