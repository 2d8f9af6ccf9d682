// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

namespace gatefly::cli {

/// Prints campaign.json on one screen.
void print_campaign(const nlohmann::ordered_json& campaign, const std::filesystem::path& out,
                    bool quiet);

/// Prints campaign_comparison() of two campaigns.
void print_comparison(const nlohmann::ordered_json& comparison);

}  // namespace gatefly::cli
