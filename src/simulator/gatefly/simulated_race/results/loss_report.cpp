// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/loss_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "gatefly/files/text.hpp"

namespace gatefly::simulated_race {
namespace {

using How = WhyLost::How;
using Cause = WhyLost::Cause;
using Json = nlohmann::ordered_json;

constexpr double kShown = 0.005;  // less is no whole centimetre [m]
constexpr double kStill = 0.02;   // [m/s]

/// "17 cm", "1.9 m".
std::string length(double metres) {
  const double size = std::abs(metres);
  return size < 0.995 ? files::fixed(100.0 * size, 0) + " cm" : files::fixed(size, 1) + " m";
}

/// "20 cm right, 6 cm low"; what is less than a fifth of the whole is left out.
std::string directions(const Eigen::Vector3d& miss, bool along) {
  constexpr std::array<std::pair<const char*, const char*>, 3> kWords{
      {{"short", "long"}, {"left", "right"}, {"high", "low"}}};
  std::string text;
  for (const int axis : {1, 2, 0}) {
    if (axis == 0 && !along) continue;
    const double part = miss(axis);
    if (std::abs(part) < std::max(kShown, 0.2 * miss.norm())) continue;
    const auto& [less, more] = kWords[static_cast<std::size_t>(axis)];
    text += (text.empty() ? "" : ", ") + length(part) + " " + (part < 0.0 ? less : more);
  }
  return text;
}

const char* side_of(const Eigen::Vector2d& wind) {
  if (std::abs(wind.x()) > std::abs(wind.y())) return wind.x() > 0.0 ? "behind" : "ahead";
  return wind.y() > 0.0 ? "the left" : "the right";
}

/// "no fix for 1.8 s, the gate out of view".
std::string fix_words(const WhyLost& why) {
  constexpr double kRecent = 0.25;  // [s]
  if (!why.since_fix) return "no fix at all";
  if (*why.since_fix < 0.05) return "a fix just before";
  if (*why.since_fix < kRecent) return "last fix " + files::fixed(*why.since_fix, 1) + " s before";
  std::string text = "no fix for " + files::fixed(*why.since_fix, 1) + " s";
  const auto& looks = why.looks;
  if (looks.pictures < 3) return text;
  if (looks.gate_in_view == 0) return text + ", the gate not whole in view";
  return text + ", the gate found in " + std::to_string(looks.gate_found) + " of the " +
         files::amount(looks.gate_in_view, "picture") + " that showed it whole" +
         (2 * looks.gate_found > looks.gate_in_view ? " but not believed" : "");
}

std::string wind_words(const WhyLost& why) {
  if (why.wind.norm() < kStill && why.wind_mean < kStill) return "";
  const std::string mean = files::fixed(why.wind_mean, 1);
  if (why.wind.norm() < 0.05) return ", no wind then, " + mean + " m/s on average";
  const std::string now = files::fixed(why.wind.norm(), 1);
  return ", wind " + now + " m/s from " + side_of(why.wind) +
         (now == mean ? "" : ", " + mean + " on average");
}

std::string detection_words(const WhyLost& why) {
  constexpr double kLately = 5.0;  // [s]
  if (why.wrong_fix && why.time - why.wrong_fix->time < kLately)
    return "it took " + why.wrong_fix->taken_of + " for its gate " +
           files::fixed(why.time - why.wrong_fix->time, 1) + " s before";
  return why.fix_error ? "its last fix was " + length(why.fix_error->norm()) + " off" : "";
}

/// "17 cm the estimate (...), 3 cm guidance, 1 cm the map; 4 cm detection against it".
std::string shares(const WhyLost& why) {
  constexpr std::array<const char*, 4> kNames{"the estimate", "guidance", "the map", "detection"};
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return why.shares[a] > why.shares[b]; });
  const std::array<std::string, 4> notes{fix_words(why) + wind_words(why), "it knew of that", "",
                                         detection_words(why)};
  std::string text, against;
  bool estimate_told = false;
  for (const std::size_t i : order) {
    const double share = why.shares[i];
    if (std::abs(share) < kShown) continue;
    std::string& to = share > 0.0 ? text : against;
    to += (to.empty() ? "" : ", ") + length(share) + " " + kNames[i];
    if (i == 0) estimate_told = true;
    if (!notes[i].empty() && (i == 0 || i == order[0])) to += " (" + notes[i] + ")";
  }
  if (!against.empty()) text += "; against it " + against;
  return estimate_told ? text : text + (text.empty() ? "" : "; ") + notes[0];
}

