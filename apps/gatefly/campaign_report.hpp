// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

namespace gatefly::cli {

/// Prints campaign.json on one screen.
void print_campaign(const nlohmann::ordered_json& campaign, const std::filesystem::path& out,
                    bool quiet);

}  // namespace gatefly::cli
