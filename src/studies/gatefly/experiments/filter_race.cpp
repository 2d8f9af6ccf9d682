// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/filter_race.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/files/quantile.hpp"

namespace gatefly::experiments {

FilterRace::FilterRace(std::uint64_t number)
    : seed_{number}, laps_{simulated_laps("oval", kLaps, number)} {}

Eigen::Vector3d FilterRace::told_start(const FilterConditions& conditions) const {
  sim::Stream noise{seed_, "start"};
  return laps_.moments.front().p_EB +
         conditions.start_sigma * Eigen::Vector3d{noise.normal(), noise.normal(), 0.0};
}

DragPilot FilterRace::drag(const FilterConditions& conditions) const {
  NavigatorParams params;
  params.filter.start_bias_sigma = Eigen::Vector3d::Constant(kBiasSigma);
  params.filter.gate_sigma = 100.0;  // these fixes have no outliers
  params.filter.model.drag *= conditions.told_drag;
  if (conditions.start_sigma > 0.0)
    params.filter.start_sigma.head<2>().setConstant(conditions.start_sigma);
  Navigator navigator{params};
  navigator.start(told_start(conditions), laps_.moments.front().attitude.yaw);
  for (const LapMoment& m : laps_.moments)
    if (m.rests) navigator.rest(m.imu, m.t);
  navigator.set_accel_bias(Eigen::Vector3d::Zero());
  return {navigator};
}

InertialPilot FilterRace::imu15(const baseline::Imu15Params& params,
                                const FilterConditions& conditions) const {
  baseline::Imu15Params told = params;
  if (conditions.start_sigma > 0.0)
    told.start_position_sigma.head<2>().setConstant(conditions.start_sigma);
  baseline::Imu15 filter{told};
  const DragPilot rested = drag(conditions);  // it knows what rest says
  const Ahrs& ahrs = rested.navigator.ahrs();
  filter.start(told_start(conditions), ahrs.attitude(), Eigen::Vector3d::Zero(), ahrs.gyro_bias());
  return {filter};
}

std::vector<FixTime> FilterRace::fixes(const FilterConditions& conditions) const {
  constexpr double kGap = 0.3, kLate = 1.5;  // blind after so long [s], [fix periods]
  const double gap = std::max(kGap, kLate * conditions.fix_period);
  std::vector<FixTime> fixes;
  for (std::size_t i = 0; i < laps_.moments.size(); ++i) {
    const double since_last =
        fixes.empty() ? 1e9 : laps_.moments[i].t - laps_.moments[fixes.back().moment].t;
    if (!laps_.moments[i].faces_gate || since_last < conditions.fix_period) continue;
    if (!fixes.empty() && since_last > gap) fixes.back().last = true;
    fixes.push_back({i});
  }
  return fixes;  // after the last gate nobody looks
}

std::vector<FilterRace> filter_races(std::uint64_t first, std::size_t count,
                                     const Options& options) {
  std::vector<std::optional<FilterRace>> races(count);
  in_pieces(count, options, [&](std::size_t i) { races[i].emplace(first + i); });
  std::vector<FilterRace> list;
  for (std::optional<FilterRace>& race : races) list.push_back(std::move(*race));
  return list;
}

std::vector<FilterRace> tuning_races(const Options& options) {
  constexpr std::uint64_t kFirstSeed = 1001;
  return filter_races(kFirstSeed, options.quick ? 4 : 12, options);
}

baseline::Imu15Params tuned_imu15(const Options& options,
                                  const std::function<double(const baseline::Imu15Params&)>& cost) {
  baseline::Imu15Params best;
  double least = 1e9;
  for (const double accel : {0.03, 0.1, 0.3})
    for (const double gyro : {0.002, 0.007, 0.02})
      for (const double tilt : {0.005, 0.03}) {
        if (options.stopped()) throw Stopped{};
        baseline::Imu15Params params;
        params.start_bias_sigma = Eigen::Vector3d::Constant(FilterRace::kBiasSigma);
        params.accel_noise = accel, params.gyro_noise = gyro, params.start_tilt_sigma = tilt;
        const double found = cost(params);
        if (found < least) least = found, best = params;
      }
  return best;
}

void append(Samples& to, const Samples& from) {
  if (to.size() < from.size()) to.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i)
    to[i].insert(to[i].end(), from[i].begin(), from[i].end());
}

double rms(std::span<const double> values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

void add_band(drawing::Plot& plot, const std::string& name, const Samples& samples, double from,
              double step, const drawing::Color& color) {
  const auto curve = [&](double part) {
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < samples.size(); ++i)
      points.emplace_back(from + static_cast<double>(i) * step,
                          files::nearest_rank(samples[i], part));
    return points;
  };
  drawing::PlotSeries band{.points = curve(0.05), .color = color.faded(0.2), .area = true};
  const auto upper = curve(0.95);
  band.points.insert(band.points.end(), upper.rbegin(), upper.rend());
  plot.series.push_back(band);
  plot.series.push_back({.name = name, .points = curve(0.5), .color = color});
}

nlohmann::ordered_json band_json(const std::vector<double>& values) {
  return {{"median", number(files::nearest_rank(values, 0.5))},
          {"p5", number(files::nearest_rank(values, 0.05))},
          {"p95", number(files::nearest_rank(values, 0.95))},
          {"rms", number(rms(values))}};
}

std::string against(const std::vector<double>& drag, const std::vector<double>& imu15,
                    const std::string& unit) {
  const auto band = [&](const std::vector<double>& v) {
    return fixed(files::nearest_rank(v, 0.5), 2) + " (" + fixed(files::nearest_rank(v, 0.05), 2) +
           "-" + fixed(files::nearest_rank(v, 0.95), 2) + ") " + unit;
  };
  return band(drag) + ", imu15 " + band(imu15) + ", ratio " +
         fixed(files::nearest_rank(imu15, 0.5) / files::nearest_rank(drag, 0.5), 1);
}

}  // namespace gatefly::experiments
