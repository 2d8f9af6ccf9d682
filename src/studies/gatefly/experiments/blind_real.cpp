// SPDX-License-Identifier: Apache-2.0
// How far two filters drift on real flights when nothing is seen: drag (Li18 §3.3) and the classic
// inertial one.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/estimation/eskf/error_state_filter.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/two_filters.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/flight_log/baseline/imu15.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/sim/random.hpp"
#include "gatefly/tasks/identification/drag_fit.hpp"

namespace gatefly::experiments {
namespace {

namespace fs = std::filesystem;
using identification::DragFit;

constexpr double kRest = 0.7;  // of every log, before the motors start [s]
constexpr double kFixPeriod = 1.0 / 15.0, kEvery = 0.1, kSettle = 1.0;  // [s]
constexpr double kFixSigma = 0.03;                                      // [m]
constexpr double kLogHeadingSigma = 15.0 * kDegree;                     // configs/flights.toml
constexpr double kBiasSigma = 0.05;  // of a bias that other flights taught [m/s²]
constexpr std::array kLengths{0.5, 1.0, 1.5, 2.0, 3.0, 4.0};  // of a blind piece [s]
constexpr std::size_t kTwoSeconds = 3;

/// Squared horizontal errors, for each blind length.
struct Errors {
  std::array<double, kLengths.size()> sum{};
  std::array<int, kLengths.size()> count{};

  void add(std::size_t length, double error) { sum[length] += error * error, ++count[length]; }
  void add(const Errors& other) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += other.sum[i], count[i] += other.count[i];
  }
  [[nodiscard]] double rms(std::size_t length) const {
    return count[length] > 0 ? std::sqrt(sum[length] / count[length]) : std::nan("");
  }
};

/// A copy that has seen nothing since `start`.
template <class Filter>
struct Blind {
  double start;
  Filter filter;
  std::size_t next = 0;  ///< Index in kLengths.
};

/// One flight through one filter: fixes at 15 Hz, and every 0.1 s a copy that gets none any more.
/// @param heading_offset  of the log's heading, which filters are told with an altitude, blind ones too;
///     nullopt: they are told neither.
template <class Filter>
Errors flown(const flight_log::FlightFolder& flight, std::optional<double> heading_offset,
             Filter filter, bool* fine) {
  const auto rows = identification::airborne(flight);
  Errors errors;
  *fine = true;
  if (rows.first == rows.last) return errors;
  const double from = seconds(flight.samples[rows.first].time) + kSettle,
               to = seconds(flight.samples[rows.last - 1].time);
  sim::Stream noise{1, "altitude"};
  std::vector<Blind<Filter>> blind;
  double next_fix = kRest, next_blind = from, before = 0.0;
  for (std::size_t i = 0; i < rows.last; ++i) {
    const flight_log::FlightSample& s = flight.samples[i];
    const double t = seconds(s.time);
    FilterTick tick{.imu = s.imu, .t = t, .dt = t - before};
    before = t;
    if (t < kRest || !s.true_p_EB || !s.ahrs) continue;
    tick.yaw = wrap_angle(s.ahrs->yaw + heading_offset.value_or(0.0));
    const bool is_fix = t >= next_fix;
    if (is_fix) next_fix = t + kFixPeriod;
    if (is_fix && heading_offset) tick.z = s.true_p_EB->z() + kAltitudeSigma * noise.normal();
    filter.step(tick);
    for (auto& b : blind) b.filter.step(tick);
    if (is_fix) filter.fix(*s.true_p_EB, {kFixSigma, kFixSigma, kAltitudeSigma});
    for (auto& b : blind)
      if (b.next < kLengths.size() && t >= b.start + kLengths[b.next])
        errors.add(b.next++, (b.filter.position() - *s.true_p_EB).template head<2>().norm());
    std::erase_if(blind, [](const auto& b) { return b.next == kLengths.size(); });
    if (t >= next_blind && t + kLengths[kTwoSeconds] <= to)
      blind.push_back({t, filter}), next_blind = t + kEvery;
    *fine = *fine && filter.position().allFinite();
  }
  return errors;
}

struct BlindFlight {
  std::string name;
  flight_log::FlightFolder folder;
};

std::vector<BlindFlight> flights_in(const fs::path& folder) {
  std::vector<BlindFlight> flights;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && entry.path().filename().string().starts_with("flight_"))
      flights.push_back(
          {entry.path().filename().string(), flight_log::read_flight_folder(entry.path())});
  if (flights.empty())
    throw std::runtime_error(folder.string() + ": there is no folder flight_* in it");
  std::sort(flights.begin(), flights.end(),
            [](const BlindFlight& a, const BlindFlight& b) { return a.name < b.name; });
  return flights;
}

