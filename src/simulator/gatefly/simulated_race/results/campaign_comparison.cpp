// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/results/campaign_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "gatefly/files/quantile.hpp"
#include "gatefly/files/text.hpp"

namespace gatefly::simulated_race {
namespace {

/// Quartiles of what one gained on the other; null without any.
nlohmann::ordered_json spread(std::vector<double> values) {
  if (values.empty()) return nullptr;
  std::sort(values.begin(), values.end());
  return {{"p25", files::quantile(values, 0.25)},
          {"p50", files::quantile(values, 0.5)},
          {"p75", files::quantile(values, 0.75)}};
}

std::string whole(const nlohmann::json& value) {
  constexpr std::size_t kMost = 200;  // nobody reads more of a message
  return files::one_line(value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
                         kMost);
}

}  // namespace

double mcnemar_exact(int only_first, int only_second) {
  const int n = only_first + only_second, k = std::min(only_first, only_second);
  double tail = 0.0;
  for (int i = 0; i <= k; ++i)  // in logarithms, for a thousand pairs underflow
    tail += std::exp(std::lgamma(n + 1.0) - std::lgamma(i + 1.0) - std::lgamma(n - i + 1.0) -
                     n * std::log(2.0));
  return std::min(1.0, 2.0 * tail);
}

nlohmann::ordered_json campaign_comparison(const std::vector<RunRow>& first,
                                           const std::vector<RunRow>& second) {
  std::map<std::uint64_t, const RunRow*> other;
  for (const RunRow& row : second) other[row.seed] = &row;
  int pairs = 0, both = 0, neither = 0;
  std::vector<std::uint64_t> only_first, only_second;
  std::vector<double> time, speed, gates;
  for (const RunRow& a : first) {
    const auto found = other.find(a.seed);
    if (found == other.end()) continue;
    const RunRow& b = *found->second;
    ++pairs;
    gates.push_back(b.gates - a.gates);
    if (a.finished && b.finished) {
      ++both;
      time.push_back(b.time - a.time);
      if (const double gain = b.mean_speed - a.mean_speed; !std::isnan(gain)) speed.push_back(gain);
    } else if (a.finished) {
      only_first.push_back(a.seed);
    } else if (b.finished) {
      only_second.push_back(a.seed);
    } else {
      ++neither;
    }
  }
  nlohmann::ordered_json json;
  json["pairs"] = pairs;
  json["unpaired"] = static_cast<int>(first.size()) + static_cast<int>(second.size()) - 2 * pairs;
  json["both_finished"] = both;
  json["neither_finished"] = neither;
  json["only_first"] = only_first;
  json["only_second"] = only_second;
  json["mcnemar_p"] =
      mcnemar_exact(static_cast<int>(only_first.size()), static_cast<int>(only_second.size()));
  json["second_minus_first"] = {{"race_time_s", spread(time)},
                                {"mean_speed_mps", spread(speed)},
                                {"gates_passed", spread(gates)}};
  return json;
}

nlohmann::ordered_json campaign_pairs(const std::vector<RunRow>& first,
                                      const std::vector<RunRow>& second) {
  using Json = nlohmann::ordered_json;
  std::map<std::uint64_t, const RunRow*> other;
  for (const RunRow& row : second) other[row.seed] = &row;
  const auto when = [](const RunRow& row) { return row.finished ? Json(row.time) : Json{}; };
  const auto speed = [](const RunRow& row) {
    return row.finished && !std::isnan(row.mean_speed) ? Json(row.mean_speed) : Json{};
  };
  Json pairs = Json::array();
  for (const RunRow& a : first) {
    const auto found = other.find(a.seed);
    if (found == other.end()) continue;
    const RunRow& b = *found->second;
    pairs.push_back({{"seed", a.seed},
                     {"finished", {a.finished, b.finished}},
                     {"gates", {a.gates, b.gates}},
                     {"time_s", {when(a), when(b)}},
                     {"speed_mps", {speed(a), speed(b)}},
                     {"cause", {a.cause, b.cause}},
                     {"why", {a.why, b.why}}});
  }
  return pairs;
}

std::vector<std::string> argument_differences(const nlohmann::json& first,
                                              const nlohmann::json& second) {
  const auto a = first.flatten(), b = second.flatten();
  std::set<std::string> keys;
  for (const auto& [key, value] : a.items()) keys.insert(key);
  for (const auto& [key, value] : b.items()) keys.insert(key);
  std::vector<std::string> differences;
  for (const std::string& key : keys) {
    if (key == "/first_seed" || key == "/runs" || key.starts_with("/shard")) continue;
    const nlohmann::json was = a.value(key, nlohmann::json{}), is = b.value(key, nlohmann::json{});
    if (was == is) continue;
    std::string name = key.substr(key.starts_with("/config/") ? 8 : 1);
    std::replace(name.begin(), name.end(), '/', '.');
    if (name == "track_toml" || name == "color_table")
      differences.push_back(name == "track_toml" ? "the track file" : "the colour table");
    else
      differences.push_back(name + ": " + whole(was) + " | " + whole(is));
  }
  return differences;
}

}  // namespace gatefly::simulated_race
