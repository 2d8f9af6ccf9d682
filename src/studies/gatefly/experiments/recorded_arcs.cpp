// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/recorded_arcs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include <Eigen/Dense>

#include "gatefly/experiments/arc_table.hpp"
#include "gatefly/files/pictures.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/geometry/math.hpp"

namespace gatefly::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolder = "tudelft_bebop_mocap_laps";

/// "28 Nov 05:02" of Take_2017_11_28_05_02_01_PM_flight_2; else the whole name.
std::string short_name(const std::string& take) {
  constexpr std::array kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                               "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const std::string head = "Take_2017_";
  const std::size_t digits = take.find_first_not_of("0123456789_", head.size());
  if (!take.starts_with(head) || digits == std::string::npos || digits < head.size() + 12)
    return take;
  const auto month = static_cast<std::size_t>(std::stoi(take.substr(head.size(), 2)));
  if (month < 1 || month > kMonths.size()) return take;
  return take.substr(head.size() + 3, 2) + " " + kMonths[month - 1] + " " +
         take.substr(head.size() + 6, 2) + ":" + take.substr(head.size() + 9, 2);
}

double course_off_nose(const std::vector<SmoothSample>& motion, const HalfCircles& found) {
  constexpr double kRunIn = 0.5;  // [s]
  std::vector<double> angles;
  for (const BlindArc& arc : found.arcs)
    for (const SmoothSample& s : motion)
      if (s.tracked && s.t > arc.begin - kRunIn && s.t < arc.begin)
        angles.push_back(wrap_angle(std::atan2(s.v_E.y(), s.v_E.x()) - s.yaw));
  return files::nearest_rank(angles, 0.5);
}

double roughness(const RecordedArcs::Take& take) {
  double largest = 0.0;
  for (const BlindArc& arc : take.found.arcs)
    for (std::size_t i = 0; i < take.motion.size(); ++i)
      if (take.motion[i].tracked && take.motion[i].t >= arc.begin && take.motion[i].t <= arc.end)
        largest = std::max(largest, (take.take.samples[i].p_E - take.motion[i].p_E).norm());
  return largest;
}

PitchByHeading pitch_by_heading(const RecordedArcs::Take& take) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SmoothSample& s : take.motion) {
    if (!s.tracked || s.t < take.found.arcs.front().begin || s.t > take.found.arcs.back().end)
      continue;
    const Eigen::Vector3d row{1.0, std::cos(s.yaw), std::sin(s.yaw)};
    normal += row * row.transpose(), sum += s.pitch * row;
  }
  const Eigen::Vector3d fit = normal.ldlt().solve(sum);
  return {fit.x(), std::hypot(fit.y(), fit.z()), std::atan2(fit.z(), fit.y())};
}

/// Another rule of where an arc begins and ends.
struct OtherRule {
  const char* name;
  double HalfCircleRule::*number;
  double value;
};
constexpr std::array<OtherRule, 6> kOtherRules{
    {{"begins at 5 % of the yaw rate", &HalfCircleRule::begin_part, 0.05},
     {"begins at 25 % of the yaw rate", &HalfCircleRule::begin_part, 0.25},
     {"begins at 50 % of the yaw rate", &HalfCircleRule::begin_part, 0.5},
     {"ends within 2° of +180°", &HalfCircleRule::end_within, 2.0 * kDegree},
     {"ends within 6° of +180°", &HalfCircleRule::end_within, 6.0 * kDegree},
     {"ends within 10° of +180°", &HalfCircleRule::end_within, 10.0 * kDegree}}};

/// The displacement with x along the entry's course instead of its nose.
Eigen::Vector2d along_course(const BlindArc& arc) {
  const double slip = arc.entry_slip();
  const Eigen::Vector2d d = arc.displacement();
  return {std::cos(slip) * d.x() + std::sin(slip) * d.y(),
          std::cos(slip) * d.y() - std::sin(slip) * d.x()};
}

}  // namespace

std::vector<BlindArc> RecordedArcs::arcs() const {
  std::vector<BlindArc> all;
  for (const Take& t : takes) all.insert(all.end(), t.found.arcs.begin(), t.found.arcs.end());
  return all;
}