/// Knowledge at the end of the rest: gravity's word for the attitude, heading from the log.
struct Rest {
  Attitude attitude;
  Eigen::Vector3d p_EB = Eigen::Vector3d::Zero();
};
Rest rest_of(const flight_log::FlightFolder& flight, double heading_offset) {
  Rest rest;
  for (const flight_log::FlightSample& s : flight.samples) {
    if (seconds(s.time) >= kRest) break;
    if (s.true_p_EB) rest.p_EB = *s.true_p_EB;
    if (s.ahrs) rest.attitude = *s.ahrs;
  }
  rest.attitude.yaw = wrap_angle(rest.attitude.yaw + heading_offset);
  return rest;
}

// The estimation that flies, after its rest, with what other flights taught of drag and bias.
Navigator rested(const flight_log::FlightFolder& flight, const Rest& rest, const DragFit& others,
                 const Eigen::Vector3d& bias, const Eigen::Vector3d& bias_sigma) {
  NavigatorParams params;
  params.filter.start_bias_sigma = bias_sigma;
  params.filter.gate_sigma = 100.0;  // motion capture has no outliers
  params.filter.model.drag = others.drag;
  Navigator navigator{params};
  navigator.start(rest.p_EB, rest.attitude.yaw);
  for (const flight_log::FlightSample& s : flight.samples) {
    if (seconds(s.time) >= kRest) break;
    navigator.rest(s.imu, seconds(s.time));
  }
  navigator.set_attitude(rest.attitude);
  navigator.set_accel_bias(bias);
  return navigator;
}

/// The error-state filter without a gate: fixes are all it is told.
struct WindPilot {
  eskf::ErrorStateFilter filter;

  void step(const FilterTick& tick) { filter.predict(tick.imu, tick.dt, tick.t); }
  void fix(const Eigen::Vector3d& p_EB, const Eigen::Vector3d& sigma) {
    (void)filter.correct_position(p_EB, sigma);
  }
  [[nodiscard]] Eigen::Vector3d position() const { return filter.now().p_EB; }
};

WindPilot wind_pilot(const Rest& rest, const Ahrs& rested, const Eigen::Vector2d& drag) {
  eskf::Setup setup;
  setup.params.drag = drag;
  setup.params.priors.heading = kLogHeadingSigma;
  WindPilot pilot{eskf::ErrorStateFilter{setup}};
  pilot.filter.start(
      {.p_EB = rest.p_EB,
       .R_EB = rotation_EB(Attitude{0.0, 0.0, rest.attitude.yaw}).matrix,
       .gyro_bias = rested.gyro_bias(),
       .rest_accel_B = rested.accel_bias() - Eigen::Vector3d{0, 0, setup.params.gravity}},
      kRest);
  return pilot;
}

struct Outcome {
  Errors drag, imu15;
  Errors wind, untold_imu15;  ///< Nothing fitted on this flight.
  double heading_offset = 0.0;
};

/// Both filters start from the rest of this flight and the log's heading as it is, and are told
/// positions before the gap, nothing in it. Of the other flights: drag.
void fly_untold(const flight_log::FlightFolder& flight, const Navigator& navigator,
                const DragFit& others, Outcome& outcome, bool* fine) {
  const Rest rest = rest_of(flight, 0.0);
  const Ahrs& ahrs = navigator.ahrs();
  bool wind_fine = true, imu_fine = true;
  outcome.wind = flown(flight, {}, wind_pilot(rest, ahrs, others.drag), &wind_fine);
  baseline::Imu15Params classic;
  classic.start_heading_sigma = kLogHeadingSigma;
  baseline::Imu15 imu15{classic};
  imu15.start(rest.p_EB, Attitude{0.0, 0.0, rest.attitude.yaw}, ahrs.accel_bias(),
              ahrs.gyro_bias());
  outcome.untold_imu15 = flown(flight, {}, InertialPilot{imu15}, &imu_fine);
  *fine = *fine && wind_fine && imu_fine;
}

