// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/campaign_statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "gatefly/files/json_file.hpp"
#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::simulated_race {
namespace {

std::string cell(const std::string& text) {
  return text.find_first_of(",\"\n\r") == std::string::npos
             ? text
             : nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// A number's cell; empty for NaN.
std::string cell(double value) { return std::isnan(value) ? "" : files::text_of(value); }

void read_loss(const files::JsonObject& summary, RunRow& row) {
  if (!summary.has("why_lost")) return;
  const files::JsonObject lost = summary.object("why_lost");
  row.why = lost.text("cause");
  for (const files::JsonObject& part : lost.objects("parts", 4))
    row.shares.push_back(part.number("share_cm"));
  row.since_fix = lost.number_or_null("since_fix_s");
}

std::string loss_cells(const RunRow& row) {
  if (row.why.empty()) return ",,,,,,";
  std::string cells = "," + cell(row.why);
  for (std::size_t i = 0; i < 4; ++i)
    cells += "," + (i < row.shares.size() ? cell(row.shares[i]) : "");
  return cells + "," + cell(row.since_fix);
}

std::string cause_in(const files::JsonObject& summary) {
  if (summary.truth("finished")) return "finished";
  if (summary.has("crash")) return "crash: " + summary.object("crash").text("object");
  const std::string reason = summary.text("stop_reason");
  return reason == "abort" ? "abort: " + summary.text("abort_reason") : reason;
}

nlohmann::ordered_json quantiles(std::vector<double> values) {
  if (values.empty()) return nullptr;
  std::sort(values.begin(), values.end());
  nlohmann::ordered_json json;
  for (const auto& [name, q] : {std::pair{"min", 0.0},
                                {"p10", 0.1},
                                {"p25", 0.25},
                                {"p50", 0.5},
                                {"p75", 0.75},
                                {"p90", 0.9},
                                {"max", 1.0}})
    json[name] = files::quantile(values, q);
  return json;
}

ChiSquareCount count_of(const files::JsonObject& json) {
  return {json.count("samples"), json.number("sum_per_dof"), json.count("inside")};
}
double mean_of(const ChiSquareCount& c) { return c.samples > 0 ? c.sum_per_dof / c.samples : 0.0; }
double inside_of(const ChiSquareCount& c) {
  return c.samples > 0 ? static_cast<double>(c.inside) / c.samples : 0.0;
}

nlohmann::ordered_json pooled(const std::vector<RunRow>& rows) {
  Consistency all;
  const auto add = [](ChiSquareCount& to, const ChiSquareCount& from) {
    to.samples += from.samples, to.sum_per_dof += from.sum_per_dof, to.inside += from.inside;
  };
  for (const RunRow& row : rows)
    add(all.nees, row.consistency.nees), add(all.nis, row.consistency.nis),
        all.divergences += row.consistency.divergences;
  const auto json = [](const ChiSquareCount& c) {
    return nlohmann::ordered_json{
        {"samples", c.samples}, {"mean_per_dof", mean_of(c)}, {"inside_95", inside_of(c)}};
  };
  return {{"nees", json(all.nees)}, {"nis", json(all.nis)}, {"divergences", all.divergences}};
}

/// Seeds of runs that have something in common, by what that is.
using Seeds = std::map<std::string, std::vector<std::uint64_t>>;

/// The most frequent first.
nlohmann::ordered_json ranked(const Seeds& seeds) {
  std::vector<std::pair<std::string, std::vector<std::uint64_t>>> all(seeds.begin(), seeds.end());
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.second.size() > b.second.size(); });
  auto json = nlohmann::ordered_json::array();
  for (const auto& [cause, of] : all)
    json.push_back({{"cause", cause}, {"count", of.size()}, {"seeds", of}});
  return json;
}

constexpr std::array kFound{"camera_tilt_deg", "heading_deg", "thrust_percent", "latency_ms"};

void read_discoveries(const files::JsonObject& summary, RunRow& row) {
  if (summary.has("found_after_lap_1")) {
    const files::JsonObject found = summary.object("found_after_lap_1");
    for (const char* name : kFound) {
      const files::JsonObject one = found.object(name);
      row.found.push_back({one.number("error"), one.number("sigma")});
    }
  }
  if (summary.has("map_reports"))
    row.map_reports = static_cast<int>(summary.objects("map_reports", 1000).size());
}

std::string found_cells(const RunRow& row) {
  std::string cells;
  for (std::size_t i = 0; i < kFound.size(); ++i)
    cells += i < row.found.size() ? "," + cell(row.found[i].error) + "," + cell(row.found[i].sigma)
                                  : ",,";
  for (const int count : {row.map_reports, row.through_false_gates, row.through_other_gates})
    cells += "," + std::to_string(count);
  return cells;
}

/// RMS over races of what is left of each error after the first lap, and in its own sigmas.
nlohmann::ordered_json found_by_all(const std::vector<RunRow>& rows) {
  nlohmann::ordered_json json;
  for (std::size_t i = 0; i < kFound.size(); ++i) {
    double squares = 0.0, in_sigmas = 0.0;
    int n = 0;
    for (const RunRow& row : rows) {
      if (i >= row.found.size() || !(row.found[i].sigma > 0.0)) continue;
      const double error = row.found[i].error, relative = error / row.found[i].sigma;
      squares += error * error, in_sigmas += relative * relative, ++n;
    }
    if (n == 0) continue;
    json[kFound[i]] = {
        {"races", n}, {"rms", std::sqrt(squares / n)}, {"rms_in_sigmas", std::sqrt(in_sigmas / n)}};
  }
  return json;
}

