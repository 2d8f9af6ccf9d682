// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace gatefly::report {

/// A line of the index: a folder in which gatefly has written.
struct IndexEntry {
  enum class Kind { kFlight, kReplay, kCampaign };
  std::string name;  ///< Folder name: "showroom-17".
  Kind kind = Kind::kFlight;
  nlohmann::json summary{};  ///< summary.json, or campaign.json; null when it cannot be read.
  std::string page{};        ///< Its page, relative to the index; "": there is none.
  std::string film{};        ///< Likewise its film.
  std::string note{};        ///< Remark on it: why it has no page.
  std::int64_t changed = 0;  ///< When it was written [s since 1970]; 0: unknown.
};

/// The flights, replays and campaigns of a folder as a page for a browser, to be sorted and filtered;
/// without JavaScript a plain table.
/// @param title  the folder's path.
[[nodiscard]] std::string index_page(const std::string& title,
                                     const std::vector<IndexEntry>& entries);

}  // namespace gatefly::report