/// The outcome in words, without its cause.
std::string event(const WhyLost& why, const RaceResult& r) {
  switch (why.how) {
    case How::kContact: {
      const std::size_t of = why.object.find(" of ");
      const bool own = why.at_its_gate && of != std::string::npos;
      const bool nameless = why.object.starts_with("person") || why.object.starts_with("decoy") ||
                            why.object.starts_with("obstacle");
      if (own) return "touched its " + why.object.substr(0, of);
      return "touched " + std::string{nameless ? "" : "the "} + why.object;
    }
    case How::kMissedGate:
      return "flew past its opening";
    case How::kNotFound:
    case How::kGivenUp:
      return "gave up, " + why.reason;
    case How::kTimeout:
      return "out of time after " + files::fixed(r.flight_time, 0) + " s";
  }
  return "";
}

/// "21 cm off centre (20 cm right, 6 cm low)".
std::string miss_words(const WhyLost& why) {
  Eigen::Vector3d miss = why.miss;
  if (why.from_gate) miss.x() = 0.0;
  const std::string where = why.from_gate ? " off its centre" : " off its way";
  const std::string ways = directions(miss, !why.from_gate);
  if (miss.norm() < kShown) return why.from_gate ? "in its centre" : "on its way";
  return length(miss.norm()) + where + (ways.empty() ? "" : " (" + ways + ")");
}

std::string afterwards(const WhyLost& why, const RaceResult& r) {
  if (why.how == How::kContact || why.object.empty() || !r.crash_time) return "";
  return "; touched " + why.object + " " + files::fixed(*r.crash_time - why.time, 1) + " s later";
}

const char* name_of(Cause cause) {
  switch (cause) {
    case Cause::kEstimate:
      return "estimate";
    case Cause::kGuidance:
      return "guidance";
    case Cause::kMap:
      return "map";
    case Cause::kDetection:
      return "detection";
    case Cause::kInTheWay:
      return "in the way";
    case Cause::kGivenUp:
      return "given up";
    case Cause::kTimeout:
      break;
  }
  return "timeout";
}

double centimetres(double metres) { return std::round(1e3 * metres) / 10.0; }

Json part(const char* cause, const Eigen::Vector3d& offset, double share) {
  return {{"cause", cause},
          {"lateral_cm", centimetres(offset.y())},
          {"vertical_cm", centimetres(offset.z())},
          {"along_cm", centimetres(offset.x())},
          {"share_cm", centimetres(share)}};
}

}  // namespace

std::string loss_line(const RaceResult& result) {
  if (!result.why_lost) return "";
  const WhyLost& why = *result.why_lost;
  std::string line = std::string{why.at_its_gate ? "Lost at gate " : "Lost before gate "} +
                     std::to_string(why.gate) + " of " + std::to_string(result.gates_total) + ": " +
                     event(why, result);
  if (why.cause == Cause::kGivenUp) return line + ".";
  if (why.cause == Cause::kInTheWay) return line + ", which stood in its way and is on no map.";
  if (why.cause == Cause::kTimeout) return line + ", " + miss_words(why) + ".";
  if (why.cause == Cause::kDetection && why.how == How::kNotFound && why.looks.gate_in_view > 0)
    return line + ": " + fix_words(why) + "; " + miss_words(why) + afterwards(why, result) + ".";
  return line + ", " + miss_words(why) + ": " + shares(why) + afterwards(why, result) + ".";
}

Json loss_json(const RaceResult& result) {
  if (!result.why_lost) return nullptr;
  const WhyLost& why = *result.why_lost;
  Json json;
  json["line"] = loss_line(result);
  json["cause"] = name_of(why.cause);
  json["t_s"] = why.time;
  json["gate"] = why.gate;
  json["object"] = why.object;
  json["measured_from"] = why.from_gate ? "centre of the gate" : "planned way";
  json["miss"] = {{"lateral_cm", centimetres(why.miss.y())},
                  {"vertical_cm", centimetres(why.miss.z())},
                  {"along_cm", centimetres(why.miss.x())}};
  json["parts"] = Json::array(
      {part("estimate", why.estimate, why.shares[0]), part("guidance", why.guidance, why.shares[1]),
       part("map", why.map, why.shares[2]), part("detection", why.detection, why.shares[3])});
  json["since_fix_s"] = why.since_fix ? Json(*why.since_fix) : Json{};
  json["last_fix_error_cm"] = nullptr;
  if (why.fix_error)
    json["last_fix_error_cm"] = {centimetres(why.fix_error->y()), centimetres(why.fix_error->z())};
  json["wrong_fix"] = nullptr;
  if (why.wrong_fix)
    json["wrong_fix"] = {{"t_s", why.wrong_fix->time}, {"taken_of", why.wrong_fix->taken_of}};
  json["pictures_since_fix"] = {{"frames", why.looks.pictures},
                                {"with_gate_visible", why.looks.gate_in_view},
                                {"true_positives", why.looks.gate_found}};
  const bool still = why.wind.norm() < kStill && why.wind_mean < kStill;
  json["wind_mps"] = still ? Json{} : Json(why.wind.norm());
  json["wind_from"] = still ? Json{} : Json(side_of(why.wind));
  json["wind_mean_mps"] = still ? Json{} : Json(why.wind_mean);
  return json;
}

}  // namespace gatefly::simulated_race