RecordedArcs recorded_arcs(const Options& options) {
  const fs::path folder = files::find_data(kFolder, options.data);
  RecordedArcs recorded;
  std::error_code error;
  if (!fs::is_directory(folder, error)) return recorded;
  for (MocapTake& take : read_takes(folder)) {
    if (options.stopped()) throw Stopped{};
    RecordedArcs::Take each{.take = std::move(take)};
    each.motion = smoothed(each.take.samples);
    each.found = find_half_circles(each.motion);
    each.course_off_nose = course_off_nose(each.motion, each.found);
    each.roughness = roughness(each);
    if (!each.found.arcs.empty()) each.pitch = pitch_by_heading(each);
    for (std::size_t i = 0; i < each.found.arcs.size(); ++i)
      each.found.arcs[i].flight = short_name(each.take.name) + " arc " + std::to_string(i + 1);
    recorded.takes.push_back(std::move(each));
  }
  return recorded;
}

void report_takes(const RecordedArcs& recorded, Result& result) {
  auto takes = nlohmann::ordered_json::array();
  if (recorded.takes.empty())
    result.table.push_back({"recorded takes", "", "no " + std::string{kFolder} + " (see --data)"});
  for (const RecordedArcs::Take& each : recorded.takes) {
    const auto& arcs = each.found.arcs;
    const Eigen::Vector2d mean = ends_of(arcs).mean;
    const double speed = spread_of(arcs, [](const BlindArc&a) { return a.entry_speed(); }).mean,
                 radius = spread_of(arcs, [](const BlindArc&a) { return a.radius; }).mean,
                 off_nose = each.course_off_nose / kDegree;
    result.table.push_back({"take of " + short_name(each.take.name), "",
                            std::to_string(arcs.size()) + " arcs, mean " + text_of(mean) +
                                " m, entered at " + fixed(speed, 2) + " m/s, radius " +
                                fixed(radius, 2) + " m, course " + fixed(off_nose, 1) +
                                "° off the nose"});
    const PitchByHeading& pitch = each.pitch;
    result.table.push_back({"  its pitch", "",
                            fixed(pitch.mean / kDegree, 1) + "°, " +
                                fixed(pitch.amplitude / kDegree, 1) + "° more towards heading " +
                                fixed(pitch.heading / kDegree, 0) + "°"});
    auto left_out = nlohmann::ordered_json::array();
    for (const LeftOut& other : each.found.left_out) {
      result.table.push_back(
          {"  left out, from " + fixed(other.begin, 1) + " s", "", other.reason});
      left_out.push_back(
          {{"begin_s", other.begin}, {"end_s", other.end}, {"reason", other.reason}});
    }
    takes.push_back({{"take", each.take.name},
                     {"arcs", arcs.size()},
                     {"mean_displacement_m", json_of(mean)},
                     {"entry_speed_mps", number(speed)},
                     {"radius_m", number(radius)},
                     {"course_off_nose_deg", number(off_nose)},
                     {"pitch",
                      {{"mean_deg", number(pitch.mean / kDegree)},
                       {"amplitude_deg", number(pitch.amplitude / kDegree)},
                       {"heading_deg", number(pitch.heading / kDegree)}}},
                     {"largest_marker_error_m", each.take.largest_marker_error},
                     {"roughness_m", each.roughness},
                     {"repeated_samples", each.take.repeated},
                     {"left_out", left_out}});
  }
  result.json["recorded"] = {{"takes", takes}};
}

void report_rules(const RecordedArcs& recorded, Result& result) {
  const std::vector<BlindArc> arcs = recorded.arcs();
  if (arcs.empty()) return;
  const Eigen::Vector2d mean = ends_of(arcs).mean;
  auto moves = nlohmann::ordered_json::array();
  const auto tell = [&](const std::string& name, std::size_t count, const Eigen::Vector2d& by) {
    const std::string fewer =
        count == arcs.size() ? "" : ", with " + std::to_string(count) + " arcs";
    result.table.push_back(
        {"recorded, " + name, "", "mean moves by " + text_of(by) + " m" + fewer});
    moves.push_back({{"rule", name}, {"arcs", count}, {"moves_m", json_of(by)}});
  };
  for (const OtherRule& other : kOtherRules) {
    HalfCircleRule rule;
    rule.*other.number = other.value;
    std::vector<BlindArc> some;
    for (const RecordedArcs::Take& each : recorded.takes) {
      const HalfCircles found = find_half_circles(each.motion, rule);
      some.insert(some.end(), found.arcs.begin(), found.arcs.end());
    }
    tell(other.name, some.size(), ends_of(some).mean - mean);
  }
  std::vector<Eigen::Vector2d> turned;
  for (const BlindArc& arc : arcs) turned.push_back(along_course(arc));
  tell("x along the entry's course, not its nose", arcs.size(), spread_of(turned).mean - mean);
  result.json["recorded"]["rules"] = moves;
}

}  // namespace gatefly::experiments
