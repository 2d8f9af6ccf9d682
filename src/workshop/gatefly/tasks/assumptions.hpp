// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "gatefly/config/config.hpp"

namespace gatefly::tasks {

/// Source of a key: "default", "--set", or "config NAME".
[[nodiscard]] std::string who_set(const config::Config& config, const std::string& key);

/// A detector's assumptions on pictures, beside how they are turned.
struct Assumptions {
  std::string lens;     ///< Its model and size; "" where nobody named one.
  std::string lens_by;  ///< Its author; "" where nobody.
  std::string sides;    ///< How a straight bar is thought to look: "straight".
  std::string color;    ///< "as described by rgb 1, 0.4, 0", "as tuned in mine.colors.toml".
  std::string color_by;
  double min_score = 0.0;
  std::string threshold_by;
};
[[nodiscard]] Assumptions assumptions_of(const config::Config& config);

/// "no lens named, sides taken as straight; colour ...; min_score 2.5 (default)".
[[nodiscard]] std::string text_of(const Assumptions& assumed);
[[nodiscard]] nlohmann::ordered_json as_json(const Assumptions& assumed);

}  // namespace gatefly::tasks