Outcome outcome_of(const flight_log::FlightFolder& flight, const DragFit& others) {
  Outcome outcome;
  outcome.heading_offset = identification::fit_heading(flight, others);
  const Rest rest = rest_of(flight, outcome.heading_offset);
  const Eigen::Vector3d bias{others.bias.x(), others.bias.y(), 0.0},
      bias_sigma{kBiasSigma, kBiasSigma, 0.3};
  const Navigator navigator = rested(flight, rest, others, bias, bias_sigma);
  bool drag_fine = true, imu_fine = true;
  outcome.drag = flown(flight, outcome.heading_offset, DragPilot{navigator}, &drag_fine);

  baseline::Imu15Params classic;
  classic.start_bias_sigma = bias_sigma;
  baseline::Imu15 imu15{classic};
  imu15.start(rest.p_EB, rest.attitude, bias, navigator.ahrs().gyro_bias());
  outcome.imu15 = flown(flight, outcome.heading_offset, InertialPilot{imu15}, &imu_fine);
  fly_untold(flight, navigator, others, outcome, &imu_fine);
  if (!drag_fine || !imu_fine)
    throw std::runtime_error(flight.directory.string() + ": an estimate is not a finite number");
  return outcome;
}

std::string metres(double value) {
  return std::isfinite(value) ? files::text_of(value, 3) + " m" : "-";
}

std::string both(const Errors& eskf, const Errors& imu15) {
  return metres(eskf.rms(kTwoSeconds)) + " (imu15 " + metres(imu15.rms(kTwoSeconds)) + ")";
}

/// Over all flights, with nothing fitted on the one that is scored; and without 05, whose heading is
/// the most wrong.
struct Untold {
  Errors wind, imu15, wind_without_05, imu15_without_05;
  nlohmann::ordered_json per_flight = nlohmann::ordered_json::object();

  void add(const std::string& flight, const Outcome& one) {
    wind.add(one.wind), imu15.add(one.untold_imu15);
    per_flight[flight] = {{"eskf_m", number(one.wind.rms(kTwoSeconds))},
                          {"imu15_m", number(one.untold_imu15.rms(kTwoSeconds))}};
    if (flight == "flight_05") return;
    wind_without_05.add(one.wind), imu15_without_05.add(one.untold_imu15);
  }
  [[nodiscard]] nlohmann::ordered_json json() const {
    return {{"eskf_rms_2s_m", number(wind.rms(kTwoSeconds))},
            {"imu15_rms_2s_m", number(imu15.rms(kTwoSeconds))},
            {"without_flight_05",
             {{"eskf_rms_2s_m", number(wind_without_05.rms(kTwoSeconds))},
              {"imu15_rms_2s_m", number(imu15_without_05.rms(kTwoSeconds))}}},
            {"per_flight", per_flight}};
  }
};

}  // namespace

