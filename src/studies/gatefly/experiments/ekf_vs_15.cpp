// SPDX-License-Identifier: Apache-2.0
// What the drag model gains over the classic filter: how fast the accelerometer's bias is found,
// how far the position drifts while no gate is seen. Li18 §3.3, where the paper says so without a
// figure.
#include <algorithm>
#include <cstddef>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "gatefly/drawing/plot.hpp"
#include "gatefly/experiments/experiment.hpp"
#include "gatefly/experiments/filter_race.hpp"
#include "gatefly/experiments/labelled_set.hpp"
#include "gatefly/experiments/pose_trial.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::experiments {
namespace {

constexpr std::size_t kRuns = 60, kQuickRuns = 8;
constexpr double kBiasStep = 1.0, kDriftStep = 0.25;        // between points of the curves [s]
constexpr std::size_t kBiasPoints = 26, kDriftPoints = 13;  // to 25 s; to 3 s
constexpr std::size_t kOneSecond = 4, kTwoSeconds = 8;

/// One filter's errors in one run.
struct Course {
  /// Horizontal, by seconds since the first fix [m/s²].
  Samples bias = Samples(kBiasPoints);
  /// Horizontal, by time since the last fix [m].
  Samples first_gap = Samples(kDriftPoints), later_gaps = Samples(kDriftPoints);
};

void add(Course& to, const Course& from) {
  append(to.bias, from.bias), append(to.first_gap, from.first_gap),
      append(to.later_gaps, from.later_gaps);
}

/// A copy that gets no fix any more.
template <class Filter>
struct Blind {
  double since;
  Samples* errors;
  Filter filter;
  std::size_t next = 0;
};

template <class Filter>
Course course_of(const FilterRace& race, Filter filter) {
  Course course;
  std::vector<Blind<Filter>> blind;
  std::size_t bias_point = 0;
  bool is_first_gap = true;
  double first_fix = 1e9;
  race.feed(
      filter, {},
      [&](const LapMoment& m, const FilterTick& tick, const Filter& now, const FixTime* fix) {
        for (auto& b : blind) b.filter.step(tick);
        if (fix != nullptr) first_fix = std::min(first_fix, m.t);
        if (fix != nullptr && fix->last)
          blind.push_back({m.t, is_first_gap ? &course.first_gap : &course.later_gaps, now}),
              is_first_gap = false;
        for (auto& b : blind)
          if (b.next < kDriftPoints && m.t >= b.since + static_cast<double>(b.next) * kDriftStep)
            (*b.errors)[b.next++].push_back(
                (b.filter.position() - m.p_EB).template head<2>().norm());
        std::erase_if(blind, [](const auto& b) { return b.next == kDriftPoints; });
        if (bias_point < kBiasPoints &&
            m.t - first_fix >= static_cast<double>(bias_point) * kBiasStep)
          course.bias[bias_point++].push_back(
              (now.accel_bias() - race.laps().accel_bias).template head<2>().norm());
        return true;
      });
  return course;
}

struct Run {
  Course drag, imu15;
  bool finished = false;
};

/// Those noises of the classic filter that drift least in 2 s, on flights that are not shown.
baseline::Imu15Params tuned(const Options& options) {
  const std::vector<FilterRace> races = tuning_races(options);
  return tuned_imu15(options, [&](const baseline::Imu15Params& params) {
    std::vector<Course> courses(races.size());
    in_parallel(races.size(),
                [&](std::size_t i) { courses[i] = course_of(races[i], races[i].imu15(params)); });
    Course all;
    for (const Course& course : courses) add(all, course);
    return rms(all.first_gap[kTwoSeconds]) + rms(all.later_gaps[kTwoSeconds]);
  });
}

// ---------------------------------------------------------------- report

nlohmann::ordered_json curve_json(const Samples& drag, const Samples& imu15, double step) {
  auto list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < drag.size(); ++i)
    list.push_back({{"t_s", static_cast<double>(i) * step},
                    {"samples", drag[i].size()},
                    {"drag", band_json(drag[i])},
                    {"imu15", band_json(imu15[i])}});
  return list;
}

}  // namespace

