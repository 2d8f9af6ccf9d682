// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "gatefly/simulated_race/closed_loop/race.hpp"

namespace gatefly::simulated_race {

/// Inputs of a race.
struct RaceIdentity {
  std::string track;  ///< The track's name.
  std::uint64_t seed = 1;
  std::string vision = "rendered";  ///< Or "ideal".
  std::string version;              ///< gatefly's version.
  std::string commit;               ///< It was built from: built_from().
  /// Fingerprint of configuration, track and kind of vision: races that have the same differ in
  /// their seed only.
  std::string configuration;
  nlohmann::json config;  ///< Effective configuration: as_json(config).
};

/// summary.json with the keys people and scripts rely on. Only "timings" may differ between two
/// runs of one seed.
[[nodiscard]] nlohmann::ordered_json summary(const RaceResult& result, const RaceIdentity& race);

}  // namespace gatefly::simulated_race
