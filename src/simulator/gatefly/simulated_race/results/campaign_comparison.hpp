// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gatefly/simulated_race/results/campaign_statistics.hpp"

namespace gatefly::simulated_race {

/// How likely it is that two kinds of race that finish equally often differ as much as this or more,
/// when `only_first` of the paired races were finished by the first alone and `only_second` by the
/// second alone. McNemar 1947, in its exact form: two sides of the binomial with p = 1/2.
[[nodiscard]] double mcnemar_exact(int only_first, int only_second);

/// Two campaigns seed by seed: who finished what, and how much faster where both did. Seeds that
/// only one of them flew are counted and left out.
[[nodiscard]] nlohmann::ordered_json campaign_comparison(const std::vector<RunRow>& first,
                                                         const std::vector<RunRow>& second);

/// Every seed that both flew, for a page: [first, second] of what became of each.
[[nodiscard]] nlohmann::ordered_json campaign_pairs(const std::vector<RunRow>& first,
                                                    const std::vector<RunRow>& second);

/// The arguments in which two campaigns differ, "control.speed_mps: 2 | 1.5"; those that say which
/// seeds are left out.
[[nodiscard]] std::vector<std::string> argument_differences(const nlohmann::json& first,
                                                            const nlohmann::json& second);

}  // namespace gatefly::simulated_race