Result ekf_vs_15(const Options& options) {
  const std::size_t count = options.quick ? kQuickRuns : kRuns;
  std::vector<Run> runs(count);
  options.progress(0.0, "the classic filter's noises");
  const baseline::Imu15Params classic = tuned(options);
  in_pieces(count, options, [&](std::size_t i) {
    const FilterRace race{i + 1};
    runs[i] = {course_of(race, race.drag()), course_of(race, race.imu15(classic)),
               race.laps().finished};
  });
  Course drag, imu15;
  int finished = 0;
  for (const Run& run : runs) add(drag, run.drag), add(imu15, run.imu15), finished += run.finished;

  Result result{
      .table = {},
      .json = {},
      .csv = "what,t_s,samples,drag_median,drag_p5,drag_p95,imu15_median,imu15_p5,imu15_p95\n",
      .picture = drawing::Canvas(1, 1)};
  result.table.push_back({std::to_string(count) + " flights of " +
                              std::to_string(FilterRace::kLaps) + " laps, finished",
                          "", std::to_string(finished)});
  for (const std::size_t second : {0u, 1u, 2u, 5u, 10u, 20u})
    result.table.push_back({"bias x, y, " + std::to_string(second) + " s after the first fix",
                            second == 0 ? "" : "converges faster",
                            against(drag.bias[second], imu15.bias[second], "m/s²")});
  for (const auto& [name, d, i] : {std::tuple{"first gap", &drag.first_gap, &imu15.first_gap},
                                   std::tuple{"later gaps", &drag.later_gaps, &imu15.later_gaps}})
    for (const std::size_t point : {std::size_t{0}, kOneSecond, kTwoSeconds})
      result.table.push_back({std::string{"position, "} + name + ", " +
                                  files::text_of(static_cast<double>(point) * kDriftStep, 2) +
                                  " s blind",
                              "", against((*d)[point], (*i)[point], "m")});

  drawing::Plot bias{.title = "Accelerometer bias found: error of x and y",
                     .x_label = "time since the first fix [s]",
                     .y_label = "error [m/s²], median, 90 % band"};
  drawing::Plot first{.title = "Drift in the first gap",
                      .x_label = "time without a fix [s]",
                      .y_label = "horizontal error [m], median, 90 % band"},
      later = first;
  later.title = "Drift in later gaps";
  const auto show = [&](const std::string& what, drawing::Plot& plot, const auto& d, const auto& i,
                        double step) {
    add_band(plot, "15 states", i, 0.0, step, drawing::kLight.gate_solid),
        add_band(plot, "drag filter, 7 states", d, 0.0, step, drawing::kLight.found);
    result.json[what] = curve_json(d, i, step);
    for (std::size_t k = 0; k < d.size(); ++k) {
      result.csv += what + "," + files::text_of(static_cast<double>(k) * step, 4) + "," +
                    std::to_string(d[k].size());
      for (const auto* v : {&d[k], &i[k]})
        for (const double part : {0.5, 0.05, 0.95})
          result.csv += "," + files::text_of(files::nearest_rank(*v, part), 4);
      result.csv += "\n";
    }
  };
  result.json = {{"runs", count},
                 {"laps", FilterRace::kLaps},
                 {"finished", finished},
                 {"fix", {{"rate_hz", 15}, {"sigma_m", FilterConditions{}.fix_sigma}}},
                 {"imu15",
                  {{"accel_noise", classic.accel_noise},
                   {"gyro_noise", classic.gyro_noise},
                   {"start_tilt_sigma_rad", classic.start_tilt_sigma}}}};
  show("bias_error_mps2", bias, drag.bias, imu15.bias, kBiasStep);
  show("first_gap_m", first, drag.first_gap, imu15.first_gap, kDriftStep);
  show("later_gaps_m", later, drag.later_gaps, imu15.later_gaps, kDriftStep);
  result.json["ratio_2s_later_gaps"] =
      number(files::nearest_rank(imu15.later_gaps[kTwoSeconds], 0.5) /
             files::nearest_rank(drag.later_gaps[kTwoSeconds], 0.5));
  result.json["ratio_2s_first_gap"] =
      number(files::nearest_rank(imu15.first_gap[kTwoSeconds], 0.5) /
             files::nearest_rank(drag.first_gap[kTwoSeconds], 0.5));
  result.picture = drawing::Canvas(drawing::kPlotWidth, drawing::kPlotHeight);
  result.picture.paste(drawing::draw(bias, drawing::kPlotWidth, drawing::kRowHeight), {0.0, 0.0});
  result.picture.paste(drawing::draw_sheet(std::array{first, later}, 2),
                       {0.0, drawing::kRowHeight});
  return result;
}

}  // namespace gatefly::experiments