Result blind_real(const Options& options) {
  const std::vector<BlindFlight> flights =
      flights_in(data_folder("tudelft_bebop_flights", options));
  std::vector<DragFit> fits;
  std::vector<std::size_t> fit_of(flights.size(), flights.size());
  for (std::size_t i = 0; i < flights.size(); ++i) {
    if (options.stopped()) throw Stopped{};
    options.progress(0.5 * static_cast<double>(i) / static_cast<double>(flights.size()),
                     flights[i].name);
    if (const auto fit = identification::fit_drag(flights[i].folder))
      fit_of[i] = fits.size(), fits.push_back(*fit);
  }
  if (fits.size() < 2)
    throw std::runtime_error(
        "tudelft_bebop_flights: fewer than two flights with a true position: nothing to learn "
        "from");

  Result result{.table = {},
                .json = {},
                .csv = "flight,windows,heading_offset_deg,drag_rms_2s_m,imu15_rms_2s_m\n",
                .picture = drawing::Canvas(1, 1)};
  Errors drag, imu15;
  Untold untold;
  auto per_drag = nlohmann::ordered_json::object(), per_imu15 = nlohmann::ordered_json::object(),
       offsets = nlohmann::ordered_json::object();
  auto without = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < flights.size(); ++i) {
    if (options.stopped()) throw Stopped{};
    options.progress(0.5 + 0.5 * static_cast<double>(i) / static_cast<double>(flights.size()),
                     flights[i].name);
    const DragFit others = identification::mean_of(fits, fit_of[i]);
    const Outcome outcome = outcome_of(flights[i].folder, others);
    const int windows = outcome.drag.count[kTwoSeconds];
    const double offset = outcome.heading_offset / kDegree;
    if (windows == 0) {
      without.push_back(flights[i].name);
      result.table.push_back({flights[i].name, "", "no window of 3 s in the air"});
      continue;
    }
    drag.add(outcome.drag), imu15.add(outcome.imu15);
    untold.add(flights[i].name, outcome);
    per_drag[flights[i].name] = outcome.drag.rms(kTwoSeconds),
    per_imu15[flights[i].name] = outcome.imu15.rms(kTwoSeconds);
    offsets[flights[i].name] = offset;
    result.csv += flights[i].name + "," + std::to_string(windows) + "," +
                  files::text_of(offset, 4) + "," +
                  files::text_of(outcome.drag.rms(kTwoSeconds), 4) + "," +
                  files::text_of(outcome.imu15.rms(kTwoSeconds), 4) + "\n";
    result.table.push_back({flights[i].name + ", heading " + files::text_of(offset, 3) + "°, " +
                                std::to_string(windows) + " windows",
                            "",
                            metres(outcome.drag.rms(kTwoSeconds)) + " (imu15 " +
                                metres(outcome.imu15.rms(kTwoSeconds)) +
                                "); nothing fitted: " + both(outcome.wind, outcome.untold_imu15)});
  }
  result.table.push_back(
      {"all, blind for 2 s", "",
       metres(drag.rms(kTwoSeconds)) + " (imu15 " + metres(imu15.rms(kTwoSeconds)) + ")"});
  result.table.push_back(
      {"the same, nothing fitted on the scored flight", "", both(untold.wind, untold.imu15)});
  result.table.push_back(
      {"the same without flight_05", "", both(untold.wind_without_05, untold.imu15_without_05)});
  const DragFit mean = identification::mean_of(fits);
  auto by_length = nlohmann::ordered_json::array();
  drawing::Plot plot{.title = "Blind on real flights",
                     .x_label = "time without a fix [s]",
                     .y_label = "horizontal error, RMS [m]"};
  plot.series = {{.name = "drag filter, 7 states"},
                 {.name = "inertial filter, 15 states", .color = drawing::kLight.gate_solid}};
  for (std::size_t k = 0; k < kLengths.size(); ++k) {
    by_length.push_back({{"blind_s", kLengths[k]},
                         {"unfitted", untold.json()},
                         {"windows", drag.count[k]},
                         {"drag_rms_m", number(drag.rms(k))},
                         {"imu15_rms_m", number(imu15.rms(k))}});
    plot.series[0].points.emplace_back(kLengths[k], drag.rms(k)),
        plot.series[1].points.emplace_back(kLengths[k], imu15.rms(k));
  }
  result.json = {
      {"drag", {{"rms_2s_m", number(drag.rms(kTwoSeconds))}, {"per_flight", per_drag}}},
      {"imu15", {{"rms_2s_m", number(imu15.rms(kTwoSeconds))}, {"per_flight", per_imu15}}},
      {"unfitted", untold.json()},
      {"windows", drag.count[kTwoSeconds]},
      {"by_length", by_length},
      {"heading_offset_deg", offsets},
      {"without_window", without},
      {"mean_drag_1ps", {mean.drag.x(), mean.drag.y()}},
      {"fix", {{"rate_hz", 15}, {"sigma_m", kFixSigma}}}};
  result.picture = drawing::draw(plot);
  return result;
}

}  // namespace gatefly::experiments
