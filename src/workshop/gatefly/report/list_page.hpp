// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace gatefly::report {

/// A flight in a list: a campaign's run, or a flight folder.
struct ListedFlight {
  std::string name;        ///< "showroom-17"
  nlohmann::json summary;  ///< Its summary.json; null when it cannot be read.
  std::string page;        ///< Its report.html, relative to the list; "": there is none.
  std::string fly;         ///< The command that flies it (again); "": unknown.
  std::string note;        ///< Remark on it: why it has no page.
};

/// A campaign, or flights of a folder, as one page for a browser.
///
/// @param page      shipped_page("campaign.html").
/// @param title     "showroom, 100 runs, ideal vision".
/// @param campaign  campaign.json; null: just a folder of flights.
[[nodiscard]] std::string list_page(const std::string& page, const std::string& title,
                                    const nlohmann::ordered_json& campaign,
                                    const std::vector<ListedFlight>& flights);

/// Two campaigns of one course beside each other, as one page for a browser.
/// @param page        shipped_page("campaign.html").
/// @param comparison  what campaign --compare says, and "seeds": campaign_pairs().
[[nodiscard]] std::string comparison_page(const std::string& page, const std::string& title,
                                          const nlohmann::ordered_json& comparison);

}  // namespace gatefly::report
