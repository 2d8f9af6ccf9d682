// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/convergence_trial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/attitude.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::experiments {
namespace {

constexpr double kHold = 2.0;  // a crossover lasts [s]

template <class Filter>
ErrorCurves error_curves(const FilterRace& race, Filter filter, const FilterConditions& given,
                         std::size_t points = kPoints) {
  ErrorCurves trace;
  const auto fixes = race.fixes(given);
  if (fixes.empty()) return trace;
  const double first = race.laps().moments[fixes.front().moment].t;
  race.feed(filter, given,
            [&](const LapMoment& m, const FilterTick&, const Filter& now, const FixTime*) {
              if (m.t - first < time_of(trace[kBias].size())) return true;
              const auto add = [&](ErrorOf what, const Eigen::Vector3d& error) {
                trace[what].push_back(error.head<2>().norm());
              };
              add(kBias, now.accel_bias() - race.laps().accel_bias);
              add(kPosition, now.position() - m.p_EB);
              add(kVelocity, now.velocity() - m.v_E);
              const Attitude attitude = now.attitude();
              trace[kTilt].push_back(std::hypot(wrap_angle(attitude.roll - m.attitude.roll),
                                                attitude.pitch - m.attitude.pitch) /
                                     kDegree);
              return trace[kBias].size() < points;
            });
  return trace;
}

/// From when on the classic filter's median error of the bias is the smaller one, for kHold at
/// least [s]; infinite: not by kTo. @param runs  of which flights, repeats allowed.
double crossover_of(const BothFilters& pair, const std::vector<std::size_t>& runs) {
  std::vector<double> drawn(runs.size());
  const auto median = [&](const std::vector<double>& values) {
    for (std::size_t i = 0; i < runs.size(); ++i) drawn[i] = values[runs[i]];
    const auto middle = drawn.begin() + static_cast<std::ptrdiff_t>(drawn.size() / 2);
    std::nth_element(drawn.begin(), middle, drawn.end());
    return *middle;
  };
  std::size_t better_since = kPoints;
  for (std::size_t i = kFirstFix; i < kPoints; ++i) {
    if (median(pair.imu15[kBias][i]) >= median(pair.drag[kBias][i]))
      better_since = kPoints;
    else if (better_since == kPoints)
      better_since = i;
    if (better_since < kPoints && time_of(i) - time_of(better_since) >= kHold)
      return time_of(better_since);
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<Condition> conditions(bool quick) {
  std::vector<Condition> list{{"as_flown", "15 Hz, 0.10 m, shipped drag"}};
  for (const int percent : {-20, -10, 10, 20})
    if (!quick || std::abs(percent) == 20)
      list.push_back(
          {"drag_" + std::to_string(percent),
           "told drag " + std::string(percent > 0 ? "+" : "") + std::to_string(percent) + " %",
           {.told_drag = 1.0 + percent / 100.0}});
  for (const int rate : {5, 2})
    list.push_back({"rate_" + std::to_string(rate),
                    "fixes at " + std::to_string(rate) + " Hz",
                    {.fix_period = 1.0 / rate}});
  for (const double sigma : {0.05, 0.3})
    list.push_back({"sigma_" + files::text_of(sigma),
                    "fixes of " + files::text_of(sigma) + " m",
                    {.fix_sigma = sigma}});
  list.push_back({"start_1", "start known to 1 m", {.start_sigma = 1.0}});
  return list;
}

baseline::Imu15Params tuned_for_bias(const Options& options) {
  constexpr std::size_t kFirst = point_at(0.5), kLast = point_at(5.0);
  const std::vector<FilterRace> races = tuning_races(options);
  return tuned_imu15(options, [&](const baseline::Imu15Params& params) {
    std::vector<std::vector<double>> biases(races.size());
    in_parallel(races.size(), [&](std::size_t i) {
      biases[i] = error_curves(races[i], races[i].imu15(params), {}, kLast + 1)[kBias];
    });
    std::vector<double> all;
    for (const std::vector<double>& bias : biases)
      for (std::size_t k = kFirst; k < bias.size(); ++k) all.push_back(bias[k]);
    return rms(all);
  });
}

FlightCurves curves_of(std::uint64_t seed, const std::vector<Condition>& list,
                       const baseline::Imu15Params& classic) {
  const FilterRace race{seed};
  FlightCurves flight;
  for (const Condition& condition : list)
    flight.emplace_back(
        error_curves(race, race.drag(condition.given), condition.given),
        condition.changes_imu15()
            ? error_curves(race, race.imu15(classic, condition.given), condition.given)
            : flight.front().second);
  return flight;
}

bool is_whole(const FlightCurves& flight) {
  return std::all_of(flight.begin(), flight.end(), [](const auto& pair) {
    return pair.first[kBias].size() == kPoints && pair.second[kBias].size() == kPoints;
  });
}

BothFilters gathered(const std::vector<FlightCurves>& flights, std::size_t condition) {
  BothFilters pair;
  for (std::size_t what = 0; what < kWhats; ++what) {
    pair.drag[what].resize(kPoints), pair.imu15[what].resize(kPoints);
    for (const FlightCurves& flight : flights)
      for (std::size_t i = 0; i < kPoints; ++i)
        pair.drag[what][i].push_back(flight[condition].first[what][i]),
            pair.imu15[what][i].push_back(flight[condition].second[what][i]);
  }
  return pair;
}

double median_ratio(const BothFilters& pair, ErrorOf what, double t) {
  const std::size_t point = point_at(t);
  return files::nearest_rank(pair.imu15[what][point], 0.5) /
         files::nearest_rank(pair.drag[what][point], 0.5);
}

double time_below(const Samples& samples, double part, double threshold) {
  for (std::size_t i = kFirstFix; i < samples.size(); ++i)
    if (files::nearest_rank(samples[i], part) <= threshold) return time_of(i);
  return std::numeric_limits<double>::quiet_NaN();
}

Crossover crossover(const BothFilters& pair) {
  constexpr std::size_t kDraws = 200;
  std::vector<std::size_t> runs(pair.drag[kBias][0].size());
  for (std::size_t i = 0; i < runs.size(); ++i) runs[i] = i;
  Crossover found{.t = crossover_of(pair, runs)};
  sim::Stream random{1, "convergence/bootstrap"};
  std::vector<double> all;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    for (std::size_t& run : runs)
      run =
          std::min(runs.size() - 1,
                   static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(runs.size()))));
    all.push_back(crossover_of(pair, runs));
  }
  std::sort(all.begin(), all.end());
  found.low = all[kDraws / 20], found.high = all[kDraws - 1 - kDraws / 20];
  return found;
}

}  // namespace gatefly::experiments
