// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/simulated_laps.hpp"
#include "gatefly/experiments/two_filters.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::experiments {

// ---------------------------------------------------------------- flights

/// Inputs of both filters, and the drag filter's assumptions.
struct FilterConditions {
  double fix_period = 1.0 / 15.0;  ///< [s]
  double fix_sigma = 0.10;         ///< An axis; both are told [m].
  double told_drag = 1.0;          ///< k_x, k_y that the drag filter is told / the shipped ones.
  /// How far off the start is that both are told, an axis of the floor plan; 0: as on a pad [m].
  double start_sigma = 0.0;
};

/// When a fix comes, and whether it is the last one before the gate goes out of sight.
struct FixTime {
  std::size_t moment;
  bool last = false;
};

/// Simulated laps, flown once, with what two filters are given of them: fixes while a gate is ahead,
/// altitude and heading always.
///
/// Both start with what rest says of attitude and gyro; the accelerometer's bias is not told.
class FilterRace {
 public:
  /// Sigma that races draw from and both filters assume [m/s²].
  static constexpr double kBiasSigma = 0.25;
  static constexpr int kLaps = 3;  ///< On the oval.

  explicit FilterRace(std::uint64_t number);

  [[nodiscard]] DragPilot drag(const FilterConditions& conditions = {}) const;
  [[nodiscard]] InertialPilot imu15(const baseline::Imu15Params& params,
                                    const FilterConditions& conditions = {}) const;
  [[nodiscard]] std::vector<FixTime> fixes(const FilterConditions& conditions = {}) const;

  /// Feeds a filter; afterwards, every IMU sample, seen(moment, tick, filter, fix): fix is the fix
  /// of this moment, else nullptr. It answers whether to go on.
  template <class Filter, class Seen>
  void feed(Filter& filter, const FilterConditions& conditions, const Seen& seen) const;

  [[nodiscard]] const SimulatedLaps& laps() const { return laps_; }

 private:
  [[nodiscard]] Eigen::Vector3d told_start(const FilterConditions& conditions) const;

  std::uint64_t seed_;
  SimulatedLaps laps_;
};

/// Flies `count` of them, numbered from `first`, on all cores.
[[nodiscard]] std::vector<FilterRace> filter_races(std::uint64_t first, std::size_t count,
                                                   const Options& options);

/// Flights that the classic filter's noises are chosen on; no reported one.
[[nodiscard]] std::vector<FilterRace> tuning_races(const Options& options);

/// The classic filter at its best: of 18 noises those whose `cost` is least.
[[nodiscard]] baseline::Imu15Params tuned_imu15(
    const Options& options, const std::function<double(const baseline::Imu15Params&)>& cost);

// ---------------------------------------------------------------- errors of many runs

/// Errors of many runs at each point of a curve.
using Samples = std::vector<std::vector<double>>;

void append(Samples& to, const Samples& from);
[[nodiscard]] double rms(std::span<const double> values);

/// Median, and the band that holds 90 %; the first point is at `from`.
void add_band(drawing::Plot& plot, const std::string& name, const Samples& samples, double from,
              double step, const drawing::Color& color);

/// {median, p5, p95, rms}.
[[nodiscard]] nlohmann::ordered_json band_json(const std::vector<double>& values);

/// "0.05 (0.01-0.10) m, imu15 0.10 (...) m, ratio 2.0".
[[nodiscard]] std::string against(const std::vector<double>& drag, const std::vector<double>& imu15,
                                  const std::string& unit);

// ---------------------------------------------------------------- bodies

template <class Filter, class Seen>
void FilterRace::feed(Filter& filter, const FilterConditions& conditions, const Seen& seen) const {
  constexpr double kAltitudePeriod = 1.0 / 15.0;  // [s]
  // constant over a run, one standard deviation
  constexpr double kHeadingError = 1.0 * kDegree;
  const std::vector<FixTime> times = fixes(conditions);
  if (times.empty()) return;
  sim::Stream noise{seed_, "fixes"};
  const double heading_error = kHeadingError * noise.normal();
  double next_z = 0.0;
  auto next = times.begin();
  for (std::size_t i = 0; i < laps_.moments.size(); ++i) {
    const LapMoment& m = laps_.moments[i];
    FilterTick tick{
        .imu = m.imu, .t = m.t, .dt = m.dt, .yaw = wrap_angle(m.attitude.yaw + heading_error)};
    if (m.rests) continue;
    if (m.t >= next_z)
      next_z = m.t + kAltitudePeriod, tick.z = m.p_EB.z() + kAltitudeSigma * noise.normal();
    filter.step(tick);
    const FixTime* fix = nullptr;
    if (next != times.end() && next->moment == i) {
      filter.fix(m.p_EB + conditions.fix_sigma *
                              Eigen::Vector3d{noise.normal(), noise.normal(), noise.normal()},
                 Eigen::Vector3d::Constant(conditions.fix_sigma));
      fix = &*next++;
    }
    if (!seen(m, tick, filter, fix)) return;
  }
}

}  // namespace gatefly::experiments
