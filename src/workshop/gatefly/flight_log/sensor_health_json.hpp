// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "gatefly/sensing/sensor_health.hpp"

namespace gatefly::flight_log {

/// Every count by its name: "sensors" of a summary.
[[nodiscard]] nlohmann::ordered_json as_json(const SensorHealth& health);

/// "IMU samples stuck: 52, jumps of the clock: 1": the counts above zero; "" where all is well.
[[nodiscard]] std::string in_words(const SensorHealth& health);

}  // namespace gatefly::flight_log
