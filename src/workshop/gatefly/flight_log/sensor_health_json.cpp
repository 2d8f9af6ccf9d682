// SPDX-License-Identifier: Apache-2.0
#include "gatefly/flight_log/sensor_health_json.hpp"

#include <nlohmann/json.hpp>

namespace gatefly::flight_log {

nlohmann::ordered_json as_json(const SensorHealth& health) {
  auto json = nlohmann::ordered_json::object();
  for (const SensorCount& each : kSensorCounts) json[each.key] = health.*each.count;
  return json;
}

std::string in_words(const SensorHealth& health) {
  std::string words;
  for (const SensorCount& each : kSensorCounts)
    if (health.*each.count > 0)
      words += (words.empty() ? "" : ", ") + std::string{each.what} + ": " +
               std::to_string(health.*each.count);
  return words;
}

}  // namespace gatefly::flight_log
