// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace gatefly::report {

/// A page of viewer/ without its data, as gatefly comes with it: "report.html", "campaign.html".
/// @throws std::runtime_error when it is missing or no such page.
[[nodiscard]] std::string shipped_page(const std::string& name = "report.html");

/// JSON that may stand inside a script element: nothing in it can end the element.
[[nodiscard]] std::string in_a_script(const nlohmann::ordered_json& json);

/// Script elements in the place that the page keeps for them.
[[nodiscard]] std::string with_elements(const std::string& page, const std::string& elements);

/// One element a name.
[[nodiscard]] std::string with_data(
    const std::string& page,
    const std::vector<std::pair<std::string, nlohmann::ordered_json>>& data);

}  // namespace gatefly::report
