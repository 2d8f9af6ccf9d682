// SPDX-License-Identifier: Apache-2.0
// What the drag model gains over the classic filter: how fast the accelerometer's bias is found,
// how far the position drifts while no gate is seen. Li18 §3.3, where the paper says so without a
// figure.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/estimation/navigator.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/experiments/simulated_laps.hpp"
#include "gatefly/experiments/two_filters.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/sim/random.hpp"

namespace gatefly::experiments {
namespace {

constexpr int kLaps = 3, kRuns = 60, kQuickRuns = 8;
// [s], [m]
constexpr double kFixPeriod = 1.0 / 15.0, kFixSigma = 0.10, kAltitudePeriod = 1.0 / 15.0;
// constant over a run, one standard deviation
constexpr double kHeadingError = 1.0 * kDegree;
// what races draw, and what both filters are told [m/s²]
constexpr double kBiasSigma = 0.25;
// no fix for this long: blind since the last [s]
constexpr double kGap = 0.3;
constexpr double kBiasStep = 1.0, kDriftStep = 0.25;        // between points of the curves [s]
constexpr std::size_t kBiasPoints = 26, kDriftPoints = 13;  // to 25 s; to 3 s
constexpr std::size_t kOneSecond = 4, kTwoSeconds = 8;

/// Errors of many runs at each point of a curve.
template <std::size_t N>
using Samples = std::array<std::vector<double>, N>;

/// What one filter made of one run.
struct Course {
  /// Horizontal, by seconds since the first fix [m/s²].
  Samples<kBiasPoints> bias;
  Samples<kDriftPoints> first_gap, later_gaps;  ///< Horizontal, by time since the last fix [m].
};

template <std::size_t N>
void append(Samples<N>& to, const Samples<N>& from) {
  for (std::size_t i = 0; i < N; ++i) to[i].insert(to[i].end(), from[i].begin(), from[i].end());
}

void append(Course& to, const Course& from) {
  append(to.bias, from.bias), append(to.first_gap, from.first_gap),
      append(to.later_gaps, from.later_gaps);
}

/// When a fix comes, and whether it is the last one before the gate goes out of sight.
struct FixTime {
  std::size_t moment;
  bool last = false;
};
std::vector<FixTime> fix_times(const std::vector<LapMoment>& moments) {
  std::vector<FixTime> fixes;
  const auto since_last = [&](double t) {
    return fixes.empty() ? 1e9 : t - moments[fixes.back().moment].t;
  };
  for (std::size_t i = 0; i < moments.size(); ++i) {
    if (!moments[i].faces_gate || since_last(moments[i].t) < kFixPeriod) continue;
    if (!fixes.empty() && since_last(moments[i].t) > kGap) fixes.back().last = true;
    fixes.push_back({i});
  }
  return fixes;  // after the last gate nobody looks
}

/// A copy that gets no fix any more.
template <class Filter>
struct Blind {
  double since;
  Samples<kDriftPoints>* errors;
  Filter filter;
  std::size_t next = 0;
};

/// Both filters are given the same: fixes while a gate is ahead, altitude and heading always.
template <class Filter>
Course course_of(const SimulatedLaps& laps, const std::vector<FixTime>& fixes, Filter filter,
                 std::uint64_t seed) {
  Course course;
  sim::Stream noise{seed, "fixes"};
  const double heading_error = kHeadingError * noise.normal();
  std::vector<Blind<Filter>> blind;
  double next_z = 0.0;
  std::size_t fix = 0, bias_point = 0;
  bool is_first_gap = true;
  for (std::size_t i = 0; i < laps.moments.size() && !fixes.empty(); ++i) {
    const LapMoment& m = laps.moments[i];
    FilterTick tick{
        .imu = m.imu, .t = m.t, .dt = m.dt, .yaw = wrap_angle(m.attitude.yaw + heading_error)};
    if (m.rests) continue;
    if (m.t >= next_z)
      next_z = m.t + kAltitudePeriod, tick.z = m.p_EB.z() + kAltitudeSigma * noise.normal();
    filter.step(tick);
    for (auto& b : blind) b.filter.step(tick);
    if (fix < fixes.size() && fixes[fix].moment == i) {
      filter.fix(
          m.p_EB + kFixSigma * Eigen::Vector3d{noise.normal(), noise.normal(), noise.normal()},
          Eigen::Vector3d::Constant(kFixSigma));
      if (fixes[fix++].last)
        blind.push_back({m.t, is_first_gap ? &course.first_gap : &course.later_gaps, filter}),
            is_first_gap = false;
    }
    for (auto& b : blind)
      if (b.next < kDriftPoints && m.t >= b.since + static_cast<double>(b.next) * kDriftStep)
        (*b.errors)[b.next++].push_back((b.filter.position() - m.p_EB).template head<2>().norm());
    std::erase_if(blind, [](const auto& b) { return b.next == kDriftPoints; });
    const double since_first = m.t - laps.moments[fixes.front().moment].t;
    if (bias_point < kBiasPoints && since_first >= static_cast<double>(bias_point) * kBiasStep)
      course.bias[bias_point++].push_back(
          (filter.accel_bias() - laps.accel_bias).template head<2>().norm());
  }
  return course;
}

/// Both filters start with what rest says of attitude and gyro; the accelerometer's bias is not
/// told.
struct Race {
  explicit Race(std::uint64_t number)
      : seed{number}, laps{simulated_laps("oval", kLaps, seed)}, fixes{fix_times(laps.moments)} {
    navigator.start(start(), laps.moments.front().attitude.yaw);
    for (const LapMoment& m : laps.moments)
      if (m.rests) navigator.rest(m.imu, m.t);
    navigator.set_accel_bias(Eigen::Vector3d::Zero());
  }
  [[nodiscard]] static NavigatorParams params() {
    NavigatorParams params;
    params.filter.start_bias_sigma = Eigen::Vector3d::Constant(kBiasSigma);
    params.filter.gate_sigma = 100.0;  // these fixes have no outliers
    return params;
  }
  [[nodiscard]] Eigen::Vector3d start() const { return laps.moments.front().p_EB; }
  [[nodiscard]] Course by_drag() const {
    return course_of(laps, fixes, DragPilot{navigator}, seed);
  }
  [[nodiscard]] Course by_imu15(const baseline::Imu15Params& params) const {
    baseline::Imu15 filter{params};
    const Ahrs& ahrs = navigator.ahrs();
    filter.start(start(), ahrs.attitude(), Eigen::Vector3d::Zero(), ahrs.gyro_bias());
    return course_of(laps, fixes, InertialPilot{filter}, seed);
  }

