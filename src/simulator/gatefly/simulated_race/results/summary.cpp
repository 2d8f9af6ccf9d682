// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/summary.hpp"

#include "gatefly/flight_log/findings_json.hpp"
#include "gatefly/flight_log/sensor_health_json.hpp"
#include "gatefly/geometry/math.hpp"
#include "gatefly/simulated_race/results/loss_report.hpp"

namespace gatefly::simulated_race {
namespace {

/// The names of "found", where it has one.
nlohmann::ordered_json truth_json(const TruthOfFindings& truth) {
  constexpr double kMillisecond = 1e-3;
  return {{"camera_tilt_deg", truth.tilt / kDegree},
          {"camera_pan_deg", truth.pan / kDegree},
          {"camera_roll_deg", truth.roll / kDegree},
          {"center_as_tilt_deg", truth.center_as_tilt / kDegree},
          {"center_as_pan_deg", truth.center_as_pan / kDegree},
          {"latency_ms", truth.latency / kMillisecond},
          {"latency_jitter_ms", truth.latency_jitter / kMillisecond},
          {"focal", truth.focal},
          {"start_heading_deg", truth.start_heading / kDegree},
          {"hover_thrust", truth.hover_thrust},
          {"moved_gate", truth.moved_gate}};
}

nlohmann::ordered_json found_after_lap(const Discoveries& found) {
  if (!found.after_lap) return nullptr;
  const auto pair = [](const FoundError& one, double unit) {
    return nlohmann::ordered_json{{"error", one.error / unit}, {"sigma", one.sigma / unit}};
  };
  return {{"camera_tilt_deg", pair(found.after_lap->camera_tilt, kDegree)},
          {"heading_deg", pair(found.after_lap->heading, kDegree)},
          {"thrust_percent", pair(found.after_lap->thrust, 0.01)},
          {"latency_ms", pair(found.after_lap->latency, 1e-3)}};
}

nlohmann::ordered_json map_reports(const Discoveries& found) {
  auto json = nlohmann::ordered_json::array();
  for (const MapReport& report : found.map_reports)
    json.push_back(
        {{"gate", report.gate + 1},
         {"t_s", report.time},
         {"along_right_down_m", {report.offset.x(), report.offset.y(), report.offset.z()}},
         {"before_its_plane", report.before_its_plane}});
  return json;
}

}  // namespace

nlohmann::ordered_json summary(const RaceResult& result, const RaceIdentity& race) {
  using Json = nlohmann::ordered_json;
  Json crash = nullptr;
  if (result.crash_time) crash = {{"t_s", *result.crash_time}, {"object", result.crash_object}};
  Json offsets = Json::array();
  for (const Eigen::Vector2d& offset : result.gate_offsets)
    offsets.push_back(Json::array({offset.x(), offset.y()}));
  Json timings = Json::object();
  for (const StageTime& stage : result.timings)
    timings[stage.stage] = {
        {"p50_us", stage.p50_us}, {"p99_us", stage.p99_us}, {"max_us", stage.max_us}};
  timings["whole_flight"] = {
      {"cpu_s", result.cpu_seconds},
      {"wall_s", result.wall_seconds},
      {"bake_s", result.bake_seconds},
      {"cpu_s_per_flight_s",
       result.flight_time > 0 ? result.cpu_seconds / result.flight_time : 0.0}};

  const Eigen::Vector3d& rmse = result.estimation_rmse;
  Json json;
  json["finished"] = result.finished;
  json["gates_passed"] = result.gates_passed;
  json["gates_total"] = result.gates_total;
  json["stray_passes"] = {{"false_gates", result.through_false_gates},
                          {"gates_out_of_turn", result.through_other_gates}};
  json["race_time_s"] = result.race_time;
  json["lap_times_s"] = result.lap_times;
  // From the first gate to the last: before there is no speed, and no error, to speak of.
  json["mean_speed_mps"] = result.gates_passed > 1 ? Json(result.mean_speed) : Json{};
  json["max_speed_mps"] = result.gates_passed > 0 ? Json(result.max_speed) : Json{};
  json["crash"] = crash;
  json["stop_reason"] = result.stop_reason;
  json["landed"] = result.landed;
  json["landing_contact"] = result.landing_contact.empty() ? Json{} : Json(result.landing_contact);
  json["abort_reason"] = result.abort_reason;
  json["why_lost"] = loss_json(result);
  json["gate_offsets_m"] = offsets;
  json["estimation_rmse_m"] =
      result.gates_passed > 0 ? Json::array({rmse.x(), rmse.y(), rmse.z()}) : Json{};
  const auto counted = [](const ChiSquareCount& count) {
    return Json{
        {"samples", count.samples}, {"sum_per_dof", count.sum_per_dof}, {"inside", count.inside}};
  };
  json["consistency"] = {{"nees", counted(result.consistency.nees)},
                         {"nis", counted(result.consistency.nis)},
                         {"divergences", result.consistency.divergences}};
  json["detection"] = {{"frames", result.frames},
                       {"with_gate_visible", result.frames_with_gate},
                       {"true_positives", result.true_positives},
                       {"false_positives", result.false_positives},
                       {"careful_searches", result.careful_searches}};
  json["sensors"] = flight_log::as_json(result.sensor_health);
  json["found"] = flight_log::as_json(result.findings);
  json["truth"] = truth_json(result.truth);
  json["found_after_lap_1"] = found_after_lap(result.discoveries);
  json["map_reports"] = map_reports(result.discoveries);
  json["gate_rmse_m"] = result.discoveries.gate_rmse;
  json["diverged"] = nullptr;
  if (result.divergence)
    json["diverged"] = {{"since_s", result.divergence->since},
                        {"why", eskf::text_of(result.divergence->why)}};
  json["true_gates"] = Json::array();
  for (const world::WorldGate& gate : result.true_gates)
    json["true_gates"].push_back({{"position_m", {gate.p_EG.x(), gate.p_EG.y(), gate.p_EG.z()}},
                                  {"heading_deg", gate.yaw_EG / kDegree}});
  json["searches"] = result.searches;
  json["flight_time_s"] = result.flight_time;
  json["timings"] = timings;
  json["seed"] = race.seed;
  json["track"] = race.track;
  json["vision"] = race.vision;
  json["version"] = race.version;
  json["commit"] = race.commit;
  json["configuration"] = race.configuration;
  json["config"] = race.config;
  return json;
}

}  // namespace gatefly::simulated_race
