// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "campaign_folder.hpp"
#include "race_options.hpp"

namespace gatefly::cli {

/// "2/5": the second fifth of the seeds.
struct Shard {
  std::uint64_t index = 1, count = 1;
};

/// The seeds of a campaign.
struct SeedRange {
  std::uint64_t first = 1, runs = 1;
  Shard shard = {};
};

/// @throws std::runtime_error when the last of them would be beyond the largest number.
void expect_seeds(const SeedRange& range);

/// Flies what is missing of a campaign into its folder, until Ctrl-C: then interrupted() says so.
/// @param options  what `maker` was made of
/// @throws std::runtime_error as CampaignFolder::opened, or what a race threw.
[[nodiscard]] CampaignFolder flown(const simulated_race::RaceMaker& maker,
                                   const RaceOptions& options, const SeedRange& range,
                                   const std::filesystem::path& out, int jobs);

}  // namespace gatefly::cli