/// The middle one of the races' own means: of them half are more consistent.
double median_nees(const std::vector<RunRow>& rows) {
  std::vector<double> means;
  for (const RunRow& row : rows)
    if (row.consistency.nees.samples > 0) means.push_back(mean_of(row.consistency.nees));
  if (means.empty()) return 0.0;
  std::sort(means.begin(), means.end());
  return files::quantile(means, 0.5);
}

}  // namespace

RunRow row_of(const nlohmann::ordered_json& json, const std::string& file) {
  const files::JsonObject summary(file, json), detection = summary.object("detection");
  RunRow row;
  row.seed = summary.whole("seed");
  row.finished = summary.truth("finished");
  row.gates = summary.count("gates_passed");
  row.gates_total = summary.count("gates_total");
  row.time = summary.number_or_null("race_time_s");
  row.mean_speed = summary.number_or_null("mean_speed_mps");
  row.max_speed = summary.number_or_null("max_speed_mps");
  row.cause = cause_in(summary);
  row.rmse = summary.numbers_or_null("estimation_rmse_m", 3);
  read_loss(summary, row);
  read_discoveries(summary, row);
  row.frames = detection.count("frames");
  row.true_positives = detection.count("true_positives");
  row.false_positives = detection.count("false_positives");
  row.searches = summary.count("searches");
  if (summary.has("stray_passes")) {
    const files::JsonObject stray = summary.object("stray_passes");
    row.through_false_gates = stray.count("false_gates");
    row.through_other_gates = stray.count("gates_out_of_turn");
  }
  row.commit = summary.text("commit", "");
  row.configuration = summary.text("configuration", "");
  if (summary.has("consistency")) {
    const files::JsonObject consistency = summary.object("consistency");
    row.consistency = {count_of(consistency.object("nees")), count_of(consistency.object("nis")),
                       consistency.count("divergences")};
  }
  return row;
}

Interval wilson95(int hits, int trials) {
  if (trials <= 0) return {};
  constexpr double kZ = 1.959963984540054;
  const double n = trials, p = hits / n, z2 = kZ * kZ;
  const double middle = (p + z2 / (2 * n)) / (1 + z2 / n);
  const double half = kZ / (1 + z2 / n) * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n));
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

std::string runs_csv(const std::vector<RunRow>& rows) {
  std::string csv =
      "seed,finished,gates,gates_total,time_s,mean_speed_mps,max_speed_mps,cause,"
      "rmse_x_m,rmse_y_m,rmse_z_m,frames,true_positives,false_positives,searches,"
      "nees_mean,nees_inside,nis_mean,nis_inside,divergences,why,estimate_cm,guidance_cm,map_cm,"
      "detection_cm,since_fix_s,commit,configuration,tilt_error_deg,tilt_sigma_deg,"
      "heading_error_deg,heading_sigma_deg,thrust_error_percent,thrust_sigma_percent,"
      "latency_error_ms,latency_sigma_ms,map_reports,through_false_gates,through_other_gates\n";
  for (const RunRow& r : rows) {
    csv += std::to_string(r.seed) + "," + (r.finished ? "1," : "0,") + std::to_string(r.gates) +
           "," + std::to_string(r.gates_total) + "," + files::text_of(r.time) + "," +
           cell(r.mean_speed) + "," + cell(r.max_speed) + "," + cell(r.cause);
    for (const double error : r.rmse) csv += "," + cell(error);
    for (const int count : {r.frames, r.true_positives, r.false_positives, r.searches})
      csv += "," + std::to_string(count);
    for (const auto& count : {r.consistency.nees, r.consistency.nis})
      csv += "," + files::text_of(mean_of(count)) + "," + files::text_of(inside_of(count));
    csv += "," + std::to_string(r.consistency.divergences) + loss_cells(r) + "," + cell(r.commit) +
           "," + cell(r.configuration) + found_cells(r) + "\n";
  }
  return csv;
}

nlohmann::ordered_json campaign_result(const std::vector<RunRow>& rows) {
  std::vector<double> times, speeds;
  Seeds causes, whys;
  long gates = 0, gates_total = 0, through_false = 0, through_other = 0;
  for (const RunRow& row : rows) {
    gates += row.gates, gates_total += row.gates_total;
    through_false += row.through_false_gates, through_other += row.through_other_gates;
    if (row.finished && !std::isnan(row.mean_speed)) speeds.push_back(row.mean_speed);
    if (row.finished)
      times.push_back(row.time);
    else
      causes[row.cause].push_back(row.seed);
    if (!row.why.empty()) whys[row.why].push_back(row.seed);
  }
  const int runs = static_cast<int>(rows.size()), finished = static_cast<int>(times.size());
  const Interval interval = wilson95(finished, runs);

  nlohmann::ordered_json json;
  json["runs"] = runs;
  json["finished"] = finished;
  json["completion_rate"] = runs > 0 ? static_cast<double>(finished) / runs : 0.0;
  json["completion_wilson95"] = {interval.low, interval.high};
  json["gates_passed"] = gates;
  json["gates_total"] = gates_total;
  json["stray_passes"] = {{"false_gates", through_false}, {"gates_out_of_turn", through_other}};
  json["race_time_s"] = quantiles(times);
  json["mean_speed_mps"] = quantiles(speeds);
  json["consistency"] = pooled(rows);
  json["consistency"]["nees_median_of_races"] = median_nees(rows);
  json["found_after_lap_1"] = found_by_all(rows);
  json["races_with_map_reports"] =
      std::count_if(rows.begin(), rows.end(), [](const RunRow& r) { return r.map_reports > 0; });
  json["causes"] = ranked(causes);
  json["lost_by"] = ranked(whys);
  return json;
}

}  // namespace gatefly::simulated_race