  std::uint64_t seed;
  SimulatedLaps laps;
  std::vector<FixTime> fixes;
  Navigator navigator{params()};
};

struct Run {
  Course drag, imu15;
  bool finished = false;
};

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// The classic filter at its best: of all these noises the ones that drift least in 2 s, on flights
/// that are not shown.
baseline::Imu15Params tuned(const Options& options) {
  if (options.stopped()) throw Stopped{};
  constexpr std::uint64_t kFirstSeed = 1001;
  std::vector<std::optional<Race>> races(options.quick ? 4 : 12);
  in_parallel(races.size(), [&](std::size_t i) { races[i].emplace(kFirstSeed + i); });
  baseline::Imu15Params best;
  double least = 1e9;
  for (const double accel : {0.03, 0.1, 0.3})
    for (const double gyro : {0.002, 0.007, 0.02})
      for (const double tilt : {0.005, 0.03}) {
        if (options.stopped()) throw Stopped{};
        baseline::Imu15Params params;
        params.start_bias_sigma = Eigen::Vector3d::Constant(kBiasSigma);
        params.accel_noise = accel, params.gyro_noise = gyro, params.start_tilt_sigma = tilt;
        std::vector<Course> courses(races.size());
        in_parallel(races.size(), [&](std::size_t i) { courses[i] = races[i]->by_imu15(params); });
        Course all;
        for (const Course& course : courses) append(all, course);
        const double drift = rms(all.first_gap[kTwoSeconds]) + rms(all.later_gaps[kTwoSeconds]);
        if (drift < least) least = drift, best = params;
      }
  return best;
}

// ---------------------------------------------------------------- report

/// Median, and the band that holds 90 %.
template <std::size_t N>
void add_curve(io::Plot& plot, const std::string& name, const Samples<N>& samples, double step,
               const io::Color& color) {
  for (const double part : {0.5, 0.05, 0.95}) {
    io::PlotSeries series{.name = part == 0.5 ? name : "",
                          .color = part == 0.5 ? color : color.faded(0.45)};
    for (std::size_t i = 0; i < N; ++i)
      series.points.emplace_back(static_cast<double>(i) * step, io::nearest_rank(samples[i], part));
    plot.series.push_back(series);
  }
}

template <std::size_t N>
nlohmann::ordered_json curve_json(const Samples<N>& drag, const Samples<N>& imu15, double step) {
  auto list = nlohmann::ordered_json::array();
  const auto told = [](const std::vector<double>& v) {
    return nlohmann::ordered_json{{"median", number(io::nearest_rank(v, 0.5))},
                                  {"p5", number(io::nearest_rank(v, 0.05))},
                                  {"p95", number(io::nearest_rank(v, 0.95))},
                                  {"rms", number(rms(v))}};
  };
  for (std::size_t i = 0; i < N; ++i)
    list.push_back({{"t_s", static_cast<double>(i) * step},
                    {"samples", drag[i].size()},
                    {"drag", told(drag[i])},
                    {"imu15", told(imu15[i])}});
  return list;
}

std::string against(const std::vector<double>& drag, const std::vector<double>& imu15,
                    const std::string& unit) {
  const auto band = [&](const std::vector<double>& v) {
    return fixed(io::nearest_rank(v, 0.5), 2) + " (" + fixed(io::nearest_rank(v, 0.05), 2) + "-" +
           fixed(io::nearest_rank(v, 0.95), 2) + ") " + unit;
  };
  return band(drag) + ", imu15 " + band(imu15) + ", ratio " +
         fixed(io::nearest_rank(imu15, 0.5) / io::nearest_rank(drag, 0.5), 1);
}

io::Canvas side_by_side(const std::vector<io::Plot>& plots) {
  constexpr int kWidth = 640, kHeight = 480;
  io::Canvas canvas(kWidth * static_cast<int>(plots.size()), kHeight);
  for (std::size_t i = 0; i < plots.size(); ++i)
    canvas.paste(io::draw(plots[i], kWidth, kHeight), {static_cast<double>(i) * kWidth, 0.0});
  return canvas;
}

}  // namespace

Result ekf_vs_15(const Options& options) {
  const auto count = static_cast<std::size_t>(options.quick ? kQuickRuns : kRuns);
  std::vector<Run> runs(count);
  options.progress(0.0, "the classic filter's noises");
  const baseline::Imu15Params classic = tuned(options);
  in_pieces(count, options, [&](std::size_t i) {
    const Race race{i + 1};
    runs[i] = {race.by_drag(), race.by_imu15(classic), race.laps.finished};
  });
  Course drag, imu15;
  int finished = 0;
  for (const Run& run : runs)
    append(drag, run.drag), append(imu15, run.imu15), finished += run.finished;

  Result result{
      .table = {},
      .json = {},
      .csv = "what,t_s,samples,drag_median,drag_p5,drag_p95,imu15_median,imu15_p5,imu15_p95\n",
      .picture = io::Canvas(1, 1)};
  result.table.push_back(
      {std::to_string(count) + " flights of " + std::to_string(kLaps) + " laps, finished", "",
       std::to_string(finished)});
  for (const std::size_t second : {0u, 1u, 2u, 5u, 10u, 20u})
    result.table.push_back({"bias x, y, " + std::to_string(second) + " s after the first fix",
                            second == 0 ? "" : "converges faster",
                            against(drag.bias[second], imu15.bias[second], "m/s²")});
  for (const auto& [name, d, i] : {std::tuple{"first gap", &drag.first_gap, &imu15.first_gap},
                                   std::tuple{"later gaps", &drag.later_gaps, &imu15.later_gaps}})
    for (const std::size_t point : {std::size_t{0}, kOneSecond, kTwoSeconds})
      result.table.push_back({std::string{"position, "} + name + ", " +
                                  io::text_of(static_cast<double>(point) * kDriftStep, 2) +
                                  " s blind",
                              "", against((*d)[point], (*i)[point], "m")});

  io::Plot bias{.title = "accelerometer bias found: error of x and y",
                .x_label = "seconds since the first fix",
                .y_label = "median, 90 % band [m/s²]"};
  io::Plot first{.title = "first gap",
                 .x_label = "seconds without a fix",
                 .y_label = "horizontal error, median, 90 % band [m]"},
      later = first;
  later.title = "later gaps";
  const auto add = [&](const std::string& what, io::Plot& plot, const auto& d, const auto& i,
                       double step) {
    add_curve(plot, "15 states", i, step, io::look::kGate),
        add_curve(plot, "drag filter, 7 states", d, step, io::look::kDetection);
    result.json[what] = curve_json(d, i, step);
    for (std::size_t k = 0; k < d.size(); ++k) {
      result.csv += what + "," + io::text_of(static_cast<double>(k) * step, 4) + "," +
                    std::to_string(d[k].size());
      for (const auto* v : {&d[k], &i[k]})
        for (const double part : {0.5, 0.05, 0.95})
          result.csv += "," + io::text_of(io::nearest_rank(*v, part), 4);
      result.csv += "\n";
    }
  };
  result.json = {{"runs", count},
                 {"laps", kLaps},
                 {"finished", finished},
                 {"fix", {{"rate_hz", 15}, {"sigma_m", kFixSigma}}},
                 {"imu15",
                  {{"accel_noise", classic.accel_noise},
                   {"gyro_noise", classic.gyro_noise},
                   {"start_tilt_sigma_rad", classic.start_tilt_sigma}}}};
  add("bias_error_mps2", bias, drag.bias, imu15.bias, kBiasStep);
  add("first_gap_m", first, drag.first_gap, imu15.first_gap, kDriftStep);
  add("later_gaps_m", later, drag.later_gaps, imu15.later_gaps, kDriftStep);
  result.json["ratio_2s_later_gaps"] = number(io::nearest_rank(imu15.later_gaps[kTwoSeconds], 0.5) /
                                              io::nearest_rank(drag.later_gaps[kTwoSeconds], 0.5));
  result.json["ratio_2s_first_gap"] = number(io::nearest_rank(imu15.first_gap[kTwoSeconds], 0.5) /
                                             io::nearest_rank(drag.first_gap[kTwoSeconds], 0.5));
  result.picture = side_by_side({bias, first, later});
  return result;
}

}  // namespace gatefly::experiments
