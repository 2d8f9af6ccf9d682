// SPDX-License-Identifier: Apache-2.0
#include "campaign_report.hpp"

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>

#include "gatefly/files/text.hpp"

namespace gatefly::cli {
namespace {

using files::fixed;

/// "3, 8, 11, ...": the first six.
std::string first_of(const nlohmann::ordered_json& seeds) {
  std::string text;
  for (std::size_t k = 0; k < std::min<std::size_t>(6, seeds.size()); ++k)
    text += (k > 0 ? ", " : "") + seeds[k].dump();
  return text + (seeds.size() > 6 ? ", ..." : "");
}

void print_line(const char* name, const std::string& text) {
  std::cout << "  " << std::left << std::setw(16) << name << text << '\n';
}

/// "0.031", "1.2e-05".
std::string probability(double p) {
  if (p == 0.0 || p >= 1e-3) return fixed(p, 3);
  std::ostringstream text;
  text << std::scientific << std::setprecision(1) << p;
  return text.str();
}

std::string percent(double part) { return fixed(100.0 * part, 1) + " %"; }

/// Prints what is left of each error after the first lap, RMS over races.
void print_found(const nlohmann::ordered_json& result) {
  const auto found = result.value("found_after_lap_1", nlohmann::ordered_json::object());
  std::string left;
  for (const auto& [key, words] :
       {std::pair{"camera_tilt_deg", "tilt ° "}, std::pair{"heading_deg", "heading ° "},
        std::pair{"thrust_percent", "thrust % "}, std::pair{"latency_ms", "latency ms "}})
    if (found.contains(key))
      left += (left.empty() ? "" : ", ") + std::string{words} +
              fixed(found.at(key).at("rms").get<double>(), 1) + " (" +
              fixed(found.at(key).at("rms_in_sigmas").get<double>(), 2) + " sigma)";
  if (!left.empty()) print_line("after lap 1", "RMS left of " + left);
}

}  // namespace

void print_campaign(const nlohmann::ordered_json& campaign, const std::filesystem::path& out,
                    bool quiet) {
  const auto& arguments = campaign.at("arguments");
  const auto& result = campaign.at("result");
  const auto& interval = result.at("completion_wilson95");
  std::cout << arguments.at("track").get<std::string>() << ", "
            << files::amount(result.at("runs").get<int>(), "run") << ", "
            << arguments.at("vision").get<std::string>() << " vision: " << result.at("finished")
            << " finished, " << percent(result.at("completion_rate")) << " (95 % interval "
            << percent(interval.at(0)) << " to " << percent(interval.at(1)) << ")\n";
  if (quiet) return;
  const auto& line = print_line;
  line("seeds", arguments.at("first_seed").dump() + " on");
  line("gates",
       result.at("gates_passed").dump() + " of " + result.at("gates_total").dump() + " passed");
  const auto spread = [&](const char* name, const char* key, const char* unit, int digits) {
    const auto& q = result.at(key);
    if (q.is_null()) return;
    const auto at = [&](const char* which) { return fixed(q.at(which).get<double>(), digits); };
    line(name, at("p50") + unit + " median, " + at("p10") + " to " + at("p90") + unit +
                   " (10 to 90 %), " + at("min") + " to " + at("max") + unit + " in all");
  };
  spread("race time", "race_time_s", " s", 1);
  spread("speed", "mean_speed_mps", " m/s", 2);
  const auto& consistency = result.at("consistency");
  const auto consistent = [&](const char* name, const char* key, const char* what) {
    const auto& count = consistency.at(key);
    if (count.at("samples") == 0) return;
    line(name, std::string{what} + " " + fixed(count.at("mean_per_dof"), 2) + " (1 is expected), " +
                   percent(count.at("inside_95")) + " inside the 95 % bounds");
  };
  consistent("consistency", "nees", "NEES / degree of freedom");
  if (consistency.contains("nees_median_of_races") && consistency.at("nees").at("samples") != 0)
    line("", "median of the races' own NEES " +
                 fixed(consistency.at("nees_median_of_races").get<double>(), 2));
  consistent("", "nis", "NIS / degree of freedom");
  if (consistency.at("divergences") != 0)
    line("",
         consistency.at("divergences").dump() + " times > 1 m off for > 1 s with a gate in view");
  print_found(result);
  constexpr std::size_t kShown = 8;
  const auto& causes = result.at("causes");
  for (std::size_t i = 0; i < std::min(kShown, causes.size()); ++i) {
    line(i == 0 ? "not finished" : "", causes[i].at("count").dump() + " x " +
                                           causes[i].at("cause").get<std::string>() + " (seed " +
                                           first_of(causes[i].at("seeds")) + ")");
  }
  if (causes.size() > kShown)
    line("", std::to_string(causes.size() - kShown) + " more causes in campaign.json");
  std::string lost_by;
  for (const auto& why : result.value("lost_by", nlohmann::ordered_json::array()))
    lost_by += (lost_by.empty() ? "" : ", ") + why.at("count").dump() + " by " +
               why.at("cause").get<std::string>();
  if (!lost_by.empty()) line("lost", lost_by);
  if (campaign.contains("replay")) line("fly one again", campaign.at("replay").get<std::string>());
  line("files", (out / "").string());
}

void print_comparison(const nlohmann::ordered_json& comparison) {
  const auto& only_first = comparison.at("only_first");
  const auto& only_second = comparison.at("only_second");
  std::cout << comparison.at("first").get<std::string>() << " | "
            << comparison.at("second").get<std::string>() << ", " << comparison.at("pairs")
            << " seeds in common: " << comparison.at("both_finished") << " finished by both, "
            << only_first.size() << " | " << only_second.size() << " by one alone, "
            << comparison.at("neither_finished")
            << " by none (McNemar's p = " << probability(comparison.at("mcnemar_p")) << ")\n";
  if (!only_first.empty()) print_line("only the first", "seed " + first_of(only_first));
  if (!only_second.empty()) print_line("only the second", "seed " + first_of(only_second));
  const auto gain = [&](const char* name, const char* key, const char* unit, int digits) {
    const auto& q = comparison.at("second_minus_first").at(key);
    if (q.is_null()) return;
    const auto at = [&](const char* which) {
      const double value = q.at(which);
      return (value < 0 ? "" : "+") + fixed(value, digits);
    };
    print_line(name, at("p50") + unit + " median, " + at("p25") + " to " + at("p75") + unit +
                         " (quartiles), second - first");
  };
  gain("race time", "race_time_s", " s", 2);
  gain("speed", "mean_speed_mps", " m/s", 3);
  gain("gates", "gates_passed", "", 1);
  constexpr std::size_t kShown = 12;
  const auto& differences = comparison.at("differences");
  for (std::size_t i = 0; i < std::min(kShown, differences.size()); ++i)
    print_line(i == 0 ? "they differ in" : "", differences[i].get<std::string>());
  if (differences.size() > kShown)
    print_line("", std::to_string(differences.size() - kShown) + " more, see --json");
  if (differences.empty()) print_line("they differ in", "nothing");
  if (comparison.at("unpaired") != 0)
    print_line("left out", comparison.at("unpaired").dump() + " runs of one alone");
}

}  // namespace gatefly::cli
